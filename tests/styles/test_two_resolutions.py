"""Coarse and fine water side by side: supports and masses by type, symmetric terms of a pair."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, box, filled, header, lattice, sph_tait

DX, C0 = 0.05, 10.0
SIDE = 20 * DX


def half_and_half(support, steps):
    """A periodic square, its left half in particles of four times the mass of the right half's."""
    fine = DX / 2
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID, dimension=2)
        + box(f"0 {SIDE} 0 {SIDE} {-fine / 2} {fine / 2}", 2)
        + lattice(DX, 2)
        + filled("left", f"0 {SIDE / 2} INF INF INF INF")
        + lattice(fine, 2)
        + filled("right", f"{SIDE / 2} {SIDE} INF INF INF INF", 2)
        + f"mass 1 {1000 * DX**2}\nmass 2 {1000 * fine**2}\n"
        + sph_tait(
            f"1 1 fluid 1000 c0 {C0} alpha 0.1",
            f"2 2 fluid 1000 c0 {C0} alpha 0.1 support {support * fine}",
            support=support * DX,
            options="tension yes",
        )
        + f"""neighbor 0.02 bin
        timestep {0.2 * support * fine / C0}
        fix step all sph/integrate constant
        fix flat all enforce2d
        run {steps}"""
    )
    return lmp


def test_the_two_halves_push_each_other_equally():
    lmp = half_and_half(4, 0)
    f = by_id(lmp, "f")
    assert np.abs(f).max() > 1.0
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()


@pytest.mark.parametrize(("support", "uneven", "speed"), [(3, 4e-3, 4e-3), (4, 1e-3, 5e-4)])
def test_the_border_comes_to_rest_at_the_density_of_the_bulk(support, uneven, speed):
    """Where two lattices meet, sums are off by up to 9 %; particles find their places."""
    rho = by_id(half_and_half(support, 0), "rho")
    assert 0.05 < np.ptp(rho) / 1000 < 0.2
    lmp = half_and_half(support, 2000)
    rho, v = by_id(lmp, "rho"), by_id(lmp, "v")
    x, near = by_id(lmp, "x")[:, 0], support * DX
    border = np.minimum(np.abs(x - SIDE / 2), np.minimum(x, SIDE - x)) < near
    bulk = rho[~border].mean()
    assert np.abs(rho[border] - bulk).max() < uneven * bulk
    assert np.linalg.norm(v, axis=1).max() < speed * C0
