"""A plane jet that a sheet turns, without gravity.

What flows in brings the momentum rho B v per time and depth along the jet, v times as much as its
mass; what flows off at the angle theta from the jet takes the part cos(theta) away,
if its speed is still v. In the mean over a steady flow the ends of the sheet bear the rest,

    F = rho Q v (1 - cos(theta)),   Q = B v

per depth, wherever the sheet is and whatever its shape. A sheet that stays level has theta = 90
degrees; one that sags throws the water back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class TurnedJet:
    """A jet that is turned.

    Attributes:
        thickness: of the jet B, m.
        speed: of the jet v, m/s.
        rho0: density, kg/m^3.

    Raises:
        UserError: a value for which there is no such scene.
    """

    thickness: float
    speed: float
    rho0: float

    def __post_init__(self) -> None:
        check_positive(self, "thickness", "rho0")

    @property
    def flow(self) -> float:
        """Volume per time and depth Q, m^2/s."""
        return self.thickness * self.speed

    def force(self, turning: float, kept: float = 1.0) -> float:
        """Return the force along the jet per depth, N/m.

        Args:
            turning: degrees.
            kept: share of the speed with which the water leaves.
        """
        lost = 1 - kept * math.cos(math.radians(turning))
        return self.rho0 * self.flow * self.speed * lost
