"""Which style is tested in which scene: the data of ``test_styles.py``.

A new style needs an entry, and a scene in which it acts if none of these will do. It then has tests
of restart, ranks, newton, units and wrong words.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from gas_scenes import commands, icosphere
from scenes import (
    FLUID,
    MAKE_FLOW,
    box,
    cloth_box,
    filled,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    no_other_bonds,
    sph_tait,
    stiffness,
)
from scenes.shared import DROP_SCENE, Scene

# ---------------------------------------------------------------------- scenes

DROP = replace(
    DROP_SCENE,
    fixes=DROP_SCENE.fixes
    + """fix watch all sph/watch every 5 density 0.9 speed 99[m/s]
compute fluid fluid sph/atom density pressure energy sound volume neighbors dt active
compute cloth cloth pbd/atom sheet strain curvature area nx ny nz
compute edges all pbd/local sheet edge length strain
compute longest all reduce max c_edges[1] inputs local
compute most all reduce max c_edges[2] inputs local
compute steps all sph/step dt active compression updates
compute held all pbd/cloth force/z strain
""",
    steps=50,
)
# water without pressure: contact alone stops it
RAIN = replace(
    DROP_SCENE,
    forces=DROP_SCENE.forces.replace("c0 30[m/s] alpha 0.1 nu 1e-3[m^2/s]", "c0 1e-3[m/s]")
    .replace("2 2 boundary", "2 2 boundary pressure own")
    .replace("timestep 0.002[s]", "timestep 5e-4[s]"),
    fixes=DROP_SCENE.fixes.replace("sph/integrate global gain 1", "sph/integrate constant").replace(
        "0.015[m]", "0.02[m]"
    )
    + "compute met all cloth/contact overlap contacts\n",
    steps=50,
)
# every kind of constraint at once, with edges projected along their start
COMPLIANT = replace(
    DROP,
    forces=DROP.forces.replace(
        "bond_coeff 1 1.0", "bond_coeff 1 compliance 1e-5[m/N] compress 0.5 limit 0.02"
    ).replace("dihedral_coeff 1 0.1", "dihedral_coeff 1 compliance 1[1/J] rest flat"),
    fixes=DROP.fixes.replace("iterations 5", "iterations 5 solver gs direction start"),
    steps=20,
)
COMPLIANT = replace(
    COMPLIANT,
    fixes=COMPLIANT.fixes
    + "variable breeze equal 20[m/s]-300[m/s^2]*time\n"
    + "fix air cloth cloth/air density 1.2[kg/m^3] wind v_breeze 0 -10[m/s] &\n"
    + "  gust 5[m/s] 0.5[m] 11 normal 1.3 tangential 0.02 shaded yes added_mass 0.05[m]\n",
)
# the sheet itself is the boundary of the water
SHEET_AS_WALL = replace(
    DROP_SCENE,
    forces=DROP_SCENE.forces.replace("2 2 boundary", "2 2 none"),
    settings=DROP_SCENE.settings.replace("neigh_modify", "comm_modify cutoff 0.3[m]\nneigh_modify"),
    fixes=DROP_SCENE.fixes.replace("cloth/contact 0.015[m]", "cloth/contact 0.015[m] wall yes"),
    steps=12,
)
# impulses of ghosts are added in the order in which they come, another one behind a restart
BLOCK = replace(
    DROP,
    fixes=DROP.fixes
    + "fix air cloth cloth/air density 1.2[kg/m^3] wind 5[m/s] 0 3[m/s]\n"
    + "run_style sph/adaptive block\n",
    steps=20,
    exact_on=1,
)

# a jittered block of water between six planes, of which one comes down and one slides
TANK = Scene(
    make=header("f f f", FLUID)
    + box("-0.1 0.5 -0.1 0.5 -0.1 0.6")
    + "mass 1 0.125\n"
    + lattice()
    + filled("water", "0 0.4 0 0.4 0 0.4")
    + jitter(0.01, 77)
    + "velocity all set 1 -2 -1 units box\nwrite_data tank.data\n",
    atoms=header("f f f", FLUID) + "read_data tank.data\n",
    forces=sph_tait(
        "1 1 fluid 1000.0[kg/m^3] c0 20[m/s] nu 1e-2[m^2/s] alpha 0.1", support="0.1[m]"
    )
    + "timestep 1e-3[s]\n",
    settings=neighbor("0.03[m]"),
    fixes="variable lid equal 0.45[m]-0.4[m/s]*time\n"
    + gravity(g="9.81[N/kg]")
    + """fix wall all wall/sph xlo 0 xhi 0.4[m] ylo 0 yhi 0.4[m] zlo 0 zhi v_lid &
  velocity zlo 1[m/s] 0.5[m/s] 0
fix step all sph/integrate global
""",
    steps=50,
)

# water comes in, falls, and is taken away
POUR = Scene(
    atoms=header("f f f", FLUID)
    + box("-0.5[m] 0.5[m] -0.5[m] 0.5[m] -0.5[m] 1[m]")
    + "mass 1 0.1209[kg]\ngroup water type 1\n",
    forces=sph_tait("1 1 fluid 1000[kg/m^3] c0 20[m/s]", support="0.1[m]") + "timestep 1e-3[s]\n",
    settings=neighbor("0.03[m]") + "region low block INF INF INF INF INF 0.65[m] units box\n",
    fixes="""fix step water sph/integrate constant
fix pour water sph/emit 300 1 0.05[m] disc 0 0 0.8[m] 0.12[m] velocity 0 0 -2[m/s]
fix out water sph/drain region low
"""
    + gravity("water", g="9.81[N/kg]"),
    steps=50,
)

# vortices in a tilted periodic box, in two dimensions
FLOW = Scene(
    make=MAKE_FLOW,
    atoms=header("p p p", FLUID, dimension=2) + "read_data flow.data\n",
    forces=sph_tait(
        "1 1 fluid 1000.0[kg/m^2] c0 10[m/s] nu 1e-3[m^2/s]",
        support="0.15[m]",
        options="tension yes density continuity delta 0.1",
    )
    + "timestep 1e-3[s]\n",
    settings=neighbor("0.02[m]"),
    fixes="""fix shift all sph/shift strength 2 correct yes
fix step all sph/integrate global max 2e-3[s]
fix flat all enforce2d
""",
    finish="""sph_write kernel 1 1 11 kernel.table
sph_write state 1 5 state.table 1000[kg/m^2] 1100[kg/m^2]
""",
    steps=30,
)

# a round sheet that is made on all ranks and falls, held at its rim
ROUND = Scene(
    atoms=header()
    + cloth_box("-1[m] 1[m] -1[m] 1[m] -1[m] 1[m]", 1)
    + "region rim cylinder z 0.1[m] 0.2[m] 0.45[m] INF INF side out units box\n"
    + "create_cloth 1 2.0[kg/m^2] disc 0.5[m] spacing 0.1[m] center 0.1[m] 0.2[m] 0.3[m] &\n"
    + "  group cloth pin rim pins\n",
    forces=stiffness("0.9") + "timestep 1e-3[s]\n",
    settings=no_other_bonds() + "pair_style zero 0.3[m]\npair_coeff * *\n" + neighbor("0.03[m]"),
    fixes=gravity(g="9.81[N/kg]")
    + "fix sheet cloth pbd/cloth pin pins damping 1[1/s]\n"
    + "variable gale atom 5[m/s]-20[1/s]*y\n"
    + "fix air cloth cloth/air density 1.2[kg/m^3] wind v_gale 0 1[m/s] &\n"
    + "  tangential 0.02 added_mass 0.1[m] shaded yes\n",
    steps=10,
)

# a gas holds the sheet from below, more and more
LIFT = replace(
    BLOCK,
    fixes=BLOCK.fixes.replace(
        "run_style",
        "variable lift equal 300[Pa]*(1+step/100)\n"
        "fix lift cloth cloth/gas pressure v_lift toward 0 0 1\nrun_style",
    ),
)
TILTED = np.array([[1, 0.2, -0.1], [0, 1, 0.1], [0, 0, 1]])


def inside(x: np.ndarray) -> np.ndarray:
    """Return the images that are in the tilted box."""
    return x - np.floor(np.linalg.solve(TILTED, x.T)).T @ TILTED.T


# gauze below a drop: some of the water is behind it in the end
GAUZE = replace(
    DROP_SCENE,
    forces=DROP_SCENE.forces.replace("2 2 boundary", "2 2 none").replace("0.002[s]", "1e-3[s]"),
    fixes=DROP_SCENE.fixes
    + "fix pores fluid cloth/pores 1 darcy 50[Pa*s/m] forchheimer 50[kg/m^3] &\n"
    + "  medium 1e-7[m^2] 1e-4[m] 0.1 screen 0.1 2e-3[m]\n",
    steps=40,
)
# two of them across the faces of a tilted box, which are pumped up until a valve opens
BALLOONS = Scene(
    make=header()
    + "region box prism 0 1 0 1 0 1 0.2 -0.1 0.1 units box\ncreate_box 1 box bond/types 1 &\n"
    + "  angle/types 1 extra/bond/per/atom 8 extra/angle/per/atom 8\nmass * 0.01\n"
    + "pair_style zero 0.9\npair_coeff * *\nneighbor 0.1 bin\n"
    + commands(inside(icosphere(0, 0.3)[0] + 0.05), icosphere()[1])
    + commands(inside(icosphere(0, 0.25)[0] + 0.6), icosphere()[1], 13)
    + "velocity all create 1 123 loop all\nvelocity all scale 1\n"
    + "velocity all ramp vx -1 1 z 0 1 units box\nwrite_data balloons.data nocoeff\n",
    atoms=header() + "read_data balloons.data\n",
    forces="bond_style pbd\nbond_coeff 1 compliance 1e-3[m/N]\nangle_style zero\nangle_coeff *\n"
    + "timestep 1e-3[s]\n",
    settings="pair_style zero 0.4[m]\npair_coeff * *\n" + neighbor("0.03[m]", "0.5[m]"),
    fixes="fix sheet all pbd/cloth\n"
    + "fix gas all cloth/gas polytropic 1.4 1e4[Pa] 9900[Pa] inflow 0.02[m^3/s] valve 500[Pa]\n",
    steps=30,
    exact_on=0,  # LAMMPS turns positions into shares of a tilted box and back
)


def calibrated(scene: Scene, steps: int) -> Scene:
    """Return the scene with water of a calibrated density, and viscosity that is switched."""
    forces = scene.forces.replace("sph/tait 0.1[m]", "sph/tait 0.1[m] density calibrated")
    return replace(scene, forces=forces.replace("alpha 0.1", "alpha 0.1 switch 0.2"), steps=steps)


def followed(scene: Scene, steps: int) -> Scene:
    """Return the scene with a speed of sound that is too small at first and follows the flow."""
    forces = re.sub(r" (c0 \d+)(\S+)", r" \1\2 c0 follow 1\2 99\2 mach 0.05", scene.forces)
    fixes = scene.fixes + "compute sound all sph/step sound sound/work\n"
    return replace(scene, forces=forces, fixes=fixes, steps=steps)


SCENES = {
    "drop": DROP,
    "rain": RAIN,
    "compliant drop": COMPLIANT,
    "sheet as wall": SHEET_AS_WALL,
    "block steps": BLOCK,
    "tank": TANK,
    "pour": POUR,
    "flow": FLOW,
    "round sheet": ROUND,
    "lifted drop": LIFT,
    "gauze": GAUZE,
    "balloons": BALLOONS,
    "followed flow": followed(FLOW, 30),
}
for name, steps in {"tank": 30, "block steps": 19, "sheet as wall": 9}.items():
    SCENES[f"calibrated {name}"] = calibrated(SCENES[name], steps)
    SCENES[f"followed {name}"] = followed(SCENES[name], steps)

# ---------------------------------------------------------------------- styles


@dataclass(frozen=True)
class Entry:
    """A style in a scene.

    Attributes:
        kind, name: as the plugin registers it.
        scene: in which it acts.
        output: thermo keyword -> unit; none of them is zero at the end.
        counts: the same, without units, for what starts at 0 behind a restart.
        columns: dump column -> unit; none of them is zero everywhere.
        tables: file that the scene writes -> units of its columns.
        commands: beginnings of commands; every keyword that the style then says it knows is tried.
        flags: pattern of keywords that take no value.
        free: keywords whose value may be any word.
    """

    kind: str
    name: str
    scene: str
    output: Mapping[str, str] = field(default_factory=dict)
    counts: Mapping[str, str] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    commands: tuple[str, ...] = ()
    flags: str = ""
    free: str = ""

    def __str__(self) -> str:
        return f"{self.kind} {self.name} in {self.scene}"


SHEET = {"f_sheet[1]": "N", "f_sheet[2]": "N", "f_sheet[3]": "N", "f_sheet[4]": ""}
AIR = {"f_air[1]": "N", "f_air[3]": "N", "f_air[4]": "J/s", "f_air[5]": "J", "f_air[6]": "m^2"}
WALL = {f"f_wall[{k}]": "N" for k in range(1, 19)}
SOUND = {"c_sound[1]": "m/s", "c_sound[2]": "J"}
CLOTH = "fix s cloth pbd/cloth\n"

ENTRIES = (
    Entry(
        "pair",
        "sph/tait",
        "drop",
        output={"evdwl": "J"},
        commands=(
            "pair_style sph/tait 0.1",
            "pair_coeff 1 1 fluid 1000 c0 20",
            "pair_coeff 1 1 fluid 1000 c0 follow 5 20",
            "pair_coeff 2 2 boundary",
        ),
    ),
    Entry("pair", "sph/tait", "flow", output={"evdwl": "J"}),
    Entry("pair", "sph/tait", "calibrated block steps", output={"evdwl": "J"}),
    Entry("pair", "sph/tait", "calibrated sheet as wall", output={"evdwl": "J"}),
    Entry("fix", "wall/sph", "calibrated tank", output=WALL),
    *(Entry("compute", "sph/step", scene, output=SOUND) for scene in SCENES if "followed" in scene),
    Entry("bond", "pbd", "drop", output={"f_sheet[4]": ""}, commands=("bond_coeff 1 1.0",)),
    Entry("bond", "pbd", "compliant drop", output={"f_sheet[7]": "J", "f_sheet[4]": ""}),
    Entry(
        "dihedral",
        "pbd",
        "round sheet",
        output={"f_sheet[3]": "N", "f_sheet[4]": ""},
        commands=("dihedral_coeff 1 1.0",),
    ),
    Entry("dihedral", "pbd", "compliant drop", output={"f_sheet[7]": "J"}),
    Entry("fix", "pbd/cloth", "drop", output=SHEET, commands=("fix x cloth pbd/cloth",)),
    Entry("fix", "pbd/cloth", "block steps", output={"f_sheet[3]": "N", "f_sheet[4]": ""}),
    Entry(
        "fix",
        "cloth/contact",
        "rain",
        output={"f_contact[4]": "m"},
        counts={"f_contact[1]": ""},
        commands=(CLOTH + "fix x water cloth/contact 0.01",),
    ),
    Entry("fix", "cloth/gas", "lifted drop", output={"f_lift": "J", "f_lift[1]": "Pa"}),
    Entry(
        "fix",
        "cloth/gas",
        "balloons",
        output={
            "f_gas": "J",
            "f_gas[1]": "Pa",
            "f_gas[2]": "m^3",
            "f_gas[3]": "m^3",
            "f_gas[4]": "J",
            "f_gas[2][1]": "Pa",
        },
        counts={"f_gas[5]": ""},
        commands=("fix x cloth cloth/gas pressure 1", "fix x cloth cloth/gas polytropic 1.4 1 0"),
    ),
    Entry(
        "fix",
        "cloth/pores",
        "gauze",
        output={
            "f_pores[1]": "N",
            "f_pores[2]": "N",
            "f_pores[3]": "N",
            "f_pores[5]": "",
            "f_pores[6]": "m^3",
            "f_pores[7]": "J",
        },
        commands=(
            CLOTH + "fix c water cloth/contact 0.01\nfix x water cloth/pores 1",
            CLOTH + "fix c water cloth/contact 0.01\nfix x water cloth/pores 1 darcy 1",
        ),
    ),
    Entry("fix", "cloth/contact", "sheet as wall", counts={"f_contact[1]": ""}),
    Entry(
        "fix",
        "cloth/air",
        "compliant drop",
        output=AIR,
        commands=("fix x cloth cloth/air density 1.2",),
    ),
    Entry("fix", "cloth/air", "block steps", output=AIR),
    Entry("fix", "cloth/air", "round sheet", output=AIR),
    Entry(
        "fix",
        "sph/integrate",
        "drop",
        output={"time": "s", "f_step": "s", "f_step[2]": "", "f_step[3]": ""},
        commands=("fix x water sph/integrate global",),
    ),
    Entry("fix", "sph/integrate", "block steps", output={"time": "s", "f_step[3]": ""}),
    Entry(
        "fix",
        "sph/emit",
        "pour",
        output={"f_pour": "", "f_pour[1]": "", "f_pour[4]": "kg*m/s"},
        commands=("fix x water sph/emit 9 1 0.1",),
    ),
    Entry(
        "fix",
        "sph/drain",
        "pour",
        output={"f_out": "", "f_out[1]": "kg", "f_out[4]": "kg*m/s"},
        commands=("fix x water sph/drain",),
    ),
    Entry(
        "fix",
        "sph/shift",
        "flow",
        output={"f_shift": "", "f_shift[1]": "m", "f_shift[2]": ""},
        commands=("fix x water sph/shift",),
    ),
    Entry(
        "fix",
        "sph/watch",
        "drop",
        output={"f_watch": "", "f_watch[1]": "", "f_watch[2]": "m/s"},
        commands=("fix x all sph/watch",),
        free="restart",
    ),
    Entry(
        "fix",
        "wall/sph",
        "tank",
        output=WALL,
        commands=("fix x all wall/sph xlo -1",),
        flags="[xyz](lo|hi)",
    ),
    Entry(
        "compute",
        "cloth/contact",
        "rain",
        output={"c_met[1]": "m"},
        counts={"c_met[2]": ""},
        commands=("compute x all cloth/contact",),
        flags="(?!fix$).*",
        free="fix",
    ),
    Entry(
        "compute",
        "pbd/cloth",
        "drop",
        output={"c_held[1]": "N", "c_held[2]": ""},
        commands=("compute x all pbd/cloth",),
        flags="(?!fix$).*",
        free="fix",
    ),
    Entry(
        "compute",
        "sph/step",
        "drop",
        output={"c_steps[1]": "s", "c_steps[2]": "", "c_steps[3]": "", "c_steps[4]": ""},
        commands=("compute x all sph/step",),
        flags="(?!fix$).*",
        free="fix",
    ),
    Entry(
        "compute",
        "pbd/atom",
        "drop",
        columns={f"c_cloth[{k}]": u for k, u in enumerate(["", "1/m", "m^2", "", "", ""], 1)},
        commands=(CLOTH + "compute x all pbd/atom s",),
        flags=".*",
    ),
    Entry(
        "compute",
        "pbd/local",
        "drop",
        output={"c_longest": "m", "c_most": ""},
        commands=(
            CLOTH + "compute x all pbd/local s edge",
            CLOTH + "compute x all pbd/local s hinge",
        ),
        flags=".*",
    ),
    Entry(
        "compute",
        "sph/atom",
        "drop",
        columns={
            f"c_fluid[{k}]": unit
            for k, unit in enumerate(["kg/m^3", "Pa", "J", "m/s", "m^3", "", "s", ""], 1)
        },
        commands=("compute x all sph/atom",),
        flags=".*",
    ),
    Entry(
        "command",
        "create_cloth",
        "round sheet",
        columns={"mass": "kg", "z": "m"},
        commands=("create_cloth 2 1.0",),
        free="group",
    ),
    Entry(
        "command",
        "sph_write",
        "flow",
        tables={
            "kernel.table": ("m", "1/m^2", "1/m^3"),
            "state.table": ("kg/m^2", "Pa*m", "m/s", "J/kg"),
        },
        commands=("sph_write",),
        flags=".*",
    ),
    Entry(
        "run",
        "sph/adaptive",
        "block steps",
        output={"f_step": "s", "f_step[2]": ""},
        commands=("fix x water sph/integrate global\nrun_style sph/adaptive",),
        flags=".*",
    ),
)
