"""Particles of water of which a surface is found, and how far each one counts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

# standard deviation of the weights and radius of a particle, in spacings: the radius is the
# distance of the mean from the plane that bounds a half-space, sqrt(2/pi) standard deviations
WIDTH = 0.78
RADIUS = np.sqrt(2 / np.pi) * WIDTH
# the weights end here, in standard deviations
REACH = 3.2


@dataclass(frozen=True)
class Particles:
    """Particles of water to find the surface of.

    Attributes:
        positions: shape (N, 3).
        spacing: the edge of the cube that each particle stands for, shape (N,).
        values: a quantity to carry to the surface, shape (N,), or None.
        room: lower and upper corner of the space that the water may fill, shape (2, 3): it ends
            flat where a periodic box goes on.
    """

    positions: NDArray[np.float64]
    spacing: NDArray[np.float64]
    values: NDArray[np.float64] | None = None
    room: NDArray[np.float64] = field(
        default_factory=lambda: np.array([[-np.inf] * 3, [np.inf] * 3])
    )

    def select(self, chosen: NDArray) -> Particles:
        """Return copies of some particles, by mask or index."""
        values = None if self.values is None else self.values[chosen]
        return replace(
            self, positions=self.positions[chosen], spacing=self.spacing[chosen], values=values
        )
