"""Start-up of plane Poiseuille flow: a force along the plates starts to drive fluid at rest.

The series solution, as in Morris, Fox and Zhu, J. Comput. Phys. 136 (1997) 214.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import check_positive

TERMS = 200


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
        """Return the velocity in m/s at heights in m and a time in s, shape of ``y``."""
        along = np.asarray(y, dtype=np.float64)[..., np.newaxis] / self.gap
        n = 2 * np.arange(TERMS) + 1
        decay = np.exp(-((n * np.pi) ** 2) * self.nu * t / self.gap**2)
        transient = 32 / (n * np.pi) ** 3 * np.sin(n * np.pi * along) * decay
        steady = 4 * along[..., 0] * (1 - along[..., 0])
        return self.fastest * (steady - np.sum(transient, axis=-1))
