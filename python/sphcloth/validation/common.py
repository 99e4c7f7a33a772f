"""Parameters that cases share."""

from __future__ import annotations

from collections.abc import Mapping

from sphcloth.validation import schemes
from sphcloth.validation.case import Parameter, Value
from sphcloth.validation.lattice import KERNELS, cubic_density_sum, density_sum

GRAVITY = Parameter("gravity", 9.81, "m/s^2", "acceleration g", 1e-3, 1e3)
DENSITIES = ("summation", "continuity", "calibrated")
REST_DENSITY = Parameter("rho0", 1000.0, "kg/m^3", "rest density", 1.0, 1e5)


def numerics(
    alpha: float,
    courant: float,
    *,
    kernel: str = "wendland/c2",
    support: float = 4.0,
    tension: str = "no",
    disorder: float = 0.1,
    density: str = "summation",
    delta: float = 0.1,
    scheme: str = "constant",
) -> tuple[Parameter, ...]:
    """Return the parameters of the method; their names are those of the scripts' variables.

    Args:
        alpha: default of the artificial viscosity.
        courant: default of the step of constant over smoothing length / speed of sound.
        kernel: default of the kernel.
        support: default of the support radius over the spacing.
        tension: default of whether negative pressure acts.
        disorder: default of the displacement at the start over the spacing.
        density: default of how the density is found.
        delta: default of the diffusion of the density.
        scheme: default of the scheme of the time step.
    """
    return (
        Parameter("gamma", 7.0, "1", "exponent of the equation of state", 1.01, 10.0),
        Parameter("alpha", alpha, "1", "artificial viscosity", 0.0, 2.0),
        Parameter("kernel", kernel, "1", "kernel", choices=tuple(KERNELS)),
        Parameter("support", support, "1", "support radius over spacing", 2.0, 6.0),
        Parameter("tension", tension, "1", "whether negative pressure acts", choices=("no", "yes")),
        Parameter("precision", "double", "1", "of the pair loops", choices=("double", "mixed")),
        Parameter("density", density, "1", "how it is found", choices=DENSITIES),
        Parameter("delta", delta, "1", "diffusion of the density, with continuity", 0.0, 1.0),
        Parameter("disorder", disorder, "1", "displacement at the start over spacing", 0.0, 0.3),
        Parameter("seed", 1234, "1", "seed of the disorder", 1, 900_000_000),
        Parameter(
            "courant", courant, "1", "step of constant over smoothing length / c0", 0.01, 1.6
        ),
        *schemes.parameters(scheme),
    )


def lattice_density(values: Mapping[str, Value], height_over_width: float = 1.0) -> float:
    """Return the density that particles on a lattice find over their mass per area.

    With continuity every particle starts with the rest density, whatever its neighbors are; a
    calibrated density is the rest density on a lattice.
    """
    if values["density"] != "summation":
        return 1.0
    return density_sum(values["kernel"], values["support"], height_over_width)


def lattice_density_in_space(values: Mapping[str, Value]) -> float:
    """Return the same for a cubic lattice, over mass per volume."""
    if values["density"] != "summation":
        return 1.0
    return cubic_density_sum(values["kernel"], values["support"])


# the script's base: particles at rest below the water
WALL = Parameter(
    "wall",
    "extrapolate",
    "1",
    "pressure of the base",
    choices=("extrapolate", "mirror", "own"),
)

SURFACE = Parameter(
    "surface", "no", "1", "whether a sum is completed at the surface", choices=("no", "yes")
)
