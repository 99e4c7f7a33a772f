"""LAMMPS's pressure of a fluid: against the equation of state, hydrostatics and a barostat."""

import itertools

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, box, filled, header, neighbor, sph_tait
from scenes import lattice as sites

RHO0, C0 = 1.0, 20.0
PARTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # xx, yy, zz, xy, xz, yz


def lattice(support, dimension=3, shear=0.0, units="si", commands="run 0"):
    """A lattice of spacing 1, compressed by a few per cent, sheared by xy/ly with its box."""
    n, tilted = 2 * support + 2, shear != 0
    sides = f"0 {n} 0 {n} -0.5 {n - 0.5 if dimension == 3 else 0.5}"
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID, units=units, dimension=dimension)
        + f"lattice {'sc' if dimension == 3 else 'sq'} 1.0\n"
        + (box(f"{sides} 0 0 0", shape="prism") if tilted else box(sides))
        + "create_atoms 1 box\nmass 1 1.05\n"
        + (f"change_box all xy final {shear * n} remap units box\n" if tilted else "")
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0}", support=support)
        + neighbor(0.2)
        + f"""compute virial all pressure NULL virial
        compute state all sph/atom pressure density
        thermo_style custom step c_virial c_virial[*] pe vol
        {commands}"""
    )
    return lmp


def lattice_factors(support, dimension, shear, rho):
    """The virial pressure, tensor over the equation of state's, of an infinite lattice.

    From - sum m_i m_j (p_i/rho_i^2 + p_j/rho_j^2) (1/r) dW/dr r r / (2 V) with equal particles.
    """
    steps = range(-2 * support, 2 * support + 1)
    sites = np.array(list(itertools.product(*[steps] * dimension)), dtype=float)
    sites[:, 0] += shear * sites[:, 1]
    q = np.linalg.norm(sites, axis=1) / support
    norm = 21 / (2 * np.pi) if dimension == 3 else 7 / np.pi
    slope = norm / support ** (dimension + 2) * -20 * np.maximum(1 - q, 0) ** 3
    tensor = -(1.05**2) / rho**2 * np.einsum("n,ni,nj->ij", slope, sites, sites)
    wide = np.zeros((3, 3))
    wide[:dimension, :dimension] = tensor
    return np.array([wide[k] for k in PARTS])


@pytest.mark.parametrize("shear", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("support", [2, 3, 4])
def test_a_compressed_lattice(support, dimension, shear):
    """To round-off the sum over the lattice; close to the equation of state as far as it is."""
    lmp = lattice(support, dimension, shear)
    pressure, rho = np.array(lmp.numpy.extract_compute("state", 1, 2))[0]
    tensor = lmp.numpy.extract_compute("virial", 0, 1) / pressure
    expected = lattice_factors(support, dimension, shear, rho)
    np.testing.assert_allclose(tensor, expected, rtol=1e-11, atol=1e-12)
    scalar = lmp.extract_compute("virial", 0, 0) / pressure
    assert scalar == pytest.approx(expected[:dimension].mean(), rel=1e-11)
    # a regular lattice's own error falls with the number of neighbors
    if shear == 0:
        assert abs(scalar - 1) < {2: 0.1, 3: 0.02, 4: 0.004}[support]


@pytest.mark.parametrize("units", ["cgs", "lj", "real", "metal", "micro", "nano", "electron"])
def test_both_pressures_have_the_unit_of_the_script(units):
    """The virial pressure and that of compute sph/atom have the ratio that they have in SI."""
    ratios = []
    for name in (units, "si"):
        lmp = lattice(2, units=name)
        state = np.array(lmp.numpy.extract_compute("state", 1, 2))[0]
        ratios.append(lmp.extract_compute("virial", 0, 0) / state[0])
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-12)


def test_a_barostat_reaches_its_pressure():
    """press/berendsen shrinks the box until the virial pressure is the one asked for."""
    wanted = 0.2 * RHO0 * C0**2
    lmp = lattice(
        3,
        commands=f"""
        timestep 0.01
        fix step all sph/integrate constant
        fix press all press/berendsen iso {wanted} {wanted} 0.1 modulus {RHO0 * C0**2}
        thermo_style custom step press c_virial vol
        run 400""",
    )
    assert lmp.get_thermo("press") == pytest.approx(wanted, rel=1e-6)
    assert lmp.get_thermo("vol") < 8.0**3
    pressure, rho = np.array(lmp.numpy.extract_compute("state", 1, 2))[0]
    assert pressure == pytest.approx(RHO0 * C0**2 / 7 * ((rho / RHO0) ** 7 - 1), rel=1e-12)
    assert pressure == pytest.approx(wanted, rel=0.02)  # the lattice's own error, as above


GRAVITY, FLOOR = 9.81, -0.025


def column(commands):
    """A tall column of water on a floor of particles, periodic in x and y, with drag to settle."""
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.2 0 0.2 -0.2 1.2", 2)
        + "mass 1 0.12\nmass 2 1\n"
        + sites()
        + filled("floor", "INF INF INF INF -0.026 0.0", 2)
        + filled("water", "INF INF INF INF 0.0 1.0", 1)
        + "group water type 1\ngroup floor type 2\n"
        + sph_tait("1 1 fluid 1000 c0 31 alpha 0.5", "2 2 boundary")
        + neighbor(0.03)
        + f"""timestep 0.001
        fix step water sph/integrate constant
        compute virial all pressure NULL virial
        compute each all stress/atom NULL virial
        compute wet water reduce sum c_each[3]
        compute wall floor reduce sum c_each[3]
        compute state water sph/atom pressure volume
        thermo_style custom step ke c_virial c_wet c_wall
        {commands}"""
    )
    return lmp


def virial_and_places(lmp):
    zz = lmp.numpy.extract_compute("virial", 0, 1)[2] * lmp.get_thermo("vol")
    return zz, by_id(lmp, "x")[:, 2], by_id(lmp, "type") == 1


def test_the_virial_is_the_moment_of_the_forces_at_any_time():
    """P_zz V = sum z f_z of the pair forces, over water and floor; no equilibrium is needed."""
    lmp = column("displace_atoms water random 0.01 0.01 0.01 7 units box\nrun 5")
    zz, z, _ = virial_and_places(lmp)
    assert zz == pytest.approx((z * by_id(lmp, "f")[:, 2]).sum(), rel=1e-12)


@pytest.fixture(scope="module")
def rest():
    lmp = column(f"""
        fix gravity water gravity {GRAVITY} vector 0 0 -1
        fix drag water viscous 0.6
        run 6000""")
    assert lmp.get_thermo("ke") < 1e-3
    return lmp


def test_a_resting_column_has_the_hydrostatic_virial(rest):
    """Every particle's pair force carries its weight: P_zz V = M g (z_center - z_floor)."""
    zz, z, water = virial_and_places(rest)
    weight = 0.12 * GRAVITY
    assert zz == pytest.approx(weight * (z[water] - FLOOR).sum(), rel=1e-4)
    push = -by_id(rest, "f")[~water, 2].sum()
    assert push == pytest.approx(weight * water.sum(), rel=1e-4)


def test_the_mean_pressure_of_the_column_is_that_of_hydrostatics(rest):
    """M g h/2, with h reaching from the surface to the floor, not to the lowest layer of water."""
    zz, z, water = virial_and_places(rest)
    pressure, volume = np.array(rest.numpy.extract_compute("state", 1, 2))[: len(z)].T
    weight, height = 0.12 * water.sum() * GRAVITY, volume.sum() / 0.2**2
    assert 0 < zz / weight - height / 2 < 0.05  # the floor is within one spacing of the water
    # the equation of state's, within the error of the lattice that the column started from
    error = 1 - lattice_factors(2, 3, 0.0, 1.05 * 1.0338)[2]
    assert zz == pytest.approx((pressure * volume).sum(), rel=error)


def test_half_of_what_the_floor_does_is_with_the_floor(rest):
    """The per-atom virial gives each partner of a pair a half; only all atoms give the whole."""
    zz, _, _ = virial_and_places(rest)
    wet, wall = (-rest.extract_compute(name, 0, 0) for name in ("wet", "wall"))
    assert wet + wall == pytest.approx(zz, rel=1e-12)
    assert 0.02 * zz < wall < 0.1 * zz
