"""Commands and fixes of LAMMPS beside steps that this plugin chooses."""

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
    jitter,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)

# a block of water that falls onto a plane
FALLING = (
    header("f f f", FLUID)
    + box("-1 1 -1 1 -0.3 1")
    + lattice(0.05)
    + filled("water", "-0.2 0.2 -0.2 0.2 0.05 0.35")
    + jitter(0.01, 17)
    + """mass * 0.125
set group all sph/rho 1000
velocity all set 0.2 0.1 -2 units box
"""
    + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1")
    + neighbor(0.03)
    + """timestep {ceiling}
fix gravity all gravity 9.81 vector 0 0 -1
fix walls all wall/sph zlo 0
"""
)
STEPS = "fix step {group} sph/integrate global gain 1 {limits}\nrun_style sph/adaptive {scheme}\n"


@pytest.mark.parametrize("z", ["0", "NULL"])
@pytest.mark.parametrize("limits", ["", "output 0.01"])
@pytest.mark.parametrize("scheme", ["global", "block", "individual"])
def test_water_whose_forces_are_replaced_does_not_move(scheme, limits, z):
    lmp = instance()
    lmp.commands_string(FALLING.format(ceiling=0.002))
    lmp.commands_string(STEPS.format(group="all", limits=limits, scheme=scheme))
    lmp.commands_string(
        "region low block INF INF INF INF INF 0.12 units box\ngroup frozen region low\n"
        f"velocity frozen set 0 0 0\nfix frozen frozen setforce 0 0 {z}\nrun 0"
    )
    before = by_id(lmp, "x")
    frozen = before[:, 2] < 0.12
    assert 50 < frozen.sum() < 200
    lmp.command("run 60")
    moved = np.abs(by_id(lmp, "x") - before)
    assert (moved[frozen, :2] == 0.0).all()
    assert (moved[frozen, 2].max() > 1e-4) == (z == "NULL")
    assert (moved[~frozen] > 1e-4).any(axis=1).all()


# a light sheet that goes up into a block of water
RISING = (
    header("p p f")
    + cloth_box("-0.5 0.5 -0.5 0.5 -0.6 1.0", 3)
    + "mass * 0.125\n"
    + lattice()
    + filled("block", "-0.2 0.2 -0.2 0.2 0.03 0.33")
    + "group fluid type 1\nset group all sph/rho 1000\n"
    + sheet(2, 4.0, "0.9 0.9", 0.05)
    + sph_tait("1 1 fluid 1000 c0 30 alpha 0.1", "2 2 {role}", "3 3 none")
    + cloth_styles()
    + neighbor(0.03)
    + """timestep 0.002
fix step fluid sph/integrate global
run_style sph/adaptive {scheme}
fix sheet cloth pbd/cloth {pin}
fix contact fluid cloth/contact {contact}
velocity cloth set 0 0 3
{held}
run 0
"""
)
PINNED = """region held block -0.44 0.44 INF INF INF INF side out
group pins region held
group pins intersect pins cloth
"""


def test_mass_scaling_does_not_move_water_whose_forces_are_replaced():
    lmp = instance()
    lmp.commands_string(
        RISING.replace("fix sheet", PINNED + "fix sheet").format(
            role="boundary",
            scheme="global",
            pin="pin pins reference 0.0005",
            contact="0.015",
            held="fix frozen fluid setforce 0 0 0",
        )
    )
    water = by_id(lmp, "type") == 1
    before = by_id(lmp, "x")[water]
    lmp.command("run 40")
    assert np.array_equal(by_id(lmp, "x")[water], before)
    assert not by_id(lmp, "v")[water].any()


WALL = {"role": "none", "pin": "", "contact": "0.02 wall yes"}
HOLDS = {
    "an empty group": "group empty empty\nfix frozen empty setforce 0 0 0",
    "another group": "fix frozen cloth setforce NULL NULL NULL",
    "no axis": "fix frozen fluid setforce NULL NULL NULL",
    "a region without water": "region above block INF INF INF INF 0.8 INF units box\n"
    "fix frozen fluid setforce 0 0 0 region above",
}


@pytest.fixture(scope="module", params=["global", "block"])
def not_held(request):
    lmp = instance()
    lmp.commands_string(RISING.format(scheme=request.param, held="", **WALL) + "run 40")
    return request.param, by_id(lmp, "v")


@pytest.mark.parametrize("held", HOLDS)
def test_a_fix_moves_no_water_that_it_does_not_hold(not_held, held):
    """Water in free flight feels no force along some axes, either."""
    scheme, v = not_held
    lmp = instance()
    lmp.commands_string(RISING.format(scheme=scheme, held=HOLDS[held], **WALL) + "run 40")
    assert np.array_equal(by_id(lmp, "v"), v)


def momentum(lmp):
    """Of all particles, without what the sheet has got ahead of time, from its first step on."""
    mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
    ahead = [lmp.extract_fix("sheet", 0, 1, 7 + d) for d in range(3)]
    return mass @ by_id(lmp, "v") - ahead


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_water_is_held_along_one_axis_and_in_a_region(scheme):
    """There its velocity stays; along the others momentum is that of water and sheet."""
    lmp = instance()
    held = """velocity fluid set 0.2 0.1 -0.5 units box
region left block INF 0 INF INF INF INF units box
fix frozen fluid setforce NULL 0 NULL region left"""
    lmp.commands_string(RISING.format(scheme=scheme, held=held, **WALL))
    lmp.command("run 1")
    before, held = momentum(lmp), by_id(lmp, "type") == 1
    free = held.copy()
    for _ in range(20):
        x = by_id(lmp, "x")[:, 0]
        held, free = held & (x < 0), free & (x > 0)
        lmp.command("run 1")
    v, change = by_id(lmp, "v"), momentum(lmp) - before
    assert (v[held, 1] == 0.1).all() and (v[held, 0] != 0.2).any()
    assert (v[free, 1] != 0.1).any()
    assert np.abs(change[[0, 2]]).max() < 1e-12 < 1e-6 < abs(change[1])


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_a_dynamic_group_is_known_to_the_first_step(scheme):
    found = []
    for group in ("", "region all_water block INF INF INF INF -0.29 1.9 units box\n"):
        lmp = instance()
        dynamic = "group wet dynamic all region all_water every 1\n"
        lmp.commands_string(FALLING.format(ceiling=0.005) + group + (dynamic if group else ""))
        lmp.commands_string(
            STEPS.format(group="wet" if group else "all", limits="", scheme=scheme) + "run 20"
        )
        found.append((lmp.get_thermo("time"), by_id(lmp, "x")))
    assert found[0][0] == found[1][0]
    assert np.array_equal(found[0][1], found[1][1])


def test_what_else_has_ended_a_run_stays_ended():
    lmp = instance()
    lmp.commands_string(FALLING.format(ceiling=0.002))
    lmp.commands_string(
        STEPS.format(group="all", limits="until 0.1", scheme="global")
        + "variable now equal time\nfix stop all halt 1 v_now > 0.02 error soft\nrun 200"
    )
    ended = lmp.extract_global("ntimestep")
    assert ended < 200
    lmp.command("run 5")
    assert lmp.extract_global("ntimestep") == ended


def test_a_run_that_until_has_ended_is_followed_by_others():
    lmp = instance()
    lmp.commands_string(FALLING.format(ceiling=0.002))
    lmp.commands_string(STEPS.format(group="all", limits="until 0.01", scheme="global") + "run 200")
    ended = lmp.extract_global("ntimestep")
    lmp.command("fix step all sph/integrate global")
    lmp.command("run 5")
    assert lmp.extract_global("ntimestep") == ended + 5


@pytest.mark.parametrize("scheme", ["block", "individual"])
def test_columns_of_output_leave_the_order_of_sums(scheme):
    found = []
    for column in ("density", "neighbors"):
        lmp = instance()
        lmp.commands_string(FALLING.format(ceiling=0.002))
        lmp.commands_string(
            STEPS.format(group="all", limits="", scheme=scheme)
            + f"compute found all sph/atom {column}\ncompute sum all reduce sum c_found\n"
            "thermo_style custom step c_sum\nthermo 1\nrun 40"
        )
        found.append(by_id(lmp, "v"))
    assert np.array_equal(*found)
