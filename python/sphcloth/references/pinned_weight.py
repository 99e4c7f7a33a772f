"""What the pins of a sheet at rest carry: the weight of the water and of the sheet."""

from __future__ import annotations

from dataclasses import dataclass

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Load:
    """Water on a square sheet.

    Attributes:
        side: of the sheet at rest, m.
        areal: mass of the sheet per area, kg/m^2.
        water: volume of the water, m^3.
        rho0: density of the water, kg/m^3.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    side: float
    areal: float
    water: float
    rho0: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "side", "gravity")

    @property
    def weight(self) -> float:
        """Weight of water and sheet, N."""
        return (self.rho0 * self.water + self.areal * self.side**2) * self.gravity
