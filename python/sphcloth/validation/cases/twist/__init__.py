"""A tube of cloth that is wrung: its rims turn against one another and approach.

The cloth is woven: threads along and around the tube do not stretch, and the diagonals of cells
give way, since a tube that is rigid in shear cannot be wrung without a stretch, with contact or
without. Edges only pull: what is pressed together has wrinkles that are finer than its mesh.
No reference: cloth does not go through itself, and threads are rigid. The limits that all scenes
share are in :mod:`sphcloth.validation.layers.contact`. The rims
approach fast enough for threads along the tube that do not stretch: for the default rates a
straight one is never longer than at rest, sqrt(distance^2 + (2 radius sin(angle / 2))^2), and what
is left over goes round the neck of packed cloth. The tube starts with the motion of its rims.
``rims`` is the error of the place of the held vertices, which turn exactly: round-off, but for
what a step that varies adds to it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact, pictures
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import tube
from sphcloth.validation.runner import Runner

PARAMETERS = (
    Parameter("radius", 0.5, "m", "of the tube", 0.01, 10.0),
    Parameter("length", 2.0, "m", "of the tube", 0.05, 100.0),
    Parameter("around", 48, "1", "vertices around the tube", 8, 1000, quick=16),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("shear", 0.01, "m/N", "compliance of the diagonals of cells", 0.0, 1e3),
    Parameter("rate", 360.0, "degrees/s", "at which each rim turns", 0.0, 1e4),
    Parameter("approach", 1.8, "m/s", "speed at which the rims approach", 0.0, 10.0),
    Parameter("damping", 20.0, "1/s", "of the edges", 0.0, 1e3),
    *contact.parameters(0.005, 1e-3, 1.0, 0.4, gravity=0.0),
)

QUANTITIES = (
    *contact.MEETINGS,
    Quantity("rims", "radius", "largest error of the place of a held vertex", 1e-6, 1e-6),
    Quantity("neck", "radius", "distance from the axis, mean over the middle row"),
    Quantity("speed", "m/s", "rms speed in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Wring the tube and look at every step."""
    variables = {
        "rate": math.radians(values["rate"]),
        "approach": values["approach"],
        "shear": values["shear"],
        "length": values["length"],
        "damping": values["damping"],
    }
    runs = contact.play(values, runner, scene(values), variables)
    pictures.side_view(runs[0], runner.picture)
    return {
        **contact.meetings(runs),
        "rims": contact.worst(runs, lambda run: _rims(run, values)) / values["radius"],
        "neck": contact.worst(runs, lambda run: _neck(run, values)) / values["radius"],
        "speed": contact.worst(runs, lambda run: run.speed()),
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return the tube along the x axis."""
    return Scene([tube(values["radius"], values["length"], values["around"], values["areal"])])


def _rims(run: contact.Scenario, values: Mapping[str, Value]) -> float:
    """Return the largest distance of a held vertex from where it should be in the end, m."""
    piece, last = run.scene.pieces[0], run.run.trajectory[-1]
    worst = 0.0
    for group, sense in ((1, 1.0), (2, -1.0)):
        held = piece.held == group
        start = piece.positions[held]
        angle = sense * math.radians(values["rate"]) * last.time
        c, s = math.cos(angle), math.sin(angle)
        x, y, z = start.T
        x = x + sense * values["approach"] / 2 * last.time
        wanted = np.stack([x, c * y - s * z, s * y + c * z], axis=1)
        distance = np.linalg.norm(last.positions[held] - wanted, axis=1)
        worst = max(worst, float(np.max(distance)))
    return worst


def _neck(run: contact.Scenario, values: Mapping[str, Value]) -> float:
    """Return the mean distance of the middle row of the tube from its axis, m."""
    rows = run.positions().reshape(-1, values["around"], 3)
    return float(np.mean(np.linalg.norm(rows[len(rows) // 2][:, 1:], axis=1)))


CASE = Case(
    "twist",
    "tube of cloth that is wrung: no intersection, rigid edges",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
