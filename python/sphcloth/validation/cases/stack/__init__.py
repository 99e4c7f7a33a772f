"""Sheets one above another that fall on a floor, and a heavy ball that falls on them.

The ball is a closed cloth whose hinges keep its shape, and a free body: its weight is a load that
the layers can always bear, whereas a ball that a fix drives down would ask for the impossible
where nothing can give way. No reference: cloth does not go through cloth or floor, no energy is
gained, and the layers below the ball are not squeezed. The limits that all scenes share are in
:mod:`sphcloth.validation.layers.contact`. Under the ball there are as many gaps as there are
sheets, one of them to the floor, and one to the ball; ``squeezed`` is what is missing of them
together in the end, with the same limit as that of one gap.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact, pictures
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import ball, plate, sheet
from sphcloth.validation.runner import Runner

# the floor is larger than the sheets by so much
MARGIN = 1.5

PARAMETERS = (
    Parameter("sheets", 5, "1", "number of sheets", 1, 100, quick=3),
    Parameter("across", 20, "1", "vertices along a side of a sheet", 4, 400, quick=9),
    Parameter("side", 1.0, "m", "of a sheet", 0.1, 100.0),
    Parameter("gap", 0.02, "m", "between sheets, to the floor and to the ball", 1e-4, 1.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area of a sheet", 1e-4, 1e3),
    Parameter("radius", 0.15, "m", "of the ball", 0.01, 10.0),
    Parameter("load", 10.0, "1", "mass of the ball over that of a sheet", 1e-3, 1e4),
    *contact.parameters(0.005, 1e-3, 1.0, 0.3, friction=0.3),
)

QUANTITIES = (
    *contact.MEETINGS,
    Quantity("growth", "1", "largest gain of energy over m g radius", 1e-3, 1e-3),
    Quantity("below", "thickness", "by which a vertex is too near to the floor", 0.5, 0.5),
    Quantity("squeezed", "1", "missing of the thicknesses below the ball in the end", 0.5, 0.5),
    Quantity("speed", "m/s", "rms speed in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Let all fall and look at every step."""
    runs = contact.play(values, runner, scene(values), {}, obstacle="obstacles")
    fall = values["gravity"], values["radius"]
    pictures.side_view(runs[0], runner.picture)
    return {
        **contact.meetings(runs),
        "growth": contact.worst(runs, lambda run: contact.growth(run, *fall)),
        "below": contact.worst(runs, lambda run: _below(run, values)),
        "squeezed": contact.worst(runs, lambda run: _squeezed(run, values)),
        "speed": contact.worst(runs, lambda run: run.speed()),
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return sheets above a floor at z = 0, each turned by a little, and a ball above them."""
    gap, side, sheets = values["gap"], values["side"], values["sheets"]
    layers = [
        sheet(side, values["across"], (n + 1) * gap, values["areal"], turned=0.1 * n)
        for n in range(sheets)
    ]
    edge = side / (values["across"] - 1)
    height = (sheets + 1) * gap + values["radius"]
    area = 4 * np.pi * values["radius"] ** 2
    heavy = values["load"] * values["areal"] * side**2 / area
    body = ball(values["radius"], edge, height, heavy, is_obstacle=False)
    # at ends of a turned sheet the floor is still there
    wide = MARGIN * side
    return Scene([*layers, body, plate(wide, round(wide / edge) + 1, 0.0)])


def _below(run: contact.Scenario, values: Mapping[str, Value]) -> float:
    """Return by how much a vertex ever is nearer to the floor than the thickness, over it."""
    moving = run.scene.moving
    lowest = min(np.min(frame.positions[:moving, 2]) for frame in run.run.trajectory)
    return max(0.0, 1 - lowest / values["thickness"])


def _squeezed(run: contact.Scenario, values: Mapping[str, Value]) -> float:
    """Return what is missing of the height of the ball's lowest vertex over that of all gaps."""
    of_ball = run.scene.parts == values["sheets"]
    lowest = float(np.min(run.positions()[of_ball, 2]))
    return max(0.0, 1 - lowest / ((values["sheets"] + 1) * values["thickness"]))


CASE = Case(
    "stack",
    "sheets on a floor below a heavy ball: no intersection",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
