"""Density by continuity with steps of individual particles."""

import numpy as np
import pytest
from block_scenes import SPLASH
from harness import by_id, instance, last_frame, run, write
from reference_sph import H, wendland
from scenes import FLUID, box, final_dump, header, neighbor, sph_tait
from scenes import lattice as sites
from test_block import (
    MAKE_DROPS,
    collide,
    from_restart,
    least_active_with_exact_momentum,
    started,
)
from test_stepping import own_steps

DELTA = 0.1
LAST_UPDATE = 1  # column of fix sph/integrate
SUPPORT = {(1, 1): 0.1, (1, 2): 0.075, (2, 2): 0.05}
MASS = np.array([0.0, 0.125, 0.015625])


@pytest.fixture
def folder(tmp_path):
    run(write(tmp_path, MAKE_DROPS, "in.drops"))
    return tmp_path


def by_continuity(limits="", options=f"delta {DELTA}", scheme="block", **friction):
    script = collide(scheme, limits, **friction)
    return script.replace("sph/tait 0.1", f"sph/tait 0.1 density continuity {options}")


def kernel_sums(lmp):
    """The sum (1) of every particle, over all pairs, in numpy."""
    x, kind = by_id(lmp, "x"), by_id(lmp, "type")
    r = np.linalg.norm(x[:, None] - x[None], axis=2)
    w = np.zeros_like(r)
    for (s, t), reach in SUPPORT.items():
        pair = (kind[:, None] == s) & (kind == t) | (kind[:, None] == t) & (kind == s)
        near = pair & (r < reach)
        w[near] = wendland(r[near] * H / reach) * (H / reach) ** 3
    return w @ MASS[kind]


def synchronized(lmp, steps):
    """Run at least so many steps, until all particles are updated."""
    lmp.command(f"run {steps} post no")
    for _ in range(64):
        lmp.command("run 1 pre no post no")
        if lmp.extract_fix("step", 0, 1, 1) == 1:
            return
    raise AssertionError("not all particles were updated together")


def test_without_diffusion_it_is_the_exact_integral(folder, monkeypatch):
    lmp = started(folder, by_continuity(options="delta 0"), monkeypatch)
    before = by_id(lmp, "rho") - kernel_sums(lmp)
    synchronized(lmp, 300)
    assert lmp.extract_fix("step", 0, 1, 2) < 0.6 * 300 * lmp.get_natoms()
    assert np.ptp(by_id(lmp, "rho")) > 20
    np.testing.assert_allclose(by_id(lmp, "rho") - kernel_sums(lmp), before, atol=1e-9)


@pytest.mark.parametrize("limits", ["", "output 2e-3"])
def test_momentum_stays_to_round_off(folder, monkeypatch, limits):
    lmp = started(folder, by_continuity(limits), monkeypatch)
    assert least_active_with_exact_momentum(lmp, times=50, steps=7) < 0.2


# Fine and coarse water at rest in one periodic box, with densities that diffuse: pressure is too
# weak to move it.
STILL = (
    header("p p p", FLUID)
    + box("0 0.6 0 0.2 0 0.2", 2)
    + sites(0.05)
    + "region left block 0.001 0.301 INF INF INF INF units box\n"
    + "region right block 0.301 0.601 INF INF INF INF units box\n"
    + "create_atoms 1 region left\n"
    + "mass 1 0.125\nmass 2 0.015625\n"
    + sites(0.025)
    + "create_atoms 2 region right\n"
    + "displace_atoms all random 0.004 0.004 0.004 3 units box\n"
    + "variable uneven atom 1000*(1+0.02*sin(31.4*y)+0.01*cos(62.8*z))\n"
    + "set group all sph/rho v_uneven\n"
    + sph_tait(
        "1 1 fluid 1000 c0 2 support 0.1",
        "2 2 fluid 1000 c0 2 support 0.05",
        options=f"density continuity delta {DELTA}",
    )
    + neighbor(0.03)
    + "timestep 1\nfix step all sph/integrate global gain 1 velocity 0 force 0 density 0\n"
    + "fix hold all setforce 0 0 0\n"
    + "run_style sph/adaptive {scheme}\nrun 0 post no\n"
)


def diffused(scheme, time, timestep=None):
    with instance() as lmp:
        lmp.commands_string(STILL.format(scheme=scheme))
        if timestep:
            lmp.command(f"timestep {timestep}")
        x, before = by_id(lmp, "x"), by_id(lmp, "rho")
        shares = []
        while lmp.get_thermo("time") < time or shares[-1] < 1:
            lmp.command("run 1 pre no post no")
            shares.append(lmp.extract_fix("step", 0, 1, 1))
        assert np.array_equal(by_id(lmp, "x"), x)
        mass = MASS[by_id(lmp, "type")]
        return lmp.get_thermo("time"), min(shares), mass, before, by_id(lmp, "rho")


def test_diffusion_takes_from_one_what_it_gives_to_another():
    """A pair exchanges a volume m d(rho)/rho, once, also where one of the two waits."""
    time, least, mass, before, after = diffused("block", 2.0)
    assert least < 0.2
    exchanged = mass * np.log(after / before)
    assert np.abs(exchanged).sum() > 0.1
    assert abs(exchanged.sum()) < 1e-3 * np.abs(exchanged).sum()
    again, _, _, _, reference = diffused("constant", time, timestep=time / 999.5)
    assert again == pytest.approx(time, rel=1e-3)
    changed = np.abs(reference - before).max()
    assert changed > 5
    assert np.abs(after - reference).max() < 0.01 * changed


WRITE_ALL = "\ncompute rho all property/atom rho\nrun ${steps}\n" + final_dump(
    "x y z vx vy vz c_rho"
)


@pytest.mark.parametrize(("ranks", "newton"), [(2, "on"), (4, "on"), (2, "off")])
def test_ranks(folder, ranks, newton):
    script = write(folder, by_continuity() + WRITE_ALL)
    run(script, dump="one.txt", steps=120)
    run(script, ranks=ranks, dump="many.txt", steps=120, newton=newton)
    one, many = last_frame(folder / "one.txt"), last_frame(folder / "many.txt")
    assert np.ptp(one[:, -1]) > 5
    np.testing.assert_allclose(many, one, rtol=1e-11, atol=1e-9)


def test_restart_and_split_runs_in_the_middle_of_a_hierarchy(folder):
    begin = by_continuity()
    half = "run 75\nwrite_restart half.bin\nrun 75\n"
    run(write(folder, begin + half + WRITE_ALL, "in.split"), dump="split.txt", steps=0)
    run(write(folder, begin + WRITE_ALL, "in.whole"), dump="whole.txt", steps=150)
    run(write(folder, from_restart(begin) + WRITE_ALL, "in.again"), dump="again.txt", steps=75)
    whole, split, again = (last_frame(folder / f"{n}.txt") for n in ("whole", "split", "again"))
    assert np.array_equal(split, again)
    np.testing.assert_allclose(split, whole, rtol=1e-11, atol=1e-9)


# A jet without weight in empty space, in which nothing moves against anything else, and a fast
# particle far away, which takes short steps.
JET = (
    header("f f p", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -20 2", 1)
    + """mass 1 0.125
create_atoms 1 single 0.45 0.45 1.5
set group all sph/rho 1000
velocity all set 0 0 -40 units box
"""
    + sph_tait("1 1 fluid 1000 c0 10", options="density continuity delta {delta} tension yes")
    + neighbor(0.03)
    + """timestep 1e-2
group water type 1
fix pour water sph/emit 100000 1 0.05 rectangle 0 0 0.8 0.2 0.2 velocity 0 0 -2 start 0
fix step all sph/integrate global gain 1
run_style sph/adaptive {scheme}
"""
)


@pytest.mark.parametrize("delta", [0, DELTA])
def test_particles_that_enter_do_not_change_the_densities_of_others(delta):
    with instance() as lmp:
        lmp.commands_string(JET.format(scheme="block", delta=delta))
        active = []
        for _ in range(60):
            lmp.command("run 7 post no")
            active.append(lmp.extract_fix("step", 0, 1, 1))
        assert min(active) < 0.02 and lmp.get_natoms() > 70
        np.testing.assert_allclose(by_id(lmp, "rho"), 1000, rtol=1e-9)
        velocities = by_id(lmp, "v")[1:] - [0, 0, -2]
        assert np.abs(velocities).max() < 1e-9


def asleep_and_uneven(height):
    """Return a drop above a pool, both thinner than at rest, without pressure, and asleep."""
    script = SPLASH.format(scheme="block", limits="sleep 0.01", ceiling=2e-3, end=10, height=height)
    script = script.replace("velocity falls", "#").replace(
        "sph/tait 0.1", f"sph/tait 0.1 density continuity delta {DELTA}"
    )
    lmp = instance()
    lmp.commands_string(
        f"{script}variable uneven atom 995+4*sin(17*x+5*y+3*z)\n"
        "set group all sph/rho v_uneven\nrun 150"
    )
    assert lmp.extract_fix("step", 0, 1, 1) == 0
    return lmp


def test_water_that_sleeps_keeps_its_density():
    """Also while it wakes."""
    with asleep_and_uneven(0.3) as lmp:
        asleep = by_id(lmp, "rho")
        assert np.ptp(asleep) > 2
        lmp.command("run 30")
        assert np.array_equal(by_id(lmp, "rho"), asleep)
        lmp.commands_string("velocity all set 0 0 -1 units box\nrun 1")
        assert lmp.extract_fix("step", 0, 1, 1) == 1
        np.testing.assert_allclose(by_id(lmp, "rho"), asleep, rtol=1e-12)
        lmp.commands_string("run 1")
        change = np.abs(by_id(lmp, "rho") - asleep).max()
        assert 0 < change < 0.1


def test_water_that_sleeps_beside_water_that_moves_keeps_its_density():
    with asleep_and_uneven(0.15) as lmp:
        x, rho, last = by_id(lmp, "x"), by_id(lmp, "rho"), own_steps(lmp, LAST_UPDATE)
        lmp.command("velocity falls set 0 0 -3 units box")
        beside = 0
        for _ in range(40):
            lmp.command("run 2 post no")
            still = own_steps(lmp, LAST_UPDATE) == last
            assert np.array_equal(by_id(lmp, "rho")[still], rho[still])
            moves = by_id(lmp, "x")[~still]
            near = np.linalg.norm(x[still][:, None] - moves[None], axis=2) < H
            beside = max(beside, near.any(axis=1).sum())
        assert beside > 50


def test_what_changes_between_runs_is_no_motion():
    """Sums of before are no measure where masses are others now, also of particles that wait."""
    script = STILL.format(scheme="block").replace(f"delta {DELTA}", "delta 0")
    with instance() as lmp:
        lmp.commands_string(script + "run 5 post no")
        while lmp.extract_fix("step", 0, 1, 1) == 1:
            lmp.command("run 1 post no")
        before = by_id(lmp, "rho")
        lmp.commands_string("mass * 0.02\nrun 0 post no")
        synchronized(lmp, 1)
        np.testing.assert_allclose(by_id(lmp, "rho"), before, rtol=1e-12)


def test_density_is_not_advanced_by_setting_up_again(folder, monkeypatch):
    lmp = started(folder, by_continuity(), monkeypatch)
    lmp.command("run 77")
    before = by_id(lmp, "rho")
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), before, rtol=1e-14)


def energy_lost(folder, monkeypatch, scheme):
    """Part of it, without viscosity and diffusion, and updates."""
    script = by_continuity("until 0.1", "delta 0 tension yes", scheme, friction="")
    lmp = started(folder, script + "thermo_modify norm no\n", monkeypatch)
    before = lmp.get_thermo("etotal")
    lmp.command("run 100000")
    assert lmp.get_thermo("time") == pytest.approx(0.1)
    return 1 - lmp.get_thermo("etotal") / before, lmp.extract_fix("step", 0, 1, 2)


def test_energy_stays_better_than_with_one_step_for_all(folder, monkeypatch):
    of_all, many = energy_lost(folder, monkeypatch, "global")
    of_each, few = energy_lost(folder, monkeypatch, "block")
    assert few < 0.8 * many
    assert abs(of_each) < abs(of_all) < 1e-3


def test_a_shift_is_refused():
    lmp = instance()
    lmp.commands_string(JET.format(scheme="block", delta=0) + "fix even water sph/shift")
    with pytest.raises(Exception, match=r"fix even sph/shift: .*: use 'density summation', or"):
        lmp.command("run 0")
