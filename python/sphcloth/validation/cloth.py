"""What the cases with cloth share: parameters of the solver, steps and frames."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sphcloth.validation.case import Parameter, Value
from sphcloth.validation.runner import Run

SOLVERS = ("gs", "jacobi", "substeps")
DIRECTIONS = ("current", "start")
ITERATIONS = Parameter(
    "iterations", 0, "1", "sweeps, or substeps, in a step; 0: as the fix chooses", 0, 100_000
)


def solver(
    dt: float,
    iterations: int,
    *,
    method: str = "gs",
    direction: str = "start",
    quick_dt: float | None = None,
    quick_iterations: int | None = None,
) -> tuple[Parameter, ...]:
    """Return the parameters of fix pbd/cloth; their names are those of the scripts' variables.

    Args:
        dt: default of the time step, s.
        iterations: default of the sweeps or substeps in a step; 0: as the fix chooses.
        method: default of what the iterations are.
        direction: default of the direction in which edges are projected.
        quick_dt: time step with ``--quick``.
        quick_iterations: sweeps or substeps with ``--quick``.
    """
    return (
        Parameter("dt", dt, "s", "time step", 1e-7, 0.1, quick=quick_dt),
        dataclasses.replace(ITERATIONS, default=iterations, quick=quick_iterations),
        Parameter("solver", method, "1", "what the iterations are", choices=SOLVERS),
        Parameter("direction", direction, "1", "of the projection", choices=DIRECTIONS),
        Parameter("tolerance", 0.0, "1", "error that ends the sweeps", 0.0, 1.0),
    )


def substep(values: Mapping[str, Value]) -> float:
    """Return the time between two projections of positions that start anew, s."""
    divided = values["iterations"] if values["solver"] == "substeps" else 1
    return values["dt"] / divided


def first_kick(values: Mapping[str, Value]) -> float:
    """Return the share of the forces that acts in the first step."""
    return 0.5 if values["direction"] == "start" else 1.0


def stepping(time: float, largest: float, frames: int = 1) -> dict[str, Value]:
    """Return time step and steps per frame such that frames and steps end at a time exactly.

    Args:
        time: of the run, s.
        largest: time step that is not exceeded.
        frames: number of frames after the first.
    """
    every = max(1, int(np.ceil(time / frames / largest - 1e-9)))
    return {"dt": time / (frames * every), "every": every}


def frames_near(time: float, largest: float, wanted: int) -> int:
    """Return a number of frames near the one wanted for which :func:`stepping` hardly rounds."""
    every = max(1, int(time / wanted / largest + 1e-9))
    return max(1, int(np.ceil(time / every / largest - 1e-9)))


def energies(run: Run, mass: float, gravity: float) -> NDArray[np.float64]:
    """Return kinetic and potential energy of all vertices in each frame, J."""
    found = []
    for frame in run.trajectory:
        motion = 0.5 * np.sum(frame.velocities**2)
        found.append(mass * (motion + gravity * np.sum(frame.positions[:, 2])))
    return np.array(found)
