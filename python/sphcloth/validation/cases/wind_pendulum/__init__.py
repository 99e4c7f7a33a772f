"""A sheet that hangs in a wind: its angle at rest, and how a plate swings there."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.wind_pendulum import WindPendulum
from sphcloth.validation import air, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

FRAMES = 60
# A triangle expects its own push, not that of its neighbors: an error of first order where these
# differ, as in a single row of cells, and small.  Cloth whose steps change is of first order.
ORDER, ORDER_OF_CHANGING_STEPS = 1.5, 0.5
WINDS = 3

PARAMETERS = (
    Parameter("length", 0.5, "m", "of the sheet", 1e-2, 100.0),
    Parameter("rows", 8, "1", "cells along the length", 1, 200, quick=4),
    Parameter("columns", 4, "1", "cells along the edges", 1, 200, quick=2),
    Parameter("slowest", 2.0, "m/s", "least wind", 0.1, 100.0),
    Parameter("fastest", 8.0, "m/s", "largest wind", 0.1, 100.0),
    Parameter("rest", 6.0, "s", "time in which the sheet comes to rest", 0.1, 1e3, quick=4.0),
    Parameter("swing", 0.5, "s", "time over which the plate is followed", 0.01, 10.0),
    *air.parameters(2e-3, 0.2, ceiling=1.0),
)

QUANTITIES = (
    Quantity("angle", "1", "angle of the sheet at rest / reference - 1, the worst", 0.01, 0.01),
    Quantity("angle_reference", "degrees", "at the largest wind"),
    Quantity("force", "1", "error of the force of the air over that force, the worst", 0.01, 0.01),
    Quantity("held", "1", "error of the force of the pins over that and the weight", 0.01, 0.01),
    Quantity("bent", "1", "largest distance from a plane over the length", 0.01, 0.01),
    Quantity("swing", "1", "largest error of the angle of the plate over that at rest", 0.01, 0.01),
    *order_quantities("in dt of that error"),
    Quantity(
        "order_missing", "1", "what the order lacks to 1.5, to 0.5 with changing steps", 0.0, 0.0
    ),
    Quantity("ranks", "1", "distance of runs with several ranks over the length", 1e-9, 1e-9),
)

DROPPED = ("slowest", "fastest", "rest", "swing")


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run all winds to rest, and the plate with three time steps."""
    winds = np.geomspace(values["slowest"], values["fastest"], WINDS)
    sheets = [_reference(values, wind) for wind in winds]
    runs = [_rest(values, runner, wind) for wind in winds]
    found = [_angle(run) for run in runs]
    plates = [
        _swing({**values, "dt": share * values["dt"]}, runner, label)
        for label, share in air.STEPS.items()
    ]
    errors = [_swing_error(run, sheets[-1], values) for run in plates]
    orders = compare.orders(errors, [1 / share for share in air.STEPS.values()])
    wanted = ORDER if values["scheme"] == "constant" else ORDER_OF_CHANGING_STEPS
    pairs = list(zip(found, sheets, strict=True))
    forces = [_forces(run, sheet) for run, sheet in zip(runs, sheets, strict=True)]
    _plot(plates[-1], sheets, found, values, runner.picture)
    return {
        "angle": max((angle / sheet.angle - 1 for angle, sheet in pairs), key=abs),
        "angle_reference": float(np.degrees(sheets[-1].angle)),
        "force": max(force for force, _ in forces),
        "held": max(held for _, held in forces),
        "bent": max(_bent(run) for run in runs) / values["length"],
        "swing": errors[-1],
        **orders,
        "order_missing": compare.order_missing(orders, wanted),
        "ranks": air.ranks(values, runner, lambda by, label: _swing(values, by, label))
        / values["length"],
    }


def _reference(values: Mapping[str, Value], wind: float) -> WindPendulum:
    names = ("areal", "air", "normal", "tangential", "gravity")
    return WindPendulum(float(wind), *(values[name] for name in names))


def _rest(values: Mapping[str, Value], runner: Runner, wind: float) -> Run:
    shared = {**values, "wind": float(wind), "stiff": 1}
    return air.run_for(shared, runner, f"wind_{wind:.3g}", values["rest"], FRAMES, DROPPED)


def _swing(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    """Run a plate of one row of cells that does not bend, in the largest wind."""
    shared = {**values, "wind": values["fastest"], "rows": 1, "columns": 1, "stiff": 1}
    return air.run_for(shared, runner, label, values["swing"], FRAMES, DROPPED)


def _lower(positions: NDArray[np.float64], rows: NDArray[np.bool_]) -> float:
    """Return the angle of the lower edge below the upper one, which is at height 0, rad."""
    x, _, z = positions[rows].mean(axis=0)
    return float(np.arctan2(x, -z))


def _lowest(run: Run) -> NDArray[np.bool_]:
    z = run.trajectory[0].positions[:, 2]
    return z < z.min() + 1e-6 * np.ptp(z)


def _angle(run: Run) -> float:
    """Return the mean angle in the last third of the frames, rad."""
    rows, frames = _lowest(run), list(run.trajectory)
    return float(np.mean([_lower(frame.positions, rows) for frame in frames[-FRAMES // 3 :]]))


def _bent(run: Run) -> float:
    """Return the largest distance of a vertex from the plane through both edges, m."""
    positions = run.trajectory[-1].positions
    theta = _lower(positions, _lowest(run))
    return float(np.max(np.abs(positions[:, [0, 2]] @ [np.cos(theta), np.sin(theta)])))


def _forces(run: Run, sheet: WindPendulum) -> tuple[float, float]:
    """Return the errors of the force of the air and of the pins, over these forces."""
    table = run.thermo
    last = slice(-max(1, len(table["Time"]) // 3), None)
    weight = float(table["v_weight"][-1])
    expected = sheet.pressure * weight / (sheet.areal * sheet.gravity)
    pins = -expected + [0.0, weight]
    found = np.array([np.mean(table[f"f_air[{k}]"][last]) for k in (1, 3)])
    held = np.array([np.mean(table[f"c_force[{k}]"][last]) for k in (1, 3)])
    return (
        float(np.linalg.norm(found - expected) / np.linalg.norm(expected)),
        float(np.linalg.norm(held - pins) / np.linalg.norm(pins)),
    )


def _angles(run: Run) -> NDArray[np.float64]:
    rows = _lowest(run)
    return np.array([_lower(frame.positions, rows) for frame in run.trajectory])


def _swing_error(run: Run, sheet: WindPendulum, values: Mapping[str, Value]) -> float:
    exact = sheet.swing(values["length"], run.trajectory.times)
    return float(np.max(np.abs(_angles(run) - exact))) / sheet.angle


def _plot(
    plate: Run,
    sheets: list[WindPendulum],
    found: list[float],
    values: Mapping[str, Value],
    path: Path,
) -> None:
    """Draw the angle over the wind, and the swing of the plate."""
    figure, (rest, swing) = compare.panels(1, 2)
    winds = np.linspace(1e-3, 1.1 * values["fastest"], 100)
    exact = [np.degrees(_reference(values, wind).angle) for wind in winds]
    rest.plot(winds, exact, "k-", label="drag balances weight")
    rest.plot([sheet.wind for sheet in sheets], np.degrees(found), "o", label="fix cloth/air")
    rest.set(xlabel="wind (m/s)", ylabel="angle at rest (degrees)")
    rest.legend()
    times = plate.trajectory.times
    fine = np.linspace(0, times[-1], 300)
    swing.plot(fine, np.degrees(sheets[-1].swing(values["length"], fine)), "k-", label="exact")
    swing.plot(times, np.degrees(_angles(plate)), ".", label="fix cloth/air")
    swing.set(xlabel="time (s)", ylabel="angle of the plate (degrees)")
    swing.legend()
    compare.save(figure, path)


CASE = Case(
    "wind-pendulum",
    "angle of a sheet hung in wind: drag balances weight",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
