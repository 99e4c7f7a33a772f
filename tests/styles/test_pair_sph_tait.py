"""pair_style sph/tait against closed formulas, written here from the paper's equations."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import FLUID, box, filled, final_dump, gravity, header, jitter, neighbor, sph_tait
from scenes import lattice as sites

H = 0.1
RHO0, C0, GAMMA = 1000.0, 20.0, 7.0


def wendland(r, dim=3):
    norm = 21 / (2 * math.pi) / H**3 if dim == 3 else 7 / math.pi / H**2
    q = r / H
    return norm * (1 - q) ** 4 * (1 + 4 * q)


def wendland_slope(r):
    return 21 / (2 * math.pi) / H**4 * -20 * (r / H) * (1 - r / H) ** 3


def tait(rho):
    return C0**2 * RHO0 / GAMMA * ((rho / RHO0) ** GAMMA - 1)


def spline_w(q, points, weights, power):
    return sum(w * np.maximum(p - q, 0) ** power for p, w in zip(points, weights, strict=True))


def kernel(norm, shape):
    """A kernel in three dimensions and its derivative by central differences of the formula."""

    def slope(q, d=1e-6):
        return norm / H**4 * (shape(q + d) - shape(q - d)) / (2 * d)

    return lambda q: norm / H**3 * shape(q), slope


def quintic(q):
    return spline_w(q, (1, 2 / 3, 1 / 3), (1, -6, 15), 5)


def cubic(q):
    return spline_w(q, (1, 0.5), (2, -8), 3)


# name: W(q), dW/dr(q); the splines in their truncated-power form, which the code does not use
KERNELS = {
    "wendland/c2": kernel(
        21 / (2 * math.pi), lambda q: np.maximum(1 - q, 0) ** 4 * (1 + 4 * np.abs(q))
    ),
    "wendland/c4": kernel(
        495 / (32 * math.pi),
        lambda q: np.maximum(1 - q, 0) ** 6 * (1 + 6 * q + 35 / 3 * q**2),
    ),
    "cubic": kernel(8 / math.pi, cubic),
    "quintic": kernel(3**7 / (40 * math.pi), quintic),
}


def two_particles(r, setting="", units="si", coeff=f"fluid {RHO0} c0 {C0}", second="", mass=1.0):
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID, units=units)
        + box("-1 1 -1 1 -1 1", 2)
        + f"mass 1 {mass}\nmass 2 {mass * 1.5}\n"
        + f"create_atoms 1 single 0 0 0\ncreate_atoms 2 single {r} 0 0\n"
        + sph_tait(f"* * {coeff}", support=H, options=setting)
        + f"{second}\nneighbor 0.02 bin\nrun 0\n"
    )
    return lmp


@pytest.mark.parametrize("r", [0.02, 0.05, 0.09])
def test_two_particles(r):
    lmp = two_particles(r)
    rho1 = 1.0 * wendland(0) + 1.5 * wendland(r)
    rho2 = 1.5 * wendland(0) + 1.0 * wendland(r)
    force = -1.5 * (tait(rho1) / rho1**2 + tait(rho2) / rho2**2) * wendland_slope(r)
    np.testing.assert_allclose(by_id(lmp, "rho"), [rho1, rho2], rtol=1e-14)
    np.testing.assert_allclose(by_id(lmp, "f")[:, 0], [-force, force], rtol=1e-12)
    assert np.all(by_id(lmp, "f")[:, 1:] == 0)


def test_particles_of_one_type_count_with_masses_of_their_own():
    masses = "fix mass all property/atom rmass ghost yes\nset atom 1 mass 1\nset atom 2 mass 2.5"
    lmp = two_particles(0.05, second=f"set type 2 type 1\n{masses}")
    mass = np.array([1.0, 2.5])
    rho = mass * wendland(0) + mass[::-1] * wendland(0.05)
    np.testing.assert_allclose(by_id(lmp, "rho"), rho, rtol=1e-12)
    along = mass.prod() * wendland_slope(0.05) * (tait(rho) / rho**2).sum()
    np.testing.assert_allclose(by_id(lmp, "f")[:, 0], [along, -along], rtol=1e-10)


def test_outside_the_support_nothing_acts():
    lmp = two_particles(0.1)
    assert np.all(by_id(lmp, "f") == 0)
    np.testing.assert_allclose(by_id(lmp, "rho")[0], wendland(0), rtol=1e-14)


def test_units_are_those_of_the_script():
    si, real = two_particles(0.05), two_particles(0.05, units="real")
    ftm2v = 4184e-7  # (kcal/mol/Angstrom)/(g/mol) in Angstrom/fs^2
    np.testing.assert_allclose(by_id(real, "f") * ftm2v, by_id(si, "f"), rtol=2e-4)


@pytest.mark.parametrize("stiffness", [f"k {C0**2}", f"c0 {C0}", f"fluctuation 0.01 {C0 / 10}"])
def test_three_ways_to_give_the_stiffness(stiffness):
    lmp = two_particles(0.05, coeff=f"fluid {RHO0} {stiffness}")
    np.testing.assert_allclose(by_id(lmp, "f"), by_id(two_particles(0.05), "f"), rtol=1e-12)


def test_negative_pressure_counts_as_zero_unless_asked_for():
    light = {"mass": 0.01}
    assert np.all(by_id(two_particles(0.05, **light), "f") == 0)
    pulled = two_particles(0.05, "tension yes", **light)
    assert by_id(pulled, "f")[0, 0] > 0


def test_kernel_choice():
    lmp = two_particles(0.05, "kernel cubic")
    cubic = 8 / math.pi / H**3
    np.testing.assert_allclose(by_id(lmp, "rho")[0], cubic * (1.0 + 1.5 * 0.25), rtol=1e-14)


@pytest.mark.parametrize(("pressure", "factor"), [("own", 1), ("mirror", 2), ("extrapolate", 2)])
def test_boundary_counts_with_its_own_volume_and_pushes_back(pressure, factor):
    volume, r = 2e-4, 0.03
    coeff = f"fluid {RHO0} c0 {C0}"
    second = f"pair_coeff 2 2 boundary volume {volume} pressure {pressure}"
    lmp = two_particles(r, coeff=coeff, second=second)
    rho = wendland(0) + RHO0 * volume * wendland(r)
    force = -factor * RHO0 * volume * tait(rho) / rho**2 * wendland_slope(r)
    np.testing.assert_allclose(by_id(lmp, "rho")[0], rho, rtol=1e-14)
    np.testing.assert_allclose(by_id(lmp, "f")[:, 0], [-force, force], rtol=1e-12)


@pytest.mark.parametrize("volume", ["", "volume auto", "volume 1e-3 volume auto"])
def test_measured_volume_of_a_lone_boundary_particle(volume):
    coeff = f"fluid {RHO0} c0 {C0}"
    lmp = two_particles(0.03, coeff=coeff, second=f"pair_coeff 2 2 boundary {volume}")
    rho = wendland(0) + RHO0 / wendland(0) * wendland(0.03)
    np.testing.assert_allclose(by_id(lmp, "rho")[0], rho, rtol=1e-14)


def test_boundary_stiffness_of_its_own():
    coeff, volume = f"fluid {RHO0} c0 {C0}", "pair_coeff 2 2 boundary volume 2e-4"
    plain = two_particles(0.03, coeff=coeff, second=volume)
    stiff = two_particles(0.03, coeff=coeff, second=f"{volume}\npair_coeff 1 2 c0 {2 * C0}")
    np.testing.assert_allclose(by_id(stiff, "f"), 4 * by_id(plain, "f"), rtol=1e-12)


def lattice(
    extra="",
    displace=True,
    newton="on",
    dimension=3,
    boundary="p p p",
    kind="block",
    setting="",
    types=1,
):
    """A periodic lattice at rest density, jittered if asked for."""
    depth = "-0.2 0.2" if dimension == 3 else "-0.025 0.025"
    sides = f"-0.2 0.2 -0.2 0.2 {depth}" + (" 0.1 0.05 0.02" if kind == "prism" else "")
    lmp = instance()
    lmp.commands_string(
        header(boundary, FLUID, dimension=dimension, newton=newton)
        + f"lattice {'sc' if dimension == 3 else 'sq'} 0.05\n"
        + box(sides, types, kind)
        + f"create_atoms 1 box\nmass * {RHO0 * 0.05**dimension}\n"
        + "velocity all create 300 4321 loop geom\nvelocity all scale 1e22\n"
        + (jitter(0.01, 99, dimension=dimension) if displace else "")
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} alpha 0.3 nu 0.01",
            support=H,
            options=f"tension yes {setting}",
        )
        + neighbor(0.02)
        + extra
    )
    return lmp


@pytest.mark.parametrize("dimension", [2, 3])
def test_lattice_density_is_the_lattice_sum(dimension):
    lmp = lattice("run 0", displace=False, dimension=dimension)
    n = np.arange(-2, 3) * 0.05
    grid = np.stack(np.meshgrid(*[n] * dimension), axis=-1).reshape(-1, dimension)
    r = np.linalg.norm(grid, axis=1)
    expected = RHO0 * 0.05**dimension * wendland(r[r < H], dimension).sum()
    np.testing.assert_allclose(by_id(lmp, "rho"), expected, rtol=1e-13)
    lmp.command("velocity all set 0 0 0")
    lmp.command("run 0")
    assert np.abs(by_id(lmp, "f")).max() < 1e-9 * RHO0 * 0.05 * C0**2


def with_spacing(coeff="spacing 0.05", *, dimension=3, before="", kernel="wendland/c2"):
    """A lattice of spacing 0.05, its mass by the pair style."""
    lmp = instance()
    z = "0 0.4" if dimension == 3 else "-0.01 0.01"
    lmp.commands_string(f"""
        units si
        dimension {dimension}
        atom_style sph
        atom_modify map array
        comm_modify vel yes
        lattice {"sc" if dimension == 3 else "sq"} 0.05
        region box block 0 0.4 0 0.4 {z} units box
        create_box 1 box
        create_atoms 1 box
        {before}
        pair_style sph/tait {H} kernel {kernel}
        pair_coeff 1 1 fluid {RHO0} {coeff} c0 {C0}
        neighbor 0.02 bin""")
    return lmp


def mass_of_lattice(kernel, dimension=3, spacing=0.05, support=H):
    n = np.arange(-9, 10) * spacing
    grid = np.stack(np.meshgrid(*[n] * dimension), axis=-1).reshape(-1, dimension)
    q = np.linalg.norm(grid, axis=1) / support
    w = KERNELS[kernel][0](q[q < 1]) * (H / support) ** 3
    if dimension == 2:  # the kernels above have the constant of three dimensions
        w *= {"wendland/c2": H * (7 / math.pi) / (21 / (2 * math.pi)), "cubic": H * 5 / 7}[kernel]
    return RHO0 / w.sum()


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kernel", ["wendland/c2", "cubic"])
def test_spacing_gives_a_lattice_the_rest_density(kernel, dimension):
    lmp = with_spacing(kernel=kernel, dimension=dimension)
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)
    mass = lmp.extract_atom("mass")[1]
    np.testing.assert_allclose(mass, mass_of_lattice(kernel, dimension), rtol=1e-12)


def test_mass_of_a_lattice_follows_kernel_support_and_spacing():
    lmp = with_spacing("spacing 0.05 support 0.15")
    mass = lmp.extract_atom("mass")
    np.testing.assert_allclose(mass[1], mass_of_lattice("wendland/c2", support=0.15), rtol=1e-12)
    lmp.command(f"pair_coeff 1 1 fluid {RHO0} c0 {C0} spacing 0.05")
    lmp.command(f"pair_style sph/tait {H} kernel quintic")
    np.testing.assert_allclose(mass[1], mass_of_lattice("quintic"), rtol=1e-12)
    lmp.command(f"pair_style sph/tait {H} kernel cubic")
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)
    lmp.command(f"pair_coeff 1 1 fluid {RHO0} c0 {C0} spacing 0.04")
    np.testing.assert_allclose(mass[1], mass_of_lattice("cubic", spacing=0.04), rtol=1e-12)


def test_mass_of_a_lattice_in_restart_and_data_files(tmp_path):
    lmp = with_spacing()
    lmp.commands_string(f"write_restart {tmp_path}/r\nwrite_data {tmp_path}/d\nrun 0")
    again = instance()
    again.commands_string(f"comm_modify vel yes\nread_restart {tmp_path}/r\nrun 0")
    np.testing.assert_allclose(by_id(again, "rho"), RHO0, rtol=1e-12)
    again.command(f"pair_style sph/tait {H} kernel cubic")
    np.testing.assert_allclose(again.extract_atom("mass")[1], mass_of_lattice("cubic"), rtol=1e-12)
    data = instance()
    data.commands_string(f"""
        units si
        atom_style sph
        comm_modify vel yes
        pair_style sph/tait {H}
        read_data {tmp_path}/d
        run 0""")
    np.testing.assert_allclose(by_id(data, "rho"), RHO0, rtol=1e-12)


def test_a_mass_that_agrees_with_the_lattice_is_fine():
    lmp = with_spacing(before="mass 1 $(1000.0*0.05^3/1.03384)")
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)


def test_a_mass_that_contradicts_the_spacing_is_an_error():
    both = r"spacing of type 1 is '0.05', which makes its mass 0.12.*'mass 1' is 0.125: leave out"
    with pytest.raises(Exception, match=both):
        with_spacing(before="mass 1 0.125")
    lmp = with_spacing()
    lmp.command("mass 1 0.125")
    with pytest.raises(Exception, match=both):
        lmp.command("run 0")


def test_spacing_needs_a_mass_of_the_type_and_neighbors():
    each = "fix mass all property/atom rmass ghost yes"
    with pytest.raises(Exception, match=r"leave out 'spacing' and use 'set type 1 mass 0\.12"):
        with_spacing(before=each)
    for spacing in (0.11, 1e-4):
        with pytest.raises(Exception, match=f"spacing of type 1 is '{spacing}'.*neighbors"):
            with_spacing(f"spacing {spacing}")


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize(("precision", "accuracy"), [("double", 1e-10), ("mixed", 2e-5)])
def test_forces_against_a_direct_sum(kernel, precision, accuracy):
    """Laminar and artificial viscosity, with pressure, over all pairs in numpy."""
    lmp = lattice(
        "fix step all sph/integrate global\nrun 0",
        setting=f"kernel {kernel} precision {precision}",
    )
    x, v, rho = by_id(lmp, "x"), by_id(lmp, "v"), by_id(lmp, "rho")
    mass, h_s = RHO0 * 0.05**3, H / 2
    d = x[:, None] - x[None]
    d -= 0.4 * np.round(d / 0.4)
    dv = v[:, None] - v[None]
    r = np.linalg.norm(d, axis=2)
    near = (r < H) & (r > 0)
    r[~near] = H
    slope = KERNELS[kernel][1](r / H) / r
    np.testing.assert_allclose(
        rho,
        mass * (KERNELS[kernel][0](np.where(near, r, H) / H).sum(axis=1) + KERNELS[kernel][0](0.0)),
        rtol=accuracy,
    )
    vr = (d * dv).sum(axis=2)
    p = tait(rho) / rho**2
    mu = h_s * np.minimum(vr, 0) / (r**2 + 0.01 * h_s**2)
    mean = (rho[:, None] + rho[None]) / 2
    along = p[:, None] + p[None] - 0.3 * C0 * mu / mean
    friction = 0.01 * 2 * mean / (rho[:, None] * rho[None])
    pair = mass**2 * slope[..., None] * (friction[..., None] * dv - along[..., None] * d)
    expected = np.where(near[..., None], pair, 0).sum(axis=1)
    size = np.abs(expected).max()
    np.testing.assert_allclose(by_id(lmp, "f"), expected, rtol=accuracy, atol=accuracy * size)
    drho = (mass * slope * vr * near).sum(axis=1)
    size = np.abs(drho).max()
    np.testing.assert_allclose(by_id(lmp, "drho"), drho, rtol=accuracy, atol=accuracy * size)
    assert np.abs(by_id(lmp, "f").sum(axis=0)).max() < 1e-12 * np.abs(expected).sum()


def test_the_rate_of_the_density_changes_nothing_else():
    """It is summed only where a scheme of time steps asks for it."""
    lmp = {
        scheme: lattice(f"fix step all sph/integrate {scheme}\nrun 0")
        for scheme in ("constant", "global")
    }
    np.testing.assert_array_equal(by_id(lmp["constant"], "f"), by_id(lmp["global"], "f"))
    assert np.all(by_id(lmp["constant"], "drho") == 0)
    assert np.all(by_id(lmp["global"], "drho") != 0)


@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_water_and_its_boundary_push_each_other_alike(precision):
    lmp = lattice(setting=f"precision {precision}", types=2)
    lmp.commands_string(f"""
        region floor block INF INF INF INF INF -0.1 units box
        set region floor type 2
        pair_coeff 1 1 fluid {RHO0} c0 {C0}
        pair_coeff 2 2 boundary pressure own volume 1.234567890123e-4
        fix 1 all nve
        run 0""")
    f = by_id(lmp, "f")
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()


@pytest.mark.parametrize("kind", ["block", "prism"])
def test_momentum_is_kept_and_newton_does_not_matter(kind):
    forces = {}
    for newton in ("on", "off"):
        lmp = lattice("timestep 1e-4\nfix 1 all nve\nrun 20", newton=newton, kind=kind)
        v = by_id(lmp, "v")
        assert np.abs(v.sum(axis=0)).max() < 1e-12 * np.abs(v).sum()
        forces[newton] = by_id(lmp, "f")
    scale = np.abs(forces["on"]).max()
    np.testing.assert_allclose(forces["on"], forces["off"], rtol=0, atol=1e-11 * scale)


def test_energy_is_what_compression_stored():
    """The work done by the pressure equals the loss of the pair energy (no viscosity)."""
    lmp = lattice(
        """pair_coeff 1 1 fluid 1000 c0 20
        velocity all set 0 0 0
        timestep 2e-5
        fix 1 all nve
        thermo_style custom step ke pe etotal
        run 0""",
    )
    start = lmp.get_thermo("etotal")
    lmp.command("run 400")
    assert lmp.get_thermo("ke") > 0.05 * start
    assert abs(lmp.get_thermo("etotal") - start) < 1e-3 * start


def test_virial_is_the_derivative_of_the_energy():
    """Pressure at rest against -dE/dV of the jittered lattice."""
    lmp = lattice("velocity all set 0 0 0\nthermo_style custom pe press\nrun 0")
    press, size = lmp.get_thermo("press"), 1e-5
    energy = []
    for scale in (1 + size, (1 - size) / (1 + size)):
        lmp.command(f"change_box all x scale {scale} y scale {scale} z scale {scale} remap")
        lmp.command("run 0")
        energy.append(lmp.get_thermo("pe"))
    slope = (energy[0] - energy[1]) / (0.4**3 * ((1 + size) ** 3 - (1 - size) ** 3))
    assert press == pytest.approx(-slope, rel=1e-4)


def test_column_of_water_rests_on_its_floor():
    """The floor carries the weight, and the pressure grows with depth."""
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.2 0 0.2 -0.2 0.6", 2)
        + "mass 1 0.125\nmass 2 1\n"
        + sites()
        + filled("floor", "INF INF INF INF -0.026 0.0", 2)
        + filled("water", "INF INF INF INF 0.0 0.4", 1)
        + "group fluid type 1\ngroup floor type 2\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.5", "2 2 boundary")
        + neighbor(0.03)
        + "timestep 0.002\n"
        + gravity("fluid")
        + """
        fix step fluid sph/integrate global
        compute push floor reduce sum fz
        fix mean all ave/time 1 1000 1000 c_push
        run 3000"""
    )
    weight = 4 * 4 * 8 * 0.125 * 9.81
    assert -lmp.extract_fix("mean", 0, 0) == pytest.approx(weight, rel=0.02)
    z = by_id(lmp, "x")[:, 2][by_id(lmp, "type") == 1]
    rho = by_id(lmp, "rho")[by_id(lmp, "type") == 1]
    deep, shallow = z < 0.15, (z > 0.2) & (z < 0.3)
    assert tait(rho[deep].mean()) > tait(rho[shallow].mean()) > 0
    assert z.min() > 0 and z.max() < 0.45


def direct(lmp):
    """Separations, their lengths and which are near, of the periodic lattice, in numpy."""
    x = by_id(lmp, "x")
    d = x[:, None] - x[None]
    d -= 0.4 * np.round(d / 0.4)
    r = np.linalg.norm(d, axis=2)
    return d, r, (r < H) & (r > 0)


def test_excluded_types_do_not_meet():
    lmp = two_particles(0.05, second="neigh_modify exclude type 1 2")
    np.testing.assert_allclose(by_id(lmp, "rho"), [wendland(0), 1.5 * wendland(0)], rtol=1e-14)
    assert np.all(by_id(lmp, "f") == 0)


def test_a_velocity_that_is_no_number_is_named():
    lmp = two_particles(0.05)
    lmp.numpy.extract_atom("v")[:] = np.nan
    with pytest.raises(Exception, match=r"particle \d has velocity nan.*finite"):
        lmp.command("run 0")


def test_isolated_particle_flies_free():
    lmp = two_particles(0.5)
    np.testing.assert_allclose(by_id(lmp, "rho"), [wendland(0), 1.5 * wendland(0)], rtol=1e-14)
    assert np.all(by_id(lmp, "f") == 0)


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


def test_mixed_precision_does_not_depend_on_where_the_box_is():
    """Integer coordinates: far from the origin the same digits."""

    def forces(shift):
        lmp = lattice("run 0", setting="precision mixed")
        lmp.commands_string(f"""
            change_box all x final {-0.2 + shift} {0.2 + shift} units box
            displace_atoms all move {shift} 0 0 units box
            run 0""")
        return by_id(lmp, "f")

    near, far = forces(0.0), forces(1000.0)
    np.testing.assert_allclose(far, near, atol=1e-5 * np.abs(near).max())


def test_boundary_takes_the_mean_pressure_of_the_fluid_around_it():
    """Two fluid particles of unequal density at unequal distances of one wall particle."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-1 1 -1 1 -1 1", 3)
        + "mass * 1.0\nmass 2 1.4\ncreate_atoms 1 single 0.04 0 0\n"
        + "create_atoms 2 single -0.07 0 0\ncreate_atoms 3 single 0 0 0\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0}",
            f"2 2 fluid {RHO0} c0 {C0}",
            "3 3 boundary volume 1e-4",
            support=H,
        )
        + neighbor(0.02)
        + "run 0\n"
    )
    rho = by_id(lmp, "rho")[:2]
    p = tait(rho) / rho**2
    w = wendland(np.array([0.04, 0.07]))
    at_wall = (w * p).sum() / w.sum()
    slope = wendland_slope(np.array([0.04, 0.07]))
    force = -np.array([1.0, 1.4]) * 1e-4 * RHO0 * (p + at_wall) * slope * np.array([1, -1])
    np.testing.assert_allclose(by_id(lmp, "f")[:2, 0], force, rtol=1e-12)
    np.testing.assert_allclose(by_id(lmp, "f")[2, 0], -force.sum(), rtol=1e-12)


@pytest.mark.parametrize("fluid", [False, True])
def test_volumes_follow_a_boundary_only_while_there_is_fluid(fluid):
    """A plane of boundary particles is drawn apart; a fluid particle is far away, or none."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-1 1 -1 1 -1 1", 2)
        + "mass * 1\nlattice sc 0.05\n"
        + filled("plane", "-0.2 0.2 -0.2 0.2 -0.01 0.01", 2)
        + ("create_atoms 1 single 0.9 0.9 0.9 units box\n" if fluid else "")
        + "variable u atom x\ngroup plane type 2\nvelocity plane set v_u NULL NULL\n"
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0}", "2 2 boundary", support=H)
        + neighbor(0.05)
        + "compute volume plane sph/atom volume\nfix go plane nve\ntimestep 1e-2\nrun 0\n"
    )
    lmp.commands_string("compute mean plane reduce sum c_volume\nthermo_style custom step c_mean")
    lmp.command("run 0")
    before = lmp.extract_compute("mean", 0, 0)
    lmp.command("run 3")
    grown = lmp.extract_compute("mean", 0, 0) / before
    assert (grown > 1.01) if fluid else (grown == 1.0)


def test_particles_of_no_role_take_no_part(tmp_path):
    """Neither densities nor forces know of them, also after a data file."""
    seen = []
    for other in ("", "create_atoms 2 single 0.42 0.53 0.51 units box\n"):
        lmp = instance()
        lmp.commands_string(
            header()
            + box("0 1 0 1 0 1", 2)
            + "mass * 1e-3\nlattice sc 0.1\ncreate_atoms 1 box\n"
            + jitter(0.02, 5)
            + other
            + sph_tait("1 1 fluid 1 c0 10 alpha 0.1", "2 2 none", support=0.2)
            + "run 0\n"
        )
        if other:
            path = tmp_path / "none.data"
            lmp.command(f"write_data {path} pair ij")
            assert "2 2 none" in path.read_text()
        fluid = by_id(lmp, "type") == 1
        seen.append((by_id(lmp, "rho")[fluid], by_id(lmp, "f")[fluid]))
        if other:
            assert np.abs(by_id(lmp, "f")[~fluid]).max() == 0
    assert all(np.array_equal(a, b) for a, b in zip(*seen, strict=True))


# All particles are neighbors of each other: lists of 290 MB, for which 100 MB are left.
CROWDED = """
import resource
from lammps import lammps
lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
lmp.commands_string('''
    units si
    atom_style sph
    comm_modify vel yes
    boundary f f f
    region box block -1 1 -1 1 -1 1
    create_box 1 box
    mass 1 1e-9
    region ball sphere 0 0 0 0.05
    create_atoms 1 random 12000 7 ball
    pair_style sph/tait 0.2
    pair_coeff 1 1 fluid 1000 c0 20
    neighbor 0.03 bin''')
with open("/proc/self/statm") as statm:
    used = int(statm.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (100 << 20),) * 2)
try:
    lmp.command("run 0")
except Exception as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is set by what /proc says is used")
@pytest.mark.skipif("libasan" in os.environ.get("LD_PRELOAD", ""), reason="reserves more memory")
def test_lists_that_do_not_fit_the_memory_are_named():
    command = [sys.executable, "-c", CROWDED]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    words = "pair_style sph/tait: not enough memory for the neighbours of 12000 particles within"
    assert words in done.stdout, done.stdout + done.stderr
