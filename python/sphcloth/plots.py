"""Plots of a run's history from its thermo output, and its pictures side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sphcloth.log import ThermoTable


def plot_history(table: ThermoTable, path: Path) -> None:
    """Write a PNG of time step and largest density deviation, one below the other, over time."""
    figure = Figure(figsize=(8, 6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    draw_time_step(upper, table)
    draw_density_deviation(lower, table)
    lower.set_xlabel("time")
    FigureCanvasAgg(figure).print_figure(path, dpi=120)


def draw_time_step(axes: Axes, table: ThermoTable) -> None:
    """Draw the time step over time; a note where none was logged."""
    axes.set_ylabel("time step")
    axes.grid(which="both", alpha=0.3)
    if "Dt" in table:
        axes.semilogy(table["Time"], table["Dt"], color="tab:blue")
    else:
        axes.text(0.5, 0.5, "no column Dt", ha="center", transform=axes.transAxes)


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
        axes.set_title(caption, fontsize=11)
    FigureCanvasAgg(figure).print_figure(path, dpi=120)
