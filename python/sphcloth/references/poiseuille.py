"""Start-up of plane Poiseuille flow: a force along the plates starts to drive fluid at rest.

At the start, with s as in :mod:`sphcloth.references.plates` and the second integral of erfc,
i2erfc, it is the flow over a single plate and its images:

  u = drive t (1 - 4 sum_k (-1)^k (i2erfc((k gap + y) / s) + i2erfc(((k + 1) gap - y) / s)))
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc

from sphcloth.references.checks import check_positive
from sphcloth.references.plates import IMAGES, TERMS, reach, start_up


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
        return self.fastest * start_up(self, y, t, _early, _late)


def _early(along: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Sum the images, over the fastest flow; lengths are in gaps, times in gap^2 / nu."""
    scale = reach(time)
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
