"""A plane free jet of ideal fluid on a smooth plate without gravity.

Along free streamlines the speed stays U, so both sheets on the plate flow off with U and the
momentum across the plate is lost to it: F_n = rho B U^2 sin(alpha). The momentum along the plate
stays, which divides the jet: B1, B2 = B (1 +- cos(alpha)) / 2 (Milne-Thomson, Theoretical
Hydrodynamics, 5th ed., 1968, section 11.42).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Jet:
    """A jet on a plate.

    Attributes:
        thickness: of the jet, B, m.
        speed: of the jet, U, m/s.
        angle: between jet and plate, degrees; 90 for a jet that meets the plate squarely.
        rho0: density, kg/m^3.

    Raises:
        UserError: a value for which there is no such scene.
    """

    thickness: float
    speed: float
    angle: float
    rho0: float

    def __post_init__(self) -> None:
        check_positive(self, "thickness", "rho0")

    @property
    def force(self) -> float:
        """Force across the plate per depth, N/m."""
        return self.rho0 * self.thickness * self.speed**2 * self.sine

    @property
    def sine(self) -> float:
        """Sine of the angle between jet and plate."""
        return math.sin(math.radians(self.angle))

    @property
    def sheets(self) -> tuple[float, float]:
        """Thickness of the sheets that flow off along and against the direction of the jet, m."""
        share = (1 + math.cos(math.radians(self.angle))) / 2
        return self.thickness * share, self.thickness * (1 - share)
