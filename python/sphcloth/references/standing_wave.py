"""Standing waves of small amplitude on water of finite depth (linear theory, free-slip bottom)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class StandingWave:
    """One wavelength of a standing wave, eta = A cos(k x) cos(omega t).

    Attributes:
        depth: of the undisturbed water, m.
        length: of the wave, m.
        gravity: acceleration, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    depth: float
    length: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "depth", "length", "gravity")

    @property
    def number(self) -> float:
        """Wave number k, 1/m."""
        return 2 * math.pi / self.length

    @property
    def period(self) -> float:
        """Period in s, from omega^2 = g k tanh(k H)."""
        rate = self.gravity * self.number * math.tanh(self.number * self.depth)
        return 2 * math.pi / math.sqrt(rate)

    def surface(self, x: ArrayLike, time: float, amplitude: float) -> NDArray[np.float64]:
        """Return the height of the surface over the one at rest, m, shape of ``x``.

        Args:
            x: places along the wave, m; a crest is at 0 when the time is 0.
            time: s.
            amplitude: A, m, small against depth and length.
        """
        phase = math.cos(2 * math.pi * time / self.period)
        return amplitude * np.cos(self.number * np.asarray(x, dtype=np.float64)) * phase

    def second_order(self, amplitude: float) -> float:
        """Return the relative change of the period in second order of an amplitude in m.

        That of deep water, omega = omega0 (1 - (k A)^2 / 8): Rayleigh, Proc. R. Soc. A 91
        (1915) 345.
        """
        return (self.number * amplitude) ** 2 / 8

    def viscous(self, viscosity: float) -> float:
        """Return the relative change of the period without damping by a viscosity in m^2/s.

        That of deep water with a free surface and no other friction, the root n of
        (n + 2 nu k^2)^2 + omega^2 = 4 nu^2 k^3 sqrt(k^2 + n/nu) with a period of 2 pi/abs(n):
        Lamb, Hydrodynamics (1932), section 349.
        """
        if viscosity == 0.0:
            return 0.0
        square, omega = viscosity * self.number**2, 2 * math.pi / self.period
        # y = sqrt(1 + n/(nu k^2)), which has a positive real part where motion decays downwards
        roots = np.roots([1, 0, 2, -4, 1 + (omega / square) ** 2])
        rate = square * (roots[roots.real > 0] ** 2 - 1)
        return omega / abs(complex(rate[0])) - 1

    def mode(self, positions: NDArray) -> NDArray[np.float64]:
        """Return the velocity for a vertical surface speed of 1 at x = 0, shape (N, 2)."""
        x, y = self.number * positions[:, 0], self.number * positions[:, 1]
        velocity = np.stack([-np.sin(x) * np.cosh(y), np.cos(x) * np.sinh(y)], axis=1)
        return velocity / math.sinh(self.number * self.depth)
