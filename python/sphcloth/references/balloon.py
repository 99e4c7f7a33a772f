"""A spherical shell without stiffness that breathes on the gas inside.

Its mass M moves with the radius R, M R'' = 4 pi R^2 (p(V) - p_a), with p V^n = const and
V = 4 pi R^3 / 3. The energy M R'^2 / 2 + U(V) + p_a V is constant, U = p V / (n - 1), or
-p V ln V for n = 1. Small oscillations have omega^2 = 3 n p / (sigma R), sigma = M / (4 pi R^2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from sphcloth.references.checks import check_positive, since_start


@dataclass(frozen=True)
class BreathingShell:
    """The shell, which starts at the pressure outside.

    Attributes:
        radius: at the start, m.
        areal: mass per area at the start, kg/m^2.
        pressure: outside, and inside at the start, Pa.
        exponent: n.
        speed: of the shell at the start, outward, m/s.

    Raises:
        UserError: a number that is not positive.
    """

    radius: float
    areal: float
    pressure: float
    exponent: float
    speed: float

    def __post_init__(self) -> None:
        check_positive(self, "radius", "areal", "pressure", "exponent", "speed")

    @property
    def mass(self) -> float:
        """Of the shell, kg."""
        return 4 * math.pi * self.radius**2 * self.areal

    @property
    def volume(self) -> float:
        """At the start, m^3."""
        return 4 / 3 * math.pi * self.radius**3

    @property
    def small_period(self) -> float:
        """Of small oscillations, s."""
        omega_sq = 3 * self.exponent * self.pressure / (self.areal * self.radius)
        return 2 * math.pi / math.sqrt(omega_sq)

    def volumes(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the volume at some times, ascending from 0, m^3.

        Raises:
            UserError: a time before the start.
        """
        at = np.atleast_1d(since_start(self, times))
        solved = solve_ivp(
            self._rate,
            (0, float(at[-1])),
            [self.radius, self.speed],
            "DOP853",
            at,
            rtol=1e-11,
            atol=1e-13 * self.radius,
            first_step=self.small_period / 1000,
            max_step=self.small_period / 20,
        )
        return 4 / 3 * np.pi * solved.y[0] ** 3

    def _rate(self, _: float, state: NDArray[np.float64]) -> list[float]:
        radius, speed = state
        inside = self.pressure * (self.radius / radius) ** (3 * self.exponent)
        return [speed, 4 * math.pi * radius**2 * (inside - self.pressure) / self.mass]
