"""fix sph/integrate and run_style sph/adaptive."""

import itertools

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
    lattice,
    neighbor,
    sheet,
    sph_tait,
)
from step_scenes import CEILING, DAM, FLOOR, GROWTH, dt_and_limit, free_particles, steps_by_limit

VELOCITY, FORCE, ACOUSTIC, VISCOUS, DENSITY, RELATIVE, WETTED, CLOTH = range(1, 9)


def test_at_rest_the_step_is_the_largest():
    assert dt_and_limit(free_particles()) == (0.01, CEILING)


@pytest.mark.parametrize(
    ("options", "coefficient"),
    [
        ("", 0.15),
        ("acoustic 0.5", 0.1),
        ("wetted 0.5", 0.1),
        ("viscous 0.2", 0.1),
        ("acoustic 0.5 velocity 0.3", 0.3),
    ],
)
def test_velocity_limit(options, coefficient):
    """With the limits of sound and viscosity it is that of the paper."""
    dt, limit = dt_and_limit(free_particles(speed=50.0, options=options))
    assert (dt, limit) == (pytest.approx(coefficient * 0.1 / 50.0, rel=1e-14), VELOCITY)


def test_force_limit():
    lmp = free_particles(extra="fix pull all gravity 50 vector 1 0 0")
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.2 * np.sqrt(0.1 / 50.0), rel=1e-12), FORCE)


def test_viscous_limit():
    dt, limit = dt_and_limit(free_particles(nu=0.5, options="viscous 0.2"))
    assert (dt, limit) == (pytest.approx(0.2 * 0.05**2 / 0.5, rel=1e-12), VISCOUS)


def compressed(options):
    """A lattice 6 % too dense: pressure everywhere, no force by symmetry."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + "lattice sc 0.05\n"
        + box("-0.2 0.2 -0.2 0.2 -0.2 0.2")
        + "create_atoms 1 box\nmass 1 0.1325\n"
        + sph_tait("1 1 fluid 1000 c0 20")
        + neighbor(0.02)
        + f"timestep 0.01\nfix step all sph/integrate global {options}\n"
    )
    return lmp


def test_acoustic_limit_uses_the_sound_speed_of_the_density():
    lmp = compressed("acoustic 0.5 force 0 velocity 0 density 0")
    lmp.command("run 0")
    sound = 20 * (by_id(lmp, "rho")[0] / 1000) ** 3
    assert sound > 22
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.5 * 0.05 / sound, rel=1e-9), ACOUSTIC)


def particles_by_limit(lmp):
    counts = {k: int(lmp.extract_fix("step", 0, 1, 17 + k)) for k in range(1, 10)}
    return {k: n for k, n in counts.items() if n}


def test_density_limit():
    lmp = compressed("force 0 velocity 0 acoustic 0")
    lmp.command("velocity all ramp vx 5 -5 x -0.2 0.2 units box")
    lmp.command("run 0")
    rate = np.abs(by_id(lmp, "drho") / by_id(lmp, "rho")).max()
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.1 / rate, rel=1e-9), DENSITY)


COEFFICIENTS = "1 1 fluid 1000 c0 20", "2 2 boundary"
CROWD = (
    header("p p f", FLUID)
    + box("-0.2 0.2 -0.2 0.2 -0.2 0.2", 2)
    + "mass * 0.125\ncreate_atoms 1 random 60 42 NULL\ncreate_atoms 2 random 30 43 NULL\n"
    + sph_tait(*COEFFICIENTS)
    + neighbor(0.05)
    + """timestep 1000
    group fluid type 1
    variable u atom 40+random(-1,1,11)
    variable v atom random(-1,1,12)
    variable w atom random(-1,1,13)
    velocity all set v_u v_v v_w
    {extra}
    fix step fluid sph/integrate global velocity 0 force 0 acoustic 0 density 0 relative 0.2
    run 0
"""
)


def approach_speeds(lmp, support=0.1):
    x, v, kind = (by_id(lmp, name) for name in ("x", "v", "type"))
    apart = x[:, None] - x[None]
    apart[..., :2] -= 0.4 * np.round(apart[..., :2] / 0.4)
    r = np.linalg.norm(apart, axis=2)
    r[r == 0] = np.inf
    closing = -((v[:, None] - v[None]) * apart).sum(axis=2) / r
    return np.where(r < support, closing, 0).max(axis=1, initial=0)[kind == 1]


def own_steps(lmp, column=0):
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    return np.array(lmp.numpy.extract_fix("step", 1, 2)[:owned, column])[order]


def test_relative_limit_is_that_of_the_fastest_approach():
    """Fluid and boundary particles count, across periodic faces too; common speed does not."""
    lmp = instance()
    lmp.commands_string(CROWD.format(extra=""))
    speed = approach_speeds(lmp)
    assert np.sum(speed > 0) > 40 and np.sum(speed == 0) > 0
    own = own_steps(lmp)[by_id(lmp, "type") == 1]
    with np.errstate(divide="ignore"):
        expected = np.minimum(0.2 * 0.1 / speed, 1000)
    np.testing.assert_allclose(own, expected, rtol=1e-10)
    assert dt_and_limit(lmp) == (own.min(), RELATIVE)
    assert particles_by_limit(lmp) == {RELATIVE: np.sum(speed > 0), CEILING: np.sum(speed == 0)}


def test_relative_limit_in_mixed_precision():
    """Of a common speed of 40 m/s single precision leaves the relative speeds to 1e-5 m/s."""
    lmp = instance()
    lmp.commands_string(CROWD.format(extra=sph_tait(*COEFFICIENTS, options="precision mixed")))
    own = own_steps(lmp)[by_id(lmp, "type") == 1]
    np.testing.assert_allclose(0.2 * 0.1 / own, approach_speeds(lmp), atol=3e-5)


def test_relative_limit_sees_plane_walls():
    lmp = instance()
    walls = "fix tank all wall/sph zlo -0.2 zhi 0.2"
    lmp.commands_string(CROWD.format(extra=walls))
    z, vz = by_id(lmp, "x")[:, 2], by_id(lmp, "v")[:, 2]
    speed = approach_speeds(lmp)
    fluid = by_id(lmp, "type") == 1
    down = np.where(z < -0.1, -vz, 0)[fluid]
    up = np.where(z > 0.1, vz, 0)[fluid]
    speed = np.maximum.reduce([speed, down, up])
    with np.errstate(divide="ignore"):
        expected = np.minimum(0.2 * 0.1 / speed, 1000)
    np.testing.assert_allclose(own_steps(lmp)[fluid], expected, rtol=1e-10)


def steps_of_a_crash(speed, limits, steps=60):
    """Two blobs meet in a frame that moves with a speed."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-0.5 0.5 -0.3 0.3 -0.3 0.3")
        + lattice()
        + filled("left", "-0.25 -0.03 -0.1 0.1 -0.1 0.1")
        + filled("right", "0.03 0.25 -0.1 0.1 -0.1 0.1")
        + "group left region left\ngroup right region right\nmass 1 0.125\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1")
        + neighbor(0.03)
        + f"""timestep 0.001
        velocity left set {speed + 8} 0 0 units box
        velocity right set {speed - 8} 0 0 units box
        fix step all sph/integrate global {limits}
        run 0"""
    )
    dts = []
    for _ in range(steps):
        lmp.command("run 1 post no")
        dts.append(lmp.extract_global("dt"))
    return np.array(dts), steps_by_limit(lmp)


def test_a_moving_frame_takes_the_same_steps():
    relative = "velocity 0 relative 0.1"
    rest, limits = steps_of_a_crash(0.0, relative)
    moving, same_limits = steps_of_a_crash(100.0, relative)
    assert limits == same_limits and limits[RELATIVE] > 5
    np.testing.assert_allclose(moving, rest, rtol=1e-8)
    assert rest.max() > 1.4 * rest.min()
    absolute, _ = steps_of_a_crash(100.0, "velocity 0.1")
    assert absolute.max() < 0.5 * moving.min()  # what the paper's limit makes of it


def test_growth_is_at_most_twofold():
    lmp = free_particles(speed=50.0, run="run 1")
    steps = [dt_and_limit(lmp)]
    assert steps[0][1] == VELOCITY
    lmp.command("velocity all set 0 0 0")
    for _ in range(7):
        lmp.command("run 0")  # the setup chooses again from the same last step
        lmp.command("run 1")
        steps.append(dt_and_limit(lmp))
    factors = [after[0] / before[0] for before, after in itertools.pairwise(steps)]
    assert factors[0] == pytest.approx(4)  # the step taken at rest was itself twice the first
    assert factors[1:4] == pytest.approx([2, 2, 2])
    assert all(limit == GROWTH for _, limit in steps[1:4])
    assert steps[-1] == (0.01, CEILING)


def test_below_the_floor_it_stops_with_the_cause():
    with pytest.raises(Exception, match=r"fix step sph/integrate: the velocity limit.*below clamp"):
        free_particles(speed=500.0, options="min 1e-3")


def test_below_the_floor_it_may_clamp_and_counts():
    lmp = free_particles(speed=500.0, options="min 1e-3 below clamp max 2e-3", run="run 5")
    assert dt_and_limit(lmp) == (1e-3, FLOOR)
    assert lmp.extract_fix("step", 0, 1, 4) == 5


def test_physical_time_is_the_sum_of_the_steps():
    lmp = free_particles(speed=1.0, extra="fix pull all gravity 20 vector 1 0 0")
    lmp.command("thermo_style custom time dt")
    total = 0.0
    for _ in range(10):
        total += lmp.extract_fix("step", 0, 0)
        lmp.command("run 1")
    assert lmp.get_thermo("time") == pytest.approx(total, rel=1e-12)
    assert lmp.extract_fix("step", 0, 1, 2) == 20  # particle updates


def test_semi_implicit_euler():
    lmp = free_particles(
        speed=1.0, extra="fix pull all gravity 2 vector 1 0 0", options="max 1e-3", run="run 10"
    )
    x, v = by_id(lmp, "x")[0, 0], by_id(lmp, "v")[0, 0]
    assert v == pytest.approx(1.019, rel=1e-13)  # half a step before
    assert x == pytest.approx(0.01 + 2e-6 * 50, rel=1e-12)


@pytest.mark.parametrize("scheme", ["constant", "global"])
def test_run_style_and_fix_alone_agree_to_the_last_bit(scheme):
    results = []
    for style in ("", f"run_style sph/adaptive {scheme}"):
        lmp = instance()
        timestep = "timestep 5e-4\n" if scheme == "constant" else ""
        lmp.commands_string(DAM.format(scheme=scheme, style=timestep + style))
        results.append((by_id(lmp, "x"), by_id(lmp, "v"), lmp.extract_global("dt")))
    for a, b in zip(*results, strict=True):
        np.testing.assert_array_equal(a, b)
    assert np.abs(results[0][1]).max() > 0.1


def test_the_scheme_is_global_if_nothing_says_another():
    results, scene = [], DAM.replace("timestep 0.002", "timestep 0.02")
    for scheme, style in (
        ("global", "run_style sph/adaptive global"),
        ("", "run_style sph/adaptive"),
    ):
        lmp = instance()
        lmp.commands_string(scene.format(scheme=scheme, style=style))
        results.append((lmp.extract_global("dt"), by_id(lmp, "x")))
    assert results[0][0] == results[1][0] < 0.01
    np.testing.assert_array_equal(results[0][1], results[1][1])


def test_the_run_style_says_the_scheme():
    lmp = instance()
    lmp.commands_string(
        DAM.format(scheme="constant stability 0.4", style="run_style sph/adaptive global")
    )
    assert lmp.extract_global("dt") < 0.0015
    lmp.command("run_style verlet")
    lmp.command("timestep 1e-3")
    lmp.command("run 2")
    assert lmp.extract_global("dt") == 1e-3


def test_many_runs_are_one_run():
    whole, parts = instance(), instance()
    whole.commands_string(DAM.format(scheme="global", style=""))
    parts.commands_string(DAM.format(scheme="global", style="").replace("run 100", "run 60"))
    parts.command("run 40")
    np.testing.assert_allclose(by_id(parts, "x"), by_id(whole, "x"), atol=1e-10)
    assert parts.extract_global("dt") == pytest.approx(whole.extract_global("dt"), rel=1e-9)


def wet_cloth(areal=1.0, options="", height=0.08, extra=""):
    lmp = instance()
    lmp.commands_string(
        header()
        + cloth_box("-1 1 -1 1 -1 1")
        + "mass 1 0.01\n"
        + sheet(2, areal, "0.8 0.8", 0.05)
        + f"create_atoms 1 single 0 0 {height}\ngroup fluid type 1\n"
        + sph_tait(*COEFFICIENTS)
        + cloth_styles("1", "0")
        + neighbor(0.02)
        + f"""timestep 0.01
        {extra}
        fix step fluid sph/integrate global {options}
        fix sheet cloth pbd/cloth
        run 0"""
    )
    return lmp


def test_light_wet_cloth_shortens_the_step():
    """The acoustic limit of a vertex grows with the root of the ratio of the masses."""
    light, heavy = (wet_cloth(a, options="acoustic 0.5 force 0.05") for a in (1.0, 4.0))
    dt, limit = dt_and_limit(light)
    assert heavy.extract_global("dt") == pytest.approx(2 * dt, rel=1e-9)
    assert heavy.extract_global("dt") < 0.5 * 0.05 / 20
    assert limit == WETTED
    vertices = 17 * 17
    counts = particles_by_limit(light)
    assert sum(counts.values()) == vertices + 1
    x = by_id(light, "x")
    wet = np.linalg.norm(x[:-1] - x[-1], axis=1) < 0.1
    assert counts[WETTED] == wet.sum() > 4


def test_wet_cloth_has_a_coefficient_of_its_own():
    """Without it that of sound counts, and it changes nothing for water."""
    dt, _ = dt_and_limit(wet_cloth(1.0, options="acoustic 0.5"))
    same = dt_and_limit(wet_cloth(1.0, options="wetted 0.5"))
    assert same == (dt, WETTED)
    assert dt_and_limit(wet_cloth(1.0, options="wetted 1.0")) == (pytest.approx(2 * dt), WETTED)
    assert dt_and_limit(wet_cloth(1.0, options="acoustic 1.0")) == (pytest.approx(2 * dt), WETTED)
    both = wet_cloth(1.0, options="wetted 0.5 acoustic 1.0")
    assert dt_and_limit(both) == (pytest.approx(dt), WETTED)
    none = wet_cloth(1.0, options="wetted 0 force 0")
    assert WETTED not in particles_by_limit(none)


def test_cloth_limit_is_a_share_of_the_shortest_edge():
    turn = "velocity all set 0 0 3 units box"
    lmp = wet_cloth(options="velocity 0 cloth 0.2", height=0.5, extra=turn)
    assert dt_and_limit(lmp) == (pytest.approx(0.2 * 0.05 / 3.0, rel=1e-12), CLOTH)
    assert particles_by_limit(lmp) == {CLOTH: 17 * 17, CEILING: 1}
    free = wet_cloth(options="velocity 0", height=0.5, extra=turn)
    assert dt_and_limit(free) == (0.01, CEILING)


def test_particles_are_counted_by_their_own_limit():
    lmp = free_particles(extra="set atom 1 vx 5", run="run 0", options="max 0.005")
    assert particles_by_limit(lmp) == {VELOCITY: 1, CEILING: 1}
    assert steps_by_limit(lmp) == {}
    lmp.command("run 3")
    assert particles_by_limit(lmp) == {VELOCITY: 1, CEILING: 1}
    assert steps_by_limit(lmp) == {VELOCITY: 3}


def test_a_restart_keeps_the_largest_step_and_the_limits_of_growth(tmp_path):
    lmp = free_particles(speed=50.0, run="run 3")
    lmp.command(f"write_restart {tmp_path / 'stop'}")
    counted = lmp.extract_fix("step", 0, 1, 2)
    again = instance()
    again.commands_string(f"""
        read_restart {tmp_path / "stop"}
        comm_modify vel yes
        neighbor 0.05 bin
        fix step all sph/integrate global
        velocity all set 0 0 0
        run 0""")
    dt, limit = dt_and_limit(again)
    assert (dt, limit) == (pytest.approx(2 * 0.15 * 0.1 / 50.0), GROWTH)
    again.command("run 20")
    assert dt_and_limit(again) == (0.01, CEILING)
    assert again.extract_fix("step", 0, 1, 2) == counted + 2 * 20


def test_inactive_particles_rest_and_cost_no_sums():
    """Their position, density and force stay; their active neighbors still feel them."""
    lmp = instance()
    lmp.commands_string(DAM.format(scheme="global", style="").replace("run 100", "run 10"))
    tags = lmp.numpy.extract_atom("id")[: lmp.extract_setting("nlocal")]
    asleep = 20
    state = lmp.numpy.extract_fix("step", 1, 2)
    assert state.shape[1] == 5 and (state[:, 2] == 1).all()
    state[np.flatnonzero(tags == asleep)[0], 2] = 0.0
    before = {name: by_id(lmp, name)[asleep - 1].copy() for name in ("x", "v", "rho")}
    updates = lmp.extract_fix("step", 0, 1, 2)
    lmp.command("run 5")
    after = {name: by_id(lmp, name)[asleep - 1] for name in ("x", "v", "rho")}
    for name in ("x", "v", "rho"):
        np.testing.assert_array_equal(after[name], before[name])
    fluid = by_id(lmp, "type") == 1
    assert lmp.extract_fix("step", 0, 1, 2) == updates + 5 * (fluid.sum() - 1)
    assert lmp.extract_fix("step", 0, 1, 1) == pytest.approx(1 - 1 / fluid.sum())
    x, rho = by_id(lmp, "x"), by_id(lmp, "rho")
    near = np.linalg.norm(x - x[asleep - 1], axis=1)
    neighbor = np.flatnonzero((near < 0.08) & (near > 0) & fluid)[0]
    awake = rho[neighbor]
    state = lmp.numpy.extract_fix("step", 1, 2)
    state[:, 2] = 1.0
    lmp.command("run 0")
    assert by_id(lmp, "rho")[neighbor] == pytest.approx(awake, rel=1e-12)
    assert by_id(lmp, "rho")[asleep - 1] != before["rho"]
