"""Substeps of fix pbd/cloth by their length: what a load needs, and no more."""

import re

import numpy as np
import pytest
from cloth_scenes import cloth
from harness import by_id, instance, run, write
from scenes import cloth_styles, header
from scipy.optimize import brentq

GRAVITY = 9.81
PULL = 200.0  # N per vertex of 0.02 kg, of 11 in a column
TOP = "region top block INF INF 0.45 INF INF INF\n"
PINNED = {"options": "pin top pins", "regions": TOP, "newton": "on"}


def hung(fix="", extra="", k=1.0):
    """Hang a sheet of 2 kg/m^2 in its plane by its upper side; the load comes at once."""
    lmp = cloth(fix=f"pin pins {fix}", extra=extra, k=k, bend=0.02, **PINNED)
    lmp.commands_string(f"unfix gravity\nfix load cloth addforce 0 -{PULL} 0\nrun 0")
    return lmp


def value(lmp, n):
    return lmp.extract_fix("sheet", 0, 1, n - 1)


@pytest.mark.parametrize("strain", [0.01, 0.003])
@pytest.mark.parametrize("dt", [1e-3, 4e-3])
def test_the_strain_of_rigid_edges_under_a_load_is_what_is_asked(dt, strain):
    """Ten substeps in a step leave 16 times more at 4 ms."""
    lmp = hung(f"damping 100 strain {strain}", f"timestep {dt}\n")
    lmp.command(f"run {round(0.8 / dt)}")
    assert 0.2 * strain < value(lmp, 11) < 1.6 * strain
    assert 0.5 * value(lmp, 11) < value(lmp, 4) < 2 * value(lmp, 11)


def hardened(share, strain, tension, mass, substep):
    """Strain of an edge of 1 m and one end of this mass, if unloaded it has `share` of w L^2."""
    load = share / mass * tension * substep**2 / strain
    return strain * brentq(lambda x: x * (1 + 9 * x**4) ** 2 - load, 0, 10)


@pytest.mark.parametrize(("strain", "substeps"), [(0.01, (10, 10)), (1e-5, (10, 60))])
def test_what_the_solver_leaves_of_a_chain(strain, substeps):
    """Of the upper edge between 3/4 and 5/4 of w T L^2, as the lower one comes later, hardened."""
    lmp = instance()
    lmp.commands_string(
        header(boundary="f f f", cutoff=2.0)
        + f"""
region box block -1 1 -1 1 -4 1
create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 2
create_atoms 1 single 0 0 0 units box
create_atoms 1 single 0 0 -1 units box
create_atoms 1 single 0 0 -2 units box
mass 1 0.1
group pins id 1
pair_style zero 2.0
pair_coeff * *
bond_style pbd
bond_coeff 1 1
create_bonds single/bond 1 1 2
create_bonds single/bond 1 2 3
fix gravity all gravity 9.81 vector 0 0 -1
fix sheet all pbd/cloth pin pins damping 20 strain {strain}
timestep 0.01
run 3000
"""
    )
    assert substeps[0] <= value(lmp, 6) <= substeps[1]
    least, most = (hardened(c, strain, 2 * 0.1 * GRAVITY, 0.1, 0.01 / 10) for c in (0.75, 1.25))
    assert value(lmp, 11) == pytest.approx(least, rel=0.05)
    assert 0.95 * least < value(lmp, 4) < 1.2 * most


def test_steps_that_are_shorter_than_a_substep_need_one():
    """The longest step has ten, and a load may ask for more."""
    lmp = cloth(extra="unfix gravity\n")
    lmp.command("run 1")
    assert value(lmp, 6) == 10
    lmp.commands_string("timestep 2.5e-4\nrun 1")
    assert value(lmp, 6) == 3
    lmp.commands_string("timestep 1e-5\nrun 1")
    assert value(lmp, 6) == 1


def test_iterations_say_how_many_there_are():
    lmp = hung("iterations 4")
    for dt in (1e-3, 1e-4):
        lmp.commands_string(f"timestep {dt}\nrun 5")
        assert value(lmp, 6) == 4


def test_edges_that_are_held_too_far_apart_take_no_more_substeps(tmp_path):
    """No substep brings a strain of 4 % down: a warning says so."""
    lmp = cloth(fix="pin pins damping 50", k=1.0, bend=0.02, **PINNED)
    lmp.commands_string(
        f"""log {tmp_path}/log
unfix gravity
region low block INF INF INF -0.45 INF INF
group low region low
group pins union pins low
displace_atoms low move 0 -0.04 0 units box
run 500
log none
"""
    )
    assert 0.04 < value(lmp, 4) < 0.12
    assert 10 <= value(lmp, 6) < 100
    text = (tmp_path / "log").read_text()
    assert len(re.findall("WARNING: fix sheet pbd/cloth: edges are strained by more", text)) == 1


LOADED = (
    header(boundary="f f f", cutoff=0.3)
    + "region box block -2 2 -2 2 -2 2\n"
    + "create_box 1 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &\n"
    + "  extra/angle/per/atom 8 extra/dihedral/per/atom 8\n"
    + TOP
    + """create_cloth 1 2.0 size 1.0 1.0 spacing 0.1 group cloth pin top pins
pair_style zero 0.3
pair_coeff * *
"""
    + cloth_styles(1.0, 0.5)
    + """variable push equal -10*(step>20)*(1+(step>60)*9)
fix push cloth addforce 0 v_push 0
fix sheet cloth pbd/cloth pin pins damping 20
timestep 2e-3
thermo 1
thermo_style custom step f_sheet[4] f_sheet[6] f_sheet[11]
thermo_modify format float %.12g
"""
)


def loaded(tmp_path, name):
    """A load that grows tenfold in a step, and the log file."""
    return f"{LOADED}log {tmp_path}/{name}\n"


def rows(path):
    found = re.findall(r"^ *(\d+) +(\S+) +(\d+) +(\S+) *$", path.read_text(), re.MULTILINE)
    return np.array(found, float)


CORNERS = """region left block INF -0.45 0.45 INF INF INF
region right block 0.45 INF 0.45 INF INF INF
region top union 2 left right
"""


@pytest.mark.parametrize(
    ("held", "load", "strain"), [(TOP, 3, 0.01), (CORNERS, 9, 0.01), (CORNERS, 9, 0.05)]
)
def test_a_sheet_under_a_load_comes_to_rest(held, load, strain):
    """Substeps that follow what they have shaken shake it on: by 0.2 to 0.7 m/s."""
    script = LOADED.replace(TOP, held).replace("*9)", f"*{load})")
    lmp = instance()
    lmp.commands_string(script.replace("damping 20", f"damping 20 strain {strain}") + "run 800")
    assert value(lmp, 6) > 11
    assert np.abs(by_id(lmp, "v")).max() < 1e-4


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_take_the_same_substeps(tmp_path, ranks):
    for n in (1, ranks):
        run(write(tmp_path, loaded(tmp_path, f"log.{n}") + "run 120\n"), ranks=n)
    one, more = rows(tmp_path / "log.1"), rows(tmp_path / f"log.{ranks}")
    assert len(one) == 121
    assert len(set(one[:, 2])) > 4
    assert np.array_equal(one[:, 2], more[:, 2])
    assert np.allclose(one, more, rtol=1e-9, atol=1e-12)


def continued(tmp_path, script_of, steps, more):
    """Rows of a run and of one that goes on from a restart file, behind `steps` of both."""
    with instance() as lmp:
        lmp.commands_string(
            f"{script_of(tmp_path, 'log.a')}run {steps}\nwrite_restart {tmp_path}/half\nrun {more}"
        )
        there = by_id(lmp, "x")
    script = script_of(tmp_path, "log.b")
    begin = script[: script.index("region box")]
    go_on = script[script.index("pair_style") :]
    with instance() as lmp:
        lmp.commands_string(f"{begin}read_restart {tmp_path}/half\n{go_on}run {more}\n")
        assert np.array_equal(by_id(lmp, "x"), there)
    return (rows(tmp_path / name)[-more:] for name in ("log.a", "log.b"))


def test_a_restart_goes_on_with_the_same_substeps(tmp_path):
    first, second = continued(tmp_path, loaded, 70, 50)
    assert np.array_equal(first[:, 2], second[:, 2])


def test_a_strain_that_no_substep_reaches_is_said(tmp_path):
    script = loaded(tmp_path, "log").replace("damping 20", "damping 20 strain 1e-6")
    text = run(write(tmp_path, script + "run 600\n"))
    assert len(re.findall("WARNING: fix sheet pbd/cloth: a strain of 1e-06 under the", text)) == 1
    assert "edges are strained by more" not in text
    found = rows(tmp_path / "log")
    assert 400 < found[:, 2].max() < 1000
    assert found[-1, 2] > 400
    assert found[-1, 3] > 1e-6


@pytest.mark.parametrize(
    ("speed", "density", "edge", "areal", "strain"),
    [
        (4, 1242, 0.18, 0.22, 0.02),
        (3, 1242, 0.18, 0.22, 0.01),
        (2.5, 900, 0.15, 0.22, 0.01),
        (4.5, 1000, 0.14, 1.0, 0.01),
        (2, 3000, 0.18, 0.22, 0.01),
    ],
)
def test_an_impact_gives_back_no_more_than_it_brought(
    tmp_path, speed, density, edge, areal, strain
):
    """Water of 50 to 500 times the mass of a vertex falls on a taut sheet.

    Substeps become short enough only while edges are stretched, by 1 to 6 %.  Less is allowed then,
    while the water is still there, which pulls at it: that may give some percent of the energy, and
    depends on round-off.
    """
    script = (
        header("f f f", "hybrid sph molecular")
        + "comm_modify vel yes\nregion box block -3 3 -3 3 -3 4\n"
        + "create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 10 &\n"
        "  extra/angle/per/atom 10 extra/dihedral/per/atom 20\n"
        "region pinned cylinder z 0 0 0.51 INF INF side out units box\n"
        f"create_cloth 2 {areal} disc 0.565 spacing {edge} axes 1 0 0 0 1 0 group cloth &\n"
        "  pin pinned pins\n"
        "lattice sc 0.1 origin 0.5 0.5 0.03\n"
        "region low block -0.297 0.297 -0.198 0.198 0.02 0.52 units box\n"
        "create_atoms 1 region low\ngroup water type 1\n"
        "pair_style sph/tait 0.23 tension no\n"
        f"pair_coeff 1 1 fluid {density} c0 45 alpha 0 spacing 0.1\npair_coeff 2 2 none\n"
        "neighbor 0.05 bin\nneigh_modify every 1 delay 0 check yes\n"
        f"velocity water set 0 0 -{speed} units box\n"
        + cloth_styles(1.0, 0.5)
        + "timestep 3.8e-3\nfix step water sph/integrate global\nrun_style sph/adaptive global\n"
        "fix sheet cloth pbd/cloth damping 5 pin pins\n"
        "fix contact water cloth/contact 0.016\n"
        "thermo_style custom step ke atoms c_sheet\nthermo_modify norm no\nthermo 1\n"
        f"log {tmp_path}/log\n"
    ).replace("thermo_style", "compute sheet all pbd/cloth strain\nthermo_style", 1)
    run(write(tmp_path, script + "run 80\n"))
    found = rows(tmp_path / "log")
    assert found[:, 3].max() > strain
    assert found[:, 1].max() < 1.05 * found[0, 1]
    assert found[-1, 1] > 0.1 * found[0, 1]


GRAIN = 3.0  # kg; a vertex has 0.04
GRAINS = (
    header("f f f", "hybrid sph molecular")
    + f"""comm_modify vel yes
region box block -1 1 -1 1 -3 1
create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 20
region inner block -0.34 0.34 -0.34 0.34 INF INF side out units box
create_cloth 1 1.0 size 0.8 0.8 spacing 0.2 pattern diagonal group cloth pin inner pins
lattice sc 0.08
region low block -0.17 0.17 -0.17 0.17 0.02 0.18 units box
create_atoms 2 region low
group grains type 2
mass 2 {GRAIN}
velocity grains set 0 0 -3 units box
pair_style zero 0.2
pair_coeff * *
neighbor 0.1 bin
"""
    + cloth_styles("compliance 0.001", 0)
    + f"""fix gravity all gravity 9.81 vector 0 0 -1
fix move grains nve
fix sheet cloth pbd/cloth pin pins
fix contact grains cloth/contact 0.01
compute grains grains ke
compute cloth cloth ke
compute height grains reduce sum z
variable energy equal c_grains+c_cloth+{GRAIN}*9.81*c_height+f_sheet[7]
thermo_style custom step v_energy f_sheet[6] f_contact[2]
thermo_modify norm no format float %.12g
thermo 1
timestep 4e-3
"""
)


MISSED = (
    "WARNING: fix sheet pbd/cloth: contact leaves more than half of the momentum that stops "
    "particles after {} iterations: what is heavy beside the cloth may gain energy; give more "
    "'iterations', or neither 'iterations' nor 'solver'"
)


def fallen(tmp_path, name, fix=""):
    """50 heavy grains fall on the nine free vertices of a light sheet; the end of the script."""
    script = GRAINS.replace("pin pins", f"pin pins {fix}")
    return f"{script}log {tmp_path}/{name}\n"


def test_grains_that_a_light_sheet_stops_gain_no_energy(tmp_path):
    """The sheet passes too little of its pull on to them in substeps of the usual length."""
    gained = {}
    for fix in ("", "iterations 10", "solver gs iterations 10"):
        run(write(tmp_path, fallen(tmp_path, "log", fix) + "run 80\n"))
        text = (tmp_path / "log").read_text()
        assert text.count(MISSED.format(10)) == (fix != "")
        found = rows(tmp_path / "log")
        energy = found[:, 1]
        gained[fix] = np.max(energy - np.minimum.accumulate(energy)) / energy[0]
        assert (found[:, 2].max() > 40) == (fix == "")
    assert energy[0] == pytest.approx(50 * GRAIN * (0.5 * 3**2 + GRAVITY * 0.12), rel=1e-6)
    assert gained[""] < 0.01
    assert gained["iterations 10"] > 0.3


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_take_the_same_substeps_for_contact(tmp_path, ranks):
    for n in (1, ranks):
        run(write(tmp_path, fallen(tmp_path, f"log.{n}") + "run 40\n"), ranks=n)
    one, more = rows(tmp_path / "log.1"), rows(tmp_path / f"log.{ranks}")
    assert one[:, 2].max() > 20
    assert np.array_equal(one[:, 2], more[:, 2])
    assert np.allclose(one, more, rtol=1e-6)


def test_a_restart_goes_on_with_the_substeps_for_contact(tmp_path):
    first, second = continued(tmp_path, fallen, 40, 20)
    assert np.array_equal(first[:, 2], second[:, 2])
    assert first[0, 2] > 20


def bent(fix):
    """A sheet that is clamped at one side and falls to where its soft hinges hold it."""
    rows = "region rows block INF -0.35 INF INF INF INF\n"
    lmp = cloth(fix=f"pin pins damping 5 {fix}", options="pin rows pins", regions=rows, newton="on")
    lmp.commands_string(
        "dihedral_coeff 1 compliance 1\nbond_coeff 1 compliance 1e-5\n"
        "compute pull all pbd/atom sheet fx fy fz\n"
        "fix pull all ave/atom 1 200 400 c_pull[*]\nrun 400"
    )
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    return by_id(lmp, "x"), lmp.numpy.extract_fix("pull", 1, 2)[:owned][order]


def test_soft_hinges_do_as_much_in_one_substep_as_in_each():
    """A symmetric order projects them in each."""
    (x, pull), (each_x, each_pull) = bent(""), bent("order symmetric")
    assert each_x[:, 2].min() < -0.7
    assert np.abs(x - each_x).max() < 5e-4
    # two rows of pins hold the moment of the sheet, far more than its weight
    assert np.abs(each_pull).max() > 5 * GRAVITY * 2 / 11
    assert np.abs(pull - each_pull).max() < 0.05 * np.abs(each_pull).max()


def test_a_light_vertex_on_a_spring_without_length_bears_its_load_at_once():
    """Of 1e-6 kg, in equilibrium from the start, in steps of 5 periods of the free vertex."""
    with instance() as lmp:
        lmp.commands_string(
            header(boundary="f f f", cutoff=2.0)
            + """
region box block -1 1 -1 1 -1 1
create_box 1 box bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 1
create_atoms 1 single 0 0 0 units box
create_atoms 1 single 0 0 -0.01 units box
mass 1 1e-6
group pins id 1
group hangs id 2
pair_style zero 2.0
pair_coeff * *
bond_style pbd
bond_coeff 1 compliance 1e-3 rest zero
create_bonds single/bond 1 1 2
fix sheet all pbd/cloth pin pins
fix load hangs addforce 0 0 -10
timestep 1e-3
"""
        )
        for _ in range(20):
            lmp.command("run 1")
            assert by_id(lmp, "x")[1, 2] == pytest.approx(-0.01, rel=5e-3)
