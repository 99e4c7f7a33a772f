"""Small tools that cases share: errors, orders of convergence, figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray


def rms(values: ArrayLike) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def late(times: NDArray[np.float64], share: float) -> NDArray[np.bool_]:
    """Tell which times are in the last share of a run, over which is averaged."""
    return times >= times[-1] - share * (times[-1] - times[0])


def order(errors: Sequence[float], resolutions: Sequence[float]) -> float:
    """Return the order of convergence between two runs, the coarse one first.

    Args:
        errors: of the two runs; the sign does not matter.
        resolutions: particles over the same length, or anything else that error falls with.
    """
    coarse, fine = np.abs(errors)
    if coarse == 0 or fine == 0:
        return math.nan
    return float(np.log(coarse / fine) / np.log(resolutions[1] / resolutions[0]))


def orders(errors: Sequence[float], resolutions: Sequence[float]) -> dict[str, float]:
    """Return the orders of convergence over several runs, the coarse one first.

    ``order`` is the slope of the logarithms by least squares, ``order_least`` the smallest order
    between two runs in a row; NaN where an error is zero or no number, and for a single run.

    Args:
        errors: of the runs; the sign does not matter.
        resolutions: as in :func:`order`.
    """
    if len(errors) < 2 or not (np.all(errors) and np.all(np.isfinite(errors))):
        return {"order": math.nan, "order_least": math.nan}
    slope = np.polyfit(np.log(resolutions), -np.log(np.abs(errors)), 1)[0]
    pairs = zip(pairwise(errors), pairwise(resolutions), strict=True)
    return {"order": float(slope), "order_least": min(order(*pair) for pair in pairs)}


def order_missing(orders: Mapping[str, float], wanted: float) -> float:
    """Return what the smallest of the :func:`orders` lacks to the one wanted; NaN if it is none."""
    least = orders["order_least"]
    return max(0.0, wanted - least) if math.isfinite(least) else math.nan


def tait_pressure(
    density: NDArray, rest_density: float, sound: float, gamma: float, tension: bool
) -> NDArray:
    """Return the Tait pressure; without tension a negative one counts as zero."""
    stiffness = rest_density * sound**2 / gamma
    pressure = stiffness * ((density / rest_density) ** gamma - 1)
    return pressure if tension else np.maximum(pressure, 0.0)


def panels(rows: int, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a figure and its axes, row by row, each with a grid."""
    figure = Figure(figsize=(1 + 6 * columns, 1 + 3 * rows), layout="constrained")
    axes = list(np.ravel(figure.subplots(rows, columns)))
    for each in axes:
        each.grid(alpha=0.3)
    return figure, axes


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG."""
    FigureCanvasAgg(figure).print_figure(path, dpi=120)
