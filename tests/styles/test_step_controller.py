"""The controller of fix sph/integrate, fluctuation: the step by the compression that results."""

import numpy as np
import pytest
from harness import by_id, instance
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
from step_scenes import FLUCTUATION, dt_and_limit, steps_by_limit
from test_stepping import own_steps


def on_floor(options, run):
    """What a restart file of the column does not hold."""
    return (
        neighbor(0.03)
        + gravity()
        + f"fix tank all wall/sph zlo 0\nfix step all sph/integrate global {options}\n{run}\n"
    )


def run_column(options, run):
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.3 0 0.3 0 0.8")
        + lattice()
        + filled("water", "INF INF INF INF 0.0 0.5")
        + "mass * 0.125\n"
        + sph_tait("1 1 fluid 1000 c0 25 alpha 0.1")
        + "timestep 0.01\n"
        + on_floor(options, run)
    )
    return lmp


BLOCK = "\nrun_style sph/adaptive block\n"
OTHERS_OFF = "acoustic 0 velocity 0 force 0 density 0"


def test_the_controller_finds_the_longest_step_that_keeps_the_compression():
    """Far above the default step, below the limit of stability; without it the column bursts."""
    eta, in_sound = 0.03, 25 / 0.05
    lmp = run_column(f"{OTHERS_OFF} fluctuation {eta}", "run 0")
    assert dt_and_limit(lmp) == (pytest.approx(0.25 / in_sound), FLUCTUATION)
    lmp.command("run 1000")
    steps, compressions = [], []
    for _ in range(200):
        lmp.command("run 10 post no")
        steps.append(lmp.extract_global("dt") * in_sound)
        compressions.append(lmp.extract_fix("step", 0, 1, 3))
    assert 1.5 < max(steps) < 2.0 and np.mean(steps) > 2 * 0.5
    # a shock halves the step at 2 eta, so that none gets to 4; 1.5 to 2.6 with other roundings
    assert eta < max(compressions) < 4 * eta
    assert steps_by_limit(lmp) == {FLUCTUATION: 3000}
    with pytest.raises(Exception, match=r"Lost atoms|density"):
        run_column(f"{OTHERS_OFF} max {2.0 / in_sound}", "run 2000")


def test_the_controller_takes_small_paces_and_halves_in_a_shock():
    eta = 0.005
    lmp = run_column(f"{OTHERS_OFF} fluctuation {eta}", "run 0")
    steps, compressions = [lmp.extract_global("dt")], [lmp.extract_fix("step", 0, 1, 3)]
    for _ in range(300):
        lmp.command("run 1 post no")
        steps.append(lmp.extract_global("dt"))
        compressions.append(lmp.extract_fix("step", 0, 1, 3))
    factors = np.array(steps[1:]) / np.array(steps[:-1])
    least = np.array(steps[1:]) < 0.0501 * 0.05 / 25
    doublings = np.floor(np.log2(np.maximum(1, np.array(compressions) / eta)))
    shock = (doublings[1:] > doublings[:-1]) & ~least
    assert shock.any() and least.any()
    np.testing.assert_allclose(factors[shock], 0.5)
    calm = np.array(compressions[1:]) < eta
    np.testing.assert_allclose(factors[~shock & ~least & calm], 1.002)
    np.testing.assert_allclose(factors[~shock & ~least & ~calm], 0.998)
    assert min(steps) == pytest.approx(0.05 * 0.05 / 25, rel=1e-12)


@pytest.mark.parametrize("scheme", ["", BLOCK])
def test_a_restart_goes_on_with_the_controllers_step_to_the_last_bit(scheme, tmp_path):
    options = f"{OTHERS_OFF} fluctuation 0.01 output 0.0101"
    whole = run_column(options, f"{scheme}run 320\nwrite_restart {tmp_path / 'stop'}")
    # what the controller knows of the past counts: no shock now, but one from rest
    assert whole.extract_fix("step", 0, 1, 3) > 2 * 0.01
    assert whole.extract_global("dt") > 2 * 0.05 * 0.05 / 25
    whole.command("run 60")
    again = instance()
    again.commands_string(
        f"read_restart {tmp_path / 'stop'}\ncomm_modify vel yes\n"
        + on_floor(options, f"{scheme}run 60")
    )
    for quantity in ("time", "dt"):
        assert again.get_thermo(quantity) == whole.get_thermo(quantity)
    assert steps_by_limit(again) == steps_by_limit(whole)
    np.testing.assert_array_equal(by_id(again, "x"), by_id(whole, "x"))


@pytest.mark.parametrize("fast", [False, True])
def test_with_block_where_all_steps_are_equal_they_are_those_of_global(fast):
    """Also where another limit has been tighter before: that of the speed, until drag sets in."""
    others = OTHERS_OFF.replace("velocity 0", "velocity 0.2") if fast else OTHERS_OFF
    steps = {}
    for scheme, gain in (("global", ""), ("block", "gain 100")):
        eta = 0.2 if fast else 0.01
        lmp = run_column(f"{others} fluctuation {eta} {gain}", "")
        if scheme == "block":
            lmp.command(BLOCK)
        if fast:
            lmp.command("velocity all set 50 0 0 units box")
        lmp.command("run 20 post no")
        assert (dt_and_limit(lmp)[1] == FLUCTUATION) is not fast
        if fast:
            lmp.command("fix drag all viscous 20")
        steps[scheme] = []
        for _ in range(200):
            lmp.command("run 1 post no")
            steps[scheme].append(lmp.extract_global("dt"))
        assert dt_and_limit(lmp)[1] == FLUCTUATION
        lmp.close()
    np.testing.assert_allclose(steps["block"], steps["global"], rtol=1e-3 if fast else 1e-6)
    assert max(steps["global"]) > 1.1 * min(steps["global"])


def test_with_block_no_particle_takes_a_longer_step():
    """A fast part of the water has a limit below the controller's, the other would have none."""
    others = OTHERS_OFF.replace("velocity 0", "velocity 0.2")
    lmp = run_column(f"gain 1 fluctuation 0.05 {others}", "")
    lmp.commands_string(
        "region top block INF INF INF INF 0.35 INF units box\ngroup top region top\n"
        "displace_atoms top move 0 0 0.2 units box\nvelocity top set 100 0 0 units box"
    )
    lmp.commands_string(BLOCK + "run 0 post no")
    shares, steps = [], []
    for _ in range(200):
        lmp.command("run 1 pre no post no")
        shares.append(lmp.extract_fix("step", 0, 1, 1))
        steps.append(own_steps(lmp).max() / 0.05 * 25)
    assert min(shares) < 0.5
    assert max(steps) < 0.25 * 1.002**200
    lmp.commands_string(
        f"fix step all sph/integrate global gain 1 max 0.01 {others}\nrun 100 post no"
    )
    assert own_steps(lmp).max() / 0.05 * 25 > 2 * 0.25
