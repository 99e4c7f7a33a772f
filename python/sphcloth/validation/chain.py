"""Motion of a chain of rigid links, the reference of several cases.

Point masses at the ends of massless rigid links hang from a fixed point. With theta_i the angle of
link i from the downward vertical and mu_k the mass that hangs on link k,

    sum_j mu_max(i,j) l_j (theta_j'' cos(theta_i - theta_j) + theta_j'^2 sin(theta_i - theta_j))
        = -mu_i g sin(theta_i)

These are Lagrange's equations in minimal coordinates: there are no constraints to drift.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import OdeSolution, solve_ivp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkedPendulum:
    """A chain that is released at rest.

    Attributes:
        lengths: of the links from the fixed point on, m, shape (N,).
        masses: at the outer end of each link, shape (N,); only their ratios matter.
        angles: of the links from the downward vertical at the start, rad, shape (N,).
        gravity: acceleration, m/s^2.
    """

    lengths: Sequence[float]
    masses: Sequence[float]
    angles: Sequence[float]
    gravity: float

    @classmethod
    def uniform(cls, links: int, length: float, angle: float, gravity: float) -> LinkedPendulum:
        """Return a straight chain of equal links and masses at an angle from the vertical."""
        return cls([length / links] * links, [1.0 / links] * links, [angle] * links, gravity)

    def positions(self, times: ArrayLike) -> Array:
        """Return x and z (upwards) of the masses at some times, shape (times, N, 2)."""
        angles, _ = self._state(times)
        return self._places(angles)

    def energy_drift(self, time: float) -> float:
        """Return the change of the energy until a time over that of the chain's own fall."""
        energies = [self._energy(*self._state(t)) for t in (0.0, time)]
        scale = np.sum(self.masses) * self.gravity * np.sum(self.lengths)
        return float((energies[1] - energies[0]) / scale)

    def accelerations(self) -> Array:
        """Return the accelerations of the masses at the start, shape (N, 2)."""
        angles = np.asarray(self.angles, dtype=np.float64)
        turning = self._angular_acceleration(angles, np.zeros_like(angles))
        along = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        return np.cumsum((self._lengths * turning)[:, None] * along, axis=0)

    @cached_property
    def _lengths(self) -> Array:
        return np.asarray(self.lengths, dtype=np.float64)

    @cached_property
    def _hanging(self) -> Array:
        """mu: mass that hangs on each link, shape (N,)."""
        return np.cumsum(np.asarray(self.masses, dtype=np.float64)[::-1])[::-1]

    @cached_property
    def _coupling(self) -> Array:
        """mu_max(i,j) l_j, shape (N, N)."""
        number = np.arange(len(self._lengths))
        return self._hanging[np.maximum.outer(number, number)] * self._lengths

    def _angular_acceleration(self, angles: Array, rates: Array) -> Array:
        between = angles[:, None] - angles
        pull = -self._hanging * self.gravity * np.sin(angles)
        whirl = (self._coupling * np.sin(between)) @ rates**2
        return np.linalg.solve(self._coupling * np.cos(between), pull - whirl)

    def _slope(self, _: float, state: Array) -> Array:
        angles, rates = np.split(state, 2)
        return np.concatenate([rates, self._angular_acceleration(angles, rates)])

    def _state(self, times: ArrayLike) -> tuple[Array, Array]:
        """Return angles and their rates at some times, each of shape (..., N)."""
        times = np.asarray(times, dtype=np.float64)
        state = np.moveaxis(self._motion(float(np.max(times)))(times), 0, -1)
        angles, rates = np.split(state, 2, axis=-1)
        return angles, rates

    def _motion(self, end: float) -> OdeSolution:
        known = self.__dict__.get("_known")
        if known is None or known.t_max < end:
            start = np.concatenate([self.angles, np.zeros(len(self._lengths))])
            span, tight = (0.0, max(end, 1e-9)), {"rtol": 1e-11, "atol": 1e-12}
            found = solve_ivp(self._slope, span, start, "DOP853", dense_output=True, **tight)
            known = self.__dict__["_known"] = found.sol
        return known

    def _places(self, angles: Array) -> Array:
        along = np.stack([np.sin(angles), -np.cos(angles)], axis=-1)
        return np.cumsum(self._lengths[:, None] * along, axis=-2)

    def _energy(self, angles: Array, rates: Array) -> float:
        across = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        velocities = np.cumsum((self._lengths * rates)[:, None] * across, axis=0)
        masses = np.asarray(self.masses, dtype=np.float64)
        motion = 0.5 * np.sum(masses * np.sum(velocities**2, axis=-1))
        return float(motion + self.gravity * np.sum(masses * self._places(angles)[:, 1]))
