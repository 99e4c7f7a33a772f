"""A sheet that hangs in a wind: the angle at which drag balances weight, and the way there.

The wind U blows level on a sheet of mass w per area that hangs from its upper edge, at an angle
theta from the vertical. Across it the force per area is rho/2 C_n (U cos theta)^2. A flexible
sheet without tension at its lower edge is straight where this and the weight across it are equal
everywhere,

    w g sin(theta) = rho/2 C_n U^2 cos^2(theta),

which with a = rho C_n U^2 / (2 w g) is sin(theta) = (sqrt(1 + 4 a^2) - 1) / (2 a). Along it the
force per area is rho/2 C_t U^2 sin(theta).

A plate of one row of cells, mass by area on its vertices and force by thirds, swings by

    m/2 L^2 theta'' = -m/2 g L sin(theta) + L (F_1 / 3 + 2 F_2 / 3),
    F_k = rho/2 C_n A/2 |u_k| u_k,  u_k = U cos(theta) - k L/3 theta'.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sphcloth.references.checks import check_positive, since_start


@dataclass(frozen=True)
class WindPendulum:
    """A sheet below its fixed upper edge, in a level wind.

    Attributes:
        wind: speed U, m/s.
        areal: mass per area w, kg/m^2.
        density: of the air, kg/m^3.
        normal: coefficient C_n.
        tangential: coefficient C_t.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    wind: float
    areal: float
    density: float
    normal: float
    tangential: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "wind", "areal", "density", "normal", "gravity")

    @property
    def angle(self) -> float:
        """Angle from the vertical at rest, rad."""
        a = self.density * self.normal * self.wind**2 / (2 * self.areal * self.gravity)
        return math.asin((math.sqrt(1 + 4 * a * a) - 1) / (2 * a))

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Force of the air per area at rest, along the wind and upwards, Pa."""
        head, theta = 0.5 * self.density * self.wind**2, self.angle
        across = head * self.normal * math.cos(theta) ** 2
        along = head * self.tangential * math.sin(theta)
        return across * np.array([math.cos(theta), math.sin(theta)]) + along * np.array(
            [math.sin(theta), -math.cos(theta)]
        )

    def swing(self, length: float, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angles of a plate of one row of cells that hangs still at first, rad.

        Args:
            length: of the plate, m.
            times: ascending from 0, s.

        Raises:
            UserError: a time before the start.
        """
        times = since_start(self, times)
        per_mass = 0.5 * self.density * self.normal / self.areal / length

        def rate(_: float, state: NDArray[np.float64]) -> list[float]:
            theta, omega = state
            turn = -self.gravity / length * math.sin(theta)
            for share in (1 / 3, 2 / 3):
                u = self.wind * math.cos(theta) - share * length * omega
                turn += per_mass * share * abs(u) * u
            return [omega, turn]

        end = max(float(times[-1]), 1e-12)
        found = solve_ivp(rate, (0, end), [0.0, 0.0], t_eval=times, rtol=1e-11, atol=1e-13)
        return found.y[0]
