"""pair_style sph/tait: fluids of different rest densities side by side."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, box, header, jitter, neighbor, sph_tait

from sphcloth.validation.lattice import cubic_density_sum

DX = 0.1
HEAVY, LIGHT = 1000.0, 400.0
# mass of a particle on a lattice at rest, over the rest density
CELL = DX**3 / cubic_density_sum("wendland/c2", 2.0)
PRECISIONS = pytest.mark.parametrize("precision", ["double", "mixed"])


def slabs(*coeffs, extra="", options="", boundary="p p p", at_rest=True, newton="on", masses=""):
    """Slabs of four layers along x, one per type, on one cubic lattice."""
    n, width = len(coeffs), 4 * DX
    regions = "".join(
        f"region r{k} block {k * width} {(k + 1) * width} 0 0.4 0 0.4 units box\n"
        f"create_atoms {k + 1} region r{k}\n"
        for k in range(n)
    )
    lmp = instance()
    lmp.commands_string(
        header(boundary, FLUID, newton=newton)
        + f"lattice sc {DX} origin 0.5 0.5 0.5\n"
        + box(f"0 {n * width} 0 0.4 0 0.4", n)
        + regions
        + masses
        + ("" if at_rest else jitter(0.2 * DX, 99))
        + sph_tait(
            *(f"{k + 1} {k + 1} {words}" for k, words in enumerate(coeffs)),
            support=2 * DX,
            options=options,
        )
        + neighbor(0.03)
        + "".join(
            f"set type {k + 1} sph/rho {words.split()[1]}\ngroup water type {k + 1}\n"
            for k, words in enumerate(coeffs)
            if words.startswith("fluid")
        )
        + "timestep 1e-4\nfix step water sph/integrate global\nrun 0\n"
        + extra
    )
    return lmp


def fluid(rho0, c0=20.0, more=f"spacing {DX}"):
    """Return the words of a fluid."""
    return f"fluid {rho0} c0 {c0} {more}"


@PRECISIONS
@pytest.mark.parametrize("density", ["summation", "continuity"])
def test_fluids_side_by_side_on_one_lattice_are_at_rest(precision, density):
    """A density has no step at the interface but that of the rest densities."""
    with slabs(
        fluid(HEAVY),
        fluid(LIGHT),
        options=f"density {density} precision {precision}",
        extra="run 50",
    ) as lmp:
        rho, kind, v = by_id(lmp, "rho"), by_id(lmp, "type"), by_id(lmp, "v")
    exact = np.where(kind == 1, HEAVY, LIGHT)
    rounding = 1e-12 if precision == "double" else 1e-5
    np.testing.assert_allclose(rho, exact, rtol=rounding)
    assert np.abs(v).max() < (1e-11 if precision == "double" else 1e-5)


def jittered(**options):
    """Return two fluids under pressure and tension in disorder."""
    return slabs(fluid(HEAVY), fluid(LIGHT, 30.0), at_rest=False, **options)


@PRECISIONS
@pytest.mark.parametrize("newton", ["on", "off"])
def test_forces_of_two_fluids_are_equal_and_opposite(precision, newton):
    with jittered(options=f"tension yes precision {precision}", newton=newton) as lmp:
        f = by_id(lmp, "f")
    assert np.abs(f).max() > 10.0
    assert np.abs(f.sum(axis=0)).max() < 1e-13 * np.abs(f).sum()


def test_forces_of_two_fluids_are_the_gradient_of_their_energy():
    with jittered(options="tension yes", extra="thermo_style custom step ke pe etotal\n") as lmp:
        lmp.commands_string("timestep 2e-5\nrun 0")
        start = lmp.get_thermo("etotal")
        lmp.command("run 300")
        assert lmp.get_thermo("ke") > 0.05 * start
        assert abs(lmp.get_thermo("etotal") - start) < 1e-3 * start


@pytest.mark.parametrize("density", ["summation", "continuity"])
def test_both_fluids_thin_out_alike_in_a_uniform_expansion(density):
    """d rho/dt = -rho div v, also at the interface."""
    start = "variable vx atom x\nvelocity all set v_vx 0 0\nrun 1"
    with slabs(
        fluid(HEAVY),
        fluid(LIGHT),
        boundary="f p p",
        options=f"density {density}",
        extra="change_box all x delta -1 1 units box\n" + start,
    ) as lmp:
        x, kind, rho = by_id(lmp, "x")[:, 0], by_id(lmp, "type"), by_id(lmp, "rho")
        rate = by_id(lmp, "drho")
    inside = (x > 2.5 * DX) & (x < 5.5 * DX)
    rest = np.where(kind == 1, HEAVY, LIGHT)
    assert set(kind[inside]) == {1, 2}
    np.testing.assert_allclose(rate[inside] / rest[inside], rate[inside][0] / rest[inside][0], 1e-9)
    assert rate[inside][0] / rest[inside][0] == pytest.approx(
        -1.0, rel=0.06
    )  # what this support gives
    np.testing.assert_allclose(rho[inside] / rest[inside], rho[inside][0] / rest[inside][0], 1e-9)


@PRECISIONS
@pytest.mark.parametrize("pressure", ["extrapolate", "mirror", "own"])
def test_a_boundary_between_two_fluids_passes_on_their_pressure(precision, pressure):
    """Both are under the same pressure, which is uniform: no force on fluid or boundary."""
    compressed = 1.001
    stiff = HEAVY / LIGHT  # of c0^2: the same pressure at the same compression
    masses = "".join(
        f"mass {k} {compressed * rho0 * CELL}\n" for k, rho0 in ((1, HEAVY), (2, 1.0), (3, LIGHT))
    )
    with slabs(
        fluid(HEAVY, more=""),
        f"boundary volume {compressed * CELL} pressure {pressure}",
        fluid(LIGHT, 20.0 * stiff**0.5, more=""),
        options=f"precision {precision}",
        masses=masses,
    ) as lmp:
        f, kind, rho = by_id(lmp, "f"), by_id(lmp, "type"), by_id(lmp, "rho")
    np.testing.assert_allclose(rho[kind == 1] / HEAVY, compressed, 1e-6)
    np.testing.assert_allclose(rho[kind == 3] / LIGHT, compressed, 1e-6)
    one_pair = 400.0 * HEAVY * (compressed - 1.0) * DX**2
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * one_pair
    if pressure != "own":
        assert np.abs(f[kind != 2]).max() < 2e-3 * one_pair
