"""A column of Tait fluid at rest under its own weight.

A particle that starts at depth d0 in a column of uniform density rho0 always carries the mass
above it, so its pressure at rest is rho0 g d0 for any equation of state. Its height follows from
the Tait density at that pressure: dy = (rho0 / rho) dd0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import check, check_positive, within


@dataclass(frozen=True)
class TaitColumn:
    """A column that started with density rho0 everywhere.

    Attributes:
        height: undisturbed height, m.
        rho0: rest density, kg/m^3.
        gravity: acceleration, m/s^2; 0 for a column without weight.
        sound: speed of sound at rest, m/s.
        gamma: exponent of the equation of state, > 1.

    Raises:
        UserError: a value for which there is no such scene.
    """

    height: float
    rho0: float
    gravity: float
    sound: float
    gamma: float

    def __post_init__(self) -> None:
        check_positive(self, "height", "rho0", "sound")
        check(self, "gravity", self.gravity >= 0, "it must not be negative")
        check(self, "gamma", self.gamma > 1, "it must be above 1")

    def pressure(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Return the pressure in Pa of what started at a depth in m.

        Raises:
            UserError: a depth outside of the column.
        """
        return self.rho0 * self.gravity * self._inside(depth)

    def level(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Return the height above the base in m at which it comes to rest.

        Raises:
            UserError: a depth outside of the column.
        """
        return self._thickness(self.height) - self._thickness(self._inside(depth))

    @property
    def settlement(self) -> float:
        """How far the surface sinks, m."""
        return float(self.height - self.level(0.0))

    def _inside(self, depth: ArrayLike) -> NDArray[np.float64]:
        remedy = "below the surface, which is at 0, and above the base"
        return within(self, "depth", depth, 0.0, self.height, remedy)

    def _thickness(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Return the thickness at rest of what lay above a depth: the integral of rho0 / rho."""
        rate = self.gamma * self.gravity / self.sound**2
        if not rate:
            return np.asarray(depth, dtype=np.float64)
        power = 1 - 1 / self.gamma
        return np.expm1(power * np.log1p(rate * np.asarray(depth))) / (rate * power)
