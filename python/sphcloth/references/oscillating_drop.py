"""An elliptic drop of ideal, incompressible fluid in the force field -omega^2 r, in the plane.

Monaghan and Rafiee, Int. J. Numer. Methods Fluids 71 (2013) 537: with v = s(t) (x, -y) and a
pressure that vanishes on the ellipse (x/A)^2 + (y/B)^2 = 1,

  A' = s A,   B' = -s B,   s' = -(s^2 + omega^2) (A^2 - B^2) / (A^2 + B^2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.integrate._ivp.ivp import OdeResult

from sphcloth.references.checks import check_positive

TOLERANCE = 1e-12
# longest time to look for a period, in that of small oscillations; at most 1.42 are needed
PERIODS = 3.0


@dataclass(frozen=True)
class EllipticDrop:
    """A drop that is a circle of radius 1 with the rate of strain sigma at the start.

    Lengths are in radii: the motion does not depend on the radius.

    Attributes:
        sigma: rate of strain at the start, 1/s.
        omega: of the force field, 1/s.

    Raises:
        UserError: a value for which there is no such scene.
    """

    sigma: float
    omega: float

    def __post_init__(self) -> None:
        check_positive(self, "omega")

    def semi_axes(self, times: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return both semi-axes over the radius at some times in s, that along x first."""
        times = np.asarray(times, dtype=np.float64) % self.period
        along_x = np.exp(self._period_of_motion.sol(times)[0])
        return along_x, 1 / along_x

    @property
    def period(self) -> float:
        """Period of the semi-axes, s: from one upward passage of A = B to the next."""
        return float(self._period_of_motion.t[-1])

    @property
    def largest(self) -> float:
        """Largest semi-axis over the radius.

        It is reached where s = 0; the energy, (s^2 + omega^2) (A^2 + B^2), is constant.
        """
        ratio = 1 + (self.sigma / self.omega) ** 2
        return math.sqrt(ratio + math.sqrt(ratio**2 - 1))

    @property
    def kinetic_energy(self) -> float:
        """Kinetic energy at the start over mass and radius squared, 1/s^2."""
        return self.sigma**2 / 4

    @cached_property
    def _period_of_motion(self) -> OdeResult:
        """Solve for log A and s over one period."""

        def rates(t: float, state: NDArray) -> tuple[float, float]:
            log_a, strain = state
            return strain, -(strain**2 + self.omega**2) * math.tanh(2 * log_a)

        def passes_the_circle(t: float, state: NDArray) -> float:
            return state[0] if t > 0 else 1.0  # the start is no passage

        passes_the_circle.terminal = True
        passes_the_circle.direction = 1
        small = 2 * math.pi / (math.sqrt(2) * self.omega)
        return solve_ivp(
            rates,
            (0, PERIODS * small),
            (0.0, self.sigma),
            method="DOP853",
            dense_output=True,
            events=passes_the_circle,
            rtol=TOLERANCE,
            atol=TOLERANCE,
        )
