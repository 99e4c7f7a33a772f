"""Standing waves of small amplitude on water of finite depth (linear theory, free-slip bottom)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class StandingWave:
    """One wavelength of a standing wave, eta = A cos(k x) cos(omega t).

    Attributes:
        depth: of the undisturbed water, m.
        length: of the wave, m.
        gravity: acceleration, m/s^2.
    """

    depth: float
    length: float
    gravity: float

    @property
    def number(self) -> float:
        """Wave number k, 1/m."""
        return 2 * math.pi / self.length

    @property
    def period(self) -> float:
        """Period in s, from omega^2 = g k tanh(k H)."""
        rate = self.gravity * self.number * math.tanh(self.number * self.depth)
        return 2 * math.pi / math.sqrt(rate)

    def second_order(self, amplitude: float) -> float:
        """Return the relative change of the period in second order of an amplitude in m.

        That of deep water, omega = omega0 (1 - (k A)^2 / 8): Rayleigh, Proc. R. Soc. A 91
        (1915) 345.
        """
        return (self.number * amplitude) ** 2 / 8

    def mode(self, positions: NDArray) -> NDArray[np.float64]:
        """Return the velocity for a vertical surface speed of 1 at x = 0, shape (N, 2)."""
        x, y = self.number * positions[:, 0], self.number * positions[:, 1]
        velocity = np.stack([-np.sin(x) * np.cosh(y), np.cos(x) * np.sinh(y)], axis=1)
        return velocity / math.sinh(self.number * self.depth)
