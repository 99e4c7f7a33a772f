"""Sheets one above another that fall on a ball, two corners of each held.

No reference: what holds is that cloth does not go through cloth or ball, that the energy of
falling is not exceeded, and that edges are rigid. The limits that all scenes share are in
:mod:`sphcloth.validation.layers.contact`. The sheets only fall, so that their energy never exceeds
that at the start but for what the half step between positions and velocities makes of it, gravity
times a step times the speed, below a thousandth of the fall.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact, pictures
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import Piece, ball, sheet
from sphcloth.validation.runner import Runner

PARAMETERS = (
    Parameter("sheets", 5, "1", "number of sheets", 1, 50, quick=3),
    Parameter("across", 32, "1", "vertices along a side of a sheet", 4, 400, quick=10),
    Parameter("side", 2.0, "m", "of a sheet", 0.1, 100.0),
    Parameter("radius", 0.5, "m", "of the ball", 0.01, 10.0),
    Parameter("gap", 0.05, "m", "between the sheets, and above the ball", 1e-4, 1.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area of a sheet", 1e-4, 1e3),
    *contact.parameters(0.005, 1e-3, 1.0, 0.25),
)

QUANTITIES = (
    *contact.MEETINGS,
    Quantity("growth", "1", "largest gain of energy over m g radius", 1e-3, 1e-3),
    Quantity("inside", "thickness", "depth of a vertex in the ball", 0.5, 0.5),
    Quantity("speed", "m/s", "rms speed in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Let the sheets fall and look at every step."""
    runs = contact.play(values, runner, scene(values), {}, obstacle="obstacles")
    fall = values["gravity"], values["radius"]
    pictures.side_view(runs[0], runner.picture)
    return {
        **contact.meetings(runs),
        "growth": contact.worst(runs, lambda run: contact.growth(run, *fall)),
        "inside": contact.worst(runs, lambda run: _depth(run, values)) / values["thickness"],
        "speed": contact.worst(runs, lambda run: run.speed()),
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return sheets above a ball in the origin, the lowest one a gap above it."""
    bottom = values["radius"] + values["gap"]
    sheets = [_held(values, bottom + n * values["gap"]) for n in range(values["sheets"])]
    edge = values["side"] / (values["across"] - 1)
    return Scene([*sheets, ball(values["radius"], edge, 0.0)])


def _held(values: Mapping[str, Value], height: float) -> Piece:
    """Return a sheet, the two ends of one side of which are held."""
    level = sheet(values["side"], values["across"], height, values["areal"])
    level.held[[0, values["across"] - 1]] = 1
    return level


def _depth(run: contact.Scenario, values: Mapping[str, Value]) -> float:
    """Return how far a vertex ever is inside the smallest ball in the obstacle's mesh, m."""
    obstacle = run.scene.pieces[-1]
    inner = np.min(np.linalg.norm(obstacle.positions[obstacle.triangles].mean(axis=1), axis=1))
    moving = run.scene.moving
    nearest = min(
        np.min(np.linalg.norm(frame.positions[:moving], axis=1)) for frame in run.run.trajectory
    )
    return max(0.0, inner - nearest)


CASE = Case(
    "drape",
    "sheets that fall on a ball: no intersection",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
