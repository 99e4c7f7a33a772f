"""Start-up of plane Couette flow: a plate starts to slide over fluid at rest.

At the start, with s as in :mod:`sphcloth.references.plates`, it is Stokes's flow under a single
plate and its images:

  u = lid sum_k erfc(((2 k + 1) gap - y) / s) - erfc(((2 k + 1) gap + y) / s),   k = 0, 1, ...
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc

from sphcloth.references.checks import check_positive
from sphcloth.references.plates import IMAGES, TERMS, reach, start_up


@dataclass(frozen=True)
class CouetteStart:
    """Fluid between a plate at rest at y = 0 and one that slides from t = 0 on.

    Attributes:
        gap: distance of the plates, m.
        nu: kinematic viscosity, m^2/s.
        lid: velocity of the plate at y = gap, m/s.

    Raises:
        UserError: a value for which there is no such scene.
    """

    gap: float
    nu: float
    lid: float

    def __post_init__(self) -> None:
        check_positive(self, "gap", "nu")

    @property
    def fastest(self) -> float:
        """Largest speed of the flow that stays in the end, m/s."""
        return self.lid

    def drag(self, rho0: float) -> float:
        """Return the drag on the plate at rest in the end, force per area."""
        return rho0 * self.nu * self.lid / self.gap

    def velocity(self, y: ArrayLike, t: float) -> NDArray[np.float64]:
        """Return the velocity in m/s at heights in m and a time in s, shape of ``y``.

        At the start, t = 0, all but the plate is at rest.

        Raises:
            UserError: a height outside of the plates, or a time before the start.
        """
        return self.lid * start_up(self, y, t, _early, _late)


def _early(along: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Sum the images; lengths are in gaps, times in gap^2 / nu."""
    scale = reach(time)
    odd = 2 * IMAGES + 1
    return np.sum(erfc((odd - along) / scale) - erfc((odd + along) / scale), axis=-1)


def _late(along: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Sum the series."""
    n = np.arange(1, TERMS + 1)
    decay = np.exp(-((n * np.pi) ** 2) * time)
    transient = 2 / (n * np.pi) * (-1.0) ** n * np.sin(n * np.pi * along) * decay
    return along[..., 0] + np.sum(transient, axis=-1)
