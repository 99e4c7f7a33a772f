"""A column of water that drains through a sheet with pores."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.drain import DrainingColumn
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY, REST_DENSITY, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

FRAMES = 20
# time of damping at the start, in sqrt(H/g)
SETTLE = 1.5
# height, over that of the start, down to which the level is compared
LOWEST = 0.3
SHEETS = ("springs", "pinned", "plate")

PARAMETERS = (
    Parameter("height", 0.2, "m", "of the column at the start", 1e-3, 100.0),
    REST_DENSITY,
    GRAVITY,
    Parameter("rate", 1.0, "1/s", "at which it drains, rho0 g over a of Darcy", 1e-3, 1e3),
    Parameter("sound", 10.0, "sqrt(2 g H)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("sheet", "springs", "1", "what has the pores", choices=SHEETS),
    Parameter("areal", 0.1, "kg/m^2", "mass per area of the sheet", 1e-6, 1e3),
    Parameter("layers", 28, "1", "particles over the height", 8, 400, quick=24),
    Parameter("across", 8, "1", "particles over the periodic width", 8, 100),
    Parameter("most_ranks", 4, "1", "of the runs that are compared", 1, 64, quick=2),
    *numerics(alpha=0.1, courant=0.5, support=2.0),
)

QUANTITIES = (
    Quantity("darcy", "H", "rms error of the level, Darcy", 0.01, 0.01),
    Quantity("forchheimer", "H", "rms error of the level, Forchheimer", 0.01, 0.01),
    Quantity("both", "H", "rms error of the level, half of each", 0.01, 0.01),
    Quantity("largest", "H", "largest error of the level, all runs"),
    Quantity("through", "1", "volume counted in pores / fall of the level - 1", 0.01, 0.02),
    Quantity("force", "1", "impulse on the sheet / of the reference - 1"),
    *order_quantities("of the level, Darcy"),
    Quantity("ranks", "H", "distance of levels on several ranks", 0.002, 0.002),
)

NOT_IN_SCRIPT = ("rate", "most_ranks", "sound")


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run Darcy at three resolutions, the other laws at the finest one, and on several ranks."""
    laws = _laws(values)
    columns = {name: _column(values, *law) for name, law in laws.items()}
    darcy = partial(_run, values, runner, laws["darcy"])
    refined = Refinement.of(darcy, three(values["layers"], 0.6, 8))
    runs = {"darcy": refined.fine} | {
        name: _run(values, runner, law, name, values["layers"])
        for name, law in laws.items()
        if name != "darcy"
    }
    worst = {name: _error(run, columns[name]) for name, run in runs.items()}
    errors = [_error(run, columns["darcy"]) for run in refined.runs]
    _plot(runs, columns, runner.picture)
    return {
        **worst,
        "largest": max(_largest(run, columns[name]) for name, run in runs.items()),
        "through": max((_through(run) for run in runs.values()), key=abs),
        "force": max((_force(run, columns[name]) for name, run in runs.items()), key=abs),
        **refined.orders(errors),
        "ranks": _ranks(values, runner, laws["darcy"]) / values["height"],
    }


def _laws(values: Mapping[str, Value]) -> dict[str, tuple[float, float]]:
    """Return a and b of the runs: the same flux at the start by each."""
    a = values["rho0"] * values["gravity"] / values["rate"]
    b = a / (values["rate"] * values["height"])
    return {"darcy": (a, 0.0), "forchheimer": (0.0, b), "both": (0.5 * a, 0.5 * b)}


def _column(values: Mapping[str, Value], a: float, b: float) -> DrainingColumn:
    return DrainingColumn(values["height"], a, b, values["rho0"], values["gravity"])


def _run(
    values: Mapping[str, Value],
    runner: Runner,
    law: tuple[float, float],
    label: str,
    layers: int,
) -> Run:
    column = _column(values, *law)
    times = np.linspace(0.0, 10 / values["rate"], 4000)
    low = np.flatnonzero(column.levels(times) < LOWEST * values["height"])
    t_settle = SETTLE * math.sqrt(values["height"] / values["gravity"])
    t_end, clock = schemes.clock(values, t_settle + float(times[low[0]]), FRAMES, t_settle)
    sound = values["sound"] * math.sqrt(2 * values["gravity"] * values["height"])
    dropped = (*NOT_IN_SCRIPT, "gain", "layers")
    shared = {key: values[key] for key in values if key not in dropped}
    return runner.run(
        label,
        t_end,
        shared | clock | {"darcy": law[0], "forchheimer": law[1], "sound": sound, "layers": layers},
    )


def _level(run: Run) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times since the sheet lets water through, and the heights of the column, m."""
    times = run.thermo["Time"]
    return times - times[0], run.thermo["v_level"]


def _error(run: Run, column: DrainingColumn) -> float:
    times, level = _level(run)
    return compare.rms(level - column.levels(times)) / column.height


def _largest(run: Run, column: DrainingColumn) -> float:
    times, level = _level(run)
    return float(np.max(np.abs(level - column.levels(times)))) / column.height


def _through(run: Run) -> float:
    """Return the relative excess of the counted volume over that which has left the column."""
    left = (run.thermo["v_level"][0] - run.thermo["v_level"][-1]) * run.thermo["v_area"][-1]
    return float(-run.thermo["f_pores[6]"][-1] / left - 1)


def _force(run: Run, column: DrainingColumn) -> float:
    """Return the relative excess of the impulse on the sheet."""
    times, _ = _level(run)
    level = column.levels(times)
    flux = -np.gradient(level, times)
    exact = (column.darcy + column.forchheimer * flux) * flux * run.thermo["v_area"][-1]
    steps = np.diff(times)
    found = float(np.sum(-run.thermo["f_pores[3]"][1:] * steps))
    return found / float(np.sum(exact[1:] * steps)) - 1


def _ranks(values: Mapping[str, Value], runner: Runner, law: tuple[float, float]) -> float:
    """Return the largest distance of final levels from that of a run on one rank, m."""
    layers = three(values["layers"], 0.6, 8)["coarse"]
    ends = [
        _level(_run(values, each, law, label, layers))[1][-1]
        for label, each in runner.on_ranks(values["most_ranks"]).items()
    ]
    return max((abs(end - ends[0]) for end in ends[1:]), default=0.0)


def _plot(runs: Mapping[str, Run], columns: Mapping[str, DrainingColumn], path: Path) -> None:
    """Draw the level over time."""
    figure, (axes,) = compare.panels(1)
    for name, run in runs.items():
        times, level = _level(run)
        fine = np.linspace(0, times[-1], 300)
        axes.plot(fine, columns[name].levels(fine), "k-", linewidth=1)
        axes.plot(times, level, ".", markersize=3, label=f"fix cloth/pores, {name}")
    axes.set(xlabel="time (s)", ylabel="level (m)")
    axes.legend()
    compare.save(figure, path)


CASE = Case(
    "drain",
    "a column drains through pores: Darcy and Forchheimer",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
