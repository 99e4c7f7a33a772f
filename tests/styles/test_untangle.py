"""fix cloth/contact with untangle yes: what passes through cloth at the start is pulled apart."""

import re

import numpy as np
import pytest
from harness import by_id, fail, last_frame, run, write
from scenes import final_dump
from test_cloth_with_cloth import (
    BLADE,
    FLAT,
    HELD,
    THICKNESS,
    UPRIGHT,
    mesh_of,
    scene,
    started,
    watch,
)

TOUCH = f"fix touch cloth cloth/contact {THICKNESS} cloth yes untangle yes\n"
# a bump of the upper sheet through the middle of the lower one
BUMP = FLAT + (
    "variable bump atom z-0.08*exp(-((x-0.011)^2+(y-0.017)^2)/0.01)\nset group upper z v_bump\n"
)
# a corner of it, and waves of a sheet that lies on the other
CORNER = FLAT.replace("spacing", "axes 1 0.02 0.28 0 1 0.3 spacing")
WAVES = FLAT + "variable wave atom z+0.02*sin(13*x+1)*cos(17*y)\nset group upper z v_wave\n"
TANGLED = {"bump": (BUMP, 0.02), "corner": (CORNER, 0.07), "waves": (WAVES, 0.012)}
FREE = "fix sheet cloth pbd/cloth damping 5\n"
SPIKE = BLADE.replace("-0.5 0.007 0.0", "-0.2 0.007 -0.4").replace(
    "0.5 0.011 0.0", "0.2 0.011 -0.4"
)
SPIKE = SPIKE.replace("0.0 0.009 -0.4", "0.013 0.009 0.03")


def tangled(name, **changes):
    upper, height = TANGLED[name]
    return scene(upper, height, **{"contact": TOUCH} | changes)


@pytest.mark.parametrize("name", TANGLED)
def test_cloth_is_parted_and_stays_apart(name):
    with started(tangled(name, contact="")) as lmp:
        start = by_id(lmp, "x").copy()
        assert mesh_of(lmp).count(start) > 5
    with started(tangled(name)) as lmp:
        parted = by_id(lmp, "x").copy()
        assert mesh_of(lmp).count(parted) == 0
        held = np.abs(start[:, :2]).max(axis=1) > 0.34
        assert np.array_equal(parted[held], start[held])
        # no farther than the sheets were through one another, with some thicknesses to spare
        assert np.linalg.norm(parted - start, axis=1).max() < 0.1
        met, crossed, _ = watch(lmp, 100)
    assert (met, crossed) == (0, 0)


def test_the_center_of_mass_of_free_sheets_stays():
    with started(tangled("bump", fixes=FREE, contact="")) as lmp:
        start = by_id(lmp, "x").copy()
    with started(tangled("bump", fixes=FREE)) as lmp:
        lmp.command("variable m atom mass")
        order = np.argsort(lmp.numpy.extract_atom("id")[: lmp.get_natoms()])
        mass = lmp.numpy.extract_variable("m", vartype=1)[order]
        by = by_id(lmp, "x") - start
    assert np.linalg.norm(by, axis=1).max() > THICKNESS
    assert np.abs(mass @ by).max() < 1e-14 * mass.sum()


def test_a_sheet_is_lifted_off_an_obstacle():
    upper = FLAT + SPIKE
    text = scene(
        upper,
        0.0,
        "fix sheet upper pbd/cloth damping 5\n",
        f"fix touch upper cloth/contact {THICKNESS} obstacle blade cloth yes untangle yes\n",
    ).replace(HELD, "")
    text = text.replace("group cloth union lower upper\n", "group cloth union upper\n")
    text = text.replace(
        "timestep",
        "create_bonds single/angle 1 $(count(all)-2) $(count(all)-1) $(count(all))\ntimestep",
    )
    with started(text) as lmp:
        oracle = mesh_of(lmp, moving=lmp.get_natoms() - 3)
        x = by_id(lmp, "x").copy()
    spike = np.array([[-0.2, 0.007, -0.4], [0.2, 0.011, -0.4], [0.013, 0.009, 0.03]])
    assert np.array_equal(x[-3:], spike)
    assert oracle.count(np.concatenate([np.c_[x[:-3, :2], 0 * x[:-3, 2]], spike])) > 0
    assert oracle.count(x) == 0


@pytest.mark.parametrize("boundary", ["f f f", "p p p"])
def test_ranks_agree(tmp_path, boundary):
    """In a periodic box the sheets lie across its border."""
    text = tangled("bump", boundary=boundary)
    if boundary == "p p p":
        text = text.replace("timestep", "displace_atoms all move 0.95 0.9 0 units box\ntimestep")
    found = {}
    for ranks in (1, 2, 4):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        printed = run(write(folder, text + "run 0\n" + final_dump("x y z", "end")), ranks)
        told = re.search(
            r"untangled in \d+ passes: \d+ vertices moved, by at most [\d.e-]+", printed
        )
        found[ranks] = told[0], last_frame(folder / "end")
    for ranks in (2, 4):
        assert found[ranks][0] == found[1][0]
        assert np.allclose(found[ranks][1], found[1][1], rtol=0, atol=1e-13)


def test_what_is_not_tangled_is_left_alone():
    ends = []
    for contact in (TOUCH, TOUCH.replace(" untangle yes", "")):
        with started(scene(UPRIGHT, contact=contact)) as lmp:
            lmp.command("run 20 pre no post no")
            ends.append(by_id(lmp, "x").copy())
    assert np.array_equal(*ends)


ERRORS = {
    # from border to border there is no way out that is shorter
    "through and through": (
        {"upper": UPRIGHT, "height": 0.2, "contact": TOUCH},
        r"cloth starts tangled, \d+ edges pass through triangles: edge \d+-\d+ through triangle "
        r"\d+-\d+-\d+ at \(.*'untangle yes' has not parted them in 400 passes",
    ),
    "nothing to do": (
        {"contact": "fix touch cloth cloth/contact 0.01 untangle yes\n"},
        "'untangle yes' has no effect without 'cloth yes' or an obstacle",
    ),
    "no answer": (
        {"contact": "fix touch cloth cloth/contact 0.01 cloth yes untangle maybe\n"},
        "untangle.*maybe",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors(tmp_path, name):
    changes, message = ERRORS[name]
    printed = fail(write(tmp_path, scene(**changes) + "run 1\n"), 2)
    assert re.search(message, printed), printed[-1500:]
