"""The lintearia: a sheet without stiffness that holds a pool of water between two level pins.

Without weight the sheet has one tension T. With l^2 = T / (rho g) the angle of the sheet obeys the
equation of a pendulum, theta'' = -sin(theta) / l^2, below the water line, and it is straight above.
With phi the angle at the water line and k = sin(phi / 2),

    area A = 2 l^2 sin(phi),   depth = 2 k l,   wetted length = 2 l K(k),
    l (2 E(k) - K(k)) + (L / 2 - l K(k)) cos(phi) = D / 2.

A sheet of weight w per area has (T cos, T sin)' = (-p sin, p cos + w) along its length, integrated
from the bottom.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root
from scipy.special import ellipe, ellipeinc, ellipj, ellipk

from sphcloth.errors import UserError
from sphcloth.references.checks import check, check_finite, check_positive, within

# angles at the water line among which the root is looked for
_ANGLES = np.linspace(1e-4, math.pi - 1e-4, 2000)

# relative error of span and area that is left
_CLOSE = 1e-8


@dataclass(frozen=True)
class Lintearia:
    """A sheet that weighs nothing.

    Attributes:
        length: length L of the sheet, m.
        span: distance D of the pins, m.
        area: cross-section A of the water, m^2.
        rho0: density of the water, kg/m^3.
        gravity: acceleration g, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    length: float
    span: float
    area: float
    rho0: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "length", "span", "area", "rho0", "gravity")

    @cached_property
    def angle(self) -> float:
        """Angle phi of the sheet at the water line and above, rad.

        Raises:
            UserError: the sheet is too short for the water, or for the distance of the pins.
        """
        if self.span < self.length:
            excess = self._excess(_ANGLES)
            for at in np.flatnonzero(excess[:-1] * excess[1:] <= 0):
                return float(brentq(self._excess, _ANGLES[at], _ANGLES[at + 1], xtol=1e-15))
        raise UserError(
            f"a sheet of {self.length:g} m on pins {self.span:g} m apart cannot hold "
            f"{self.area:g} m^2: take L larger, or A or D smaller"
        )

    @property
    def scale(self) -> float:
        """Length l, m."""
        return float(self._scale(self.angle))

    @property
    def modulus(self) -> float:
        """Modulus k of the elliptic functions."""
        return math.sin(self.angle / 2)

    @property
    def tension(self) -> float:
        """Tension of the sheet per width, N/m."""
        return self.rho0 * self.gravity * self.scale**2

    @property
    def depth(self) -> float:
        """Depth of the water, m."""
        return 2 * self.modulus * self.scale

    @property
    def wet(self) -> float:
        """Length of the sheet from the bottom to the water line, m."""
        return float(self.scale * ellipk(self.modulus**2))

    @property
    def sag(self) -> float:
        """Depth of the bottom below the pins, m."""
        return self.depth + (self.length / 2 - self.wet) * math.sin(self.angle)

    @property
    def lift(self) -> float:
        """Vertical force of one pin per width, N/m."""
        return self.rho0 * self.gravity * self.area / 2

    def shape(self, arc: ArrayLike) -> NDArray[np.float64]:
        """Return x and z, shape (N, 2), at lengths along the sheet; 0 is the bottom, z = 0.

        Raises:
            UserError: a length beyond the pins.
        """
        arc = _between_pins(self, arc, self.length)
        wet = np.minimum(np.abs(arc), self.wet)
        dry = np.abs(arc) - wet
        _, cosine, _, amplitude = ellipj(wet / self.scale, self.modulus**2)
        x = 2 * self.scale * ellipeinc(amplitude, self.modulus**2) - wet
        z = self.depth * (1 - cosine)
        x, z = x + dry * math.cos(self.angle), z + dry * math.sin(self.angle)
        return np.stack([np.sign(arc) * x, z], axis=-1)

    def _scale(self, angle: ArrayLike) -> NDArray[np.float64]:
        return np.sqrt(self.area / (2 * np.sin(angle)))

    def _excess(self, angle: ArrayLike) -> NDArray[np.float64]:
        """Return x of the end of the sheet less D / 2; NaN where it is too short for the water."""
        scale, square = self._scale(angle), np.sin(np.asarray(angle) / 2) ** 2
        dry = self.length / 2 - scale * ellipk(square)
        x = scale * (2 * ellipe(square) - ellipk(square)) + dry * np.cos(angle)
        return np.where(dry >= 0, x - self.span / 2, np.nan)


@dataclass(frozen=True)
class HeavyLintearia:
    """A sheet with weight.

    Attributes:
        light: length, pins and water.
        areal: mass of the sheet per area, kg/m^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    light: Lintearia
    areal: float

    def __post_init__(self) -> None:
        check_finite(self)
        check(self, "areal", self.areal >= 0, "it must not be negative")

    @property
    def tension(self) -> float:
        """Tension at the bottom per width, N/m."""
        return float(self._state(0.0)[2])

    @property
    def depth(self) -> float:
        """Depth of the water, m."""
        return self._solution[0]

    @property
    def sag(self) -> float:
        """Depth of the bottom below the pins, m."""
        return float(self._state(self.light.length / 2)[1])

    @property
    def lift(self) -> float:
        """Vertical force of one pin per width, N/m."""
        return self.light.lift + self.areal * self.light.gravity * self.light.length / 2

    def shape(self, arc: ArrayLike) -> NDArray[np.float64]:
        """Return x and z, shape (N, 2), at lengths along the sheet; 0 is the bottom, z = 0.

        Raises:
            UserError: a length beyond the pins.
        """
        x, z = self._state(arc)[:2]
        return np.stack([np.sign(arc) * x, z], axis=-1)

    def pull(self, arc: ArrayLike) -> NDArray[np.float64]:
        """Return the tension per width at lengths along the sheet, N/m.

        Raises:
            UserError: a length beyond the pins.
        """
        return np.hypot(*self._state(arc)[2:4])

    def _state(self, arc: ArrayLike) -> NDArray[np.float64]:
        """Return x, z, horizontal and vertical pull, and the area so far, at lengths from 0."""
        return self._solution[1](np.abs(_between_pins(self, arc, self.light.length)))

    @cached_property
    def _solution(self) -> tuple[float, Callable[[ArrayLike], NDArray[np.float64]]]:
        """The depth and the curve for which span and area are right."""
        light = self.light

        def missing(unknown: NDArray) -> list[float]:
            end = self._sweep(unknown[0] * light.depth, unknown[1] * light.tension)
            x, area = end(light.length / 2)[[0, 4]]
            return [2 * x / light.span - 1, 2 * area / light.area - 1]

        found = root(missing, [1.0, self.lift / light.lift], tol=1e-12)
        if np.max(np.abs(found.fun)) > _CLOSE:
            raise UserError(f"no shape of a sheet of {self.areal:g} kg/m^2: take areal smaller")
        depth, tension = found.x * [light.depth, light.tension]
        return float(depth), self._sweep(depth, tension)

    def _sweep(self, depth: float, tension: float) -> Callable[[ArrayLike], NDArray[np.float64]]:
        """Return the right half of the sheet for a depth and a tension at the bottom."""
        light = self.light
        specific, weight = light.rho0 * light.gravity, self.areal * light.gravity

        def rate(_: float, state: NDArray) -> list[float]:
            cosine, sine = state[2:4] / np.hypot(*state[2:4])
            below = max(depth - state[1], 0.0)
            push = specific * below
            return [cosine, sine, -push * sine, push * cosine + weight, below * cosine]

        start = [0.0, 0.0, tension, 0.0, 0.0]
        step = light.length / 400
        return solve_ivp(
            rate,
            (0, light.length / 2),
            start,
            "DOP853",
            rtol=1e-10,
            max_step=step,
            dense_output=True,
        ).sol


def _between_pins(sheet: object, arc: ArrayLike, length: float) -> NDArray[np.float64]:
    """Return lengths along a sheet from its middle as float64; UserError beyond the pins."""
    return within(sheet, "arc", arc, -length / 2, length / 2, "from pin to pin; 0 is the middle")
