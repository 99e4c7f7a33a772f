"""A long strip between two clamped edges that a pressure bulges: a circular arc.

The tension N per width follows the arc of radius r = N / p. With the distance a of the edges, the
length L of the strip at rest and its stiffness K per width, the half angle phi of the arc satisfies

    a = 2 r sin(phi),    2 r phi = L (1 + N / K).

An inextensible strip has K = infinity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from sphcloth.errors import UserError
from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Bulge:
    """The strip.

    Attributes:
        span: distance of the edges a, m.
        length: at rest L, m.
        pressure: over that on the other side p, Pa.
        stiffness: force per width over strain K, N/m; infinity if inextensible.

    Raises:
        UserError: a number that is not positive, or an inextensible strip that is not longer than
            the span.
    """

    span: float
    length: float
    pressure: float
    stiffness: float = math.inf

    def __post_init__(self) -> None:
        check_positive(self, "span", "length", "pressure", "stiffness")
        if math.isinf(self.stiffness) and self.length <= self.span:
            raise UserError("an inextensible strip must be longer than the span to bulge")

    @property
    def half_angle(self) -> float:
        """Half the angle of the arc, rad."""
        lowest, highest = 1e-9, math.pi - 1e-9
        return float(brentq(self._too_long, lowest, highest, xtol=1e-15, rtol=1e-15))

    def _too_long(self, phi: float) -> float:
        """Return the length of the arc over that of the strip under the tension, less one."""
        radius = self.span / (2 * math.sin(phi))
        return 2 * radius * phi / (self.length * (1 + self.pressure * radius / self.stiffness)) - 1

    @property
    def radius(self) -> float:
        """Of the arc, m."""
        return self.span / (2 * math.sin(self.half_angle))

    @property
    def tension(self) -> float:
        """Per width, N/m."""
        return self.pressure * self.radius

    @property
    def height(self) -> float:
        """Of the middle over the edges, m."""
        return self.radius * (1 - math.cos(self.half_angle))

    @property
    def area(self) -> float:
        """Between the arc and the plane of the edges, per width, m^2."""
        phi = self.half_angle
        return self.radius**2 * (phi - math.sin(phi) * math.cos(phi))

    def shape(self, points: int) -> NDArray[np.float64]:
        """Return x from the middle and z over the edges of points of equal distance, m."""
        angle = np.linspace(-self.half_angle, self.half_angle, points)
        offset = math.cos(self.half_angle)
        return self.radius * np.stack([np.sin(angle), np.cos(angle) - offset])
