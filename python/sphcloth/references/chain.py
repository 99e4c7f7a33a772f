"""Motion of a chain of rigid links, the reference of several cases.

Point masses m_i at the ends of massless rigid links hang from a fixed point. Link i has the length
l_i, the angle theta_i from the downward vertical, the direction u_i and, across it, t_i. With
tensions T_i the accelerations are a_i = g + (T_{i+1} u_{i+1} - T_i u_i) / m_i, a_0 = 0, and

    (a_i - a_{i-1}) . u_i = -l_i theta_i'^2      (a tridiagonal system for the tensions)
    (a_i - a_{i-1}) . t_i =  l_i theta_i''

The state is angles and their rates: there are no constraints to drift.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import OdeSolution, solve_ivp
from scipy.linalg import solve_banded

from sphcloth.references.checks import check_positive, since_start

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkedPendulum:
    """A chain that is released at rest.

    Attributes:
        lengths: of the links from the fixed point on, m, shape (N,).
        masses: at the outer end of each link, kg, shape (N,).
        angles: of the links from the downward vertical at the start, rad, shape (N,).
        gravity: acceleration, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    lengths: Sequence[float]
    masses: Sequence[float]
    angles: Sequence[float]
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "lengths", "masses")

    @classmethod
    def uniform(cls, links: int, length: float, angle: float, gravity: float) -> LinkedPendulum:
        """Return a straight chain of equal links and masses at an angle from the vertical."""
        return cls([length / links] * links, [1.0 / links] * links, [angle] * links, gravity)

    def positions(self, times: ArrayLike) -> Array:
        """Return x and z (upwards) of the masses at some times, shape (times, N, 2).

        Raises:
            UserError: a time before the start.
        """
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
        return np.cumsum(self._relative(angles, np.zeros_like(angles)), axis=0)

    @cached_property
    def _lengths(self) -> Array:
        return np.asarray(self.lengths, dtype=np.float64)

    @cached_property
    def _inverse_masses(self) -> Array:
        """1 / m of the fixed point, which is 0, and of the masses, shape (N + 1,)."""
        return np.concatenate([[0.0], 1 / np.asarray(self.masses, dtype=np.float64)])

    def _relative(self, angles: Array, rates: Array) -> Array:
        """Return a_i - a_{i-1}, shape (N, 2)."""
        along = np.stack([np.sin(angles), -np.cos(angles)], axis=-1)
        w = self._inverse_masses
        fall = np.zeros_like(along)
        fall[0, 1] = -self.gravity
        beside = np.cos(np.diff(angles)) * w[1:-1]
        bands = np.zeros((3, len(angles)))
        bands[0, 1:], bands[1], bands[2, :-1] = beside, -(w[:-1] + w[1:]), beside
        right = -self._lengths * rates**2 - np.sum(fall * along, axis=-1)
        pulls = solve_banded((1, 1), bands, right)[:, None] * along
        forces = np.concatenate([pulls, np.zeros((1, 2))]) - np.concatenate(
            [np.zeros((1, 2)), pulls]
        )
        return fall + np.diff(w[:, None] * forces, axis=0)

    def _angular_acceleration(self, angles: Array, rates: Array) -> Array:
        across = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        return np.sum(self._relative(angles, rates) * across, axis=-1) / self._lengths

    def _slope(self, _: float, state: Array) -> Array:
        angles, rates = np.split(state, 2)
        return np.concatenate([rates, self._angular_acceleration(angles, rates)])

    def _state(self, times: ArrayLike) -> tuple[Array, Array]:
        """Return angles and their rates at some times, each of shape (..., N)."""
        times = since_start(self, times)
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
