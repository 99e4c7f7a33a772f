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


def test_mass_scaling_does_not_move_water_whose_forces_are_replaced():
    lmp = instance()
    lmp.commands_string(
        header("p p f")
        + cloth_box("-0.5 0.5 -0.5 0.5 -0.6 1.0", 3)
        + "mass * 0.125\n"
        + lattice()
        + filled("block", "-0.2 0.2 -0.2 0.2 0.03 0.33")
        + "group fluid type 1\nset group all sph/rho 1000\n"
        + sheet(2, 4.0, "0.9 0.9", 0.05)
        + "region held block -0.44 0.44 INF INF INF INF side out\ngroup pins region held\n"
        + "group pins intersect pins cloth\n"
        + sph_tait("1 1 fluid 1000 c0 30 alpha 0.1", "2 2 boundary", "3 3 none")
        + cloth_styles()
        + neighbor(0.03)
        + """timestep 0.002
fix step fluid sph/integrate global
run_style sph/adaptive global
fix sheet cloth pbd/cloth pin pins reference 0.0005
fix contact fluid cloth/contact 0.015
velocity cloth set 0 0 3
fix frozen fluid setforce 0 0 0
run 0
"""
    )
    water = by_id(lmp, "type") == 1
    before = by_id(lmp, "x")[water]
    lmp.command("run 40")
    assert np.array_equal(by_id(lmp, "x")[water], before)
    assert not by_id(lmp, "v")[water].any()


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
