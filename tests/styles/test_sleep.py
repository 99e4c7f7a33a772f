"""run_style sph/adaptive block: particles that sleep, and what wakes them."""

import numpy as np
import pytest
from block_scenes import SPLASH
from harness import by_id, instance, last_frame, run, write
from scenes import (
    FLUID,
    box,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    sph_tait,
)


def splash(scheme, limits="", ceiling=2e-3, end=0.14, height=0.3):
    """Kinetic energy (J) at the end, and particle updates."""
    lmp = instance()
    lmp.commands_string(
        SPLASH.format(scheme=scheme, limits=limits, ceiling=ceiling, end=end, height=height)
    )
    lmp.command("run 5000")
    assert lmp.get_thermo("time") == pytest.approx(end, rel=1e-12)
    return lmp.get_thermo("ke"), lmp.extract_fix("step", 0, 1, 2)


def test_a_fast_drop_wakes_a_pool_that_sleeps():
    """As with a small uniform step; what is not woken remains a wall."""
    reference, _ = splash("constant", ceiling=2e-4)
    awake, updates = splash("block")
    woken, fewer = splash("block", "sleep 0.01")
    late, _ = splash("block", "sleep 0.01 waking no")
    assert awake == pytest.approx(reference, rel=0.01)
    assert woken == pytest.approx(reference, rel=0.01)
    assert fewer < 0.8 * updates
    assert abs(late / reference - 1) > 0.1


def test_what_sleeps_stays_and_costs_nothing(monkeypatch):
    lmp = instance()
    script = SPLASH.format(
        scheme="block", limits="sleep 0.01", ceiling=2e-3, end=10, height=0.3
    ).replace("velocity falls", "#")
    lmp.commands_string(script + "run 100")
    assert lmp.extract_fix("step", 0, 1, 1) == 0
    before, updates = by_id(lmp, "x"), lmp.extract_fix("step", 0, 1, 2)
    lmp.command("run 50")
    assert np.array_equal(by_id(lmp, "x"), before)
    assert lmp.extract_fix("step", 0, 1, 2) == updates
    lmp.command("velocity falls set 0 0 -3 units box")
    lmp.command("run 5")
    falls = np.flatnonzero(before[:, 2] > 0.2)
    assert (by_id(lmp, "x")[falls, 2] < before[falls, 2] - 1e-3).all()
    assert lmp.extract_fix("step", 0, 1, 1) < 0.5
    lmp.command("fix g all gravity 9.81 vector 0 0 -1")
    lmp.command("run 5")
    assert lmp.extract_fix("step", 0, 1, 1) > 0.9


# Water without weight that sleeps over a floor, which comes up at 1 m/s from 0.1 s on.
QUIET = (
    header("f f f", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 0.7", 2)
    + lattice(0.052)
    + filled("pool", "-0.156 0.156 -0.156 0.156 -0.26 0")
    + """{floor}
mass * 0.125
set group all sph/rho 1000
group water type 1
group floor type 2
"""
    + sph_tait("1 1 fluid 1000 c0 30 alpha 0.1", "2 2 boundary")
    + neighbor(0.03)
    + """timestep {ceiling}
{moves}
fix step water sph/integrate global gain 1 velocity 0 until 0.16 sleep 0.01
run_style sph/adaptive {scheme}
compute kinetic water ke
"""
)
FLOORS = {
    "plane": {
        "floor": "variable height equal -0.26+(time>0.1)*(time-0.1)",
        "moves": "fix floor all wall/sph zlo v_height",
        "rises": "",
    },
    "particles": {
        "floor": "region floor block -0.26 0.26 -0.26 0.26 -0.364 -0.26 units box\n"
        "create_atoms 2 region floor",
        "moves": "fix floor floor nve/noforce",
        "rises": "velocity floor set 0 0 1 units box",
    },
}


def sleepers(lmp):
    return lmp.extract_fix("step", 0, 1, 29)


@pytest.mark.parametrize("floor", FLOORS)
def test_a_floor_that_begins_to_move_wakes_water_that_sleeps(floor):
    """It is lifted as with a small uniform step."""
    kinetic = {}
    for scheme, ceiling in (("constant", 2e-4), ("block", 1e-3)):
        lmp = instance()
        lmp.commands_string(QUIET.format(scheme=scheme, ceiling=ceiling, **FLOORS[floor]))
        lmp.command(f"run {round(0.1 / ceiling)}")
        water = (by_id(lmp, "type") == 1).sum()
        assert sleepers(lmp) == (water if scheme == "block" else 0)
        lmp.commands_string(f"{FLOORS[floor]['rises']}\nrun 1000")
        assert lmp.get_thermo("time") == pytest.approx(0.16, rel=1e-12)
        assert sleepers(lmp) == 0
        kinetic[scheme] = lmp.extract_compute("kinetic", 0, 0)
    assert kinetic["constant"] > 8
    assert kinetic["block"] == pytest.approx(kinetic["constant"], rel=0.01)


# One particle that drifts slowly.
LONELY = (
    header("f f f", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
    + """mass 1 0.125
create_atoms 1 single 0 0 0
set group all sph/rho 1000
velocity all set 0.003 0.004 -0.005 units box
"""
    + sph_tait("1 1 fluid 1000 c0 30")
    + neighbor(0.03)
    + """timestep 1e-3
fix step all sph/integrate global gain 1 velocity 0 sleep 0.01
run_style sph/adaptive block
"""
)


def steps_awake(lmp):
    """Steps until the particle sleeps."""
    for step in range(300):
        if sleepers(lmp):
            return step
        lmp.command("run 1")
    return None


def test_what_falls_asleep_stops_in_all_directions():
    with instance() as lmp:
        lmp.commands_string(LONELY + "run 0")
        assert (by_id(lmp, "v") != 0).all()
        assert steps_awake(lmp) > 20
        assert (by_id(lmp, "v") == 0).all()


@pytest.mark.parametrize("reset", ["reset_timestep 0", "reset_timestep 100000"])
def test_a_reset_of_the_time_neither_hastens_nor_delays_sleep(reset):
    awake = []
    for between in ("", reset):
        with instance() as lmp:
            lmp.commands_string(f"{LONELY}run 20\n{between}\nrun 0")
            awake.append(steps_awake(lmp))
    assert awake[0] > 20
    assert awake[1] == awake[0]


# unequal steps do not save so much: all that is awake takes the same step
EQUAL = "gain 100"
SHAKEN = "velocity all ramp vx 0.1 0.3 z -0.3 0.5 sum yes units box\n"


def equal_splash(limits="sleep 0.01"):
    """The script; atoms have the same IDs on any number of ranks."""
    script = SPLASH.format(
        scheme="block", limits=f"{limits} {EQUAL}", ceiling=1e-3, end=10, height=0.3
    )
    return script.replace("set group", "reset_atoms id sort yes\nset group", 1)


def test_while_nothing_sleeps_the_keyword_changes_nothing():
    """Neither a digit nor the evaluations of pairs."""
    found = []
    for limits in ("", "sleep 1e-9"):
        lmp = instance()
        lmp.commands_string(equal_splash(limits) + SHAKEN + "run 120")
        assert sleepers(lmp) == 0
        found.append((by_id(lmp, "x"), by_id(lmp, "v"), lmp.extract_fix("step", 0, 1, 35)))
    (x, v, pairs), (x_sleep, v_sleep, pairs_sleep) = found
    assert np.array_equal(x, x_sleep) and np.array_equal(v, v_sleep)
    assert pairs == pairs_sleep > 0


def test_equal_steps_beside_water_that_sleeps():
    """As with a small uniform step, with fewer updates."""
    reference, _ = splash("constant", ceiling=2e-4)
    awake, updates = splash("block", EQUAL)
    woken, fewer = splash("block", f"sleep 0.01 {EQUAL}")
    assert awake == pytest.approx(reference, rel=0.02)
    assert woken == pytest.approx(awake, rel=0.002)
    assert fewer < 0.8 * updates


DUMPED = (
    "dump final all custom 1 {name} id x y z vx vy vz\ndump_modify final sort id format float %.17g"
)
SLEEPY, STEPS = 90, 60


@pytest.fixture(scope="module")
def while_some_sleep(tmp_path_factory):
    """The state after a drop has fallen into a pool that sleeps in part, on one rank."""
    folder = tmp_path_factory.mktemp("sleep")
    text = equal_splash() + f'run {SLEEPY}\nprint "sleep $(f_step[30])"\nrun {STEPS}\n'
    text += 'print "sleep $(f_step[30])"\n' + DUMPED.format(name="all.dump") + "\nrun 0\n"
    said = run(write(folder, text))
    asleep = [float(line.split()[1]) for line in said.splitlines() if line.startswith("sleep ")]
    assert asleep[0] > 100 and asleep[-1] < asleep[0]  # the drop wakes some
    return folder, last_frame(folder / "all.dump")


@pytest.mark.parametrize("ranks", [2, 4])
def test_equal_steps_beside_sleeping_water_on_any_number_of_ranks(while_some_sleep, ranks):
    folder, one = while_some_sleep
    text = equal_splash() + f"run {SLEEPY}\nrun {STEPS}\n"
    name = f"all{ranks}.dump"
    run(write(folder, text + DUMPED.format(name=name) + "\nrun 0\n", f"in.{ranks}"), ranks)
    np.testing.assert_allclose(last_frame(folder / name), one, rtol=0, atol=1e-9)


def test_equal_steps_beside_sleeping_water_go_on_from_a_restart_file(while_some_sleep):
    """The file is written while the drop is in the water, and some of that sleeps."""
    folder, one = while_some_sleep
    text = equal_splash()
    run(write(folder, text + f"run {SLEEPY}\nrun {STEPS // 2}\nwrite_restart half.rst\n", "in.a"))
    settings = text[text.index("pair_style") :].replace("velocity falls", "#")
    go_on = f"read_restart half.rst\nneighbor 0.03 bin\n{settings}\nrun {SLEEPY + STEPS} upto\n"
    run(write(folder, go_on + DUMPED.format(name="half.dump") + "\nrun 0\n", "in.b"))
    np.testing.assert_allclose(last_frame(folder / "half.dump"), one, rtol=0, atol=1e-9)


# A pool and a drop of half the spacing, one by one: IDs are the same on any number of ranks.
SITES = [
    (kind, *(round(low + spacing * k, 3) for low, k in zip(corner, cell, strict=True)))
    for kind, spacing, corner, cells in (
        (1, 0.1, (-0.45, -0.45, -0.35), (10, 10, 3)),
        (2, 0.05, (0.0, -0.05, 0.25), (5, 5, 5)),
    )
    for cell in np.ndindex(cells)
    if kind == 1 or np.linalg.norm(np.array(cell) - 2) < 2.5
]

# A drop of half the spacing falls into a pool, and speeds that count as rest are high: in most
# steps some particles fall asleep and others are woken.
RESTLESS = (
    header("p p f", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 0.9", 2)
    + "".join(f"create_atoms {kind} single {x} {y} {z} units box\n" for kind, x, y, z in SITES)
    + "set group all sph/rho 1000\ngroup drop type 2\n"
    + sph_tait(
        "1 1 fluid 1000 c0 15 {viscosity} spacing 0.1 support 0.2",
        "2 2 fluid 1000 c0 15 {viscosity} spacing 0.05",
        support=0.2,
        options="density calibrated",
    )
    + neighbor("{skin}")
    + "velocity drop set 0.1 0 -1 units box\ntimestep 0.01\n"
    + gravity()
    + "fix floor all wall/sph zlo -0.45\nfix step all sph/integrate global sleep 0.6 {steps}\n"
    + "run_style sph/adaptive block\nthermo 1000\n"
)
UNEQUAL = "gain 1"
BEFORE, TOGETHER = 60, 80


def restless(steps, skin=0.08, viscosity="alpha 0.2"):
    return RESTLESS.format(steps=steps, skin=skin, viscosity=viscosity)


@pytest.mark.parametrize("steps", [UNEQUAL, EQUAL, f"{UNEQUAL} output 0.05"])
def test_runs_that_end_while_water_wakes_and_falls_asleep_are_one_run(steps):
    """Setup of a run repeats the last evaluation of the run before, which changed what sleeps."""
    ends, asleep = [], []
    for run_by_run in (False, True):
        with instance() as lmp:
            lmp.commands_string(restless(steps) + f"run {BEFORE}")
            for _ in range(TOGETHER if run_by_run else 1):
                lmp.command("run 1" if run_by_run else f"run {TOGETHER}")
                asleep.append(sleepers(lmp))
            ends.append(by_id(lmp, "v"))
    assert asleep[-1] == asleep[0]
    changes = np.diff(asleep[1:])
    assert (changes > 0).any() and (changes < 0).any()
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("until", [72, 73, 76, 101])
def test_a_restart_file_while_water_wakes_and_falls_asleep(tmp_path, monkeypatch, until):
    monkeypatch.chdir(tmp_path)
    text = restless(UNEQUAL)
    settings = text[text.index("neighbor 0.08") :].replace("velocity drop", "#")
    ends = []
    with instance() as lmp:
        lmp.commands_string(f"{text}run {until}\nwrite_restart some.rst\n")
    for begin in (text, f"read_restart some.rst\n{settings}"):
        with instance() as lmp:
            lmp.commands_string(f"{begin}run {until + 3} upto")
            assert sleepers(lmp) > 0
            ends.append(by_id(lmp, "v"))
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("viscosity", ["alpha 0.2", "alpha 0.2 switch 0.3"])
@pytest.mark.parametrize("steps", [UNEQUAL, EQUAL])
def test_what_sleeps_depends_neither_on_ranks_nor_on_lists(tmp_path, steps, viscosity):
    ends = []
    for ranks, skin in ((1, 0.08), (1, 0.05), (2, 0.08), (4, 0.08)):
        name = f"{ranks}-{skin}"
        text = restless(steps, skin, viscosity) + f"run {BEFORE + TOGETHER}\n"
        run(write(tmp_path, text + DUMPED.format(name=name) + "\nrun 0\n"), ranks)
        ends.append(last_frame(tmp_path / name))
    for other in ends[1:]:
        np.testing.assert_allclose(other, ends[0], rtol=0, atol=1e-8)
