"""Scenes between plane walls that several files of tests use."""

import math

import numpy as np
from harness import instance
from scenes import FLUID, filled, header, lattice, neighbor, sph_tait
from scenes import box as a_box

H = 0.1
RHO0, C0, GAMMA = 1000.0, 20.0, 7.0

KERNELS = {
    "wendland/c2": (
        {2: 7 / math.pi, 3: 21 / (2 * math.pi)},
        lambda q: (1 - q) ** 4 * (1 + 4 * q),
        lambda q: -20 * (1 - q) ** 3,
        [0.0, 1.0],
    ),
    "cubic": (
        {2: 40 / (7 * math.pi), 3: 8 / math.pi},
        lambda q: np.where(q < 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * (1 - q) ** 3),
        lambda q: np.where(q < 0.5, 18 * q - 12, -6 * (1 - q) ** 2 / q),
        [0.0, 0.5, 1.0],
    ),
}


def channel(walls, extra="", ratio=3.0, alpha=0.0, setting="tension yes", size=(8, 20)):
    """2-D fluid between two walls in y, periodic in x; its lattice has rest density by summation"""
    dx = H / ratio
    n = np.arange(-5, 6)
    q = np.hypot(n[:, None], n[None]) / ratio
    norm, shape, _, _ = KERNELS["wendland/c2"]
    lattice_sum = norm[2] / ratio**2 * np.where(q < 1, shape(np.minimum(q, 1)), 0).sum()
    lx, ly = size[0] * dx, size[1] * dx
    lmp = instance()
    lmp.commands_string(
        header("p f p", FLUID, dimension=2)
        + a_box(f"0 {lx} {-H} {ly + H} {-dx} {dx}")
        + f"mass 1 {RHO0 * dx * dx / lattice_sum}\n"
        + lattice(dx, 2)
        + filled("water", f"INF INF 0 {ly} INF INF")
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0} alpha {alpha}", support=H, options=setting)
        + neighbor(0.4 * dx)
        + f"thermo_modify norm no\nvariable ly equal {ly}\n"
        + f"fix wall all wall/sph {walls.format(ly=ly)}\n{extra}\n"
    )
    return lmp, lx, ly
