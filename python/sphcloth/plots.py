"""Plots of a run's history from its thermo output."""

from __future__ import annotations

from pathlib import Path

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
    """Draw the time step over time."""
    axes.semilogy(table["Time"], table["Dt"], color="tab:blue")
    axes.set_ylabel("time step")
    axes.grid(which="both", alpha=0.3)


def draw_density_deviation(axes: Axes, table: ThermoTable) -> None:
    """Draw the largest density deviation in percent over time; a note where none was logged."""
    axes.set_ylabel("largest density deviation (%)")
    axes.grid(alpha=0.3)
    if "v_deviation" in table:
        axes.plot(table["Time"], 100 * table["v_deviation"], color="tab:red")
    else:
        axes.text(0.5, 0.5, "no column v_deviation", ha="center", transform=axes.transAxes)
