"""pair_style sph/tait ... surface yes: density sums that are completed at free surfaces."""

import numpy as np
import pytest
from harness import by_id, instance
from lammps import MPIAbortException
from reference_sph import C0, RHO0
from scenes import FLUID, box, filled, header, jitter, lattice, neighbor, sph_tait

DX = 0.05


def block(options="", dimension=3, spacing=DX, cells=5, by=0.0, floor="", support=0.12, more=""):
    """A cube, or square, of water with free surfaces, with the mass of a lattice of DX."""
    side = f"0 {cells * DX}"
    depth = side if dimension == 3 else f"{-DX / 2} {DX / 2}"
    types = 2 if floor else 1
    lmp = instance()
    lmp.commands_string(
        header("f f f" if dimension == 3 else "f f p", FLUID, dimension=dimension)
        + box("-1 1 -1 1 " + ("-1 1" if dimension == 3 else depth), types)
        + lattice(spacing, dimension)
        + filled("water", f"{side} {side} {depth}")
        + (filled("floor", f"{side} -0.1 0 {depth}", 2) + "mass 2 1\n" if floor else "")
        + "group water_atoms type 1\n"
        + (jitter(by, 7, "water_atoms", dimension) if by else "")
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} spacing {DX}",
            *([floor] if floor else []),
            support=support,
            options=f"surface yes {options}",
        )
        + neighbor(0.02)
        + more
        + "thermo_style custom step pe press\nthermo_modify norm no\nrun 0\n"
    )
    return lmp


@pytest.mark.parametrize("dimension", [2, 3])
def test_faces_have_the_density_of_the_inside(dimension):
    plain = block("surface no", dimension, cells=12)
    whole = block("", dimension, cells=12)
    x = by_id(whole, "x")
    along = x[:, 1 : 1 + dimension - 1]
    face = np.all((along > 0.15) & (along < 0.45), axis=1)  # of edges nothing is known
    assert np.abs(by_id(plain, "rho")[face] / RHO0 - 1).max() > 0.15
    np.testing.assert_allclose(by_id(whole, "rho")[face], RHO0, rtol=0.04)


def test_inside_nothing_changes():
    plain, whole = (block(f"surface {word}", cells=12) for word in ("no", "yes"))
    x = by_id(whole, "x")
    inside = np.all((x > 0.13) & (x < 0.47), axis=1)
    assert inside.any()
    np.testing.assert_allclose(by_id(whole, "rho")[inside], by_id(plain, "rho")[inside], rtol=1e-9)


def energy(lmp):
    lmp.command("run 0 post no")
    return lmp.get_thermo("pe")


@pytest.mark.parametrize("kernel", ["wendland/c2", "wendland/c4", "cubic", "quintic"])
@pytest.mark.parametrize(
    ("options", "dimension", "floor"),
    [
        ("", 3, ""),
        ("tension yes", 2, ""),
        ("density calibrated", 3, ""),
        ("", 2, f"2 2 boundary pressure own volume {DX**2}"),
    ],
)
def test_forces_are_the_gradient_of_the_energy(kernel, options, dimension, floor):
    lmp = block(f"kernel {kernel} {options}", dimension, 0.93 * DX, 4, 0.006, floor)
    water = lmp.numpy.extract_atom("type")[: lmp.get_natoms()] == 1
    force, tags = by_id(lmp, "f").copy(), np.sort(lmp.numpy.extract_atom("id")[: len(water)][water])
    largest, h = np.abs(force).max(), 1e-6
    assert largest > 0
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-11 * largest)
    for atom in tags[:: max(1, len(tags) // 6)]:
        for axis in range(dimension):
            found = []
            for step in (h, -2 * h, h):
                shift = " ".join(str(step if a == axis else 0) for a in range(3))
                lmp.commands_string(
                    f"group one id {atom}\ndisplace_atoms one move {shift} units box\n"
                    "group one delete"
                )
                found.append(energy(lmp))
            slope = (found[0] - found[1]) / (2 * h)
            assert -slope == pytest.approx(force[atom - 1, axis], abs=3e-5 * largest)


def test_virial_is_the_derivative_of_the_energy_by_the_size():
    lmp = block("tension yes", 3, 0.93 * DX, 4, 0.006)
    lmp.commands_string(
        "compute virial all pressure NULL pair\nthermo_style custom step c_virial pe"
    )
    lmp.commands_string("thermo_modify norm no\nrun 0")
    work = lmp.extract_compute("virial", 0, 0) * 2.0**3 * 3
    x, h, found = by_id(lmp, "x").copy(), 1e-6, []
    for scale in (1 + h, 1 - h):
        for i, place in enumerate(scale * x):
            lmp.command(f"set atom {i + 1} x {place[0]:.17g} y {place[1]:.17g} z {place[2]:.17g}")
        found.append(energy(lmp))
    assert work == pytest.approx(-(found[0] - found[1]) / (2 * h), rel=1e-4)


def test_mixed_precision_finds_the_same_forces():
    double, mixed = (
        by_id(block(f"precision {word}", 3, 0.93 * DX, 4, 0.006), "f").copy()
        for word in ("double", "mixed")
    )
    np.testing.assert_allclose(mixed, double, atol=1e-5 * np.abs(double).max())


def test_a_drop_at_rest_keeps_its_momenta():
    lmp = block("", 2, 0.99 * DX, 6, 0.005, more="fix step all sph/integrate global\n")
    lmp.commands_string(f"timestep {0.2 * 0.06 / C0}\nrun_style sph/adaptive constant\nrun 400")
    x, v = by_id(lmp, "x"), by_id(lmp, "v")
    fastest = np.abs(v).max()
    assert fastest > 0
    np.testing.assert_allclose(v.sum(axis=0), 0, atol=1e-9 * fastest * len(v))
    spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum()
    assert spin == pytest.approx(0, abs=1e-9 * fastest * len(v))


@pytest.mark.parametrize(
    ("options", "more", "words"),
    [
        ("density continuity", "", "leave out one of them"),
        ("", "fix wall all wall/sph zlo 0\n", "use boundary particles"),
        (
            "",
            "fix step all sph/integrate global\nrun_style sph/adaptive block\n",
            "scheme constant or global",
        ),
    ],
)
def test_what_it_does_not_go_with(options, more, words):
    with pytest.raises((MPIAbortException, Exception), match=words):
        block(options, more=more)
