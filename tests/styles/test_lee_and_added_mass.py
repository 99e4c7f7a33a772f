"""Cloth in the lee of cloth, and air that moves along with it."""

import numpy as np
import pytest
from air_scenes import (
    ABOVE,
    ALL,
    BELOW,
    COEFFICIENTS,
    NORMAL,
    RHO,
    G,
    air_of,
    sheet,
    wet_sheet,
)
from harness import by_id, instance, run, write
from scenes import SMALL_SHEET, cloth_box, gravity, header, neighbor, no_other_bonds, stiffness

SQUARE = 0.16  # area of each sheet


def two_sheets(apart, *, shift=0.0):
    """Two pinned squares of 0.4 m, one behind the other along z, one fix of the air for both."""
    square = "create_cloth 1 0.5 size 0.4 0.4 spacing 0.1"
    return (
        header("p p p")
        + cloth_box("-2 2 -2 2 -2 2", 1)
        + "region all block INF INF INF INF INF INF\n"
        + f"{square} center 0 0 0 group cloth pin all pins\n"
        + f"{square} center {shift} 0 {apart} group cloth pin all pins\n"
        + stiffness("1.0", "0.5")
        + f"pair_style zero 0.2\npair_coeff * *\n{no_other_bonds()}{neighbor(0.05, 0.5)}"
        + "fix s cloth pbd/cloth pin pins\n"
    )


def across(speed):
    return 0.5 * RHO * SQUARE * NORMAL * speed**2


@pytest.mark.parametrize("apart", [0.5, -0.5, 1e-3])
@pytest.mark.parametrize("up", [1, -1])
def test_the_sheet_behind_takes_no_wind(apart, up):
    """Whichever of the two it is, and however near it is."""
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 {7 * up} shaded "
    with_lee = air_of(two_sheets(apart) + air + "yes\n", 2)
    np.testing.assert_allclose(with_lee[:3], [0, 0, up * across(7)], rtol=1e-12, atol=1e-12)
    without = air_of(two_sheets(apart) + air + "no\n", 2)
    np.testing.assert_allclose(without[:3], [0, 0, 2 * up * across(7)], rtol=1e-12, atol=1e-12)


def test_what_is_aside_takes_the_wind_and_what_is_aside_in_part_in_part():
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 7 shaded yes\n"
    for shift, open_share in ((0.0, 0.0), (0.2, 0.5), (0.4, 1.0)):
        force = air_of(two_sheets(0.5, shift=shift) + air, 2)[2]
        assert force == pytest.approx((1 + open_share) * across(7), rel=1e-9), shift


def test_a_sheet_is_not_in_its_own_lee():
    """Oblique to the wind, and along it."""
    script = sheet(pin=ALL) + f"fix air cloth cloth/air {COEFFICIENTS} wind 5 1 2 "
    np.testing.assert_allclose(
        air_of(script + "shaded yes\n", 2), air_of(script + "shaded no\n", 2), rtol=1e-13
    )


def test_cloth_that_moves_in_the_lee_meets_air_at_rest():
    """As if there were no wind."""
    fall = "velocity cloth set 0 0 3\n"
    script = two_sheets(0.5).replace("pin all pins", "").replace("pin pins", "")
    still = air_of(script + fall + f"fix air cloth cloth/air {COEFFICIENTS}\n", 1)
    lee = air_of(
        script + fall + f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 1 shaded yes\n", 1
    )
    front = 0.5 * RHO * SQUARE * NORMAL
    assert still[2] == pytest.approx(-2 * front * 9, rel=0.01)
    assert lee[2] == pytest.approx(-front * (9 + 4), rel=0.01)


@pytest.mark.parametrize("grid", ["2 1 1", "1 1 2", "2 2 1"])
def test_other_ranks_keep_the_wind_off(tmp_path, grid):
    make = two_sheets(0.5, shift=0.2)
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 0.5 0 7 shaded yes\n"
    tell = (
        "thermo_style custom step f_air[*]\nthermo_modify norm no\nrun 3\n"
        "print '$(f_air[1]:%.17g) $(f_air[3]:%.17g)' file found.txt\n"
    )
    found = []
    for ranks in ("1 1 1", grid):
        n = int(np.prod([int(k) for k in ranks.split()]))
        run(write(tmp_path, f"processors {ranks}\n" + make + air + tell), n)
        found.append(np.loadtxt(tmp_path / "found.txt"))
    np.testing.assert_allclose(found[1], found[0], rtol=1e-12)
    assert across(7) < found[0][1] < 1.9 * across(7)


def test_what_moves_or_turns_into_the_lee_is_found_in_time():
    """A sheet that drifts across the wind of another, and a wind that turns: no list is built.

    Within half a triangle, and the third of one that is looked up: 0.21 of a sheet.
    """
    drift = two_sheets(0.5, shift=0.4).replace("pin pins", "").replace("pin all pins", "")
    drift = drift.replace("neighbor 0.05", "neighbor 0.9")
    drift += "region high block INF INF INF INF 0.25 INF\ngroup high region high\n"
    drift += "velocity high set -2 0 0\ntimestep 1e-3\n"
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 0 0 7 shaded yes\n"
    air = air.replace(f"density {RHO}", f"density {1e-9 * RHO}")
    by = 1e9 / across(7)
    with instance() as lmp:
        lmp.commands_string(drift + air + "thermo_style custom step f_air[3]\nrun 0 post no")
        for steps, low, high in ((1, 1.99, 2.01), (99, 1.29, 1.71), (100, 0.99, 1.21)):
            lmp.command(f"run {steps} pre no post no")
            assert low < by * lmp.extract_fix("air", 0, 1, 2, 0) < high, steps

    turning = two_sheets(0.5) + "variable u equal 7*step/50\n"
    air = air.replace("wind 0 0 7", "wind v_u 0 7")
    with instance() as lmp:
        lmp.commands_string(turning + air + "thermo_style custom step f_air[3]\nrun 0 post no")
        for steps, low, high in ((1, 0.99, 1.01), (20, 1.29, 1.71), (40, 1.99, 2.01)):
            lmp.command(f"run {steps} pre no post no")
            assert low < by * lmp.extract_fix("air", 0, 1, 2, 0) < high, steps


@pytest.mark.parametrize(
    ("skin", "runs"),
    [(0.01, "run 60"), (0.3, "run 60"), (0.05, "run 60 every 7 'write_restart lee'")],
)
def test_the_lee_does_not_depend_on_lists_and_on_what_is_written(tmp_path, monkeypatch, skin, runs):
    """Sheets that drift apart across the wind: the shares of the lee change in the meantime."""
    monkeypatch.chdir(tmp_path)
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 6 0 9 shaded yes\n"
    free = two_sheets(0.3, shift=0.15).replace(" pin pins\n", "\n") + air
    found = []
    for width, commands in ((0.05, "run 60"), (skin, runs)):
        with instance() as lmp:
            lmp.commands_string(f"{free}neighbor {width} bin\ntimestep 2e-3\n{commands}")
            found.append((by_id(lmp, "x"), by_id(lmp, "v")))
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-12 * np.abs(one).max())


def test_a_restart_file_from_within_a_run_continues_with_the_same_lee(tmp_path):
    """It is written between two searches, and no list is built there."""
    make = two_sheets(0.1, shift=0.2).replace("pin all pins", "").replace("pin pins", "")
    make = make.replace("neighbor 0.05", "neighbor 0.9")
    air = f"fix air cloth cloth/air {COEFFICIENTS} wind 3 0 7 gust 2 0.2 3 shaded yes\n"
    air += "dump all all custom 7 {} id x y z vx vy vz\n"
    air += "dump_modify all sort id format float %.17g\ntimestep 1e-3\n"
    whole = f"{make}{air}run 27 post no\nwrite_restart half noinit\n"
    run(write(tmp_path, whole.format("one") + "run 28 pre no post no\n"), 1)
    again = f"read_restart half\n{make[make.index('pair_style') :]}{air}run 28\n"
    run(write(tmp_path, again.format("again"), "in.again"), 1)
    one, two = ((tmp_path / name).read_text().split("ITEM: TIMESTEP") for name in ("one", "again"))
    assert len(one) > 3
    assert two[-1] == one[-1]


def turned_by(degrees, axis):
    """Rotation matrix, of Rodrigues."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across


@pytest.mark.parametrize(("degrees", "axis"), [(120, (1, 1, 1)), (30, (1, -2, 3))])
def test_the_lee_turns_with_the_scene(degrees, axis):
    """Two free sheets across an oblique wind: it is found anew many times."""

    def at_the_end(turn):
        def words(*vector):
            return " ".join(f"{each:.17g}" for each in turn @ vector)

        def square(center, first, second):
            return (
                "create_cloth 1 0.5 size 0.6 0.6 spacing 0.05 group cloth "
                f"center {words(*center)} axes {words(*first)} {words(*second)}\n"
            )

        script = (
            header("p p p")
            + cloth_box("-2 2 -2 2 -2 2", 1)
            + square((0, 0, 0), (1, 0.2, 0.1), (0, 1, 0.3))
            + square((0.2, 0.1, 0.3), (1, -0.2, 0.3), (0.3, 1, 0))
            + stiffness("1.0", "0.1")
            + f"pair_style zero 0.2\npair_coeff * *\n{no_other_bonds()}{neighbor(0.03)}"
            + "fix s cloth pbd/cloth\ntimestep 2e-3\n"
            + f"fix air cloth cloth/air density 1.2 wind {words(1, 2, 3)} shaded yes\n"
        )
        with instance() as lmp:
            lmp.commands_string(script + "run 120")
            return by_id(lmp, "x"), by_id(lmp, "v")

    x, v = at_the_end(np.eye(3))
    turn = turned_by(degrees, axis)
    turned = at_the_end(turn)
    np.testing.assert_allclose(turned[0], x @ turn.T, rtol=0, atol=1e-9)
    np.testing.assert_allclose(turned[1], v @ turn.T, rtol=0, atol=1e-9)


# added mass

AREAL, THICKNESS = 0.5, 0.4
ADDED = f"density {RHO} normal 0 added_mass {THICKNESS}"


def of_air(lmp, kind=1):
    """Added mass over that of each vertex of a flat sheet: each has a third of its triangles."""
    x, mass = by_id(lmp, "x"), lmp.numpy.extract_atom("mass")[kind]
    area = np.zeros(len(x))
    for _, *corners in lmp.numpy.gather_angles():
        a, b, c = x[np.array(corners) - 1]
        area[np.array(corners) - 1] += np.linalg.norm(np.cross(b - a, c - a)) / 6
    return RHO * THICKNESS * area / mass


@pytest.mark.parametrize("solver", ["gs iterations 5", "jacobi iterations 5", "substeps"])
def test_the_weight_of_a_sheet_moves_the_air_too(solver):
    script = sheet(areal=AREAL).replace("pbd/cloth", f"pbd/cloth solver {solver}")
    script = script.replace("dihedral_coeff 1 0.5", "dihedral_coeff 1 0.0")
    with instance() as lmp:
        lmp.commands_string(
            script + gravity(g=G) + f"fix air cloth cloth/air {ADDED}\ntimestep 1e-3\n"
            "thermo_style custom step f_air[*]\nrun 0"
        )
        share = of_air(lmp)
        lmp.command("run 1")
        first = by_id(lmp, "v")
        lmp.command("run 1")
        v = by_id(lmp, "v")
        force = lmp.extract_fix("air", 0, 1, 2, 0)
        work = lmp.extract_fix("air", 0, 1, 4, 0)
        mass = lmp.numpy.extract_atom("mass")[1]
    assert share.min() > 0.2 and share.max() > 3 * share.min()
    # velocities are those of half a substep ago
    time = 1e-3 - 0.5e-3 / (10 if solver == "substeps" else 1)
    np.testing.assert_allclose(first[:, 2], -G * time / (1 + share), rtol=1e-5)
    np.testing.assert_allclose(first[:, :2], 0, atol=1e-7)
    # momentum and energy
    gained = mass * np.sum(v[:, 2] - first[:, 2]) / 1e-3
    assert force == pytest.approx(gained + mass * len(v) * G, rel=1e-9)
    assert work == pytest.approx(-0.5 * mass * np.sum(share * v[:, 2] ** 2), rel=0.35)


def test_along_the_sheet_nothing_is_added():
    script = sheet(areal=AREAL, axes="1 0 0 0 0 1")
    with instance() as lmp:
        lmp.commands_string(
            script + gravity(g=G) + f"fix air cloth cloth/air {ADDED}\ntimestep 1e-3\nrun 50"
        )
        v = by_id(lmp, "v")
    late = 0.5e-3 / 10  # velocities are those of half a substep ago
    expected = np.broadcast_to([0, 0, -G * (0.05 - late)], v.shape)
    np.testing.assert_allclose(v, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("blocks", "dry"), [((), 1.0), ((ABOVE,), 0.5), ((BELOW,), 0.5), ((ABOVE, BELOW), 0.0)]
)
def test_the_side_that_water_covers_moves_no_air(blocks, dry):
    """A vertex in the middle is pushed for some steps by a weight alone."""
    air = f"fix air cloth cloth/air density {RHO} added_mass {THICKNESS}\n"
    with instance() as lmp:
        lmp.commands_string(
            wet_sheet(blocks, pinned=False) + "fix weight cloth gravity 9.81 vector 0 0 -1\n" + air
        )
        lmp.command("run 20")
        cloth = by_id(lmp, "type") == 2
        share, v, x = of_air(lmp, 2)[cloth], by_id(lmp, "v")[cloth], by_id(lmp, "x")[cloth]
    middle = np.hypot(x[:, 0], x[:, 1]) < 0.08
    assert share[middle].min() > 0.1
    late = 0.5e-6 / 10  # velocities are those of half a substep ago
    expected = -G * (20e-6 - late) / (1 + dry * share)
    np.testing.assert_allclose(v[middle, 2], expected[middle], rtol=1e-4)


def half_period(air, solver):
    """Of a taut strip of two rows of vertices: from one zero of its middle to the next."""
    script = (
        header("p p p")
        + cloth_box("-2 2 -2 2 -2 2", 1)
        + "region low block INF -0.49 INF INF INF INF\n"
        + "region high block 0.49 INF INF INF INF INF\nregion ends union 2 low high\n"
        + f"create_cloth 1 {AREAL} size 1.0 0.05 spacing 0.05 group cloth pin ends pins\n"
        + stiffness("compliance 1e-4", "0.0")
        + f"pair_style zero 0.2\npair_coeff * *\n{no_other_bonds()}{neighbor(0.05, 0.5)}"
        + f"fix s cloth pbd/cloth pin pins {solver}\n{air}"
        + "displace_atoms cloth ramp x 0 0.01 x -0.5 0.5\n"
        + "variable w atom 0.05*sin(PI*(x+0.5))\nvelocity cloth set 0 0 v_w\n"
        + "velocity pins set 0 0 0\ntimestep 1e-4\n"
    )
    with instance() as lmp:
        lmp.commands_string(script + "run 0 post no")
        heights = []
        while len(heights) < 1500 and (len(heights) < 50 or heights[-1] > 0):
            lmp.command("run 1 pre no post no")
            heights.append(by_id(lmp, "x")[:, 2].mean())
    above, below = heights[-2:]
    return 1e-4 * (len(heights) - 1 + above / (above - below))


@pytest.mark.parametrize("solver", ["", "solver gs iterations 40"])
def test_a_taut_strip_swings_with_both_masses(solver):
    """Frequencies go with the root of the mass: a row's vertex has half of the area of a cell."""
    added = RHO * THICKNESS * 0.5 * 0.05**2 / (AREAL * 0.05 / 42)
    slower = half_period(f"fix air cloth cloth/air {ADDED}\n", solver) / half_period("", solver)
    assert slower == pytest.approx(np.sqrt(1 + added), rel=0.01)


def test_pins_have_no_added_mass():
    """No force, no work: everything is pinned."""
    script = sheet(pin=ALL) + "timestep 1e-3\n"
    added = air_of(script + f"fix air cloth cloth/air {ADDED} wind 0 0 3\n", 3)
    np.testing.assert_array_equal(added[:5], 0)


def test_restart_and_ranks_with_lee_and_added_mass(tmp_path):
    make = sheet(pin="block INF -0.15 INF INF INF INF")
    air = (
        f"fix air cloth cloth/air {COEFFICIENTS} wind 6 0 2 gust 1 0.3 5 shaded yes "
        "added_mass 0.4\ntimestep 1e-3\n"
    )
    tell = "run 110\nwrite_dump all custom {} id x y z vx vy vz modify sort id format float %.17g\n"
    whole = make + air + "run 90\nwrite_restart half\n" + tell
    run(write(tmp_path, whole.format("one")), 1)
    again = "read_restart half\n" + make[make.index("pair_style") :] + air + tell
    run(write(tmp_path, again.format("again"), "in.again"), 1)
    run(write(tmp_path, whole.format("four"), "in.four"), 4)
    rows = {name: np.loadtxt(tmp_path / name, skiprows=9) for name in ("one", "again", "four")}
    assert np.ptp(rows["one"][:, 3]) > 0.05
    np.testing.assert_array_equal(rows["again"], rows["one"])
    np.testing.assert_allclose(rows["four"], rows["one"], rtol=0, atol=1e-9)


AIR = SMALL_SHEET + "fix sheet cloth pbd/cloth\nfix a cloth cloth/air density 1.2 "
ERRORS = {
    "thickness": (
        AIR + "added_mass -1",
        r"added_mass is '-1': give a number >= 0",
    ),
    "shade": (AIR + "shaded 1", r"fix a cloth/air: shaded is '1': .*no or yes"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_bad_input_is_named(name):
    script, message = ERRORS[name]
    with instance() as lmp, pytest.raises(Exception, match=message):
        lmp.commands_string(script)
