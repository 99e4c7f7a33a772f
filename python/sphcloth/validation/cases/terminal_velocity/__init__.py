"""A level sheet that falls through air at rest, and a light one that a storm blows up."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.terminal_velocity import FallingSheet
from sphcloth.validation import air, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

FRAMES = 40
ORDER = 1.8
# time of the fall, in those in which gravity alone gives the terminal velocity
FALL = 4.0
# steps of the light sheet, in steps of the case
LONGER, LIGHT_STEPS = 10.0, 100

PARAMETERS = (
    Parameter("length", 0.5, "m", "side of the sheet", 1e-2, 100.0),
    Parameter("cells", 6, "1", "along a side", 1, 200, quick=3),
    Parameter("light", 0.01, "kg/m^2", "mass per area of the light sheet", 1e-5, 1e3),
    Parameter("storm", 50.0, "m/s", "wind that blows the light sheet up", 0.1, 1e3),
    *air.parameters(1e-3, 0.2),
)

QUANTITIES = (
    Quantity("terminal", "1", "velocity in the end / reference - 1", 0.01, 0.01),
    Quantity("terminal_reference", "m/s", "terminal velocity"),
    Quantity("approach", "1", "largest error of the fall over the fall", 0.01, 0.01),
    *order_quantities("in dt of that error"),
    Quantity("order_missing", "1", "what the order lacks to 1.8", 0.0, 0.0),
    Quantity("flat", "1", "largest difference of heights over the side", 0.01, 0.01),
    Quantity("energy", "1", "error of the work of the air over that of the weight", 0.01, 0.01),
    Quantity("storm", "1", "velocity of the light sheet / reference - 1", 0.01, 0.01),
    Quantity("beyond", "1", "how far it ever is beyond the wind, over the wind", 0.0, 0.0),
    Quantity("ranks", "1", "distance of runs with several ranks over the side", 1e-9, 1e-9),
)

DROPPED = ("light", "storm")


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run the fall with three time steps, and the light sheet with long ones."""
    sheet = _reference(values, values["areal"])
    falls = [
        _fall({**values, "dt": share * values["dt"]}, runner, label)
        for label, share in air.STEPS.items()
    ]
    errors = [_fall_error(run, sheet) for run in falls]
    orders = compare.orders(errors, [1 / share for share in air.STEPS.values()])
    storm, beyond = _storm(values, runner)
    _plot(falls, sheet, runner.picture)
    return {
        "terminal": _last_velocity(falls[-1], sheet),
        "terminal_reference": sheet.terminal,
        "approach": errors[-1],
        **orders,
        "order_missing": compare.order_missing(orders, ORDER),
        "flat": max(float(np.ptp(frame.positions[:, 2])) for frame in falls[-1].trajectory)
        / values["length"],
        "energy": _energy(falls[-1], sheet),
        "storm": storm,
        "beyond": beyond,
        "ranks": air.ranks(values, runner, lambda by, label: _fall(values, by, label))
        / values["length"],
    }


def _reference(values: Mapping[str, Value], areal: float) -> FallingSheet:
    return FallingSheet(areal, values["air"], values["normal"], values["gravity"])


def _fall(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    time = FALL * _reference(values, values["areal"]).terminal / values["gravity"]
    return air.run_for(values, runner, label, time, FRAMES, DROPPED)


def _heights(run: Run) -> NDArray[np.float64]:
    """Return the mean height in each frame, m."""
    return np.array([frame.positions[:, 2].mean() for frame in run.trajectory])


def _fall_error(run: Run, sheet: FallingSheet) -> float:
    exact = sheet.fall(run.trajectory.times)
    return float(np.max(np.abs(_heights(run) + exact)) / exact[-1])


def _last_velocity(run: Run, sheet: FallingSheet) -> float:
    """Return the error of the mean velocity between the last two frames."""
    exact = np.diff(sheet.fall(run.trajectory.times[-2:]))
    return float((-np.diff(_heights(run)[-2:]) / exact)[0]) - 1


def _energy(run: Run, sheet: FallingSheet) -> float:
    """Return the error of the work of the air, from the exact fall and velocity."""
    table = run.thermo
    time, weight = float(table["Time"][-1]), float(table["v_weight"][-1])
    fall, v = sheet.fall(np.array([time]))[0], sheet.velocity(np.array([time]))[0]
    exact = weight * (0.5 * v * v / sheet.gravity - fall)
    return float(table["f_air[5]"][-1] - exact) / (weight * fall)


def _storm(values: Mapping[str, Value], runner: Runner) -> tuple[float, float]:
    """Return the errors of the velocity of the light sheet, in the end and beyond the wind."""
    light = {**values, "areal": values["light"], "wind": values["storm"]}
    light["dt"] = LONGER * values["dt"]
    run = air.run_for(light, runner, "storm", LIGHT_STEPS * light["dt"], LIGHT_STEPS, DROPPED)
    rising = np.diff(_heights(run)) / np.diff(run.trajectory.times)
    exact = values["storm"] - _reference(values, values["light"]).terminal
    beyond = max(0.0, float(np.max(rising)) / values["storm"] - 1)
    return float(rising[-1]) / exact - 1, beyond


def _plot(runs: list[Run], sheet: FallingSheet, path: Path) -> None:
    """Draw the velocity, and the error of the fall over time."""
    figure, (velocity, error) = compare.panels(1, 2)
    times = np.linspace(0, runs[-1].trajectory.times[-1], 300)
    velocity.plot(times, sheet.velocity(times), "k-", label="exact")
    for run in runs:
        at = run.trajectory.times
        heights = _heights(run)
        label = f"dt {run.thermo['Dt'][0]:.3g} s"
        velocity.plot(0.5 * (at[1:] + at[:-1]), -np.diff(heights) / np.diff(at), ".", label=label)
        error.semilogy(at[1:], np.abs(heights + sheet.fall(at))[1:], label=label)
    velocity.set(xlabel="time (s)", ylabel="velocity of the fall (m/s)")
    velocity.legend()
    error.set(xlabel="time (s)", ylabel="error of the fall (m)")
    error.legend()
    compare.save(figure, path)


CASE = Case(
    "terminal-velocity",
    "fall of a sheet through air: v = u tanh(g t / u)",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
