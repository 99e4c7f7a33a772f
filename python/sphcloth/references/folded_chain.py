"""A chain that hangs folded from two points close together and is let go at one of them.

Without loss of energy, and as the links become small, the free end has the speed
v^2 = 2 g x (1 - x / 2L) / (1 - x / L) after it fell by x (Calkin and March, Am. J. Phys. 57 (1989)
154). It falls faster than freely; the time until x = L over that of free fall is

    (1/2) int_0^1 sqrt((1 - u) / (u (1 - u / 2))) du = 0.847213
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from sphcloth.references.chain import LinkedPendulum


@cache
def fall_over_free_fall() -> float:
    """Return the time of the fall over that of free fall, for a chain of no thickness."""
    return quad(lambda s: math.sqrt((1 - s**2) / (1 - s**2 / 2)), 0, 1, epsabs=1e-13)[0]


def free_fall(length: float, gravity: float) -> float:
    """Return the time in which a body falls freely by a length, s."""
    return math.sqrt(2 * length / gravity)


def folded(links: int, length: float, gravity: float) -> LinkedPendulum:
    """Return the chain of an odd number of links: half down, one across, half up."""
    leg = (links - 1) // 2
    angles = [0.0] * leg + [math.pi / 2] + [math.pi] * leg
    return LinkedPendulum([length / links] * links, [1.0] * links, angles, gravity)


def time_of_fall(chain: LinkedPendulum) -> float:
    """Return when the free end is lowest for the first time, s."""
    expected = fall_over_free_fall() * free_fall(float(np.sum(chain.lengths)), chain.gravity)
    times = np.linspace(0.0, 1.15 * expected, 1151)
    first = times[first_lowest(chain.positions(times)[:, -1, 1])]
    step = times[1]
    found = minimize_scalar(
        lambda t: float(chain.positions(t)[-1, 1]),
        bounds=(first - step, first + step),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return float(found.x)


def first_lowest(heights: np.ndarray) -> int:
    """Return the index of the first minimum, or the last index if there is none."""
    rising = np.flatnonzero(np.diff(heights) > 0)
    return int(rising[0]) if len(rising) else len(heights) - 1
