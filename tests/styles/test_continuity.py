"""Density by continuity in pair_style sph/tait: rate, diffusion and re-initialization."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from reference_sph import C0, RHO0, H, lattice, two_particles, wendland, wendland_slope
from scenes import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    final_dump,
    gravity,
    header,
    jitter,
    neighbor,
    sheet,
    sph_tait,
)
from scenes import lattice as sites


def direct(lmp):
    """Separations, their lengths and which are near, of the periodic lattice, in numpy."""
    x = by_id(lmp, "x")
    d = x[:, None] - x[None]
    d -= 0.4 * np.round(d / 0.4)
    r = np.linalg.norm(d, axis=2)
    return d, r, (r < H) & (r > 0)


def slope_over_r(r, near):
    return np.where(near, wendland_slope(np.where(near, r, 1.0)) / np.where(near, r, 1.0), 0)


def diffusion(delta, d, r, near, rho, half_way, mass=RHO0 * 0.05**3):
    """d rho/dt by Antuono's diffusion, and without its gradients, over all pairs in numpy."""
    weight = mass / rho[None] * slope_over_r(r, near)
    matrix = -np.einsum("ij,ija,ijb->iab", weight, d, d)
    differences = np.einsum("ij,ija,ij->ia", weight, d, rho[None] - rho[:, None])
    gradient = np.linalg.solve(matrix, differences[..., None])[..., 0]
    linear = np.einsum("ija,ija->ij", gradient[:, None] + gradient[None], d) / 2
    plain = rho[:, None] - rho[None]
    scale = 2 * delta * C0 * H / 2
    weight = mass / rho[None] * half_way
    return [scale * (weight * psi).sum(axis=1) for psi in (plain - linear, plain)]


def test_continuity_follows_the_velocities_and_diffuses():
    """One step: rho + dt * rate, half way between old and new positions, against all pairs."""
    delta, dt = 0.2, 1e-4
    lmp = lattice(
        f"""
        variable uneven atom {RHO0}*(1+0.01*sin(17*x+5*y+3*z))
        set group all sph/rho v_uneven
        timestep {dt}
        fix 1 all sph/integrate constant
        run 0""",
        setting=f"density continuity delta {delta}",
    )
    before = by_id(lmp, "rho")
    lmp.command("run 1")
    mass = RHO0 * 0.05**3
    v = by_id(lmp, "v")
    d, r, near = direct(lmp)
    dv = v[:, None] - v[None]
    half = d - dt / 2 * dv
    r_half = np.linalg.norm(half, axis=2)
    slope = slope_over_r(r_half, near & (r_half < H))
    spread, _ = diffusion(delta, d, r, near, before, slope)
    rate = (mass * slope * (dv * half).sum(axis=2)).sum(axis=1) + spread
    assert np.abs(dt * rate).max() > 0.01 and np.abs(dt * spread).max() > 1e-3
    np.testing.assert_allclose(by_id(lmp, "rho"), before + dt * rate, rtol=1e-12)


VORTICES = (
    header(atoms=FLUID, dimension=2)
    + box("0 1 0 1 -0.02 0.02")
    + "mass 1 $(1/32^2)\n"
    + sites("$(1/32)", 2)
    + "create_atoms 1 box\n"
    + jitter("$(0.2/32)", 1234, dimension=2)
    + sph_tait(
        "1 1 fluid 1 c0 10",
        support="$(4/32)",
        options="tension yes density continuity delta 0",
    )
    + neighbor("$(0.5/32)")
    + """set group all sph/rho 1
variable u atom -cos(2*PI*x)*sin(2*PI*y)
variable v atom sin(2*PI*x)*cos(2*PI*y)
velocity all set v_u v_v NULL
timestep 0.005
fix step all sph/integrate constant
fix flat all enforce2d
thermo_style custom step ke etotal
thermo_modify norm no
run 0
"""
)


def test_vortices_gain_no_energy_by_continuity():
    """Nothing takes energy here; a rate taken at the end of each step gives 6.6 % in 0.5 s."""
    lmp = instance()
    lmp.commands_string(VORTICES)
    kinetic, start = lmp.get_thermo("ke"), lmp.get_thermo("etotal")
    lmp.command("run 100")
    assert lmp.get_thermo("ke") > 0.9 * kinetic
    assert abs(lmp.get_thermo("etotal") - start) < 0.01 * kinetic


def density_change_of_what_starts_too_near(density):
    """Of two particles; the lower one, half a thickness above a table, is moved out at rest."""
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-1 1 -1 1 -1 1")
        + "create_atoms 1 single 0.013 0.021 0.01\ncreate_atoms 1 single 0.013 0.021 0.06\n"
        + sheet(2, 4, "0.6 0.6", 0.1, "group table")
        + "group water type 1\nmass 1 0.125\nset group water sph/rho 500\n"
        + sph_tait("1 1 fluid 1000 c0 20", "2 2 none", options=f"density {density}")
        + neighbor(0.05)
        + """timestep 1e-3
fix step water sph/integrate constant
fix contact water cloth/contact 0.02 obstacle table
run 0
"""
    )
    before = by_id(lmp, "rho")[:2]
    lmp.command("run 20")
    np.testing.assert_allclose(by_id(lmp, "x")[:2, 2], [0.02, 0.06], rtol=1e-6)
    assert np.all(by_id(lmp, "v")[:2] == 0)
    return by_id(lmp, "rho")[:2] - before


def test_density_follows_what_contact_moves_out_without_velocity():
    summed = density_change_of_what_starts_too_near("summation")
    assert summed.min() > 50
    integrated = density_change_of_what_starts_too_near("continuity delta 0")
    np.testing.assert_allclose(integrated, summed, rtol=0.01)


def density_change_before_pores(density):
    """Of two particles in free flight, when a sheet with fine pores has stopped the lower one."""
    lmp = instance()
    lmp.commands_string(
        header("f f f", "hybrid sph molecular")
        + cloth_box("-1 1 -1 1 -1 1")
        + "create_atoms 1 single 0.013 0.021 0.03\ncreate_atoms 1 single 0.013 0.021 0.08\n"
        + sheet(2, 4, "0.6 0.6", 0.1, "group cloth")
        + "group water type 1\nmass 1 0.125\nset group water sph/rho 500\n"
        + "velocity water set 0 0 -1 units box\n"
        + sph_tait("1 1 fluid 1000 c0 20", "2 2 none", options=f"density {density}")
        + cloth_styles("1", "0")
        + neighbor(0.05)
        + """timestep 1e-4
fix step water sph/integrate constant
fix sheet cloth pbd/cloth pin cloth
fix contact water cloth/contact 0.005
fix pores water cloth/pores 1 darcy 1e7
run 0
"""
    )
    before = by_id(lmp, "rho")[:2]
    lmp.command("run 20")
    assert np.abs(by_id(lmp, "v")[0]).max() < 1e-9
    return by_id(lmp, "rho")[:2] - before


def test_density_follows_what_pores_stop():
    """They take the velocity in the midst of a step, for the rest of which the particle stands."""
    summed = density_change_before_pores("summation")
    assert summed.min() > 0.02
    integrated = density_change_before_pores("continuity delta 0")
    np.testing.assert_allclose(integrated, summed, rtol=0.01)


def diffused(field, **options):
    """Rate at which diffusion changes the densities at rest: a short step with delta 0.2 and 0."""
    dt, after = 1e-7, []
    for delta in (0.2, 0):
        lmp = lattice(
            f"""
            variable field atom {RHO0}*(1+{field})
            set group all sph/rho v_field
            velocity all set 0 0 0
            timestep {dt}
            fix 1 all sph/integrate constant
            run 0""",
            setting=f"density continuity delta {delta}",
            **options,
        )
        before = by_id(lmp, "rho")
        lmp.command("run 1")
        after.append(by_id(lmp, "rho"))
    return (after[0] - after[1]) / dt, before


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_linear_density_does_not_diffuse_up_to_its_free_surfaces(dimension):
    options = {"dimension": dimension, "boundary": "s s p" if dimension == 2 else "s s s"}
    still, _ = diffused("0.05*x-0.1*y" + ("+0.03*z" if dimension == 3 else ""), **options)
    bent, _ = diffused("0.01*sin(10*x)", **options)
    assert np.abs(bent).max() > 1e-2 * RHO0
    assert np.abs(still).max() < 1e-6 * np.abs(bent).max()


@pytest.mark.parametrize("boundary", ["p p p", "s s s"])
def test_diffusion_takes_from_one_what_it_gives_to_another(boundary):
    """The sum of V d rho vanishes, also at free surfaces."""
    rate, before = diffused("0.01*sin(17*x+5*y+3*z)", boundary=boundary)
    exchanged = np.abs(rate / before).sum()
    assert exchanged > 1.0
    assert abs((rate / before).sum()) < 1e-7 * exchanged


def test_without_a_gradient_the_plain_difference_diffuses_and_within_one_type_only():
    """A pair of one type, a particle of another type beside it, and a lone one."""
    after = {}
    for delta in (0.2, 0):
        scene = f"""
            pair_coeff 2 2 fluid {RHO0} c0 {C0}
            create_atoms 1 single 0 0.06 0
            create_atoms 1 single 0.9 0.9 0.9
            set group all sph/rho {RHO0}
            set atom 1 sph/rho {1.01 * RHO0}
            timestep 1e-7
            fix 1 all sph/integrate constant"""
        lmp = two_particles(0.05, f"density continuity delta {delta}", second=scene)
        lmp.command("run 1")
        after[delta] = by_id(lmp, "rho")
    change = after[0.2] - after[0]
    rate = 2 * 0.2 * C0 * H / 2 * 0.01 * wendland_slope(0.06) / 0.06
    np.testing.assert_allclose(change[[0, 2]], [1e-7 * rate, -1e-7 * rate / 1.01], rtol=1e-6)
    assert change[1] == change[3] == 0


COLUMN = (
    header("p f p", FLUID, dimension=2)
    + box("0 0.5 -0.4 1.4 -0.03125 0.03125", 2)
    + "mass 1 $(1000/16^2)\nmass 2 1\n"
    + sites(0.0625, 2)
    + """region water block INF INF 0 1 INF INF units box
region base block INF INF -0.3125 0 INF INF units box
create_atoms 1 region water
{base}
group water type 1
displace_atoms water random 0.006 0.006 0 12
set group all sph/rho 1000
"""
    + sph_tait(
        "1 1 fluid 1000 c0 31.3 alpha 0.5",
        "2 2 boundary volume $(1/16^2)",
        support=0.25,
        options="density continuity delta 0.1",
    )
    + neighbor(0.03)
    + "timestep 0.0016\n"
    + gravity("water", "0 -1 0")
    + """fix step water sph/integrate constant
fix flat all enforce2d
{wall}
fix calm water viscous 200
run 2000
unfix calm
"""
)


@pytest.mark.parametrize(
    ("base", "wall"),
    [
        ("create_atoms 2 region base", ""),
        ("", "fix wall water wall/sph ylo 0 pressure mirror slip yes"),
    ],
    ids=["particles", "plane"],
)
def test_a_resting_column_does_not_sink(base, wall):
    """The density of water at rest grows with depth; that must not diffuse away."""
    lmp = instance()
    lmp.commands_string(COLUMN.format(base=base, wall=wall))

    def height():
        return by_id(lmp, "x")[by_id(lmp, "type") == 1, 1].mean()

    before = height()
    assert before > 0.49
    lmp.command("run 2000")
    assert abs(height() - before) < 1e-3
    assert len(by_id(lmp, "x")) == (168 if base else 128)


def test_diffusion_does_not_depend_on_ranks_and_newton(tmp_path):
    script = (
        "newton ${newton}\n"
        + COLUMN.format(base="create_atoms 2 region base", wall="").replace("run 2000", "run 100")
        + final_dump("x y vx vy c_rho")
    ).replace("fix calm water", "compute rho all property/atom rho\nfix calm water")
    write(tmp_path, script)
    ends = []
    for ranks, newton in ((1, "on"), (2, "on"), (2, "off")):
        run(tmp_path / "in.test", ranks=ranks, newton=newton, dump="end.txt")
        ends.append(last_frame(tmp_path / "end.txt"))
    assert np.ptp(ends[0][:128, 5]) > 5  # densities, to the same relative digits as the rest
    for end in ends[1:]:
        np.testing.assert_allclose(end, ends[0], rtol=1e-10, atol=1e-10)


def test_reinitialization_is_shepard_interpolation():
    lmp = lattice(
        f"""
        variable uneven atom {RHO0}*(1+0.01*sin(17*x+5*y+3*z))
        set group all sph/rho v_uneven
        velocity all set 0 0 0
        timestep 1e-12
        fix 1 all sph/integrate constant
        run 1""",
        setting="density continuity delta 0 reinit 2",
    )
    before = by_id(lmp, "rho")
    lmp.command("run 1")
    _, r, near = direct(lmp)
    w = np.where(near | (r == 0), wendland(np.minimum(r, H)), 0)
    expected = w.sum(axis=1) / (w / before[None]).sum(axis=1)
    np.testing.assert_allclose(by_id(lmp, "rho"), expected, rtol=1e-9)
    assert np.abs(expected - before).max() > 0.1


def test_density_is_not_advanced_by_setting_up_again():
    lmp = lattice(
        f"set group all sph/rho {RHO0}\nfix 1 all sph/integrate constant\nrun 3",
        setting="density continuity",
    )
    before = by_id(lmp, "rho")
    lmp.command("run 0")
    assert np.array_equal(by_id(lmp, "rho"), before)
