"""What moves atoms without a velocity, as fix recenter does, is no motion of cloth and what is
beside it: a shift of all atoms changes no velocity, and a box carries both sides of a contact."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import (
    cloth_box,
    filled,
    header,
    lattice,
    neighbor,
    no_other_bonds,
    sph_tait,
    stiffness,
)

RECENTER = "fix shift all recenter INIT INIT INIT\n"
MIXED = "hybrid sph molecular"


def grains(contact="", pin="", forces=""):
    """Two grains on a level sheet, with a plate far below."""
    return (
        header("p p p", MIXED)
        + cloth_box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
        + "mass * 0.01\n"
        + "create_cloth 2 1.0 size 0.8 0.4 spacing 0.05 group cloth\n"
        + "create_cloth 2 1.0 center 0 0 -0.3 size 0.8 0.4 spacing 0.05 group plate\n"
        + "create_atoms 1 single 0.31 0.013 0.01\ncreate_atoms 1 single 0 0.013 0.01\n"
        + "group grains type 1\nregion edge block INF -0.35 INF INF INF INF\n"
        + "group edge region edge\ngroup pins intersect cloth edge\n"
        + "pair_style zero 0.05\npair_coeff * *\n"
        + stiffness("1.0", "0.0")
        + no_other_bonds()
        + neighbor(0.05, 0.25)
        + f"timestep 1e-3\n{forces}"
        + f"fix move grains nve\nfix plate plate nve\nfix sheet cloth pbd/cloth {pin}\n"
        + f"fix contact grains cloth/contact 0.01 friction 0.5 {contact}\n"
    )


def water(density, contact="", more="", plate=False):
    """A block of water with a sheet across it, and perhaps a plate far below."""
    below = "center 0 0 -0.3 size 0.8 0.4 spacing 0.05 group plate"
    return (
        header("p p p", MIXED)
        + cloth_box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
        + "mass * 0.125\n"
        + lattice(0.05)
        + filled("w", "-0.1 0.1 -0.1 0.1 -0.2 0.2")
        + "create_cloth 2 2 size 0.4 0.4 spacing 0.05 group cloth\ngroup water type 1\n"
        + (f"create_cloth 2 1.0 {below}\n" if plate else "")
        + "set type * sph/rho 1000\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1", "2 2 none", options=f"density {density}")
        + stiffness("1.0", "0.0")
        + no_other_bonds()
        + neighbor(0.05, 0.25)
        + "timestep 1e-3\nfix step water sph/integrate constant\n"
        + ("fix plate plate nve\n" if plate else "")
        + "fix sheet cloth pbd/cloth\n"
        + f"fix contact water cloth/contact 0.02 {contact}\n{more}"
    )


PORES = "fix pores water cloth/pores 1 darcy 5000\n"
PRESSED = "fix press grains addforce 0 0 -0.1\n"
SCENES = {
    "friction": grains(forces=PRESSED),
    "friction beside moving pins": grains("", "pin pins velocity 0.5 0 0.3", PRESSED),
    "friction beside an obstacle": grains("obstacle plate", "", PRESSED),
    "bounce": grains("restitution 0.5", "", "fix press grains addforce 0 0 -1\n"),
    "air": grains() + "fix air cloth cloth/air density 1.2 wind 0 0 5\n",
    "pores": water("summation", "", PORES),
    "pores beside an obstacle": water("summation", "obstacle plate", PORES, plate=True),
    "density by continuity": water("continuity", "wall yes", "fix press water addforce 0 0 -5\n"),
}


def motion(script, commands=""):
    with instance() as lmp:
        lmp.commands_string(f"{script}velocity all set 0.5 0 0.3 units box\n{commands}run 30")
        return by_id(lmp, "x"), by_id(lmp, "v")


@pytest.mark.parametrize("scene", SCENES)
def test_a_shift_of_all_atoms_changes_no_velocity(scene):
    place, expected = motion(SCENES[scene])
    shifted, found = motion(SCENES[scene], RECENTER)
    assert np.abs(place - shifted).max() > 0.01
    assert np.abs(expected - [0.5, 0, 0.3]).max() > 1e-3
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


def test_grains_go_with_the_box_as_the_sheet_does_on_which_they_lie():
    script = grains("", "pin cloth", "fix press grains addforce 0 0 -0.1\n")
    with instance() as lmp:
        lmp.commands_string(f"{script}fix box all deform 1 x erate -1 remap x\nrun 100")
        x, v = by_id(lmp, "x"), by_id(lmp, "v")
    np.testing.assert_allclose(x[-2:, 0], [0.9 * 0.31, 0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(v[-2:, 0], 0, rtol=0, atol=1e-9)
