"""A column of compressible fluid on a sheet that springs hold.

Small motion about rest. The column is a rod of the modulus rho c^2 with a free upper end, so its
displacement is a multiple of cos(omega (h - z) / c), with z from the sheet upwards. At z = 0 it
pulls the sheet with rho c omega sin(omega h / c), and the sheet obeys

    (k_A - m_A omega^2) cos(omega h / c) = rho c omega sin(omega h / c)

For c without bound this is omega^2 (m_A + rho h) = k_A.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Piston:
    """A sheet on springs with fluid on it; all masses and stiffnesses are per area.

    Attributes:
        areal: mass of the sheet m_A, kg/m^2.
        stiffness: of the springs k_A, N/m^3.
        height: of the fluid h, m.
        rho0: density, kg/m^3.
        sound: speed of sound c, m/s.

    Raises:
        UserError: a value for which there is no such scene.
    """

    areal: float
    stiffness: float
    height: float
    rho0: float
    sound: float

    def __post_init__(self) -> None:
        check_positive(self, "stiffness", "height", "rho0", "sound")

    @property
    def rigid_period(self) -> float:
        """Period with a fluid that cannot be compressed, s."""
        return 2 * math.pi * math.sqrt((self.areal + self.rho0 * self.height) / self.stiffness)

    @property
    def frequency(self) -> float:
        """Least angular frequency of sheet and column, 1/s."""
        # at 0 the sheet is pulled back, at the first resonance of the column on a fixed sheet it
        # is not; a rod that yields is slower than one that does not
        quarter = 0.5 * math.pi * self.sound / self.height
        highest = min(quarter, 2 * math.pi / self.rigid_period * (1 + 1e-9))
        return brentq(self._missing, 0.0, highest, xtol=1e-14 * highest, rtol=1e-14)

    @property
    def period(self) -> float:
        """Period of the slowest motion, s."""
        return 2 * math.pi / self.frequency

    def _missing(self, omega: float) -> float:
        phase = omega * self.height / self.sound
        pull = self.rho0 * self.sound * omega * math.sin(phase)
        return (self.stiffness - self.areal * omega**2) * math.cos(phase) - pull
