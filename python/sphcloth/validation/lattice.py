"""Density and stress of lattices, from the formulas of the kernels alone.

``python -m sphcloth.validation.lattice`` prints them as tables.

Particles on a lattice weigh such that their summed density is the rest density. The kernels
are written here anew, without their constants, which follow from the integral over the plane.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

from sphcloth.results import markdown_table

Shape = Callable[[NDArray], NDArray]


def _wendland_c2(q: NDArray) -> NDArray:
    return (1 - q) ** 4 * (1 + 4 * q)


def _wendland_c4(q: NDArray) -> NDArray:
    return (1 - q) ** 6 * (1 + 6 * q + 35 / 3 * q**2)


def _cubic(q: NDArray) -> NDArray:
    return np.where(q < 0.5, 1 - 6 * q**2 + 6 * q**3, 2 * (1 - q) ** 3)


def _quintic(q: NDArray) -> NDArray:
    parts = ((1.0, 1.0), (2 / 3, -6.0), (1 / 3, 15.0))
    return sum(share * np.maximum(end - q, 0.0) ** 5 for end, share in parts)


KERNELS: dict[str, Shape] = {
    "wendland/c2": _wendland_c2,
    "wendland/c4": _wendland_c4,
    "cubic": _cubic,
    "quintic": _quintic,
}


# where a kernel has another formula
_KINKS = (1 / 3, 1 / 2, 2 / 3)


def density_sum(kernel: str, support: float, height_over_width: float = 1.0) -> float:
    """Return the sum of W over a plane lattice times the area of a cell.

    Args:
        kernel: one of ``KERNELS``.
        support: support radius over the height of a cell.
        height_over_width: of a cell of the lattice.

    Returns:
        Summed density over mass per area: 1 for a perfect kernel.
    """
    shape = KERNELS[kernel]
    reach = math.ceil(support * max(1.0, height_over_width))
    column, row = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1))
    q = np.hypot(column / height_over_width, row) / support
    total = float(np.sum(shape(q[q < 1])))
    return total / (_plane_integral(shape) * support**2) / height_over_width


def cubic_density_sum(kernel: str, support: float) -> float:
    """Return the sum of W over a cubic lattice times the volume of a cell.

    Args:
        kernel: one of ``KERNELS``.
        support: support radius over the edge of a cell.
    """
    shape, q = KERNELS[kernel], _distances(support, 3)
    return float(np.sum(shape(q))) / (_space_integral(shape) * support**3)


def virial(kernel: str, support: float, dimension: int) -> float:
    """Return the virial pressure of a square or cubic lattice over the pressure of its particles.

    Pairs push each other by m^2 (2 p/rho^2) dW/dr, with the summed density rho, so that the sum
    over neighbors is p/dimension times that of r |dW/dr| over the square of the sum of W.

    Args:
        kernel: one of ``KERNELS``.
        support: support radius over the edge of a cell.
        dimension: 2 or 3.
    """
    shape, q, small = KERNELS[kernel], _distances(support, dimension), 1e-6
    # a kernel is smooth at its center, and vanishes at its end as its slope does
    inside = q[(q > small) & (q < 1 - small)]
    slope = (shape(inside + small) - shape(inside - small)) / (2 * small)
    integral = _plane_integral(shape) if dimension == 2 else _space_integral(shape)
    cells = integral * support**dimension
    return float(-np.sum(inside * slope) / np.sum(shape(q)) ** 2) * cells / dimension


def _distances(support: float, dimension: int) -> NDArray[np.float64]:
    """Return the distances from a lattice point to those in the support, itself too, over it."""
    along = np.arange(-math.ceil(support), math.ceil(support) + 1)
    q = np.sqrt(sum(part**2 for part in np.meshgrid(*[along] * dimension))) / support
    return q[q < 1]


def _space_integral(shape: Shape) -> float:
    """Return the integral of the kernel's shape over the unit ball."""
    integral = quad(lambda q: float(shape(np.float64(q))) * q**2, 0, 1, points=_KINKS)[0]
    return 4 * math.pi * integral


def _plane_integral(shape: Shape) -> float:
    """Return the integral of the kernel's shape over the unit disc."""
    return 2 * math.pi * quad(lambda q: float(shape(np.float64(q))) * q, 0, 1, points=_KINKS)[0]


def main() -> None:
    """Print the density sums over mass per volume, and the virial over the pressure."""
    supports = (2, 2.4, 2.5, 3, 3.6, 4, 5)
    heads = ["support / spacing", *map(str, supports)]
    rows = []
    for dimension, total in ((2, density_sum), (3, cubic_density_sum)):
        for kernel in KERNELS:
            name = f"{kernel}, {dimension}-D"
            rows.append([f"density sum, {name}", *(f"{total(kernel, s):.4f}" for s in supports)])
            ratios = (virial(kernel, s, dimension) for s in supports)
            rows.append([f"virial pressure / p, {name}", *(f"{ratio:.4f}" for ratio in ratios)])
    print(markdown_table(heads, rows))


if __name__ == "__main__":
    main()
