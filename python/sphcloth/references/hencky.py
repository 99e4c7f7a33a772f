"""A flat circular membrane, held at its rim, that a pressure bulges.

Young's modulus times thickness E, Poisson's ratio nu, radius a, pressure p; N is the radial force
per width and w the deflection. Equilibrium along the axis, p r / 2 = -N w', and the condition that
strains belong to a deflection,

    r (N_r + N_t)' + E w'^2 / 2 = 0,

go with N_t = (r N)', for small loads (Hencky 1915), or N_t = (r N)' - p r w', where the pressure
turns with the membrane (Fichter 1997). The rim does not move: N_t = nu N there.

Both are for small slopes and strains. Without these limits a net of linear springs in all
directions has the energy W = 3/2 E <(l - 1)^2> per area at rest, where l is the stretch of a
direction at the angle t to the radius, l^2 = l_r^2 cos^2 t + l_t^2 sin^2 t: of Poisson's ratio
1/3 where strains are small. With T_r = dW/dl_r, T_t = dW/dl_t, r(R) and z(R), equilibrium is

    R T_r sin(psi) = -p r^2 / 2,    (R T_r cos(psi))' = T_t + p r z'.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.optimize import brentq

from sphcloth.references.checks import check_positive, within

START = 1e-4  # radius, of the membrane's, where the integration begins


@dataclass(frozen=True)
class PressurizedMembrane:
    """The membrane.

    Attributes:
        radius: a, m.
        pressure: p, Pa.
        modulus: Young's modulus times thickness, N/m.
        ratio: Poisson's.
        turns: whether the pressure turns with the membrane.

    Raises:
        UserError: a number that is not positive.
    """

    radius: float
    pressure: float
    modulus: float
    ratio: float = 1 / 3
    turns: bool = True

    def __post_init__(self) -> None:
        check_positive(self, "radius", "pressure", "modulus", "ratio")

    @property
    def load(self) -> float:
        """p a / E, without a unit."""
        return self.pressure * self.radius / self.modulus

    @cached_property
    def _solution(self) -> NDArray[np.float64]:
        """Radii over a, forces over E and deflections over a."""
        middle = brentq(self._slip, *self._bracket(), xtol=1e-14, rtol=1e-13)
        r, force = self._forces(middle)
        slope = -self.load * r / (2 * force)
        w = cumulative_trapezoid(slope, r, initial=0.0)
        return np.stack([r, force, w - w[-1]])

    def _bracket(self) -> tuple[float, float]:
        size = self.load ** (2 / 3)
        return 0.2 * size, 2.0 * size

    def _forces(self, middle: float) -> tuple[NDArray, NDArray]:
        """Integrate from the middle, where the force over E is given."""
        q = self.load

        def rate(r: float, state: NDArray) -> list[float]:
            force, slope = state
            bend = q * r / (2 * force)  # -w'
            more = 0.0
            if self.turns:  # r (q^2 r^2 / (2 N))'
                more = q**2 * (r**2 / force - r**3 * slope / (2 * force**2))
            return [slope, -(3 * r * slope + 0.5 * bend**2 + more) / r**2]

        first = -(q**2) * (1 / (64 * middle**2) + (0.125 / middle if self.turns else 0.0))
        start = [middle + first * START**2, 2 * first * START]
        r = np.concatenate([[START], np.linspace(0, 1, 2001)[1:]])
        solved = solve_ivp(rate, (START, 1), start, "DOP853", r, rtol=1e-11, atol=1e-16)
        self.__dict__["_end"] = solved.y[:, -1]
        return solved.t, solved.y[0]

    def _slip(self, middle: float) -> float:
        """Return the strain of the rim for a force in the middle."""
        self._forces(middle)
        force, slope = self.__dict__["_end"]
        around = force + slope + (self.load**2 / (2 * force) if self.turns else 0.0)
        return float(around - self.ratio * force)

    @property
    def height(self) -> float:
        """Of the middle over the rim, m."""
        return float(self.radius * self._solution[2, 0])

    @property
    def middle_force(self) -> float:
        """Per width in the middle, N/m."""
        return float(self.modulus * self._solution[1, 0])

    @property
    def volume(self) -> float:
        """Between the membrane and the plane of its rim, m^3."""
        r, _, w = self._solution
        return float(2 * np.pi * self.radius**3 * np.trapezoid(r * w, r))

    def deflection(self, r: ArrayLike) -> NDArray[np.float64]:
        """Return the deflection at some radii, m.

        Raises:
            UserError: a radius beyond the rim.
        """
        known, _, w = self._solution
        r = within(self, "r", r, 0.0, self.radius, "the rim")
        return self.radius * np.interp(r / self.radius, known, w)


ANGLES = (np.arange(24) + 0.5) * np.pi / 48
COS_SQ, SIN_SQ = np.cos(ANGLES) ** 2, np.sin(ANGLES) ** 2


@dataclass(frozen=True)
class PressurizedNet:
    """A net of springs that a pressure bulges, with any slope and strain.

    Attributes:
        radius: a, m.
        pressure: p, Pa.
        modulus: Young's modulus times thickness for small strains, N/m.

    Raises:
        UserError: a number that is not positive.
    """

    radius: float
    pressure: float
    modulus: float

    def __post_init__(self) -> None:
        check_positive(self, "radius", "pressure", "modulus")

    @cached_property
    def _profile(self) -> NDArray[np.float64]:
        """Radii at rest, radii and heights over the radius of the rim."""
        size = (self.pressure * self.radius / self.modulus) ** (2 / 3)
        bracket = 1 + 0.05 * size, 1 + 1.5 * size
        middle = brentq(lambda stretch: self._integrate(stretch)[1][-1] - 1, *bracket, xtol=1e-14)
        at, r, z = self._integrate(middle)
        return np.stack([at, r, z - z[-1]])

    def _integrate(self, middle: float) -> tuple[NDArray, NDArray, NDArray]:
        """Integrate from the middle, where the stretch is given; forces are over the modulus."""
        load = self.pressure * self.radius / self.modulus

        def rate(at: float, state: NDArray) -> list[float]:
            r, force, _ = state
            down = -load * r**2 / 2
            along = _stretch(np.hypot(force, down) / at, r / at)
            angle = np.arctan2(down, force)
            slope = along * np.sin(angle)
            around = _tensions(along, r / at)[1]
            return [along * np.cos(angle), around + load * r * slope, slope]

        start = [middle * START, START * _tensions(middle, middle)[0], 0.0]
        at = np.concatenate([[START], np.linspace(0, 1, 1001)[1:]])
        solved = solve_ivp(rate, (START, 1), start, "DOP853", at, rtol=1e-10, atol=1e-14)
        return solved.t, solved.y[0], solved.y[2]

    @property
    def height(self) -> float:
        """Of the middle over the rim, m."""
        return float(self.radius * self._profile[2, 0])

    def deflection(self, r: ArrayLike) -> NDArray[np.float64]:
        """Return the height over the rim at some radii, those of the bulged net, m.

        Raises:
            UserError: a radius beyond the rim.
        """
        _, known, z = self._profile
        r = within(self, "r", r, 0.0, self.radius, "the rim")
        return self.radius * np.interp(r / self.radius, known, z)


def _tensions(along: float, around: float) -> tuple[float, float]:
    """Return the derivatives of the energy by both stretches, over the modulus."""
    stretch = np.sqrt(along**2 * COS_SQ + around**2 * SIN_SQ)
    share = 3 * (1 - 1 / stretch)
    return float(along * np.mean(share * COS_SQ)), float(around * np.mean(share * SIN_SQ))


def _stretch(tension: float, around: float) -> float:
    """Return the stretch along the radius that has a tension."""
    return float(brentq(lambda along: _tensions(along, around)[0] - tension, 0.5, 3.0, xtol=1e-14))
