"""fix sph/integrate and run_style sph/adaptive."""

import itertools

import numpy as np
import pytest
from harness import by_id, instance

VELOCITY, FORCE, ACOUSTIC, VISCOUS, DENSITY, CEILING, FLOOR, GROWTH = range(1, 9)


def free_particles(speed=0.0, options="", extra="", run="run 0", nu=0.0, timestep=0.01):
    """Particles out of each other's reach."""
    lmp = instance()
    lmp.commands_string(f"""
        units si
        atom_style sph
        comm_modify vel yes
        region box block -1 1 -1 1 -1 1
        create_box 1 box
        mass 1 0.125
        create_atoms 1 single 0 0 0
        create_atoms 1 single 0.5 0 0
        pair_style sph/tait 0.1
        pair_coeff 1 1 fluid 1000 c0 20 nu {nu}
        neighbor 0.05 bin
        timestep {timestep}
        velocity all set {speed} 0 0
        {extra}
        fix step all sph/integrate global {options}
        {run}""")
    return lmp


def dt_and_limit(lmp):
    return lmp.extract_fix("step", 0, 0), int(lmp.extract_fix("step", 0, 1, 0))


def test_at_rest_the_step_is_the_largest():
    assert dt_and_limit(free_particles()) == (0.01, CEILING)


def test_velocity_limit():
    dt, limit = dt_and_limit(free_particles(speed=5.0))
    assert (dt, limit) == (pytest.approx(0.1 * 0.1 / 5.0, rel=1e-14), VELOCITY)


def test_force_limit():
    lmp = free_particles(extra="fix pull all gravity 50 vector 1 0 0")
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.05 * np.sqrt(0.1 / 50.0), rel=1e-12), FORCE)


def test_viscous_limit():
    dt, limit = dt_and_limit(free_particles(nu=0.5))
    assert (dt, limit) == (pytest.approx(0.2 * 0.05**2 / 0.5, rel=1e-12), VISCOUS)


def compressed(options):
    """A lattice 6 % too dense: pressure everywhere, no force by symmetry."""
    lmp = instance()
    lmp.commands_string(f"""
        units si
        atom_style sph
        comm_modify vel yes
        lattice sc 0.05
        region box block -0.2 0.2 -0.2 0.2 -0.2 0.2 units box
        create_box 1 box
        create_atoms 1 box
        mass 1 0.1325
        pair_style sph/tait 0.1
        pair_coeff 1 1 fluid 1000 c0 20
        neighbor 0.02 bin
        timestep 0.01
        fix step all sph/integrate global {options}""")
    return lmp


def test_acoustic_limit_uses_the_sound_speed_of_the_density():
    lmp = compressed("force 0 velocity 0 density 0")
    lmp.command("run 0")
    sound = 20 * (by_id(lmp, "rho")[0] / 1000) ** 3
    assert sound > 22
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.5 * 0.05 / sound, rel=1e-9), ACOUSTIC)


def test_density_limit():
    lmp = compressed("force 0 velocity 0 acoustic 0")
    lmp.command("velocity all ramp vx 5 -5 x -0.2 0.2 units box")
    lmp.command("run 0")
    rate = np.abs(by_id(lmp, "drho") / by_id(lmp, "rho")).max()
    dt, limit = dt_and_limit(lmp)
    assert (dt, limit) == (pytest.approx(0.1 / rate, rel=1e-9), DENSITY)


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
    assert v == pytest.approx(1.02, rel=1e-13)
    assert x == pytest.approx(0.01 + 2e-6 * 55, rel=1e-12)


DAM = """
units si
atom_style sph
comm_modify vel yes
boundary f p f
region box block 0 1 0 0.2 0 0.6
create_box 2 box
lattice sc 0.05 origin 0.5 0.5 0.5
region water block 0.05 0.4 INF INF 0.05 0.4 units box
region wall block 0.05 0.95 0.0 0.2 0.05 INF side out units box
create_atoms 1 region water
create_atoms 2 region wall
mass * 0.125
group fluid type 1
pair_style sph/tait 0.1
pair_coeff 1 1 fluid 1000 c0 25 alpha 0.1
pair_coeff 2 2 boundary
neighbor 0.03 bin
neigh_modify every 1 delay 0 check yes
timestep 0.002
fix gravity fluid gravity 9.81 vector 0 0 -1
fix step fluid sph/integrate {scheme}
fix drain fluid sph/drain
{style}
run 100
"""


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


def test_the_run_style_says_the_scheme():
    lmp = instance()
    lmp.commands_string(DAM.format(scheme="constant", style="run_style sph/adaptive global"))
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


def test_light_wet_cloth_shortens_the_step():
    """The acoustic limit of a vertex grows with the root of the ratio of the masses."""
    steps = []
    for areal in (1.0, 4.0):
        lmp = instance()
        lmp.commands_string(f"""
            units si
            atom_style hybrid sph molecular
            atom_modify map yes
            comm_modify vel yes
            region box block -1 1 -1 1 -1 1
            create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
              extra/angle/per/atom 8 extra/dihedral/per/atom 8
            mass 1 0.01
            create_cloth 2 {areal} size 0.8 0.8 spacing 0.05 group cloth
            create_atoms 1 single 0 0 0.08
            group fluid type 1
            special_bonds lj/coul 1 1 1
            pair_style sph/tait 0.1
            pair_coeff 1 1 fluid 1000 c0 20
            pair_coeff 2 2 boundary
            bond_style pbd
            bond_coeff 1 1
            dihedral_style pbd
            dihedral_coeff 1 0
            neighbor 0.02 bin
            timestep 0.01
            fix step fluid sph/integrate global
            fix sheet cloth pbd/cloth
            run 0""")
        steps.append(lmp.extract_global("dt"))
    assert steps[1] == pytest.approx(2 * steps[0], rel=1e-9)
    assert steps[1] < 0.5 * 0.05 / 20


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
    assert (dt, limit) == (pytest.approx(2 * 0.1 * 0.1 / 50.0), GROWTH)
    again.command("run 20")
    assert dt_and_limit(again) == (0.01, CEILING)
    assert again.extract_fix("step", 0, 1, 2) == counted + 2 * 20


def test_inactive_particles_rest_and_cost_no_sums():
    """Their position, density and force stay; their active neighbours still feel them."""
    lmp = instance()
    lmp.commands_string(DAM.format(scheme="global", style="").replace("run 100", "run 10"))
    tags = lmp.numpy.extract_atom("id")[: lmp.extract_setting("nlocal")]
    asleep = 20
    state = lmp.numpy.extract_fix("step", 1, 2)
    assert state.shape[1] == 3 and (state[:, 2] == 1).all()
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
    neighbour = np.flatnonzero((near < 0.08) & (near > 0) & fluid)[0]
    awake = rho[neighbour]
    state = lmp.numpy.extract_fix("step", 1, 2)
    state[:, 2] = 1.0
    lmp.command("run 0")
    assert by_id(lmp, "rho")[neighbour] == pytest.approx(awake, rel=1e-12)
    assert by_id(lmp, "rho")[asleep - 1] != before["rho"]
