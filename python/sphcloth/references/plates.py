"""Start-up of flow between two plates: series that decay, and images at the start.

The series solutions are those of Morris, Fox and Zhu, J. Comput. Phys. 136 (1997) 214. Their terms
decay as exp(-n^2 pi^2 nu t / gap^2), which at the start is not at all. There the plates are mirrors
of the flow at a single plate (method of images: Carslaw and Jaeger, Conduction of Heat in Solids,
1959), in terms of distances over s = 2 sqrt(nu t).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.references.checks import since_start, within

# of the series, enough from EARLY on
TERMS = 10
# time, in gap^2 / nu, up to which images are summed; both sums are exact to rounding there
EARLY = 0.1
IMAGES = np.arange(4)

Array = NDArray[np.float64]
# of heights in gaps, shape (..., 1), and a time in gap^2 / nu
Sum = Callable[[Array, float], Array]


class Flow(Protocol):
    """Fluid between two plates."""

    @property
    def gap(self) -> float:
        """Distance of the plates, m."""

    @property
    def nu(self) -> float:
        """Kinematic viscosity, m^2/s."""


def start_up(flow: Flow, y: ArrayLike, t: float, images: Sum, series: Sum) -> Array:
    """Return the sum that is exact at a time, shape of ``y``.

    Args:
        flow: which one.
        y: heights above the lower plate.
        t: time since the start.
        images: the sum at the start.
        series: the sum later on.

    Raises:
        UserError: a height outside of the plates, or a time before the start.
    """
    y = within(flow, "y", y, 0.0, flow.gap, "between the plates")
    time = float(since_start(flow, t, {()})) * flow.nu / flow.gap**2
    return (images if time < EARLY else series)(y[..., np.newaxis] / flow.gap, time)


def reach(time: float) -> float:
    """Return s over the gap; at the start a distance over it is none, or larger than any."""
    return 2 * np.sqrt(max(time, np.finfo(np.float64).tiny))
