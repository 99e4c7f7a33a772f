"""A mass on one compliant constraint against the eigenvalue of implicit Euler."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.xpbd_oscillator import Oscillator
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

# sweeps of the second run, in those of the first
MORE = 10
# runs of the order of convergence: eighths of a step in half a period
REFINED = (32, 64, 128)

PARAMETERS = (
    Parameter("mass", 1.0, "kg", "mass", 1e-6, 1e6),
    Parameter("compliance", 1e-3, "m/N", "compliance alpha", 1e-12, 1e3),
    Parameter("length", 1.0, "m", "length at rest", 0.1, 10.0),
    Parameter("start", 0.5, "length", "elongation at first", 0.01, 0.9),
    Parameter("steps", 300, "1", "number of steps", 1, 100_000),
    *cloth.solver(1 / 60, 1),
)

QUANTITIES = (
    Quantity("motion", "start", "largest error of the elongation", 1e-12, 1e-12),
    Quantity("motion_more", "start", "the same with ten times the iterations", 1e-12, 1e-12),
    Quantity("magnitude", "1", "of the eigenvalue of a (sub)step"),
    Quantity("numerical", "start", "largest distance from the oscillator without steps"),
    *order_quantities("in dt of that distance"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run few and more iterations, and for the order three smaller steps."""
    run = _run(values, runner, "few")
    more = {**values, "iterations": MORE * values["iterations"]}
    _plot(run, values, runner.picture)
    finer = [
        _distance(_run(each, runner, f"order_{refined}"), each)
        for refined in REFINED
        for each in [_finer(values, refined)]
    ]
    return {
        "motion": _error(run, values),
        "motion_more": _error(_run(more, runner, "more"), more),
        "magnitude": abs(_oscillator(values).eigenvalue),
        "numerical": _distance(run, values),
        **compare.orders(finer, REFINED),
    }


def _finer(values: Mapping[str, Value], refined: int) -> dict[str, Value]:
    """Return the values for half a period in small steps of that period."""
    half_period = np.pi / _oscillator(values).omega
    steps = 8 * refined
    return {**values, "dt": float(half_period / steps), "steps": steps}


def _oscillator(values: Mapping[str, Value]) -> Oscillator:
    return Oscillator(values["mass"], values["compliance"], cloth.substep(values))


def _run(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    shared = {name: values[name] for name in values if name != "steps"}
    start = {"start": values["start"] * values["length"]}
    return runner.run(label, values["steps"] * values["dt"], shared | start | {"every": 1})


def _elongation(run: Run, values: Mapping[str, Value]) -> NDArray[np.float64]:
    """Return the elongation in each frame over the first one."""
    x = np.array([frame.positions[1, 0] for frame in run.trajectory])
    return (x - values["length"]) / (values["start"] * values["length"])


def _substeps(run: Run, values: Mapping[str, Value]) -> NDArray[np.int64]:
    divided = values["iterations"] if values["solver"] == "substeps" else 1
    return run.trajectory.steps * divided


def _error(run: Run, values: Mapping[str, Value]) -> float:
    exact = _oscillator(values).motion(1.0, _substeps(run, values))
    return float(np.max(np.abs(_elongation(run, values) - exact)))


def _distance(run: Run, values: Mapping[str, Value]) -> float:
    exact = _oscillator(values).exact(1.0, _substeps(run, values))
    return float(np.max(np.abs(_elongation(run, values) - exact)))


def _plot(run: Run, values: Mapping[str, Value], path: Path) -> None:
    """Draw the elongation over time, and its error."""
    figure, (motion, error) = compare.panels(1, 2)
    substeps, times = _substeps(run, values), run.trajectory.times
    exact = _oscillator(values).motion(1.0, substeps)
    motion.plot(times, exact, "k-", label="eigenvalue")
    motion.plot(times, _elongation(run, values), ".", label="fix pbd/cloth")
    motion.set(xlabel="time (s)", ylabel="elongation / first elongation")
    motion.legend()
    error.plot(times, _elongation(run, values) - exact)
    error.set(xlabel="time (s)", ylabel="error of the elongation / first elongation")
    compare.save(figure, path)


CASE = Case(
    "xpbd-oscillator",
    "a mass on a compliant constraint: implicit Euler",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
