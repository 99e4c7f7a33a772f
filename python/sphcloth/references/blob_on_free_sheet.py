"""A drop of fluid and a sheet that is free, without outer forces.

Momentum is constant. Kinetic energy is least if all matter has one velocity, P / M; contact without
restitution takes some of what is above, and can give nothing back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Collision:
    """A drop that flies towards a sheet at rest.

    Attributes:
        drop: mass of the drop, kg.
        sheet: mass of the sheet, kg.
        speed: of the drop, m/s.
        angle: between its path and the sheet, degrees; 90 for a normal impact.

    Raises:
        UserError: a value for which there is no such scene.
    """

    drop: float
    sheet: float
    speed: float
    angle: float

    def __post_init__(self) -> None:
        check_positive(self, "drop", "sheet")

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocity of the drop, m/s: along the sheet, across its path, and upwards."""
        slope = math.radians(self.angle)
        return self.speed * np.array([math.cos(slope), 0.0, -math.sin(slope)])

    @property
    def momentum(self) -> NDArray[np.float64]:
        """Momentum of drop and sheet at any time, kg m/s."""
        return self.drop * self.velocity

    @property
    def energy(self) -> float:
        """Kinetic energy at first, J."""
        return 0.5 * self.drop * self.speed**2

    @property
    def least_energy(self) -> float:
        """Kinetic energy that momentum leaves at any time, J."""
        return self.energy * self.drop / (self.drop + self.sheet)
