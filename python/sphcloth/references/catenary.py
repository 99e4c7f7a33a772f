"""A chain of equal links and masses between two fixed points at one height, at rest.

The horizontal pull H is the same in all links. With a weight m g at each inner joint the vertical
part of the pull of link i of N is V_i = m g (i - (N + 1) / 2). So the link has the slope V_i / H
and the length l + alpha sqrt(H^2 + V_i^2). H follows from the distance of the fixed points. This is
the polygon, not the curve that it tends to.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from sphcloth.references.checks import check, check_positive


@dataclass(frozen=True)
class HangingPolygon:
    """A chain between two fixed points.

    Attributes:
        links: number N of links.
        length: of the whole chain at rest, m.
        span: distance of the fixed points, m, shorter than the length.
        mass: at each inner joint, kg.
        gravity: acceleration g, m/s^2.
        compliance: of a link, m/N; 0 for rigid links.

    Raises:
        UserError: a value for which there is no such scene.
    """

    links: int
    length: float
    span: float
    mass: float
    gravity: float
    compliance: float = 0.0

    def __post_init__(self) -> None:
        check_positive(self, "links", "length", "span", "mass", "gravity")
        rigid_fits = self.compliance > 0 or self.span < self.length
        check(self, "span", rigid_fits, f"it must be below the length, {self.length:g}")

    @cached_property
    def pull(self) -> float:
        """Horizontal pull H, N."""
        weight = self.mass * self.gravity
        # the span grows with H, from 0 (N even) or one link (N odd)
        upper = weight
        while self._span(upper) < self.span:
            upper *= 2
        return float(brentq(lambda pull: self._span(pull) - self.span, 0.0, upper, xtol=1e-300))

    @property
    def joints(self) -> NDArray[np.float64]:
        """Places x, z of all joints, ends included, m, shape (N + 1, 2); the middle is x = 0."""
        steps = np.stack(self._links(self.pull), axis=-1)
        start = np.array([-self.span / 2, 0.0])
        return start + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])

    @property
    def sag(self) -> float:
        """Depth of the lowest joint, m."""
        return -float(np.min(self.joints[:, 1]))

    def _links(self, pull: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the extent of each link along x and z under a horizontal pull."""
        rise = self.mass * self.gravity * (np.arange(self.links) - (self.links - 1) / 2)
        tension = np.hypot(pull, rise)
        # without any pull the middle link of an odd number has no direction: it stays level
        at_rest = np.where(tension > 0, tension, 1.0)
        along = np.where(tension > 0, pull, 1.0) / at_rest
        stretched = self.length / self.links + self.compliance * tension
        return stretched * along, stretched * rise / at_rest

    def _span(self, pull: float) -> float:
        return float(np.sum(self._links(pull)[0]))
