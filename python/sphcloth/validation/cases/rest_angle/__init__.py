"""Hinges with rest angles of both signs, which they must hold and return to."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.rest_angle import hinge_angles
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.runner import Run, Runner

FRAMES = 20

PARAMETERS = (
    Parameter("hinges", 11, "1", "number of hinges", 3, 101),
    Parameter("largest", 150.0, "degrees", "rest angles from minus this to this", 1.0, 179.0),
    Parameter("open", 0.5, "1", "angle at first over the rest angle", -1.0, 1.15),
    Parameter("size", 0.1, "m", "length of the edge of a hinge", 1e-3, 1.0),
    Parameter("mass", 0.01, "kg", "mass of a vertex", 1e-6, 1e3),
    Parameter("model", "k", "1", "what makes hinges stiff", choices=("k", "compliance")),
    Parameter("k", 1.0, "1", "stiffness of the hinges", 0.0, 1.0),
    Parameter("compliance", 1e-3, "1/(N m)", "compliance of the hinges", 0.0, 1e6),
    Parameter("drag", 20.0, "1/s", "rate of the drag that calms the hinges", 0.0, 1e3),
    Parameter("time", 2.0, "s", "time of each run", 1e-2, 100.0),
    *cloth.solver(1e-3, 10, direction="current"),
)

QUANTITIES = (
    Quantity("held", "rad", "largest change of an angle that starts at rest", 1e-6, 1e-6),
    Quantity("returned", "rad", "largest error of an angle after a start elsewhere", 1e-6, 1e-6),
    Quantity("unfolded", "rad", "the same after a start from flat", 1e-6, 1e-6),
    Quantity("strain", "1", "largest strain of an edge in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Start at the rest angles, at a share of them, and flat."""
    rest = np.radians(np.linspace(-values["largest"], values["largest"], values["hinges"]))
    held = _angles(_run(values, runner, "held", 1.0)) - rest
    back = _run(values, runner, "returned", values["open"])
    returned = _angles(back) - rest
    unfolded = _angles(_run(values, runner, "unfolded", 0.0)) - rest
    _plot(back, returned + rest, rest, runner.picture)
    return {
        "held": float(np.max(np.abs(held))),
        "returned": float(np.max(np.abs(returned[-1]))),
        "unfolded": float(np.max(np.abs(unfolded[-1]))),
        "strain": float(back.thermo["c_strain"][-1]),
    }


def _run(values: Mapping[str, Value], runner: Runner, label: str, start: float) -> Run:
    shared = {name: values[name] for name in values if name != "time"}
    steps = cloth.stepping(values["time"], values["dt"], FRAMES)
    return runner.run(label, values["time"], shared | steps | {"open": start})


def _angles(run: Run) -> NDArray[np.float64]:
    """Return the angle of each hinge in each frame, rad, shape (frames, hinges)."""
    return np.array([hinge_angles(frame.positions.reshape(-1, 4, 3)) for frame in run.trajectory])


def _plot(run: Run, angles: NDArray, rest: NDArray, path: Path) -> None:
    """Draw the angles over time, and their error in the end."""
    figure, (motion, error) = compare.panels(1, 2)
    motion.plot(run.trajectory.times, np.degrees(angles), ".-")
    motion.set(xlabel="time (s)", ylabel="angle (degrees)")
    error.semilogy(np.degrees(rest), np.maximum(np.abs(angles[-1] - rest), 1e-17), "o")
    error.set(xlabel="rest angle (degrees)", ylabel="error in the end (rad)")
    compare.save(figure, path)


CASE = Case(
    "rest-angle",
    "hinges at rest angles of both signs: the angles",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
