"""Error against cost, as a figure for print and for the screen."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import (
    LogFormatterSciNotation,
    LogLocator,
    MaxNLocator,
    NullLocator,
    StrMethodFormatter,
)

from sphcloth.tradeoff.front import COSTS, Point, choices, pareto
from sphcloth.tradeoff.scene import AS_WRITTEN, Quantity
from sphcloth.tradeoff.study import Study

# colors that stay apart for all readers, and in gray (Okabe and Ito 2008); one mark each
STYLES = {
    "constant": ("#0072B2", "o"),
    "global": ("#E69F00", "s"),
    "individual": ("#CC79A7", "^"),
    "block": ("#009E73", "D"),
    AS_WRITTEN: ("#0072B2", "o"),
}
# of groups that are no schemes, in their order
OTHERS = (*list(STYLES.values())[:4], ("#D55E00", "v"), ("#56B4E9", "P"), ("#000000", "X"))
# text in an SVG stays text
SETTINGS = {"svg.fonttype": "none", "font.size": 9, "legend.fontsize": 8}
# errors above are off the scale: how wrong a run is that is all wrong does not matter
WORST = 1.0
# an axis over a smaller factor has no room for powers of ten
NARROW = 4.0


def draw(study: Study, out: Path) -> list[Path]:
    """Write one figure for each quantity, as PNG and as SVG; returns all files."""
    written = []
    with mpl.rc_context(SETTINGS):
        for quantity in study.scene.quantities:
            figure = _figure(study, quantity)
            for form in ("png", "svg"):
                written.append(out / f"{study.scene.name}-{quantity.name}.{form}")
                figure.savefig(written[-1], dpi=160)
    return written


def _figure(study: Study, quantity: Quantity) -> Figure:
    """Return error over particle updates and over wall time, side by side."""
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (cost, label) in zip(panels, COSTS.items(), strict=True):
        handles = _draw_panel(axes, study, quantity.name, cost)
        axes.set_xlabel(label)
    if study.side_by_side:
        panels[1].set_xlabel(f"{COSTS['wall_s']}, measured side by side")
    kind = f"relative error ({quantity.norm})" if study.reference else quantity.norm
    panels[0].set_ylabel(f"{quantity.description}: {kind}")
    title = f"{study.scene.name}: {study.scene.summary}"
    above = {"loc": "outside upper center", "ncols": 3, "frameon": False, "title_fontsize": 10}
    figure.legend(handles=handles, title=title, **above)
    return figure


def _draw_panel(axes: Axes, study: Study, quantity: str, cost: str) -> list[Artist]:
    """Draw all settings, the front of each scheme as a thin line, and that of all as a band.

    Returns:
        What the legend of the figure explains; the panel has one of its own.
    """
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(LogLocator(subs=(2, 5)))
        axis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(9, 9)))
    axes.grid(which="major", alpha=0.3)
    front = _visible(pareto(study.points, quantity, cost), quantity)
    axes.plot(*_curve(front, quantity, cost), color="0.8", lw=7, zorder=1, label="Pareto front")
    for scheme in dict.fromkeys(point.scheme for point in study.points):
        _draw_scheme(axes, study, scheme, quantity, cost)
    error = study.plan.error
    axes.axhline(error, color="0.4", ls=":", lw=1, label=f"error {error:g}")
    explained, _ = axes.get_legend_handles_labels()
    found = choices(study.points, quantity, cost, error)
    rings = [
        _ring(axes, choice.point, quantity, cost, _style(study, scheme)[0])
        for scheme, choice in found.items()
    ]
    _number_narrow_axes(axes)
    below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.14), "frameon": False}
    axes.legend(handles=rings, title=f"cheapest within {error:g}" if rings else None, **below)
    return explained


def _number_narrow_axes(axes: Axes) -> None:
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if high >= NARROW * low:
            continue
        axis.set_major_locator(MaxNLocator(5))
        axis.set_major_formatter(StrMethodFormatter("{x:.3g}"))
        axis.set_minor_locator(NullLocator())


def _style(study: Study, scheme: str) -> tuple[str, str]:
    """Return color and mark of a scheme, or of another group of settings."""
    groups = list(dict.fromkeys(point.scheme for point in study.points))
    return STYLES.get(scheme, OTHERS[groups.index(scheme) % len(OTHERS)])


def _draw_scheme(axes: Axes, study: Study, scheme: str, quantity: str, cost: str) -> None:
    color, mark = _style(study, scheme)
    mine = [point for point in study.points if point.scheme == scheme]
    finished = [point for point in mine if point.failure is None]
    well = _visible(finished, quantity)
    off = sum(point.errors[quantity] > WORST for point in finished)
    failed = "unstable" if study.reference else "failed"
    notes = {failed: len(mine) - len(finished), "off the scale": off}
    failures = ", ".join(f"{count} {note}" for note, count in notes.items() if count)
    label = f"{scheme} ({failures})" if failures else scheme
    axes.plot(*_curve(well, quantity, cost), mark, color=color, ms=5, label=label)
    axes.plot(*_curve(pareto(well, quantity, cost), quantity, cost), "-", color=color, lw=1)


def _ring(axes: Axes, point: Point, quantity: str, cost: str, color: str) -> Line2D:
    """Put a ring around the cheapest point of a scheme within the error."""
    ring = {"marker": "o", "ms": 11, "mfc": "none", "mec": color, "ls": ""}
    label = f"{point.scheme}: {point.label}"
    return axes.plot(point.cost(cost), point.errors[quantity], **ring, label=label)[0]


def _visible(points: list[Point], quantity: str) -> list[Point]:
    """Leave out errors off the scale, and those of 0, which a logarithmic axis cannot show."""
    return [point for point in points if 0 < point.errors[quantity] <= WORST]


def _curve(points: list[Point], quantity: str, cost: str) -> tuple[list[float], list[float]]:
    return [point.cost(cost) for point in points], [point.errors[quantity] for point in points]
