"""Decaying Taylor-Green vortices in a periodic square, an exact solution of Navier and Stokes.

Taylor and Green, Proc. R. Soc. A 158 (1937) 499, in two dimensions:

  u = U exp(-8 pi^2 t / Re) (-cos(2 pi x) sin(2 pi y), sin(2 pi x) cos(2 pi y))

for the side 1 and U = 1, with the viscosity 1 / Re.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class TaylorGreen:
    """The vortices of one Reynolds number; lengths in sides, speeds in U.

    Attributes:
        reynolds: U times side over viscosity.

    Raises:
        UserError: a value for which there is no such scene.
    """

    reynolds: float

    def __post_init__(self) -> None:
        check_positive(self, "reynolds")

    @property
    def rate(self) -> float:
        """Rate at which all speeds fall; the kinetic energy falls at twice this rate."""
        return 8 * math.pi**2 / self.reynolds

    def time(self, speed: float) -> float:
        """Return when the largest speed has fallen from 1 to this."""
        return -math.log(speed) / self.rate

    def mode(self, positions: NDArray) -> NDArray[np.float64]:
        """Return the velocity at the start, shape (N, 2)."""
        x, y = 2 * math.pi * positions[:, 0], 2 * math.pi * positions[:, 1]
        return np.stack([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)], axis=1)

    def velocity(self, positions: NDArray, time: float) -> NDArray[np.float64]:
        """Return the velocity at positions, shape (N, 2 or more), and a time; shape (N, 2)."""
        return math.exp(-self.rate * time) * self.mode(positions)
