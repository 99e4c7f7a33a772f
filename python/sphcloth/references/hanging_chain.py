"""A chain of equal springs and masses that hangs at rest.

Link i of N carries the masses i to N, so its tension is T_i = (N + 1 - i) m g. A link of
compliance alpha is longer than at rest by alpha T_i; the whole chain by alpha m g N (N + 1) / 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check, check_positive


@dataclass(frozen=True)
class HangingChain:
    """A chain below a fixed point.

    Attributes:
        links: number N of links, each with a mass at its lower end.
        mass: m of each, kg.
        length: of a link at rest, m.
        compliance: alpha of a link, m/N; 0 if it is rigid.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    links: int
    mass: float
    length: float
    compliance: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "links", "mass", "length", "gravity")
        check(self, "compliance", self.compliance >= 0, "it must not be negative")

    @property
    def tensions(self) -> NDArray[np.float64]:
        """Tension of the links from the top, N, shape (N,)."""
        return self.mass * self.gravity * np.arange(self.links, 0, -1)

    @property
    def heights(self) -> NDArray[np.float64]:
        """Heights of the masses below the fixed point, m, negative, shape (N,)."""
        return -np.cumsum(self.length + self.compliance * self.tensions)

    @property
    def stretch(self) -> float:
        """How much longer than at rest the chain is, m."""
        return self.compliance * float(np.sum(self.tensions))

    @property
    def support(self) -> float:
        """Force of the fixed point, N."""
        return float(self.tensions[0])

    @property
    def slowest(self) -> float:
        """Lowest angular frequency of motion along the chain, rad/s; infinity if links are rigid.

        A row of N masses and springs, fixed at one end:
        omega = 2 sqrt(1 / alpha m) sin(pi / (4 N + 2)).
        """
        if not self.compliance:
            return math.inf
        stiffness = 1 / (self.compliance * self.mass)
        return 2 * float(np.sqrt(stiffness) * np.sin(np.pi / (4 * self.links + 2)))
