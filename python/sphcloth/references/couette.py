"""Start-up of plane Couette flow: a plate starts to slide over fluid at rest.

The series solution, as in Morris, Fox and Zhu, J. Comput. Phys. 136 (1997) 214.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import check_positive

TERMS = 400


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
        """Return the velocity in m/s at heights in m and a time in s, shape of ``y``."""
        along = np.asarray(y, dtype=np.float64)[..., np.newaxis] / self.gap
        n = np.arange(1, TERMS + 1)
        decay = np.exp(-((n * np.pi) ** 2) * self.nu * t / self.gap**2)
        transient = 2 / (n * np.pi) * (-1.0) ** n * np.sin(n * np.pi * along) * decay
        return self.lid * (along[..., 0] + np.sum(transient, axis=-1))
