"""A sheet of springs, held at some vertices, with a liquid at rest in it.

At rest the energy of springs, weight of the vertices and liquid has a minimum,

    E = sum_e (l_e - L_e)^2 / (2 A_e) + sum_v m_v g z_v + rho g integral of (s^2 - z^2)/2 da_z,

where the last integral is over the part of the sheet below the level s of the liquid, a_z is the
area seen from above, and s follows from the volume, V = integral of (s - z) da_z.  The derivative
of the liquid's energy at constant V is the hydrostatic pressure rho g (s - z) on the sheet.
Bending is left out.  The minimum is found by Newton's method with the positive part of the
springs' stiffness (Teran et al. 2005) and the stiffness of the liquid's level.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from sphcloth.errors import UserError
from sphcloth.references.checks import check_positive

# a triangle is cut into this many times as many for the integrals over its wet part
CUTS = 6
# largest force that is left on a vertex that moves, over the weight of liquid and sheet
BALANCED = 1e-6
STEPS = 2000
# a step is no longer than this share of the longest edge
REACH = 0.25


@dataclass(frozen=True)
class AtRest:
    """The equilibrium.

    Attributes:
        positions: of the vertices, m, shape (V, 3).
        level: height of the liquid, m.
        lift: vertical force of the held vertices on the sheet, N.
        residual: largest force that is left on a vertex that moves, N.
    """

    positions: NDArray[np.float64]
    level: float
    lift: float
    residual: float

    @property
    def bottom(self) -> float:
        """Height of the lowest vertex, m."""
        return float(np.min(self.positions[:, 2]))

    @property
    def depth(self) -> float:
        """Depth of the liquid over the lowest vertex, m."""
        return self.level - self.bottom


@dataclass(frozen=True)
class FilledSheet:
    """A sheet and what is in it.

    Attributes:
        edges: vertices of each edge, shape (E, 2).
        lengths: of the edges without load, m, shape (E,).
        compliance: of each edge, m/N.
        triangles: vertices of each triangle, counter-clockwise seen from above, shape (T, 3).
        held: whether a vertex is held, shape (V,).
        mass: of a vertex, kg.
        volume: of the liquid, m^3.
        rho: its density, kg/m^3.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    edges: NDArray[np.int64]
    lengths: NDArray[np.float64]
    compliance: float
    triangles: NDArray[np.int64]
    held: NDArray[np.bool_]
    mass: float
    volume: float
    rho: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "compliance", "mass", "volume", "rho", "gravity")

    @property
    def weight(self) -> float:
        """Weight of the liquid and of the vertices, N; that of the held ones is in it."""
        return (self.rho * self.volume + self.mass * len(self.held)) * self.gravity

    def at_rest(self, start: NDArray[np.float64]) -> AtRest:
        """Return the equilibrium next to a shape.

        Args:
            start: positions of all vertices, m, shape (V, 3); those of the held ones stay.

        Raises:
            UserError: the liquid runs over, or no equilibrium was found.
        """
        x, energy = start.copy(), self._energy(start)
        for _ in range(STEPS):
            force = self._force(x)
            residual = float(np.max(np.linalg.norm(force[~self.held], axis=1)))
            if residual <= BALANCED * self.weight:
                return self._result(x, force, residual)
            step = self._newton(x, force)
            x, energy = self._descend(x, step, force, energy)
        raise UserError(f"the sheet is not at rest: {residual:.3g} N are left after {STEPS} steps")

    def _result(self, x: NDArray, force: NDArray, residual: float) -> AtRest:
        lift = -float(np.sum(force[self.held, 2]))
        return AtRest(x, self._level(x), lift, residual)

    def _descend(
        self, x: NDArray, step: NDArray, force: NDArray, energy: float
    ) -> tuple[NDArray[np.float64], float]:
        """Go along a step, half as far until the energy falls as it should (Armijo)."""
        gain, share = float(np.sum(force * step)), 1.0
        while share > 1e-12:
            there = x + share * step
            lower = self._energy(there)
            if lower <= energy - 1e-4 * share * gain + 1e-14 * abs(energy):
                return there, lower
            share /= 2
        raise UserError("the sheet is not at rest: its energy falls along no direction")

    def _newton(self, x: NDArray, force: NDArray) -> NDArray[np.float64]:
        """Return the Newton step of the vertices that move."""
        free = np.repeat(~self.held, 3)
        matrix = self._stiffness(x)[free][:, free]
        step = np.zeros(x.size)
        step[free] = splu(csc_array(matrix)).solve(force.ravel()[free])
        step = step.reshape(-1, 3)
        longest = float(np.max(np.linalg.norm(step, axis=1)))
        return step * min(1.0, REACH * float(np.max(self.lengths)) / longest)

    # springs

    def _springs(self, x: NDArray) -> tuple[NDArray, NDArray]:
        """Return length and direction of each edge."""
        along = x[self.edges[:, 1]] - x[self.edges[:, 0]]
        length = np.linalg.norm(along, axis=1)
        return length, along / length[:, None]

    def _stiffness(self, x: NDArray) -> coo_array:
        """Return the positive part of the springs' stiffness and that of the liquid, N/m."""
        length, n = self._springs(x)
        sideways = np.maximum(0.0, 1 - self.lengths / length)[:, None, None]
        outer = n[:, :, None] * n[:, None, :]
        block = (outer + sideways * (np.eye(3) - outer)) / self.compliance
        first, second = (3 * self.edges[:, k, None] + np.arange(3) for k in (0, 1))
        rows, columns, values = [], [], []
        for a, b, sign in (
            (first, first, 1),
            (second, second, 1),
            (first, second, -1),
            (second, first, -1),
        ):
            rows.append(np.repeat(a, 3, axis=1).ravel())
            columns.append(np.tile(b, (1, 3)).ravel())
            values.append(sign * block.ravel())
        size = x.size
        springs = coo_array(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size)
        )
        return springs.tocsr() + diags_array(np.full(size, self._ground(x)))

    def _ground(self, x: NDArray) -> float:
        """Return the stiffness of the liquid's level per vertex, N/m; it keeps steps finite."""
        area = np.sum(np.abs(self._areas(x))) / len(self.held)
        return self.rho * self.gravity * float(area)

    # liquid

    @cached_property
    def _points(self) -> NDArray[np.float64]:
        """Weights of the corners at the centers of the pieces of a triangle, shape (Q, 3)."""
        third = 1 / (3 * CUTS)
        up = [(3 * i + 1, 3 * j + 1) for i in range(CUTS) for j in range(CUTS - i)]
        down = [(3 * i + 2, 3 * j + 2) for i in range(CUTS - 1) for j in range(CUTS - 1 - i)]
        pair = third * np.array(up + down)
        return np.column_stack([1 - pair.sum(axis=1), pair])

    def _areas(self, x: NDArray) -> NDArray[np.float64]:
        """Return the area of each triangle seen from above; where it is upside down, negative."""
        a, b, c = (x[self.triangles[:, k], :2] for k in range(3))
        u, v = b - a, c - a
        return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2

    def _heights(self, x: NDArray) -> NDArray[np.float64]:
        return x[self.triangles, 2] @ self._points.T

    def _level(self, x: NDArray) -> float:
        """Return the height of the liquid."""
        piece = self._areas(x)[:, None] / len(self._points)
        heights = self._heights(x)

        def excess(level: float) -> float:
            return float(np.sum(piece * np.maximum(0.0, level - heights))) - self.volume

        low, high = float(heights.min()), float(np.min(x[self.held, 2]))
        if excess(high) < 0:
            raise UserError(
                f"volume = {self.volume:g} m^3: the sheet holds {excess(high) + self.volume:.4g}, "
                "the rest runs over the held vertices"
            )
        return float(brentq(excess, low, high, xtol=1e-14))

    def _energy(self, x: NDArray) -> float:
        level, heights = self._level(x), self._heights(x)
        column = np.where(heights < level, level**2 - heights**2, 0.0) / 2
        liquid = self.rho * np.sum(self._areas(x) * np.mean(column, axis=1))
        length, _ = self._springs(x)
        springs = np.sum((length - self.lengths) ** 2) / (2 * self.compliance)
        return float(springs + self.gravity * (self.mass * np.sum(x[:, 2]) + liquid))

    def _force(self, x: NDArray) -> NDArray[np.float64]:
        """Return the force on each vertex, minus the derivative of the energy."""
        length, n = self._springs(x)
        pull = ((length - self.lengths) / self.compliance)[:, None] * n
        force = np.zeros_like(x)
        np.add.at(force, self.edges[:, 0], pull)
        np.add.at(force, self.edges[:, 1], -pull)
        force[:, 2] -= self.mass * self.gravity
        self._add_pressure(x, force)
        return force

    def _add_pressure(self, x: NDArray, force: NDArray) -> None:
        over = np.maximum(0.0, self._level(x) - self._heights(x))
        weight = self.rho * self.gravity
        # through the heights of the corners, and through the area seen from above
        down = weight * self._areas(x)[:, None] * (over @ self._points) / len(self._points)
        spread = weight * np.mean(over**2, axis=1) / 2
        for k in range(3):
            corner, second, third = (self.triangles[:, (k + n) % 3] for n in range(3))
            side = (x[third, :2] - x[second, :2]) / 2
            np.add.at(force[:, 2], corner, -down[:, k])
            np.add.at(force[:, 0], corner, -spread * side[:, 1])
            np.add.at(force[:, 1], corner, spread * side[:, 0])
