"""A chain of rigid links that swings from level, and a single link at any amplitude."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sphcloth.references.chain import LinkedPendulum
from sphcloth.references.pendulum import pendulum_period
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

# time steps of the runs of the order of convergence, in that of the case
STEPS = {"coarse": 4.0, "middle": 2.0, "fine": 1.0}
ORDER = 1.9
FRAMES = 200

PARAMETERS = (
    Parameter("links", 3, "1", "links N of the chain that starts level", 1, 50),
    Parameter("length", 1.0, "m", "length L of the chain", 1e-2, 100.0),
    Parameter("mass", 1.0, "kg", "mass of the chain, at the outer ends of the links", 1e-6, 1e6),
    Parameter("angle", 90.0, "degrees", "amplitude of the single link", 1.0, 170.0),
    GRAVITY,
    Parameter("time", 1.0, "s", "time over which the chain is followed", 0.1, 10.0),
    *cloth.solver(5e-4, 50),
)

QUANTITIES = (
    Quantity("period", "1", "period of the single link / reference - 1", 1e-4, 1e-4),
    Quantity("period_reference", "s", "4 sqrt(L / g) K(sin^2(A / 2))"),
    Quantity("path", "L", "largest distance of the chain's tip from its path", 1e-2, 1e-2),
    Quantity("tip", "L", "the same in the end"),
    Quantity("energy", "1", "largest change of the energy over m g L"),
    Quantity("strain", "1", "largest strain in the end"),
    *order_quantities("in dt of the path"),
    Quantity("order_missing", "1", "what the order lacks to 1.9", 0.0, 0.0),
    Quantity("order_period", "1", "order in dt of the period"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run one link and the chain with three time steps each."""
    expected = pendulum_period(values["length"], values["gravity"], math.radians(values["angle"]))
    single = {**values, "links": 1, "time": 1.05 * expected}
    swings = [
        run_pendulum(coarser(single, n), runner, f"period_{label}") for label, n in STEPS.items()
    ]
    periods = [_period(run) / expected - 1 for run in swings]
    level = {**values, "angle": 90.0}
    runs = [run_pendulum(coarser(level, n), runner, label) for label, n in STEPS.items()]
    errors = [path_errors(run, values) for run in runs]
    largest = [float(np.max(error)) for error in errors]
    orders = compare.orders(largest, _rates(runs))
    _plot(runs, errors, values, runner.picture)
    return {
        "period": periods[-1],
        "period_reference": expected,
        "path": largest[-1],
        "tip": float(errors[-1][-1]),
        "energy": _energy(runs[-1], values),
        "strain": float(runs[-1].thermo["c_strain"][-1]),
        **orders,
        "order_missing": compare.order_missing(orders, ORDER),
        "order_period": compare.orders(periods, _rates(swings))["order"],
    }


def _rates(runs: list[Run]) -> list[float]:
    """Return the steps per time."""
    return [1 / float(run.thermo["Dt"][-1]) for run in runs]


def coarser(values: Mapping[str, Value], share: float) -> dict[str, Value]:
    """Return the parameters with so many times the time step."""
    return {**values, "dt": share * values["dt"]}


def run_pendulum(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    """Run the script over ``time``."""
    shared = {name: values[name] for name in values if name != "time"}
    frames = cloth.frames_near(values["time"], values["dt"], FRAMES)
    steps = cloth.stepping(values["time"], values["dt"], frames)
    return runner.run(label, values["time"], shared | steps)


def path_errors(run: Run, values: Mapping[str, Value]) -> NDArray[np.float64]:
    """Return the distance of the tip from its exact place in each frame, in L."""
    exact = _chain(values).positions(run.trajectory.times)[:, -1]
    return np.linalg.norm(_tip(run) - exact, axis=1) / values["length"]


def _chain(values: Mapping[str, Value]) -> LinkedPendulum:
    links, length, gravity = (values[name] for name in ("links", "length", "gravity"))
    return LinkedPendulum.uniform(links, length, math.pi / 2, gravity)


def _tip(run: Run) -> NDArray[np.float64]:
    """Return x and z of the last mass in each frame, m."""
    return np.array([frame.positions[-1, [0, 2]] for frame in run.trajectory])


def _period(run: Run) -> float:
    """Return twice the time between the first two passages of the vertical, s."""
    x, z = _tip(run).T
    passages = CubicSpline(run.trajectory.times, np.arctan2(x, -z)).roots(extrapolate=False)
    return 2 * float(passages[1] - passages[0]) if len(passages) > 1 else math.nan


def _energy(run: Run, values: Mapping[str, Value]) -> float:
    """Return the largest energy, of either sign, over m g L; at first it is 0.

    Velocities belong to half a step before the positions: they are interpolated to their times.
    """
    frames, times = list(run.trajectory), run.trajectory.times
    lag = 0.5 * cloth.substep({**values, "dt": float(run.thermo["Dt"][-1])})
    speeds = np.array([frame.velocities for frame in frames])
    speeds = CubicSpline([0.0, *(times[1:] - lag)], speeds)(times[1:-1])
    heights = np.array([frame.positions[:, 2] for frame in frames[1:-1]])
    motion = 0.5 * np.sum(speeds**2, axis=(1, 2))
    energy = motion + values["gravity"] * np.sum(heights, axis=1)
    return float(np.max(np.abs(energy))) / (values["links"] * values["gravity"] * values["length"])


def _plot(runs: list[Run], errors: list[NDArray], values: Mapping[str, Value], path: Path) -> None:
    """Draw the path of the tip, and its error over time."""
    figure, (path_of_tip, error) = compare.panels(1, 2)
    exact = _chain(values).positions(np.linspace(0, values["time"], 500))[:, -1]
    path_of_tip.plot(*exact.T, "k-", label="exact")
    path_of_tip.plot(*_tip(runs[-1]).T, ".", ms=3, label="fix pbd/cloth")
    path_of_tip.set(xlabel="x (m)", ylabel="z (m)", aspect="equal")
    path_of_tip.legend()
    for run, each in zip(runs, errors, strict=True):
        error.semilogy(run.trajectory.times[1:], each[1:], label=f"dt {run.thermo['Dt'][0]:.3g} s")
    error.set(xlabel="time (s)", ylabel="distance of the tip from its path (L)")
    error.legend()
    compare.save(figure, path)


CASE = Case(
    "pendulum",
    "one link and a chain of links: equations of motion",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
