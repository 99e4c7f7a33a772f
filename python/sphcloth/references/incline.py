"""A body on an inclined plane with Coulomb's friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sphcloth.references.checks import check, check_positive


@dataclass(frozen=True)
class Incline:
    """The body, at rest at first.

    Attributes:
        angle: of the plane, degrees, from 0 to 90.
        friction: coefficient, at rest and in motion, >= 0.
        gravity: > 0.

    Raises:
        UserError: a value for which there is no such scene.
    """

    angle: float
    friction: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "angle", "gravity")
        check(self, "angle", self.angle < 90, "it must be below 90")
        check(self, "friction", self.friction >= 0, "it must not be negative")

    @property
    def slides(self) -> bool:
        """Whether the plane is steeper than the angle of friction."""
        return math.tan(math.radians(self.angle)) > self.friction

    @property
    def free(self) -> float:
        """Acceleration without friction."""
        return self.gravity * math.sin(math.radians(self.angle))

    @property
    def acceleration(self) -> float:
        """Acceleration down the plane, g (sin - mu cos), or 0 where friction holds."""
        drag = self.friction * self.gravity * math.cos(math.radians(self.angle))
        return max(0.0, self.free - drag)
