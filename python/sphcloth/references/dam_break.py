"""The front of a collapsing column of water, by two experiments.

A column twice as high as wide (n^2 = 2) is set free on a dry, level floor. T = t sqrt(2 g / a) is
the time and Z = x / a the place of the front for a column of width a.

The points are some of those published: J. C. Martin and W. J. Moyce, Phil. Trans. R. Soc. A 244
(1952) 312, figure 3, n^2 = 2, a = 2.25 in; S. Koshizuka and Y. Oka, Nucl. Sci. Eng. 123 (1996) 421,
experiment, a = 0.146 m. Both as digitised in PySPH (pysph/examples/db_exp_data.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import check_positive

# largest shift in time that is allowed, in units of sqrt(a / 2 g)
LARGEST_SHIFT = 0.15
# how many shifts are tried
SHIFTS = 301

# T, Z
MARTIN_MOYCE = np.array(
    [[0.832, 1.217], [1.219, 1.474], [1.997, 2.292], [2.547, 2.995], [3.345, 4.134]]
)
KOSHIZUKA_OKA = np.array(
    [
        [0.769, 1.252],
        [1.153, 1.505],
        [1.537, 1.892],
        [1.935, 2.241],
        [2.323, 2.615],
        [2.719, 3.003],
        [3.096, 3.624],
    ]
)
EXPERIMENTS = {"Martin & Moyce 1952": MARTIN_MOYCE, "Koshizuka & Oka 1996": KOSHIZUKA_OKA}

# times T that both experiments cover
FIRST = max(points[0, 0] for points in EXPERIMENTS.values())
LAST = min(points[-1, 0] for points in EXPERIMENTS.values())
COMPARED = np.linspace(FIRST, LAST, 100)


@dataclass(frozen=True)
class Column:
    """A column of water, n^2 = 2.

    Attributes:
        width: a, m; it is 2 a high.
        gravity: acceleration, m/s^2.

    Raises:
        UserError: a value for which there is no such scene.
    """

    width: float
    gravity: float

    def __post_init__(self) -> None:
        check_positive(self, "width", "gravity")

    @property
    def time(self) -> float:
        """The time with T = 1, s."""
        return math.sqrt(self.width / (2 * self.gravity))

    @property
    def energy(self) -> float:
        """Potential energy over the floor at the start over mass, J/kg."""
        return self.gravity * self.width


def band(times: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lower and the upper of the two experiments' fronts Z at times T."""
    fronts = [np.interp(times, *points.T) for points in EXPERIMENTS.values()]
    return np.minimum(*fronts), np.maximum(*fronts)


def outside(times: NDArray, fronts: NDArray, shift: float) -> NDArray[np.float64]:
    """Return how far fronts lie outside of the band, relative to its edge: 0 inside.

    Args:
        times: T since the column was set free.
        fronts: Z at these times.
        shift: added to the times before the comparison.

    Returns:
        One value for each of ``COMPARED``, positive ahead of the band and negative behind it.
    """
    lower, upper = band(COMPARED)
    z = np.interp(COMPARED - shift, times, fronts)
    return np.maximum(z / upper - 1, 0) + np.minimum(z / lower - 1, 0)


def best_shift(times: NDArray, fronts: NDArray) -> float:
    """Return the allowed shift of time with which the fronts lie nearest to the band."""

    def distance(shift: float) -> tuple[float, float]:
        largest = np.max(np.abs(outside(times, fronts, shift)))
        return float(largest), abs(shift)

    return float(min(np.linspace(-LARGEST_SHIFT, LARGEST_SHIFT, SHIFTS), key=distance))
