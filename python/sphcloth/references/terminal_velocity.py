"""A level sheet that falls through air at rest.

With mass w per area, w dv/dt = w g - rho/2 C_n v^2: from rest v = u tanh(g t / u), with the
terminal velocity u = sqrt(2 w g / (rho C_n)), and the sheet falls by u^2/g ln(cosh(g t / u)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check_positive, since_start


@dataclass(frozen=True)
class FallingSheet:
    """A level sheet, at rest at first.

    Attributes:
        areal: mass per area w, kg/m^2.
        density: of the air, kg/m^3.
        normal: coefficient C_n.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    areal: float
    density: float
    normal: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "areal", "density", "normal", "gravity")

    @property
    def terminal(self) -> float:
        """Terminal velocity, m/s."""
        return math.sqrt(2 * self.areal * self.gravity / (self.density * self.normal))

    def velocity(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the velocity of the fall, m/s.

        Raises:
            UserError: a time before the start.
        """
        return self.terminal * np.tanh(self.gravity * since_start(self, times) / self.terminal)

    def fall(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the sheet has fallen, m.

        Raises:
            UserError: a time before the start.
        """
        x = self.gravity * since_start(self, times) / self.terminal
        # ln(cosh(x)) without overflow
        return self.terminal**2 / self.gravity * (x + np.log1p(np.exp(-2 * x)) - math.log(2))
