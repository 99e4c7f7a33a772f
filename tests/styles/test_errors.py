"""Bad input ends with an error that names the style, the keyword, the value and the remedy."""

import pytest
from harness import instance
from scenes import SMALL_SHEET as SHEET
from scenes import header

SHEET_FIX = SHEET + "fix sheet cloth pbd/cloth\n"
STEP = SHEET + "fix step water sph/integrate "
SHIFT = SHEET + "fix shift water sph/shift "
EMIT = SHEET + "fix pour water sph/emit "
NINE_SHEETS = "".join(
    f"create_cloth 2 1 size 0.2 0.2 center 0 0 {n / 10} spacing 0.1 group s{n}\n"
    f"fix s{n} s{n} pbd/cloth\n"
    for n in range(1, 10)
)


def case(name, script, message):
    return pytest.param(script, message, id=name)


CASES = [
    # pair_style and pair_coeff
    case(
        "pair: no support", SHEET + "pair_style sph/tait", r"pair_style sph/tait: support.*missing"
    ),
    case("pair: support < 0", SHEET + "pair_style sph/tait -1", r"support radius H is '-1'.*> 0"),
    case(
        "pair: no number", SHEET + "pair_style sph/tait ten", r"support radius H is 'ten'.*number"
    ),
    case("pair: nan", SHEET + "pair_style sph/tait nan", r"support radius H is 'nan'.*finite"),
    case("pair: kernel", SHEET + "pair_style sph/tait 0.1 kernel gauss", r"'gauss'.*wendland/c2"),
    case("pair: tension", SHEET + "pair_style sph/tait 0.1 tension maybe", r"'maybe'.*no or yes"),
    case("pair: keyword", SHEET + "pair_style sph/tait 0.1 color red", r"unknown keyword 'color'"),
    case("coeff: rho0", SHEET + "pair_coeff 1 1 fluid 0 c0 10", r"pair_coeff .*rho0 is '0'.*> 0"),
    case("coeff: no stiffness", SHEET + "pair_coeff 1 1 fluid 1000", r"needs a stiffness.*c0 C"),
    case("coeff: gamma", SHEET + "pair_coeff 1 1 fluid 1000 c0 9 gamma 1", r"gamma.*> 1"),
    case(
        "coeff: eta",
        SHEET + "pair_coeff 1 1 fluid 1000 fluctuation 0.01",
        r"reference speed.*missing",
    ),
    case("coeff: nu", SHEET + "pair_coeff 1 1 fluid 1000 c0 9 nu -1", r"nu is '-1'.*>= 0"),
    case("coeff: role I J", SHEET + "pair_coeff 1 2 fluid 1000 c0 9", r"role belongs to one type"),
    case("coeff: no role", SHEET + "pair_coeff 1 1 nu 1", r"pair 1 1 has no role"),
    case("coeff: volume", SHEET + "pair_coeff 2 2 boundary volume 0", r"volume is '0'.*> 0"),
    case("coeff: pair", SHEET + "pair_coeff 1 2 gamma 5", r"unknown keyword 'gamma'"),
    case("coeff: range", SHEET + "pair_coeff 1*5 1 none", r"first type is '1\*5'.*1 to 2, or a r"),
    case("bond: range", SHEET + "bond_coeff 2* 1", r"bond type is '2\*'.*1 to 1, or a range"),
    case(
        "coeff: stiffness of two fluids",
        SHEET + "pair_coeff 2 2 fluid 900 c0 20\npair_coeff 1 2 c0 10\nrun 0",
        r"pair_coeff \(sph/tait\): a stiffness of pair 1 2 is for a fluid and a boundary.*I = J",
    ),
    case("coeff: few", SHEET + "pair_coeff 1 1", r"pair_coeff"),
    case(
        "init: no role for a type",
        SHEET.replace("pair_coeff 2 2 boundary", "") + "run 0",
        r"All pair coeffs are not set",
    ),
    case(
        "init: a support in millimeters",
        SHEET.replace("sph/tait 0.1", "sph/tait 100") + "run 0",
        r"the support 100 of types 1 and 1 is 50 times the box, 2, and reaches over .*units",
    ),
    case("init: ghost velocities", SHEET + "comm_modify vel no\nrun 0", r"comm_modify vel yes"),
    case(
        "init: excluded pairs",
        SHEET_FIX + "neigh_modify exclude group cloth cloth\nrun 0",
        r"neigh_modify exclude group or molecule would hide.*remove it",
    ),
    case(
        "run: continuity without a density",
        SHEET.replace("sph/tait 0.1", "sph/tait 0.1 density continuity") + "run 0",
        r"particle \d+ has density 0.*set group all sph/rho RHO0.*density summation",
    ),
    case(
        "run: a density beyond all measure",
        SHEET + "mass 1 1e60\nrun 0",
        r"pair_style sph/tait: particle 50 has density .*overlap or the time step is too large",
    ),
    case("pair: delta", "pair_style sph/tait 0.1 delta -1", r"delta is '-1'.*>= 0"),
    case("pair: precision", "pair_style sph/tait 0.1 precision half", r"'half'.*double or mixed"),
    case(
        "pair: density",
        "pair_style sph/tait 0.1 density sum",
        r"'sum'.*summation or continuity or calibrated",
    ),
    case(
        "init: support in other units than the box",
        SHEET.replace("sph/tait 0.1", "sph/tait 1e300") + "run 0",
        r"support 1e\+300 of types 1 and 1 is 5e\+299 times the box, 2, .*units",
    ),
    case(
        "init: atom style without density",
        SHEET.replace("hybrid sph molecular", "molecular") + "run 0",
        r"atom_style molecular has no density.*hybrid sph molecular",
    ),
    case(
        "run: NaN",
        SHEET + "fix step water sph/integrate constant\nrun 0\nset type 1 vx NaN\nrun 3",
        r"(density|Non-numeric|NaN|finite|floating|number)",
    ),
    # bonds and hinges
    case("bond: k > 1", SHEET + "bond_coeff 1 1.5", r"bond_coeff .*stiffness k is '1.5'.*0 to 1"),
    case("bond: none", SHEET + "bond_coeff 1", r"stiffness k is missing"),
    case("bond: many", SHEET + "bond_coeff 1 0.5 3", r"'3'"),
    case("bond: compliance", SHEET + "bond_coeff 1 compliance -1", r"compliance is '-1'.*>= 0"),
    case("bond: overflow", SHEET + "bond_coeff 1 compliance 1e400", r"'1e400'.*finite number"),
    case("bond: no compliance", SHEET + "bond_coeff 1 compliance", r"compliance is missing"),
    case("bond: compress", SHEET + "bond_coeff 1 1 compress 2", r"compress is '2'.*0 to 1"),
    case(
        "bond: share of nothing",
        SHEET + "bond_coeff 1 1 compress 0.5",
        r"compress is '0.5.*compliance > 0",
    ),
    case("bond: limit", SHEET + "bond_coeff 1 1 limit -0.1", r"limit is '-0.1'.*>= 0"),
    case("bond: rest", SHEET + "bond_coeff 1 1 rest flat", r"rest is 'flat': use model or zero"),
    case(
        "hinge: rest", SHEET + "dihedral_coeff 1 1 rest zero", r"rest is 'zero': use model or flat"
    ),
    case("hinge: limit", SHEET + "dihedral_coeff 1 1 limit 1", r"unknown keyword 'limit'"),
    case("hinge: k < 0", SHEET + "dihedral_coeff 1 -0.5", r"dihedral_coeff .*'-0.5'.*0 to 1"),
    # fix pbd/cloth
    case(
        "cloth: keyword", SHEET + "fix s cloth pbd/cloth stretch 1", r"fix s pbd/cloth.*'stretch'"
    ),
    case("cloth: strain", SHEET + "fix s cloth pbd/cloth strain 0", r"strain is '0'.*> 0"),
    case(
        "cloth: strain of whole steps",
        SHEET + "fix s cloth pbd/cloth strain 0.1 solver gs",
        r"strain is '0.1.*how long substeps are: leave it out",
    ),
    case("cloth: sweeps", SHEET + "fix s cloth pbd/cloth iterations 0", r"iterations is '0'"),
    case(
        "cloth: solver",
        SHEET + "fix s cloth pbd/cloth solver sor",
        r"solver is 'sor': use gs or jacobi or substeps",
    ),
    case(
        "cloth: direction",
        SHEET + "fix s cloth pbd/cloth direction end",
        r"direction is 'end': use current or start",
    ),
    case("cloth: tolerance", SHEET + "fix s cloth pbd/cloth tolerance 0", r"tolerance is '0'.*> 0"),
    case(
        "cloth: tolerance of substeps",
        SHEET + "fix s cloth pbd/cloth tolerance 0.1 solver substeps",
        r"tolerance is '0.1.*one sweep each.*solver gs",
    ),
    case(
        "cloth: order of jacobi",
        SHEET + "fix s cloth pbd/cloth order symmetric solver jacobi",
        r"order is 'symmetric'.*have no order",
    ),
    case("cloth: reference", SHEET + "fix s cloth pbd/cloth reference 0", r"reference is '0'.*> 0"),
    case("cloth: damping", SHEET + "fix s cloth pbd/cloth damping -1", r"damping rate is '-1'"),
    case(
        "cloth: no pin group",
        SHEET + "fix s cloth pbd/cloth pin gone",
        r"pin group is 'gone'.*group",
    ),
    case(
        "cloth: empty pins", SHEET + "fix s cloth pbd/cloth pin vacant", r"pin.*'vacant'.*no vertex"
    ),
    case(
        "cloth: rest",
        SHEET + "fix s cloth pbd/cloth rest d2_r",
        r"rest property 'd2_r'.*property/atom",
    ),
    case(
        "cloth: velocity of no pins",
        SHEET + "fix s cloth pbd/cloth velocity 0 0 1",
        r"fix s pbd/cloth: velocity is that of pins: name their group with 'pin'",
    ),
    case(
        "cloth: velocity of no variable",
        SHEET + "fix s cloth pbd/cloth pin cloth velocity 0 v_speed 1",
        r"fix s pbd/cloth: velocity is 'v_speed': define an equal- or atom-style variable",
    ),
    case(
        "cloth: velocity of a string",
        SHEET + "variable speed string fast\nfix s cloth pbd/cloth pin cloth velocity 0 v_speed 1",
        r"fix s pbd/cloth: velocity is 'v_speed': define an equal- or atom-style variable",
    ),
    case(
        "cloth: atom style",
        "atom_style sph\nregion box block -1 1 -1 1 -1 1\ncreate_box 1 box\nfix s all pbd/cloth",
        r"fix s pbd/cloth: atom_style sph has no bonds: use .*hybrid sph molecular",
    ),
    case("cloth: empty", SHEET + "fix s vacant pbd/cloth", r"group vacant has no atoms"),
    case("cloth: no bonds", SHEET + "fix s water pbd/cloth\nrun 0", r"group water has no bonds"),
    case(
        "cloth: bonds leave the group",
        SHEET + "group half id 1:10\nfix s half pbd/cloth\nrun 0",
        r"bond of atom \d+ leaves the group at atom \d+",
    ),
    case(
        "cloth: two on one vertex",
        SHEET_FIX + "group half id 1:10\nfix b half pbd/cloth\nrun 0",
        r"shares vertices with fix",
    ),
    case(
        "cloth: other bond style",
        SHEET_FIX + "bond_style zero\nbond_coeff *\nrun 0",
        r"bond_style zero holds no stiffness.*bond_style pbd",
    ),
    case(
        "cloth: vertex added later",
        SHEET_FIX + "create_atoms 2 single 0 0 -0.5\ngroup cloth id 51\nrun 0",
        r"has no rest position",
    ),
    # fix cloth/contact
    case("contact: thickness", SHEET_FIX + "fix c water cloth/contact 0", r"thickness is '0'.*> 0"),
    case(
        "contact: thickness above the box",
        SHEET_FIX + "fix c water cloth/contact 1e20\nrun 0",
        r"fix c cloth/contact: needs ghosts as far as 1e\+20, .* images of each atom",
    ),
    case("contact: none", SHEET_FIX + "fix c water cloth/contact", r"thickness is missing"),
    case(
        "contact: no cloth", SHEET + "fix c water cloth/contact 0.01\nrun 0", r"there is no cloth"
    ),
    case(
        "contact: group",
        SHEET_FIX + "fix c all cloth/contact 0.01\nrun 0",
        r"group all holds vertices",
    ),
    case(
        "contact: cloth behind",
        SHEET + "fix c water cloth/contact 0.01\nfix s cloth pbd/cloth\nrun 0",
        r"fix c cloth/contact: fix s pbd/cloth is defined after it: define it before",
    ),
    case(
        "contact: many sheets",
        SHEET + NINE_SHEETS + "fix c water cloth/contact 0.01\nrun 0",
        r"fix c cloth/contact: 9 cloths and open obstacles have sides, the most are 8: "
        r"give 'sides no'",
    ),
    case(
        "contact: two that part the fluid",
        SHEET_FIX + "fix c water cloth/contact 0.01\nfix d water cloth/contact 0.01\nrun 0",
        r"pair_style sph/tait: fix c and fix d cloth/contact both part .* one of them 'sides no'",
    ),
    case(
        "contact: wall without fluid",
        SHEET_FIX + "fix c water cloth/contact 0.01 wall yes\npair_style zero 0.2\n"
        "pair_coeff * *\nrun 0",
        r"fix c cloth/contact: 'wall' fills .*there is none: use 'pair_style sph/tait', or 'wall n",
    ),
    case(
        "contact: no triangles",
        SHEET_FIX + "delete_bonds all angle 1 remove\nfix c water cloth/contact 0.01\nrun 0",
        r"cloth has no triangles.*Angles",
    ),
    case(
        "contact: coarse mesh, and no ghosts that could reach farther",
        SHEET_FIX.replace("neighbor 0.05 bin", "neighbor 0.02 multi\ncomm_modify mode multi")
        + "fix c water cloth/contact 0.01\nrun 0",
        r"vertex \d+ is out of reach|longest edge of the mesh and .* are 0.15.*comm_modify cutoff",
    ),
    # fix sph/shift
    case("shift: keyword", SHIFT + "color 1", r"fix shift sph/shift: unknown keyword 'color'"),
    case("shift: strength", SHIFT + "strength -1", r"fix shift sph/shift: strength is '-1'.*>= 0"),
    case("shift: speed", SHIFT + "speed slow", r"speed is 'slow'.*largest or own"),
    case("shift: max", SHIFT + "max 2", r"max is '2'.*0 to 1"),
    case("shift: surface", SHIFT + "surface -0.1", r"surface is '-0.1'.*0 to 1"),
    case("shift: clumping", SHIFT + "clumping nan", r"clumping is 'nan'.*finite"),
    case("shift: correct", SHIFT + "correct maybe", r"correct is 'maybe'.*no or yes"),
    case("shift: no value", SHIFT + "max", r"fix shift sph/shift: max is missing"),
    case(
        "shift: cloth in the group",
        SHEET + "fix shift all sph/shift\nrun 0",
        r"fix shift sph/shift: group all holds type 2, a boundary type.*group of fluid",
    ),
    case(
        "shift: twice",
        SHIFT + "\nfix again water sph/shift\nrun 0",
        r"another fix sph/shift: keep one",
    ),
    case(
        "shift: no pair style",
        SHIFT + "\npair_style zero 0.2\npair_coeff * *\nrun 0",
        r"fix shift sph/shift: pair_style zero.*use 'pair_style sph/tait'",
    ),
    # fix sph/integrate and run_style
    case("step: scheme", STEP + "local", r"scheme is 'local'.*constant or global"),
    case("step: keyword", STEP + "global speed 1", r"unknown keyword 'speed'"),
    case("step: accuracy 0", STEP + "global accuracy 0", r"accuracy is '0'.*> 0"),
    case("step: accuracy 2", STEP + "global accuracy 2", r"accuracy is '2'.*share up to 1"),
    case(
        "step: accuracy and a limit",
        STEP + "global force 0.1 accuracy 0.01",
        r"fix step sph/integrate: accuracy is '0.01': it takes the place of velocity, force.*leave",
    ),
    case(
        "step: accuracy and acoustic",
        STEP + "global accuracy 0.01 acoustic 0.5",
        r"accuracy is '0.01': it takes the place of .*acoustic.*leave these out",
    ),
    case("step: growth", STEP + "global growth 3", r"growth is '3.*at most 2"),
    case("step: below", STEP + "global below zero", r"below is 'zero'.*stop or clamp"),
    case("step: relative", STEP + "global relative -1", r"relative is '-1'.*>= 0"),
    case("step: cloth limit", STEP + "global cloth nan", r"cloth is 'nan'.*finite"),
    case("step: fluctuation", STEP + "global fluctuation x", r"fluctuation is 'x'.*finite"),
    case("step: output", STEP + "global output", r"output is missing"),
    case(
        "step: output, constant",
        STEP + "constant output 0.1\nrun 0",
        r"fix step sph/integrate: output 0.1 would shorten.*use the scheme global",
    ),
    case(
        "step: output, run style",
        STEP + "global output 0.1\nrun_style sph/adaptive constant\nrun 0",
        r"fix step sph/integrate: output 0.1 would shorten.*use the scheme global",
    ),
    case("step: gain", STEP + "global gain 0.9", r"gain is '0.9'.*>= 1"),
    case("step: min > max", STEP + "global min 1 max 0.1", r"min 1 is above max 0.1"),
    case(
        "step: no pair",
        STEP + "global\npair_style zero 0.2\npair_coeff * *\nrun 0",
        r"pair_style zero",
    ),
    case(
        "step: cloth",
        SHEET + "fix step all sph/integrate global\nrun 0",
        r"group all holds type 2, a boundary",
    ),
    case(
        "step: twice",
        STEP + "global\nfix again water sph/integrate global\nrun 0",
        r"another fix sph/integrate",
    ),
    case("run style: value", STEP + "global\nrun_style sph/adaptive all", r"scheme is 'all'"),
    case(
        "run style: no fix",
        SHEET + "run_style sph/adaptive global\nrun 0",
        r"needs one fix sph/integrate",
    ),
    # sources
    case("emit: count", EMIT + "0 1 0.05", r"fix pour sph/emit: number of particles is '0'"),
    case("emit: type", EMIT + "10 7 0.05", r"atom type is '7'.*1 to 2"),
    case("emit: opening", EMIT + "10 1 0.05 velocity 0 0 -1", r"opening is missing.*disc"),
    case("emit: velocity", EMIT + "10 1 0.05 disc 0 0 0 0.1", r"velocity is missing"),
    case("emit: radius", EMIT + "10 1 0.05 disc 0 0 0 -1", r"disc radius is '-1'"),
    case(
        "emit: fine",
        EMIT + "10 1 1e-6 disc 0 0 0 10 velocity 0 0 -1",
        r"fix pour sph/emit: spacing 1e-06 makes 4e\+14 particles in a layer, more than 1e\+08",
    ),
    case("emit: short", EMIT + "10 1 0.05 disc 0 0", r"disc center z is missing"),
    case(
        "emit: boundary type",
        EMIT + "10 2 0.05 disc 0 0 0 0.1 velocity 0 0 -1\nrun 0",
        r"type 2 is no fluid",
    ),
    case(
        "emit: out of the box",
        EMIT + "10 1 0.05 disc 0.99 0 0 0.1 velocity 0 0 -1\nrun 0",
        r"opening reaches out of the box",
    ),
    case(
        "emit: fast",
        SHEET.replace("boundary p p p", "boundary f f f")
        + EMIT.removeprefix(SHEET)
        + "100 1 0.05 disc 0 0 -0.95 0.1 velocity 0 0 -20\ntimestep 0.01\n"
        "fix step water sph/integrate constant\nrun 3",
        r"fix pour sph/emit: \d+ of \d+ particles of a layer fell out .* move the opening inwards",
    ),
    case(
        "emit: mass of a type",
        EMIT + "10 1 0.05 disc 0 0 0 0.1 velocity 0 0 -1 mass 2\nrun 0",
        r"masses belong to types",
    ),
    case(
        "drain: region",
        SHEET + "fix d water sph/drain region sea",
        r"region is 'sea'.*region command",
    ),
    case("drain: keyword", SHEET + "fix d water sph/drain sea", r"unknown keyword 'sea'"),
    case("drain: cloth", SHEET + "fix d all sph/drain\nrun 0", r"group all holds bonded atoms"),
    # create_cloth
    case("create: type", SHEET + "create_cloth 5 1.0", r"create_cloth: atom type is '5'"),
    case("create: mass", SHEET + "create_cloth 2 0", r"mass per area is '0'"),
    case(
        "create: size",
        SHEET + "create_cloth 2 1 spacing 0.1",
        r"size is missing.*size LX LY.*disc R",
    ),
    case("create: spacing", SHEET + "create_cloth 2 1 size 1 1", r"spacing is missing"),
    case(
        "create: size and disc",
        SHEET + "create_cloth 2 1 size 1 1 disc 0.5 spacing 0.1",
        r"create_cloth: .*both size 1 1 and disc 0.5: remove one",
    ),
    case("create: disc", SHEET + "create_cloth 2 1 disc -0.5", r"disc, radius is '-0.5'.*> 0"),
    case(
        "create: pattern of a disc",
        SHEET + "create_cloth 2 1 disc 0.5 spacing 0.1 pattern square",
        r"create_cloth: pattern is .*disc 0.5 .*remove pattern",
    ),
    case(
        "create: shear of a disc",
        SHEET + "create_cloth 2 1 disc 0.5 spacing 0.1 shear 1",
        r"create_cloth: shear is .*disc 0.5 .*remove shear",
    ),
    case(
        "create: coarse disc",
        SHEET + "create_cloth 2 1 disc 0.5 spacing 0.6",
        r"spacing 0.6 is larger than the radius 0.5: lower it",
    ),
    case(
        "create: disc out of the box",
        SHEET.replace("boundary p p p", "boundary f f f") + "create_cloth 2 1 disc 2 spacing 0.1",
        r"sheet reaches out of the box",
    ),
    case(
        "create: fine",
        SHEET + "create_cloth 2 1 size 1 5e9 spacing 1",
        r"create_cloth: spacing 1 cuts the sheet into 5e\+09 cells, more than 1e\+08: raise it",
    ),
    case(
        "create: fine disc",
        SHEET + "create_cloth 2 1 disc 1 spacing 1e-9",
        r"spacing 1e-09 cuts the sheet into 4e\+18 cells",
    ),
    case("create: coarse", SHEET + "create_cloth 2 1 size 1 1 spacing 3", r"spacing 3 is larger"),
    case(
        "create: pattern",
        SHEET + "create_cloth 2 1 pattern knit",
        r"pattern is 'knit'.*equilateral",
    ),
    case("create: region", SHEET + "create_cloth 2 1 pin edge pins", r"pin region is 'edge'"),
    case("create: bond type", SHEET + "create_cloth 2 1 bond 4", r"bond is '4'.*1 to 1"),
    case(
        "create: axes",
        SHEET + "create_cloth 2 1 size 1 1 spacing 0.1 axes 1 0 0 2 0 0",
        r"two axes are parallel",
    ),
    case(
        "create: far out of a periodic box",
        SHEET + "create_cloth 2 1 size 0.4 0.6 spacing 0.1 center 0 2147483648 0.1",
        r"create_cloth: the sheet reaches to \(.*more than 500 periodic boxes.*move its center",
    ),
    case(
        "create: out of the box",
        SHEET.replace("boundary p p p", "boundary f f f") + "create_cloth 2 1 size 3 1 spacing 0.1",
        r"sheet reaches out of the box",
    ),
    case(
        "create: no room",
        SHEET.replace("extra/bond/per/atom 8", ""),
        r"no room for .*extra/bond/per/atom",
    ),
    case(
        "create: atom style without bonds",
        "atom_style sph\nregion box block -1 1 -1 1 -1 1\ncreate_box 1 box\ncreate_cloth 1 1",
        r"create_cloth: atom_style sph has no bonds.*hybrid sph molecular",
    ),
    case(
        "create: no type",
        SHEET.replace("dihedral/types 1", "dihedral/types 0"),
        r"create_cloth: hinge type 1 does not exist: add 'dihedral/types 1' to create_box",
    ),
    case(
        "drain: region that is gone",
        SHEET_FIX + "region sea block INF INF INF INF INF -0.5\nfix d water sph/drain region sea\n"
        "region sea delete\nfix step water sph/integrate global\nrun 0",
        r"fix d sph/drain: region sea is gone: define it again",
    ),
    case(
        "cloth: a bond that leaves the group",
        SHEET + "group part id 1:10\nfix sheet part pbd/cloth\nrun 0",
        r"fix sheet pbd/cloth: a bond of atom \d+ leaves the group at atom \d+: put both",
    ),
    case("create: no box", header() + "create_cloth 2 1", r"there is no box"),
]


@pytest.mark.parametrize(("script", "message"), CASES)
def test_error(script, message):
    lmp = instance()
    with pytest.raises(Exception, match=message):
        lmp.commands_string(script)


def test_the_scene_of_these_tests_is_sound():
    lmp = instance()
    lmp.commands_string(
        SHEET_FIX
        + "fix step water sph/integrate global\nfix c water cloth/contact 0.005\n"
        + "fix d water sph/drain\nfix s water sph/shift\nrun_style sph/adaptive global\nrun 2"
    )
    assert lmp.extract_global("ntimestep") == 2
