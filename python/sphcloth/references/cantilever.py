"""A sheet clamped level at one edge that bends under its own weight.

The heavy elastica: with the slope theta(s) below the horizontal, s from 0 at the clamp to 1 at the
free edge in units of the length L,

    theta'' = -Gamma (1 - s) cos(theta),   theta(0) = 0,   theta'(1) = 0

and Gamma = w L^3 / B of weight per area w and bending stiffness B per width.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

from sphcloth.references.checks import check_positive, within

# Gamma grows by this factor from solution to solution, each of which starts the next
GROWTH = 2.0
POINTS = 101


@dataclass(frozen=True)
class HeavyElastica:
    """The sheet at rest.

    Attributes:
        gamma: w L^3 / B, > 0.

    Raises:
        UserError: a value for which there is no such scene.
    """

    gamma: float

    def __post_init__(self) -> None:
        check_positive(self, "gamma")

    @property
    def drop(self) -> float:
        """How far the free edge lies below the clamp, in L."""
        return -float(self.shape(1.0)[1])

    @property
    def reach(self) -> float:
        """Horizontal distance of the free edge from the clamp, in L."""
        return float(self.shape(1.0)[0])

    def shape(self, s: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x and z (upwards) at some distances along the sheet, in L, shape (2, ...).

        Raises:
            UserError: a distance that is not from 0 to 1.
        """
        along = within(self, "s", s, 0.0, 1.0, "from the clamp to the free edge")
        _, _, x, drop = self._solution(along)
        return np.stack([x, -drop])

    @cached_property
    def _solution(self):
        s = np.linspace(0, 1, POINTS)
        gamma = min(self.gamma, 1.0)
        guess = np.stack([gamma * (1 - (1 - s) ** 3) / 6, gamma * (1 - s) ** 2 / 2, s, 0 * s])
        while True:
            found = solve_bvp(_slope_for(gamma), _ends, s, guess, tol=1e-9, max_nodes=100_000)
            if not found.success:
                raise ArithmeticError(f"heavy elastica, Gamma = {gamma:g}: {found.message}")
            if gamma == self.gamma:
                return found.sol
            guess = found.sol(s)
            gamma = min(GROWTH * gamma, self.gamma)


def _slope_for(gamma: float):
    def slope(s: NDArray, state: NDArray) -> NDArray:
        theta, curvature, _, _ = state
        bend = -gamma * (1 - s) * np.cos(theta)
        return np.stack([curvature, bend, np.cos(theta), np.sin(theta)])

    return slope


def _ends(clamp: NDArray, free: NDArray) -> NDArray:
    return np.array([clamp[0], free[1], clamp[2], clamp[3]])
