"""What sleeping water rests on, and goes away: with ``sleep`` it falls as it does without."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    header,
    lattice,
    neighbor,
    sph_tait,
)

# Water between planes, on a plane, a sheet or other water; each scene has at most one of the parts
# that vanish.
HELD = (
    header("f f f")
    + cloth_box("-0.5 1.5 -0.5 0.5 -3 1", 3)
    + "mass * 0.125\n"
    + lattice(0.05)
    + filled("water", "-0.2 0.2 -0.2 0.2 0 0.3", 1)
    + "{part}\nset group all sph/rho 1000\ngroup water type 1\n"
    + sph_tait(
        "1 1 fluid 1000 c0 30 alpha 0.3 nu 0.01",
        "2 2 boundary volume 1.25e-4",
        "3 3 none",
        options="density calibrated",
    )
    + cloth_styles("1", "0")
    + neighbor(0.03)
    + """timestep 2e-3
fix walls water wall/sph {walls} ylo -0.2 yhi 0.2 
fix gravity water gravity 9.81 vector 0 0 -1
fix step water sph/integrate global max 0.002 sleep {sleep} gain 1
run_style sph/adaptive block
{fixes}
"""
)
SHEET = """create_cloth 3 20 size 0.8 0.8 spacing 0.1 center 0 0 -0.02 group cloth
variable fall equal -1.0*(time>2)"""
ON_SHEET = """fix cloth cloth pbd/cloth pin cloth velocity 0 0 v_fall
fix contact water cloth/contact 0.025"""
# what is there, planes, fixes, and commands between two runs
SCENES = {
    "a plane that jumps": (
        "variable x equal 0.2+1.2*(time>2)",
        "xlo -0.2 xhi v_x zlo 0",
        "",
        "",
    ),
    "a plane whose variable changes": (
        "variable x equal 0.2",
        "xlo -0.2 xhi v_x zlo 0",
        "",
        "variable x equal 1.4",
    ),
    "a plane at an edge of the box that goes away": (
        "change_box all x final -0.5 0.2 units box",
        "xlo -0.2 xhi EDGE zlo 0",
        "",
        "change_box all x final -0.5 1.5 units box",
    ),
    "a gate of particles that is displaced": (
        "region gate block 0.2 0.3 -0.2 0.2 0 0.45 units box\n"
        "create_atoms 2 region gate\ngroup gate type 2",
        "xlo -0.2 zlo 0",
        "",
        "displace_atoms gate move 1 0 0 units box",
    ),
    "a sheet that is drawn away": (SHEET, "xlo -0.2 xhi 0.2", ON_SHEET, ""),
    "water that is lifted itself": (
        "variable x equal 0.2",
        "xlo -0.2 xhi v_x zlo 0",
        "",
        "displace_atoms water move 0 0 0.3 units box",
    ),
    "contact with a sheet that is unfixed": (
        SHEET,
        "xlo -0.2 xhi 0.2",
        ON_SHEET,
        "unfix contact",
    ),
    "water that is drained": (
        "variable up equal (time>2)\n"
        "region sink block INF INF INF INF -2.5 -0.85 move NULL NULL v_up units box",
        "xlo -0.2 xhi 0.2 zlo 0",
        "fix drain water sph/drain region sink\nneigh_modify check no",
        "",
    ),
}


def run_until(lmp, time):
    """Return the mean height of the water then."""
    lmp.commands_string(
        f"variable now equal time\nfix end all halt 1 v_now > {time} error continue\n"
        "run 4000\nunfix end"
    )
    return by_id(lmp, "x")[by_id(lmp, "type") == 1][:, 2].mean()


def heights(name, sleep):
    """Mean height of the water before and after, and how many slept before."""
    part, walls, fixes, between = SCENES[name]
    with instance() as lmp:
        lmp.commands_string(HELD.format(part=part, walls=walls, fixes=fixes, sleep=sleep))
        asleep = []
        # what is beside particles that are awake is asked at times whether it rests
        for time in np.linspace(1.0, 1.9, 7):
            before = run_until(lmp, time)
            asleep.append(lmp.extract_fix("step", 0, 1, 29))
        lmp.commands_string(between)
        return before, run_until(lmp, 2.1), max(asleep)


@pytest.mark.parametrize("name", SCENES)
def test_water_falls_that_slept_on_what_has_gone(name):
    before, after, asleep = heights(name, 0.1)
    start, awake, none = heights(name, 0)
    assert asleep > 200 and none == 0
    assert before - after == pytest.approx(start - awake, rel=0.1)
    assert abs(before - after) > 0.01


# Water that fills a box of two periods, on a plane.
PERIODIC = (
    header("p p f", FLUID)
    + box("0 0.3 0 0.3 -0.1 0.6")
    + "mass 1 0.125\n"
    + lattice(0.05)
    + filled("water", "0 0.3 0 0.3 0 0.3")
    + "set group all sph/rho 1000\n"
    + sph_tait("1 1 fluid 1000 c0 20 alpha 0.5", options="density calibrated")
    + neighbor(0.03)
    + """timestep 4e-3
fix walls all wall/sph zlo 0
fix gravity all gravity 9.81 vector 0 0 -1
fix step all sph/integrate global sleep 0.3 gain 1
run_style sph/adaptive block
run 600
"""
)


@pytest.mark.parametrize("change", ["change_box all x final 0 0.6 units box", "run 0"])
def test_a_gap_that_a_longer_period_opens_wakes(change):
    with instance() as lmp:
        lmp.commands_string(PERIODIC)
        assert lmp.extract_fix("step", 0, 1, 29) == 216
        before = by_id(lmp, "x")
        lmp.commands_string(f"{change}\nrun 100")
        after = by_id(lmp, "x")
    if change == "run 0":
        assert np.array_equal(after, before)
    else:
        assert after[:, 2].mean() < before[:, 2].mean() - 0.02


def test_what_sleeps_is_not_shifted():
    """A particle that flies above sets the speed by which others are shifted."""
    bead = "create_atoms 1 single 0 0 0.45 units box\ngroup bead id 385"
    flies = "fix flies bead setforce 0 0 0\nvelocity bead set 0 0 0.4 units box"
    walls = SCENES["a plane that jumps"][1].replace("v_x", "0.2")
    with instance() as lmp:
        lmp.commands_string(HELD.format(part=bead, walls=walls, fixes=flies, sleep=0.1))
        run_until(lmp, 0.8)
        assert lmp.extract_fix("step", 0, 1, 29) == 384
        before = by_id(lmp, "x")
        lmp.commands_string("fix shift water sph/shift speed largest\nrun 20")
        after = by_id(lmp, "x")
        assert after[384, 2] > before[384, 2] + 0.01
        assert np.array_equal(after[:384], before[:384])


# Two halves of a column between walls of LAMMPS, at rest; what holds the upper one goes away.
COLUMN = (
    header("f f f", FLUID)
    + box("-0.2 1 -0.2 0.6 -0.4 0.8", 2)
    + lattice(0.05)
    + filled("low", "0 0.2 0 0.2 0 0.1")
    + filled("high_region", "0 0.2 0 0.2 0.1 0.2", 2)
    + "group lower type 1\ngroup high type 2\n"
    + sph_tait("* * fluid 1000 c0 20 alpha 0.5 spacing 0.05", options="density calibrated")
    + neighbor(0.03)
    + """timestep 4e-3
fix gravity all gravity 9.81 vector 0 0 -1
fix sides all wall/sph xlo 0 xhi 0.2 ylo 0 yhi 0.2 {floor}
fix step all sph/integrate global sleep 0.3 gain 1
run_style sph/adaptive block
thermo_modify lost ignore
run 400
"""
)
PLANE, REFLECTING = "zlo 0", "\nfix floor all wall/reflect zlo 0 units box"
GOES_AWAY = {
    "water that evaporates": (PLANE, "fix gone lower evaporate 5 20 low 777"),
    "a floor of LAMMPS": (REFLECTING, "unfix floor"),
    "a floor of LAMMPS that is lowered": (
        REFLECTING,
        "unfix floor\nfix lower all wall/reflect zlo -0.2 units box",
    ),
    "water that another type does not feel any more": (PLANE, "neigh_modify exclude type 1 2"),
}


@pytest.mark.parametrize("name", GOES_AWAY)
def test_water_falls_when_lammps_takes_away_what_it_slept_on(name):
    floor, command = GOES_AWAY[name]
    with instance() as lmp:
        lmp.commands_string(COLUMN.format(floor=floor))
        assert lmp.extract_fix("step", 0, 1, 29) == 64
        lmp.commands_string("variable z atom z\ncompute height high reduce ave v_z\nrun 0")
        before = lmp.extract_compute("height", 0, 0)
        lmp.commands_string(f"{command}\nrun 60")
        assert lmp.extract_compute("height", 0, 0) < before - 0.03


@pytest.mark.parametrize(
    "fix", ["ave/time 1 1 1 c_thermo_temp", "balance 1000 1.0 shift x 5 1.0", "store/force"]
)
def test_water_sleeps_on_beside_fixes_that_move_nothing(fix):
    with instance() as lmp:
        lmp.commands_string(COLUMN.format(floor=PLANE))
        before = by_id(lmp, "x")
        lmp.commands_string(f"fix more all {fix}\nrun 20")
        assert np.array_equal(by_id(lmp, "x"), before)


# Water at rest between planes, one of which jumps away.
GATE = (
    header("f f f", FLUID)
    + box("-0.1 {edge} -0.1 0.3 -0.1 0.5")
    + lattice(0.05)
    + filled("water", "0 0.3 0 0.2 0 0.3")
    + sph_tait("1 1 fluid 1000 c0 20 alpha 0.5 spacing 0.05", options="density calibrated")
    + neighbor(0.03)
    + """timestep 4e-3
variable x equal {x}
fix gravity all gravity 9.81 vector 0 0 -1
fix planes all wall/sph xlo 0 xhi {gate} ylo 0 yhi 0.2 zlo 0
fix step all sph/integrate global sleep 0.3 gain 1
run_style sph/adaptive block
"""
)
SLEEPS, FALLS = 300, 60


def go_on(folder, script):
    """A new instance, with the state at the end of the run before in a restart file."""
    lmp = instance()
    lmp.command(f"read_restart {folder}/gate.rst")
    lmp.commands_string(neighbor(0.03) + script[script.index("pair_style") :])
    return lmp


@pytest.mark.parametrize("between", ["two runs", "a restart file"])
def test_a_plane_that_jumps_in_the_last_step_of_a_run_wakes(tmp_path, between):
    script = GATE.format(edge=0.8, gate="v_x", x=f"0.3+0.4*(step>={SLEEPS})")
    found = []
    for parted in (False, True):
        lmp = instance()
        lmp.commands_string(script)
        lmp.command(f"run {SLEEPS - 1}")
        before, asleep = by_id(lmp, "x"), lmp.extract_fix("step", 0, 1, 29)
        assert asleep == len(before) == 144
        lmp.command(f"run {1 if parted else 1 + FALLS}")
        if parted and between == "a restart file":
            lmp.command(f"write_restart {tmp_path}/gate.rst")
            lmp = go_on(tmp_path, script)
        if parted:
            lmp.command(f"run {FALLS}")
        found.append(by_id(lmp, "x"))
    assert found[0][:, 2].mean() < before[:, 2].mean() - 0.02
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-12)


# edge of the box, place of the plane, and commands before and after a restart file
MOVES = {
    "at an edge of the box": (0.3, "EDGE", "change_box all x final -0.1 0.8 units box", ""),
    "by a variable": (0.8, "v_x", "", "variable x equal 0.7"),
}
PARTS = ["a run of no steps", "another fix", "a restart file", "a restart file and another fix"]


@pytest.mark.parametrize("between", PARTS)
@pytest.mark.parametrize("plane", MOVES)
def test_a_plane_that_jumps_between_runs_wakes(tmp_path, plane, between):
    edge, gate, of_box, of_variable = MOVES[plane]
    script = GATE.format(edge=edge, gate=gate, x=0.3)
    lmp = instance()
    lmp.commands_string(f"{script}run {SLEEPS}")
    before = by_id(lmp, "x")
    assert lmp.extract_fix("step", 0, 1, 29) == len(before)
    lmp.commands_string(of_box)
    if "restart" in between:
        lmp.command(f"write_restart {tmp_path}/gate.rst")
        name = "other" if "fix" in between else "planes"
        lmp = go_on(tmp_path, script.replace("fix planes", f"fix {name}"))
    elif "fix" in between:
        lmp.commands_string(f"unfix planes\n{script[script.index('fix planes') :].splitlines()[0]}")
    lmp.commands_string(f"{of_variable}\nrun 0\nrun {FALLS}")
    assert by_id(lmp, "x")[:, 2].mean() < before[:, 2].mean() - 0.02


def test_planes_that_stay_let_water_sleep_between_runs(tmp_path):
    script = GATE.format(edge=0.3, gate="EDGE", x=0.3)
    lmp = instance()
    lmp.commands_string(f"{script}run {SLEEPS}")
    before = by_id(lmp, "x")
    lmp.commands_string(f"run 10\nwrite_restart {tmp_path}/gate.rst")
    assert np.array_equal(by_id(lmp, "x"), before)
    lmp = go_on(tmp_path, script)
    lmp.command("run 10")
    assert np.array_equal(by_id(lmp, "x"), before)
