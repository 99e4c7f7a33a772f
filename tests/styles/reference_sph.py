"""Closed formulas of SPH, and scenes of a few particles to compare them with."""

import math

import numpy as np
from harness import instance
from scenes import FLUID, box, header, jitter, neighbor, sph_tait

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
