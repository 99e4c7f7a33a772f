"""Shape and distance from the curve with several couplings, drawn of finished runs.

``python -m sphcloth.validation.cases.lintearia.modes FOLDER ... --out PICTURE`` takes the folders
that ``sphcloth validate lintearia --out FOLDER`` has written, one column for each ``mode``.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sphcloth.validation.case import Value
from sphcloth.validation.cases.lintearia import Pool, curve_of, pool_of, resolutions
from sphcloth.validation.runner import Run

# colors of the runs of one mode, the coarsest first
COLORS = ("tab:orange", "tab:blue", "tab:green", "tab:red")


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(prog="python -m sphcloth.validation.cases.lintearia.modes")
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=Path("lintearia_modes.png"))
    given = parser.parse_args(arguments)
    draw(given.folders, given.out)


def draw(folders: Sequence[Path], path: Path) -> None:
    """Draw the pools of all folders; those of one mode share a column."""
    modes: dict[str, list[Path]] = {}
    values = {folder: _values(folder) for folder in folders}
    for folder in folders:
        modes.setdefault(str(values[folder]["mode"]), []).append(folder)
    figure = Figure(figsize=(1 + 4.5 * len(modes), 6.5), layout="constrained")
    columns = figure.subplots(2, len(modes), sharey="row", squeeze=False).T
    for (shape, error), (mode, chosen) in zip(columns, modes.items(), strict=True):
        # the same size in two folders is drawn once
        runs = {across: run for each in chosen for across, run in _runs(each, values[each])}
        _column(shape, error, runs, values[chosen[0]])
        shape.set(title=mode, xlabel="x (m)", aspect="equal", adjustable="box")
        error.set(xlabel="length along the sheet (m)")
    columns[0, 0].set_ylabel("z (m)")
    columns[0, 1].set_ylabel("distance from the curve (mm)")
    FigureCanvasAgg(figure).print_figure(path, dpi=90, bbox_inches="tight")


def _values(folder: Path) -> dict[str, Value]:
    """Return the parameters with which a folder was made."""
    return json.loads((folder / "lintearia.json").read_text(encoding="utf-8"))["parameters"]


def _runs(folder: Path, values: Mapping[str, Value]) -> list[tuple[int, tuple[Run, Pool]]]:
    """Return particles over L -> output and mean shape of the two runs of a folder."""
    runs = []
    for label, across in resolutions(values).items():
        run = Run(folder / label, "lintearia")
        runs.append((across, (run, pool_of(run, values, across))))
    return runs


def _column(
    shape: Axes, error: Axes, runs: Mapping[int, tuple[Run, Pool]], values: Mapping[str, Value]
) -> None:
    """Draw the sheets with the water of the finest, and the distances of all from the curve."""
    exact = curve_of(values)
    finest = max(runs)
    run, pool = runs[finest]
    water = run.trajectory[-1].select(1).positions
    shape.plot(water[:, 0], water[:, 2] - pool.pins, ".", ms=1, color="tab:gray")
    curve = exact.shape(pool.arc) - [0.0, exact.sag]
    shape.plot(*curve.T, "k-", lw=0.8, label="exact")
    level = exact.depth - exact.sag
    wet = curve[curve[:, 1] < level, 0]
    shape.plot([wet[0], wet[-1]], [level, level], "k-", lw=0.8)
    for (across, (_, each)), color in zip(sorted(runs.items()), COLORS, strict=False):
        label = f"{across} over L"
        shape.plot(*each.sheet.T, "o", ms=3, mfc="none", color=color, label=label)
        error.plot(each.arc, 1e3 * each.distances(exact), color=color, label=label)
    for axes in (shape, error):
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small", loc="upper center")


if __name__ == "__main__":
    main()
