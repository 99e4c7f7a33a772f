"""Start-up of plane Poiseuille flow: a force along the plates starts to drive fluid at rest.

The series solution, as in Morris, Fox and Zhu, J. Comput. Phys. 136 (1997) 214. Its terms decay as
exp(-n^2 pi^2 nu t / gap^2), which at the start is not at all. There the sum is that of the images
of the flow over a single plate (method of images: Carslaw and Jaeger, Conduction
of Heat in Solids, 1959), with s = 2 sqrt(nu t) and the second integral of erfc, i2erfc:

  u = drive t (1 - 4 sum_k (-1)^k (i2erfc((k gap + y) / s) + i2erfc(((k + 1) gap - y) / s)))
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc

from sphcloth.references.checks import check_positive, since_start, within

# of the series, enough from EARLY on
TERMS = 10
# time, in gap^2 / nu, up to which images are summed; both sums are exact to rounding there
EARLY = 0.1
IMAGES = np.arange(4)


@dataclass(frozen=True)
class PoiseuilleStart:
    """Fluid between two plates at rest, at y = 0 and y = gap, driven from t = 0 on.

    Attributes:
        gap: distance of the plates, m.
        nu: kinematic viscosity, m^2/s.
        drive: acceleration along the plates, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    gap: float
    nu: float
    drive: float

    def __post_init__(self) -> None:
        check_positive(self, "gap", "nu")

    @property
    def fastest(self) -> float:
        """Largest speed of the flow that stays in the end, m/s."""
        return self.drive * self.gap**2 / (8 * self.nu)

    def drag(self, rho0: float) -> float:
        """Return the drag on the lower plate in the end, force per area."""
        return rho0 * self.drive * self.gap / 2

    def velocity(self, y: ArrayLike, t: float) -> NDArray[np.float64]:
        """Return the velocity in m/s at heights in m and a time in s, shape of ``y``.

        Raises:
            UserError: a height outside of the plates, or a time before the start.
        """
        y = within(self, "y", y, 0.0, self.gap, "between the plates")
        along = y[..., np.newaxis] / self.gap
        time = float(since_start(self, t, {()})) * self.nu / self.gap**2
        return self.fastest * (_early(along, time) if time < EARLY else _late(along, time))


def _early(along: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Sum the images, over the fastest flow; lengths are in gaps, times in gap^2 / nu."""
    # at the start a distance over 0 is none, or larger than any
    scale = 2 * np.sqrt(max(time, np.finfo(np.float64).tiny))
    lag = _i2erfc((IMAGES + along) / scale) + _i2erfc((IMAGES + 1 - along) / scale)
    return 8 * time * (1 - 4 * np.sum((-1.0) ** IMAGES * lag, axis=-1))


def _i2erfc(x: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.minimum(x, 30.0)  # where it is 0; squares of what is larger overflow
    return ((1 + 2 * x**2) * erfc(x) - 2 * x * np.exp(-(x**2)) / np.sqrt(np.pi)) / 4


def _late(along: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Sum the series, over the fastest flow."""
    n = 2 * np.arange(TERMS) + 1
    decay = np.exp(-((n * np.pi) ** 2) * time)
    transient = 32 / (n * np.pi) ** 3 * np.sin(n * np.pi * along) * decay
    steady = 4 * along[..., 0] * (1 - along[..., 0])
    return steady - np.sum(transient, axis=-1)
