"""A column of water that drains through a sheet with pores in its floor.

The sheet takes the pressure a u + b u^2 of the flux u: Darcy (1856), Forchheimer (1901). A column
of density rho and height h over it, with air above and below, moves as one piece,

    h' = -u,  rho h u' = rho g h - (a u + b u^2),

the momentum that leaves with the water being what the falling column loses of its own. Where the
sheet takes most of the weight, u' is small, and h falls

    as h0 exp(-rho g t / a) by Darcy alone,  as (sqrt(h0) - t/2 sqrt(rho g / b))^2 by b alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sphcloth.references.checks import check, check_positive, since_start

# share of the height at which the integration ends: an empty column has no velocity
EMPTY = 1e-3


@dataclass(frozen=True)
class DrainingColumn:
    """Water over a porous floor, at rest at first.

    Attributes:
        height: at the start, m.
        darcy: resistance a, Pa s/m.
        forchheimer: resistance b, kg/m^3.
        rho0: density of the water, kg/m^3.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    height: float
    darcy: float
    forchheimer: float
    rho0: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "height", "rho0", "gravity")
        check(self, "darcy", self.darcy >= 0, "it must be at least 0")
        check(self, "forchheimer", self.forchheimer >= 0, "it must be at least 0")

    def flux(self, height: float) -> float:
        """Return the flux at which the sheet bears a column at rest, m/s."""
        weight = self.rho0 * self.gravity * height
        if self.forchheimer == 0:
            return weight / self.darcy
        # without a difference of nearly equal numbers
        root = np.sqrt(self.darcy**2 + 4 * self.forchheimer * weight)
        return float(2 * weight / (self.darcy + root))

    def levels(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the heights at some times, m; 0 where it is empty.

        Raises:
            UserError: a time before the start.
        """
        times, least = since_start(self, times), EMPTY * self.height

        def rates(_: float, state: NDArray) -> list[float]:
            h, u = max(state[0], least), state[1]
            loss = (self.darcy + self.forchheimer * abs(u)) * u / self.rho0
            return [-u, self.gravity - loss / h]

        def is_empty(_: float, state: NDArray) -> float:
            return state[0] - least

        is_empty.terminal = True
        run = solve_ivp(
            rates,
            (0.0, max(float(np.max(times)), 1e-12)),
            [self.height, 0.0],
            method="LSODA",
            events=is_empty,
            dense_output=True,
            rtol=1e-9,
            atol=1e-12 * self.height,
        )
        inside = np.minimum(times, run.t[-1])
        return np.where(times <= run.t[-1], run.sol(inside)[0], 0.0)
