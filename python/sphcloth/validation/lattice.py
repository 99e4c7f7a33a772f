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


def density_sum_in_space(kernel: str, support: float) -> float:
    """Return the sum of W over a cubic lattice times the volume of a cell.

    Args:
        kernel: one of ``KERNELS``.
        support: support radius over the spacing.

    Returns:
        Summed density over mass per volume: 1 for a perfect kernel.
    """
    shape = KERNELS[kernel]
    steps = np.arange(-math.ceil(support), math.ceil(support) + 1)
    x, y, z = np.meshgrid(steps, steps, steps)
    q = np.sqrt(x**2 + y**2 + z**2) / support
    kinks = [1 / 3, 1 / 2, 2 / 3]
    ball = 4 * math.pi * quad(lambda q: float(shape(np.float64(q))) * q**2, 0, 1, points=kinks)[0]
    return float(np.sum(shape(q[q < 1]))) / (ball * support**3)


def _plane_integral(shape: Shape) -> float:
    """Return the integral of the kernel's shape over the unit disc."""
    kinks = [1 / 3, 1 / 2, 2 / 3]
    return 2 * math.pi * quad(lambda q: float(shape(np.float64(q))) * q, 0, 1, points=kinks)[0]
