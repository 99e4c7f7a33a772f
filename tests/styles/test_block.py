"""run_style sph/adaptive block: steps of individual particles in powers of two."""

from importlib import resources

import numpy as np
import pytest
from block_scenes import SPLASH
from harness import by_id, instance, last_frame, run, write
from scenes import (
    END,
    FLUID,
    MAKE_FALL,
    box,
    fall,
    filled,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    sph_tait,
)
from test_stepping import own_steps

from sphcloth import bench
from sphcloth.bench.water_density import density_error

# Two drops of different water, fine and coarse, collide in empty space.  Nothing else acts.
COLLIDE = (
    "variable steps index 200\nvariable dump index end.txt\nvariable newton index on\n"
    + header(atoms=FLUID, newton="${{newton}}")
    + "read_data drops.data\n"
    + sph_tait("1 1 fluid 1000 c0 20 {friction}", "2 2 fluid 1000 c0 20 support 0.05 {friction}")
    + neighbor(0.03)
    + """timestep 2e-3
fix step all sph/integrate global gain 1 velocity 0 force 0 acoustic 0.5 relative 0.2 {limits}
run_style sph/adaptive {scheme}
"""
)
MAKE_DROPS = (
    header(atoms=FLUID)
    + box("-0.6 0.6 -0.5 0.5 -0.5 0.5", 2)
    + lattice()
    + filled("coarse", "0.2 0 0 0.16", 1, "sphere")
    + lattice(0.025)
    + filled("fine", "-0.06 0 0 0.09", 2, "sphere")
    + "mass 1 0.125\nmass 2 0.015625\ngroup coarse type 1\ngroup fine type 2\n"
    + jitter(0.005, 17, "coarse")
    + jitter(0.002, 18, "fine")
    + """set group all sph/rho 1000
velocity coarse set -1 0.3 0 units box
velocity fine set 1 0 0 units box
write_data drops.data
"""
)


def collide(scheme="block", limits="", friction="alpha 0.1 nu 1e-3"):
    return COLLIDE.format(scheme=scheme, limits=limits, friction=friction)


@pytest.fixture
def folder(tmp_path):
    run(write(tmp_path, MAKE_FALL, "in.make"))
    run(write(tmp_path, MAKE_DROPS, "in.drops"))
    return tmp_path


def started(folder, script, monkeypatch):
    monkeypatch.chdir(folder)
    lmp = instance()
    lmp.commands_string(script + "run 0 post no")
    return lmp


def from_restart(script):
    lines = script.replace("read_data drops.data", "read_restart half.bin").splitlines(True)
    return "".join(line for line in lines if not line.startswith(("pair_style", "pair_coeff")))


def least_active_with_exact_momentum(lmp, times, steps):
    """Run so many steps so many times: the least active share, once momentum was found exact."""
    before, active = momentum(lmp), []
    for _ in range(times):
        lmp.command(f"run {steps} post no")
        active.append(lmp.extract_fix("step", 0, 1, 1))
    assert np.abs(momentum(lmp) - before).max() < 1e-13 * np.abs(before).max()
    return min(active)


def momentum(lmp):
    mass = np.array([0.0, 0.125, 0.015625])[by_id(lmp, "type")]
    return mass @ by_id(lmp, "v")


def test_all_in_one_bin_is_the_global_scheme(folder):
    """A ceiling below every limit."""
    for scheme in ("global", "block"):
        run(write(folder, fall(scheme, ceiling=2e-4) + END, f"in.{scheme}"), dump=f"{scheme}.txt")
    assert np.array_equal(last_frame(folder / "global.txt"), last_frame(folder / "block.txt"))


def test_unequal_steps_are_taken_where_they_gain_enough(folder, monkeypatch):
    """A uniform step updates all particles in every step, in as many steps as global."""
    updates, active = {}, {}
    for scheme, gain in (("global", 1), ("block", 1), ("block", 1.5), ("block", 50)):
        lmp = started(folder, collide(scheme, f"gain {gain}"), monkeypatch)
        active[scheme, gain] = 1.0
        for _ in range(40):
            lmp.command("run 1 pre no post no")
            share = lmp.extract_fix("step", 0, 1, 1)
            active[scheme, gain] = min(active[scheme, gain], share)
        updates[scheme, gain] = lmp.extract_fix("step", 0, 1, 2) / lmp.get_thermo("time")
    assert active["block", 1] < 0.5 and active["block", 1.5] < 0.5
    assert active["block", 50] == 1.0
    assert updates["block", 50] == pytest.approx(updates["global", 1], rel=0.1)
    assert updates["block", 1.5] < 0.6 * updates["block", 50]


# Ten particles that do not meet, of which four are fast.
ROWS = (
    header("p p p", FLUID)
    + box("0 1 0 2 0 1")
    + "mass 1 0.125\n"
    + "".join(f"create_atoms 1 single 0.5 {0.1 + 0.2 * k} 0.5\n" for k in range(10))
    + """set group all sph/rho 1000
group fast id 1:4
group slow id 5:10
velocity fast set 10 0 0 units box
velocity slow set 1 0 0 units box
"""
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.03)
    + "timestep 8e-3\nfix step all sph/integrate global velocity 0.1 gain 1.8\n"
    + "run_style sph/adaptive block\n"
)


@pytest.mark.parametrize(("speed", "go_on"), [(5, False), (2.2, True)])
def test_unequal_steps_go_on_while_they_gain_four_fifths_of_what_is_asked(speed, go_on):
    """Updates, and a tenth of one per particle in each step: 1.4 times fewer, and 1.7 times."""

    def least_active(lmp):
        shares = []
        for _ in range(16):
            lmp.command("run 1 pre no post no")
            shares.append(lmp.extract_fix("step", 0, 1, 1))
        return min(shares)

    with instance() as lmp:
        lmp.commands_string(ROWS + "run 40")
        assert least_active(lmp) == 0.4
        lmp.commands_string(f"velocity slow set {speed} 0 0 units box\nrun 40")
        assert least_active(lmp) == (0.4 if go_on else 1.0)


@pytest.mark.parametrize("limits", ["", "ratio 2", "waking no", "output 2e-3"])
def test_momentum_stays_to_round_off(folder, monkeypatch, limits):
    lmp = started(folder, collide(limits=limits), monkeypatch)
    assert least_active_with_exact_momentum(lmp, times=40, steps=10) < 0.1


def test_fluid_that_is_not_integrated_keeps_its_velocity_at_output_times(folder, monkeypatch):
    script = collide(limits="output 2e-3").replace("fix step all", "group own type 1\nfix step own")
    lmp = started(folder, script, monkeypatch)
    others = by_id(lmp, "type") == 2
    before = by_id(lmp, "v")
    lmp.command("run 200 post no")
    assert np.array_equal(by_id(lmp, "v")[others], before[others])
    assert not np.allclose(by_id(lmp, "v")[~others], before[~others])


def test_energy_stays_better_than_with_one_step_for_all(folder, monkeypatch):
    """Without friction, up to where the drops have gone through each other's middle."""
    error, updates = {}, {}
    for scheme, limits in (("global", ""), ("block", "ratio 2"), ("block", "ratio 4")):
        name = f"{scheme} {limits}"
        lmp = started(folder, collide(scheme, limits + " output 0.03", friction=""), monkeypatch)
        lmp.commands_string("thermo_modify norm no\nvariable t equal time")
        lmp.command("fix end all halt 1 v_t >= 0.12 error continue")
        lmp.command("run 0 post no")
        before = lmp.get_thermo("etotal")
        lmp.command("run 2000")
        error[name] = abs(lmp.get_thermo("etotal") / before - 1)
        updates[name] = lmp.extract_fix("step", 0, 1, 2)
        lmp.close()
    for ratio in (2, 4):
        assert error[f"block ratio {ratio}"] < 0.8 * error["global "] < 0.02
        assert updates[f"block ratio {ratio}"] < 0.5 * updates["global "]


def test_a_steady_state_and_a_moving_frame_take_the_longest_step(tmp_path, monkeypatch):
    """v = 0 and a = 0 give the ceiling exactly, and so does everything at one velocity."""
    for velocity in ("0 0 0", "7 3 1"):
        script = fall("block", ceiling=3e-3, limits="velocity 0 relative 0.1")
        set_up, rest = script.split("read_data fall.data")
        loose = MAKE_FALL.split("comm_modify vel yes")[1].replace("sc 0.05", "sc 0.06")
        loose = loose.split("displace_atoms")[0].split("boundary f f f")[1]
        rest = rest.replace("fix g", "#").replace("fix w", "#")
        lmp = started(
            tmp_path, f"{set_up}{loose}mass 1 0.125\nset group all sph/rho 1000{rest}", monkeypatch
        )
        lmp.command(f"velocity all set {velocity} units box")
        lmp.command("run 20 post no")
        assert lmp.extract_fix("step", 0, 0) == 3e-3
        lmp.close()


@pytest.mark.parametrize(
    "scene", [collide(limits="ratio 2"), collide(), collide(limits="output 3e-3")]
)
@pytest.mark.parametrize(("ranks", "newton"), [(2, "on"), (4, "on"), (2, "off")])
def test_ranks(folder, scene, ranks, newton):
    """Active and inactive neighbors on two sides of a border, periodic ones too."""
    run(write(folder, scene + END), dump="one.txt", steps=120)
    run(write(folder, scene + END), ranks=ranks, dump="many.txt", steps=120, newton=newton)
    one, many = last_frame(folder / "one.txt"), last_frame(folder / "many.txt")
    assert np.abs(one - many).max() < 1e-9


# Two particles that fall: a fast one alone on the right, and a slow one that comes to it.
ARRIVAL = (
    header(atoms=FLUID)
    + "processors * 1 1\n"
    + box("-2 2 -0.5 0.5 -0.5 0.5")
    + """mass 1 0.125
create_atoms 1 single -0.005 0 0
create_atoms 1 single 1 0 0
set group all sph/rho 1000
set atom 1 vx 1.0
set atom 2 vx 10.0
"""
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.03)
    + """neigh_modify every 1 delay 0 check no
timestep 0.02
fix fall all gravity 1 vector 0 0 -1
fix step all sph/integrate global gain 1
run_style sph/adaptive block
variable steps index 30
"""
    + END
)


def test_an_inactive_particle_stays_inactive_on_a_rank_where_all_others_are_active(tmp_path):
    """It gets no impulse in the midst of its step, on whatever rank."""
    script = write(tmp_path, ARRIVAL)
    run(script, dump="one.txt")
    run(script, ranks=2, dump="two.txt")
    one, two = last_frame(tmp_path / "one.txt"), last_frame(tmp_path / "two.txt")
    assert one[0][1] > 0  # it came to the other half
    np.testing.assert_allclose(two, one, rtol=1e-12, atol=1e-12)


def test_restart_and_split_runs_in_the_middle_of_a_hierarchy(folder):
    begin = collide()
    write_all = END.replace("run ${steps}", "")
    half = "run 75\nwrite_restart half.bin\nrun 75\n"
    run(write(folder, begin + half + write_all, "in.split"), dump="split.txt")
    run(write(folder, begin + END, "in.whole"), dump="whole.txt", steps=150)
    after = from_restart(begin)
    run(write(folder, after + END, "in.again"), dump="again.txt", steps=75)
    whole, split, again = (last_frame(folder / f"{n}.txt") for n in ("whole", "split", "again"))
    assert np.array_equal(split, again)
    assert np.abs(whole - split).max() < 1e-9


def test_restart_on_other_ranks(folder):
    begin = collide()
    half = "run 75\nwrite_restart half.bin\nrun 75\n"
    run(write(folder, begin + half + END, "in.split"), steps=0, dump="split.txt")
    after = from_restart(begin)
    run(write(folder, after + END, "in.again"), ranks=3, dump="again.txt", steps=75)
    split, again = last_frame(folder / "split.txt"), last_frame(folder / "again.txt")
    assert np.abs(split - again).max() < 1e-9


def test_another_scheme_before_and_behind(folder, monkeypatch):
    lmp = started(folder, collide("global"), monkeypatch)
    before = momentum(lmp)
    for scheme in ("block", "constant", "block", "global"):
        lmp.commands_string(f"run_style sph/adaptive {scheme}\ntimestep 2e-4\nrun 13 post no")
    assert lmp.extract_fix("step", 0, 1, 1) == 1
    assert np.abs(momentum(lmp) - before).max() < 1e-12
    for scheme in ("individual", "block"):
        lmp.command(f"run_style sph/adaptive {scheme}")
        lmp.command("run 13 post no")
    assert np.isfinite(by_id(lmp, "x")).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("acoustic 0.5", "acoustic 0.5 ratio 3"), "ratio is '3': steps differ by 2 or 4"),
        (("acoustic 0.5", "acoustic 0.5 waking maybe"), "waking is 'maybe': use no or yes"),
        (("acoustic 0.5", "acoustic 0.5 min 1e-3"), r"acoustic limit of particle \d+ asks"),
    ],
)
def test_errors(folder, monkeypatch, change, message):
    with pytest.raises(Exception, match=message):
        started(folder, collide().replace(*change), monkeypatch).command("run 100")


# Single particles, each with a limit of its own.
APART = (
    header(atoms=FLUID)
    + box("0 5 -0.5 0.5 -0.5 0.5", 2)
    + """mass * 0.125
create_atoms 1 single 0.5 0 0
create_atoms 1 single 1.5 0 0
create_atoms 2 single 2.5 0 0
create_atoms 2 single 3.5 0 0
create_atoms 1 single 4.5 0 0
"""
    + sph_tait("1 1 fluid 1000 c0 20", "2 2 fluid 1000 c0 20 nu 0.3")
    + neighbor(0.03)
    + """timestep 5e-3
group pulled id 2
set atom 5 vy 3.0
fix pull pulled addforce 0 0 $(0.125*40)
fix step all sph/integrate global gain 1 force 0.05 {viscous}
run_style sph/adaptive {scheme}
"""
)


@pytest.mark.parametrize("scheme", ["global", "individual", "block"])
@pytest.mark.parametrize("viscous", [0.2, 0.5])
def test_particles_are_counted_by_their_own_limits(scheme, viscous):
    lmp = instance()
    lmp.commands_string(APART.format(scheme=scheme, viscous=f"viscous {viscous}"))
    lmp.command("run 10")
    ceiling, by_force = 5e-3, 0.05 * np.sqrt(0.1 / 40)
    by_viscosity, by_velocity = viscous * 0.05**2 / 0.3, 0.1 * 0.1 / 3.0
    limits = np.array([ceiling, by_force, by_viscosity, by_viscosity, by_velocity])
    counts = [lmp.extract_fix("step", 0, 1, 17 + limit) for limit in range(1, 10)]
    assert counts == [1, 1, 0, 2, 0, 0, 0, 0, 1]
    own = own_steps(lmp)
    if scheme != "block":
        np.testing.assert_allclose(own, limits, rtol=1e-12)
        assert lmp.extract_fix("step", 0, 1, 30) == 0
        return
    assert (own <= limits * (1 + 1e-12)).all() and (own > 0.5 * limits).sum() >= 4
    ideal, ends = [], []
    for _ in range(2):
        last, own = own_steps(lmp, 1), own_steps(lmp)
        ends.append(last + own)
        ideal.append(lmp.extract_fix("step", 0, 1, 30))
        lmp.command("run 15")
    assert ideal[1] - ideal[0] == pytest.approx(((ends[1] - ends[0]) / limits).sum(), rel=1e-9)


def test_water_without_pressure_beside_water_under_pressure_does_not_fly_freely(tmp_path):
    """A column that breaks keeps its density at the longest steps that sound allows.

    Long steps of free flight in its midst leave holes there, where half of the density is missing.
    """
    column = resources.files(bench).joinpath("in.peers").read_text()
    scene = {"across": 15, "scheme": "block", "courant": 1.0, "time": 0.28, "every": 0.28}
    run(write(tmp_path, column), **scene)
    x = last_frame(tmp_path / "water.dump")[:, 2:5]
    error = density_error([x], 1 / 15)
    assert error.samples > 300
    assert error.tail < 0.05


@pytest.mark.parametrize("scheme", ["constant", "global", "block"])
def test_until_ends_a_run_at_its_time(scheme):
    lmp = instance()
    lmp.commands_string(
        SPLASH.format(scheme=scheme, limits="", ceiling=1e-3, end=0.0125, height=0.3)
    )
    lmp.command("run 1000")
    assert 0.0125 <= lmp.get_thermo("time") < 0.0136
    if scheme != "constant":
        assert lmp.get_thermo("time") == pytest.approx(0.0125, rel=1e-14)
    steps = lmp.extract_global("ntimestep")
    lmp.command("run 1000")
    assert lmp.extract_global("ntimestep") == steps


# Coarse water and fine water of a quarter of the spacing, where regions of these names are.
COARSE_AND_FINE = (
    lattice(0.04)
    + "create_atoms 1 region coarse\n"
    + lattice(0.01)
    + "create_atoms 2 region fine\nset group all sph/rho 1000\n"
    + sph_tait(
        "1 1 fluid 1000 c0 20 alpha 0.1",
        "2 2 fluid 1000 c0 20 alpha 0.1 support 0.026",
        support=0.104,
    )
    + neighbor(0.01)
)

# Fine water in the middle of coarse water, of a quarter of the spacing, under pressure.
UNDER_PRESSURE = (
    header(atoms=FLUID)
    + box("-0.2 0.2 -0.2 0.2 -0.2 0.2", 2)
    + """region fine block -0.04 0.04 -0.04 0.04 -0.04 0.04 units box
region coarse block -0.04 0.04 -0.04 0.04 -0.04 0.04 side out units box
mass 1 0.0672
mass 2 0.00105
"""
    + COARSE_AND_FINE
    + """timestep 2e-4
fix step all sph/integrate constant
run_style sph/adaptive constant
fix drag all viscous 0.2 scale 1 5
run 1500
unfix drag
timestep {dt}
fix step all sph/integrate global gain 1 velocity 0 force 0 viscous 0 density 0 acoustic 0.8
run_style sph/adaptive {scheme}
variable late equal time>0.33
fix stop all halt 1 v_late > 0.5 error continue
run 100000
unfix stop
"""
)


def test_fine_water_is_not_shaken_by_the_steps_of_coarse_water():
    """Pressures balance, but impulses of a coarse particle come all at once."""
    speed, updates = {}, {}
    for scheme, dt in (("constant", 4e-4), ("block", 5e-3)):
        with instance() as lmp:
            lmp.commands_string(UNDER_PRESSURE.format(scheme=scheme, dt=dt))
            fine, speeds = by_id(lmp, "type") == 2, []
            for _ in range(40):
                lmp.command("run 1 post no")
                speeds.append(np.sqrt((by_id(lmp, "v")[fine] ** 2).sum(axis=1).mean()))
            speed[scheme] = np.mean(speeds)
            updates[scheme] = lmp.extract_fix("step", 0, 1, 2)
    assert speed["block"] < 2.0 * speed["constant"]
    assert updates["block"] < 0.8 * updates["constant"]


# Water at rest on a floor, deep and coarse, with some fine water on top.
AT_REST = (
    header("p p f", FLUID)
    + box("0 0.2 0 0.2 -0.1 0.9", 2)
    + """region coarse block 0 0.2 0 0.2 0 0.6 units box
region fine block 0 0.2 0 0.2 0.6 0.64 units box
mass 1 0.064
mass 2 0.001
"""
    + COARSE_AND_FINE
    + gravity()
    + """fix floor all wall/sph zlo 0
fix drag all viscous 1.28 scale 2 0.015625
timestep 5e-4
fix step all sph/integrate constant
run_style sph/adaptive constant
run 1000
timestep 1e-2
fix step all sph/integrate global gain 1 velocity 0 force 0 density 0 acoustic 0.8 &
  output 0.02 until 0.7
run_style sph/adaptive block
"""
)


def test_velocities_at_output_times_are_those_of_the_motion():
    """Impulses of coarse water under pressure come and go by turns: what counts is their mean."""
    at_output, late, after, root = [], [], [], 0
    with instance() as lmp:
        lmp.commands_string(AT_REST)
        deep = (by_id(lmp, "x")[:, 2] < 0.25) & (by_id(lmp, "type") == 1)
        while lmp.get_thermo("time") < 0.599:
            lmp.command("run 1 post no")
            fall = -by_id(lmp, "v")[deep, 2].mean()
            if at_output and len(after[-1]) < root:
                after[-1].append(fall)
            if lmp.extract_fix("step", 0, 1, 27) == 1:
                at_output.append(fall)
                after.append([])
                own, step = own_steps(lmp)[deep], lmp.extract_fix("step", 0, 0)
                late.append(0.5 * 9.81 * (own.mean() - step))
                root = round(own.max() / step)
    assert len(at_output) == 4
    assert root >= 4
    error = at_output[:-1] - np.array([np.mean(falls) for falls in after[:-1]])
    assert np.abs(error).max() < 0.2 * np.mean(late)
