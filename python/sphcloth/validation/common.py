"""Parameters that the cases with water share."""

from __future__ import annotations

from sphcloth.validation.case import Parameter
from sphcloth.validation.lattice import KERNELS


def numerics(alpha: float, courant: float) -> tuple[Parameter, ...]:
    """Return the parameters of the method; their names are those of the scripts' variables.

    Args:
        alpha: default of the artificial viscosity.
        courant: default of the largest step over smoothing length / speed of sound.
    """
    return (
        Parameter("gamma", 7.0, "1", "exponent of the equation of state", 1.01, 10.0),
        Parameter("alpha", alpha, "1", "artificial viscosity", 0.0, 2.0),
        Parameter("kernel", "wendland/c2", "1", "kernel", choices=tuple(KERNELS)),
        Parameter("support", 4.0, "1", "support radius over spacing", 2.0, 6.0),
        Parameter("tension", "no", "1", "whether negative pressure acts", choices=("no", "yes")),
        Parameter("disorder", 0.1, "1", "displacement at the start over spacing", 0.0, 0.3),
        Parameter("seed", 1234, "1", "seed of the disorder", 1, 900_000_000),
        Parameter("courant", courant, "1", "largest step over smoothing length / c0", 0.01, 1.6),
        Parameter(
            "scheme", "constant", "1", "scheme of the time step", choices=("constant", "global")
        ),
    )


# the script's base: particles at rest below the water
MIRROR = Parameter(
    "mirror", 2.0, "1", "pressure on the base over the energy-consistent one", 0.5, 4.0
)
