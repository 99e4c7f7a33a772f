"""Density sums of lattices, from the formulas of the kernels alone.

Particles on a lattice weigh such that their summed density is the rest density. The kernels
are written here anew, without their constants, which follow from the integral over the plane.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

Shape = Callable[[NDArray], NDArray]


def _wendland_c2(q: NDArray) -> NDArray:
    return (1 - q) ** 4 * (1 + 4 * q)


def _cubic(q: NDArray) -> NDArray:
    return np.where(q < 0.5, 1 - 6 * q**2 + 6 * q**3, 2 * (1 - q) ** 3)


def _wendland_c4(q: NDArray) -> NDArray:
    return (1 - q) ** 6 * (3 + 18 * q + 35 * q**2)


def _quintic(q: NDArray) -> NDArray:
    def power(edge: float) -> NDArray:
        return np.maximum(edge - 3 * q, 0) ** 5

    return power(3) - 6 * power(2) + 15 * power(1)


KERNELS: dict[str, Shape] = {
    "wendland/c2": _wendland_c2,
    "cubic": _cubic,
    "wendland/c4": _wendland_c4,
    "quintic": _quintic,
}


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


def _plane_integral(shape: Shape) -> float:
    """Return the integral of the kernel's shape over the unit disc."""
    return 2 * math.pi * quad(lambda q: float(shape(np.float64(q))) * q, 0, 1, points=[0.5])[0]
