"""Wind and drag on cloth: force laws, balances, light sheets, water, and what must not matter."""

import itertools

import numpy as np
import pytest
from air_scenes import (
    ABOVE,
    ALL,
    BELOW,
    COEFFICIENTS,
    NORMAL,
    RHO,
    TANGENTIAL,
    G,
    air_of,
    sheet,
    wet_sheet,
)
from harness import by_id, instance, run, write
from scenes import (
    SMALL_SHEET,
    gravity,
)

TELL_AIR = "thermo_style custom step f_air[*]\n"
FAR = "-0.25 0.25 -0.25 0.25 0.3 0.4"  # of water that is not at the sheet


def law(wind, area=0.16):
    """Force of the cross-flow principle on a level sheet."""
    n = np.array([0.0, 0.0, 1.0])
    across = wind @ n
    along = wind - across * n
    return (
        0.5
        * RHO
        * area
        * (NORMAL * abs(across) * across * n + TANGENTIAL * np.linalg.norm(wind) * along)
    )


@pytest.mark.parametrize("wind", [(0, 0, 7.0), (0, 0, -7.0), (3.0, -1.0, 2.0), (4.0, 1.0, 0.0)])
def test_a_held_sheet_bears_the_force_of_the_law(wind):
    words = " ".join(str(w) for w in wind)
    script = (
        sheet(pin=ALL) + f"fix air cloth cloth/air {COEFFICIENTS} wind {words}\ntimestep 0.01\n"
    )
    expected = law(np.array(wind, dtype=float))
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_air[*] f_s[*]\nrun 3")
        found = np.array([lmp.extract_fix("air", 0, 1, k, 0) for k in range(6)])
        held = np.array([lmp.extract_fix("s", 0, 1, k, 0) for k in range(3)])
    np.testing.assert_allclose(found[:3], expected, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(held, -expected, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(found[3:], [0, 0, 0.16], rtol=1e-12, atol=1e-13)


def test_a_table_stands_for_the_law_that_it_was_made_of(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    angles = np.linspace(0, 90, 181)
    sine, cosine = np.sin(np.radians(angles)), np.cos(np.radians(angles))
    normal, along = NORMAL * sine**2, TANGENTIAL * cosine
    rows = np.c_[angles, normal * sine + along * cosine, normal * cosine - along * sine]
    np.savetxt("plate.table", rows, header="angle drag lift")
    fix = "fix air cloth cloth/air {} wind 3 -1 2\n"
    forces = [
        air_of(sheet(pin=ALL) + fix.format(words), 2)[:3]
        for words in (COEFFICIENTS, f"density {RHO} table plate.table")
    ]
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-3)


def test_a_falling_sheet_gains_what_weight_and_air_give_it():
    """From rest: 1/2 m v^2 = work of the weight + work of the air."""
    script = sheet() + gravity(g=G) + f"fix air cloth cloth/air {COEFFICIENTS} wind 1 0 0\n"
    with instance() as lmp:
        lmp.commands_string(
            script + "timestep 1e-3\ncompute z cloth reduce sum z\ncompute ke cloth ke\n"
            "thermo_style custom step c_z c_ke f_air[5]\nrun 400"
        )
        v, mass = by_id(lmp, "v"), lmp.numpy.extract_atom("mass")[1]
        fall = -lmp.numpy.extract_compute("z", 0, 0)
        work = lmp.extract_fix("air", 0, 1, 4, 0)
    kinetic, potential = 0.5 * mass * np.sum(v**2), mass * G * fall
    assert work < -0.2 * potential
    assert kinetic == pytest.approx(potential + work, rel=5e-3)


@pytest.mark.parametrize("solver", ["gs iterations 20", "jacobi iterations 200", "substeps"])
def test_a_very_light_sheet_in_a_storm_takes_long_steps(solver):
    """0.01 kg/m^2 at 50 m/s: the air moves it as fast as itself within 1.4e-4 s."""
    flag = sheet(areal=0.01, pin="block INF -0.19 INF INF INF INF")
    air = f"fix air cloth cloth/air density {RHO} normal 1.2 tangential 0.02 wind 40 0 30\n"
    with instance() as lmp:
        lmp.commands_string(
            flag.replace("pbd/cloth", f"pbd/cloth solver {solver}")
            + air
            + "timestep 0.01\nthermo_style custom step f_air[*]\nrun 300"
        )
        x, v = by_id(lmp, "x"), by_id(lmp, "v")
        force = [lmp.extract_fix("air", 0, 1, k, 0) for k in range(3)]
    assert np.abs(v).max() < 50
    assert np.abs(x - x[0]).max() < 1.5 * 0.4 * np.sqrt(2)
    assert force[0] > 0


def test_a_free_light_sheet_takes_the_velocity_of_the_wind():
    """1e-4 kg/m^2 in steps of 3000 times the time that the air needs."""
    script = sheet(areal=1e-4) + f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 20\n"
    with instance() as lmp:
        lmp.commands_string(script + "timestep 0.01\n")
        for n in range(15):
            lmp.command("run 1")
            v = by_id(lmp, "v")[:, 2]
            assert 0 < v.min() <= v.max() < 25
            assert n > 2 or v.mean() < 20
    assert v.mean() == pytest.approx(20, rel=0.05)


BOXES = {
    "large": {},
    "small": {"sides": "-0.3 0.3 -0.3 0.3 -0.3 0.3"},
    "tilted": {"sides": "-0.6 0.6 -0.6 0.6 -0.4 0.4", "shape": "prism"},
}


def test_periodic_and_tilted_boxes_do_not_matter(tmp_path):
    """The sheet crosses all faces while it is blown away."""
    start = "velocity cloth set 3 2 -4\nvelocity cloth ramp vz -1 1 x -0.2 0.2 sum yes\n"
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 5 0 5 gust 2 0.3 7\nrun 150\n"
    found = {}
    for name, words in BOXES.items():
        with instance() as lmp:
            lmp.commands_string(sheet(**words) + start + "timestep 1e-3\n" + air)
            found[name] = by_id(lmp, "v")
    for name in ("small", "tilted"):
        np.testing.assert_allclose(found[name], found["large"], rtol=0, atol=1e-11, err_msg=name)


def test_empty_ranks_do_not_matter(tmp_path):
    script = (
        "processors 1 1 4\n"
        + sheet(sides="-2 2 -2 2 -4 4", boundary="p p p")
        + f"fix air cloth cloth/air {COEFFICIENTS} wind 5 1 -5 gust 2 0.3 7\n"
        + "velocity cloth ramp vz -1 1 x -0.2 0.2 sum yes\ntimestep 1e-3\n"
        + "thermo_style custom step f_air[*]\nthermo_modify norm no\nrun 60\n"
        + "print '$(f_air[1]:%.17g) $(f_air[3]:%.17g) $(f_air[5]:%.17g)' file found.txt\n"
    )
    run(write(tmp_path, script), 4)
    apart = np.loadtxt(tmp_path / "found.txt")
    run(write(tmp_path, script.replace("1 1 4", "1 1 1")), 1)
    np.testing.assert_allclose(np.loadtxt(tmp_path / "found.txt"), apart, rtol=1e-10)


def test_unequal_steps_give_the_same_fall():
    """m dv/dt = m g - c v^2, from rest: v = u tanh(g t / u)."""
    script = sheet() + gravity(g=G) + f"fix air cloth cloth/air {COEFFICIENTS}\n"
    u = np.sqrt(2 * G * 0.5 / (RHO * NORMAL))
    with instance() as lmp:
        lmp.commands_string(script)
        time = 0.0
        for dt, steps in itertools.islice(itertools.cycle([(1e-3, 7), (4e-3, 5), (5e-4, 9)]), 24):
            lmp.commands_string(f"timestep {dt}\nrun {steps}")
            time += dt * steps
        v = -by_id(lmp, "v")[:, 2]
    assert v.mean() == pytest.approx(u * np.tanh(G * time / u), rel=3e-3)


def test_what_a_rigid_body_feels_is_what_the_air_gives():
    """The whole sheet is attached to a body: its momentum is the sum of the forces."""
    script = sheet().replace("pbd/cloth ", "pbd/cloth attach cloth ")
    script = script.replace("fix s", "fix body cloth rigid single\nfix s")
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 5\ntimestep 1e-3\n"
    with instance() as lmp:
        lmp.commands_string(script + air + "run 200")
        v, n = by_id(lmp, "v")[:, 2], lmp.get_natoms()
        total = lmp.numpy.extract_atom("mass")[1] * n
    c = 0.5 * RHO * NORMAL * 0.16 / total
    assert v.mean() == pytest.approx(5 - 5 / (1 + c * 5 * 0.2), rel=0.02)


# a sheet that has been at rest, and commands that lead to its next run
AT_REST = {
    "run": "run 3",
    "restart file": "run 3\nwrite_restart rest",
    "restart file without an initialization": "run 3\nwrite_restart rest noinit",
    "restart file from within a run": "restart 3 rest\nrun 4",
    "minimization": "run 3\nminimize 0 0 1 1",
    "fresh": "",
}


def two_impulses(lmp):
    found = []
    for _ in range(2):
        lmp.command("run 1")
        found.append(lmp.extract_fix("air", 0, 1, 2, 0))
    return found


@pytest.mark.parametrize("solver", ["solver gs direction current", "solver gs", "iterations 5"])
@pytest.mark.parametrize("before", AT_REST)
def test_another_velocity_between_two_runs_is_the_one_that_the_air_feels(
    before, solver, tmp_path, monkeypatch
):
    """The first impulse follows from the velocity of the atoms, the second from the step behind."""
    monkeypatch.chdir(tmp_path)
    make = sheet(areal=0.01).replace("pbd/cloth", f"pbd/cloth {solver}")
    air = f"fix air cloth cloth/air {COEFFICIENTS}\ntimestep 1e-3\n{TELL_AIR}"
    fast = "velocity cloth set 0 0 5\n"
    with instance() as lmp:
        lmp.commands_string(make + air + fast)
        expected = two_impulses(lmp)
    with instance() as lmp:
        lmp.commands_string(make + air + AT_REST[before])
        for file in tmp_path.glob("rest*"):
            more = make[make.index("pair_style") :]
            lmp.commands_string(f"clear\nread_restart {file.name}\n{more}{air}")
        lmp.command(fast)
        found = two_impulses(lmp)
    assert max(expected) < -0.1
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_covered_triangles_take_no_air():
    """Water on the sheet takes half of the force of what it lies on, water on both sides all."""
    air = "fix air cloth cloth/air density 1.2 normal 1.2 wind 0 0 5\n"
    areas = [
        air_of(wet_sheet(blocks, pinned=True) + air, 1)[5]
        for blocks in ((), (ABOVE,), (BELOW,), (ABOVE, BELOW), (FAR,))
    ]
    np.testing.assert_allclose(areas, [0.16, 0.08, 0.08, 0, 0.16], atol=1e-9)


def test_two_instances_do_not_meet():
    script = sheet() + f"fix air cloth cloth/air {COEFFICIENTS} wind 1 2 3 gust 2 0.3 7\n"
    with instance() as alone:
        alone.commands_string(script + "run 20")
        expected = by_id(alone, "v")
    with instance() as one, instance() as other:
        one.commands_string(script + "run 10")
        other.commands_string(script.replace("gust 2", "gust 5") + "run 13")
        one.command("run 10")
        np.testing.assert_array_equal(by_id(one, "v"), expected)
        other.command("clear")
        other.commands_string(script + "run 20")
        np.testing.assert_array_equal(by_id(other, "v"), expected)


START = SMALL_SHEET + "fix sheet cloth pbd/cloth\n"
FIX = START + "fix a cloth cloth/air "
AIR = FIX + "density 1.2 "
WINDY = "fix a cloth cloth/air density 1.2 "
ERRORS = {
    "no density": (FIX + "wind 1 0 0", r"fix a cloth/air: 'density' is missing: give that of the"),
    "density": (FIX + "density -1", r"density is '-1': give a number > 0"),
    "normal": (AIR + "normal -1", r"normal is '-1': give a number >= 0"),
    "tangential": (AIR + "tangential -1", r"tangential is '-1': give a number >= 0"),
    "gust": (AIR + "gust -1 1 1", r"rms velocity of 'gust' is '-1': give a number >= 0"),
    "length": (AIR + "gust 1 0 1", r"length of 'gust' is '0': give a number > 0"),
    "seed": (AIR + "gust 1 1 0", r"seed of 'gust' is '0': give a whole number from 1"),
    "variable": (
        AIR + "wind 1 v_none 0",
        r"wind along y is 'v_none': define an equal- or atom-style variable of this name",
    ),
    "style": (
        START + "variable w string abc\n" + WINDY + "wind v_w 0 0\nrun 0",
        r"wind along x is 'v_w': define an equal- or atom-style variable of this name",
    ),
    "no number": (
        START + "variable w equal exp(1000*(step>2))\n" + WINDY + "wind 0 v_w 0\nrun 5",
        r"fix a cloth/air: wind along y is 'inf' at step 3: correct variable w",
    ),
    "gust and atoms": (
        START + "variable w atom x\n" + WINDY + "wind v_w 0 0 gust 1 1 1\nrun 0",
        r"'gust' is carried by one wind .* use variables of style equal",
    ),
    "file": (AIR + "table none.table", r"table is 'none.table': cannot be read: give the name"),
    "both": (AIR + "normal 1 table none.table", r"'table' stands for .*: give one or the other"),
    "no cloth": (
        START + "fix a water cloth/air density 1\nrun 0",
        r"fix a cloth/air: group water holds no triangle of a cloth: give the group of a fix pbd",
    ),
    "twice": (
        AIR + "\nfix b cloth cloth/air density 1\nrun 0",
        r"group cloth has vertices of fix . cloth/air, too: give each vertex one fix cloth/air",
    ),
    "behind": (
        SMALL_SHEET + "fix a cloth cloth/air density 1\nfix s cloth pbd/cloth\nrun 0",
        r"fix a cloth/air: fix s pbd/cloth is defined after it: define it before",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_bad_input_is_named(name):
    script, message = ERRORS[name]
    with instance() as lmp, pytest.raises(Exception, match=message):
        lmp.commands_string(script)


TABLES = {
    "0 0 0\n45 1 1\n45 1 1\n90 1 0\n": r"the angle in line 3 is not above the one before: sort",
    "0 0 0\n# half\n45 -1 1\n90 1 0\n": r"the drag in line 3 is negative: it must be >= 0",
    "0 0 0\n45 1\n90 1 0\n": r"line 2 is not three numbers: give angle, drag and lift",
    "0 0 0\n80 1 0\n": r"its angles must go from 0, along the sheet, to 90 degrees",
    "0 nan 0\n90 1 0\n": r"line 1 (holds a number that is not finite|is not three numbers)",
    "": r"its angles must go from 0",
}


@pytest.mark.parametrize("text", TABLES)
def test_a_bad_table_is_named(tmp_path, monkeypatch, text):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.table").write_text(text)
    message = rf"fix a cloth/air: table is 'bad.table': {TABLES[text]}"
    with instance() as lmp, pytest.raises(Exception, match=message):
        lmp.commands_string(AIR + "table bad.table")
