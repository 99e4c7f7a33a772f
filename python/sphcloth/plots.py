"""Plots of a run's history from its thermo output, and its pictures side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sphcloth.log import ThermoTable
from sphcloth.rendering.movie import COMPRESSION

# of a share: particles that were poured between two rows count as if they were there all the time
ROUNDING = 0.05


def plot_history(table: ThermoTable, path: Path) -> None:
    """Write a PNG of time step and largest density deviation, one below the other, over time.

    Where particles have steps of their own their active share is drawn beside the step, as in
    figure 4 of the paper.
    """
    figure = Figure(figsize=(8, 6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    draw_time_step(upper, table)
    draw_active_share(upper, table)
    draw_density_deviation(lower, table)
    lower.set_xlabel("time")
    _write(figure, path)


def draw_time_step(axes: Axes, table: ThermoTable) -> None:
    """Draw the time step over time; a note where none was logged."""
    axes.set_ylabel("time step")
    axes.grid(which="both", alpha=0.3)
    if "Dt" in table:
        axes.semilogy(table["Time"], table["Dt"], color="tab:blue")
    else:
        axes.text(0.5, 0.5, "no column Dt", ha="center", transform=axes.transAxes)


def active_share(table: ThermoTable) -> NDArray[np.float64] | None:
    """Return the mean share of active particles since the row before, shape (rows - 1,).

    None without the columns ``v_updates`` and ``v_fluid``. NaN where there was no step or no fluid.
    """
    if "v_updates" not in table or "v_fluid" not in table:
        return None
    possible = np.diff(table["Step"]) * table["v_fluid"][1:]
    updates = np.diff(table["v_updates"])
    return np.divide(updates, possible, out=np.full_like(possible, np.nan), where=possible > 0)


def draw_active_share(axes: Axes, table: ThermoTable) -> None:
    """Draw the active share in percent on an axis of its own; nothing if all always are active."""
    share = active_share(table)
    if share is None or not (share < 1 - ROUNDING).any():
        return
    right = axes.twinx()
    right.set_ylabel("active particles (%)")
    right.set_ylim(0, 105)
    right.step(table["Time"][1:], 100 * share, where="pre", color="tab:orange", linewidth=1)


def draw_density_deviation(axes: Axes, table: ThermoTable) -> None:
    """Draw the largest density deviation in percent over time; a note where none was logged."""
    axes.set_ylabel("largest density deviation (%)")
    axes.grid(alpha=0.3)
    if "v_deviation" in table:
        axes.plot(table["Time"], 100 * table["v_deviation"], color="tab:red")
    else:
        axes.text(0.5, 0.5, "no column v_deviation", ha="center", transform=axes.transAxes)


def contact_sheet(pictures: Sequence[Path], captions: Sequence[str], path: Path) -> None:
    """Put pictures with captions side by side, three in a row, on one PNG."""
    columns = min(3, len(pictures))
    rows = -(-len(pictures) // columns)
    figure = Figure(figsize=(4.8 * columns, 3.8 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, picture, caption in zip(grid.flat, pictures, captions, strict=False):
        axes.imshow(image.imread(picture))
        # a height that is given need not be found from ticks
        axes.set_title(caption, fontsize=11, y=1.0)
    _write(figure, path)


def _write(figure: Figure, path: Path) -> None:
    options = {"compress_level": COMPRESSION}
    FigureCanvasAgg(figure).print_figure(path, dpi=120, pil_kwargs=options)
