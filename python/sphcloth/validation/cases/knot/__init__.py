"""Two ribbons in a loose reef knot that are pulled tight by their ends.

One ribbon is a bight in a plane; the other comes from the opposite side, up through the bight,
round behind both of its legs, and down through it again. So each holds the other: with contact the
ends cannot be drawn apart, and without it they slide through each other. No reference: cloth does
not go through cloth and edges are rigid. The limits that all scenes share are in
:mod:`sphcloth.validation.layers.contact`. ``apart`` is the distance of the two bights, positive
once one has left the other: 0 is the only value of a knot that holds.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from sphcloth.validation import compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact, pictures
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import Piece, ribbon
from sphcloth.validation.runner import Runner

# half of each way, in widths of the ribbon: the other half is its mirror image in y
BIGHT = ((-14, 3, 0), (-10, 3, 0), (-6, 3, 0), (-2, 3, 0), (2, 3, 0), (5, 1.8, 0))
BIGHT_TIP = (6, 0, 0)
ROUND = (
    (14, 1.3, -2),
    (10, 1.3, -2),
    (6, 1.3, -2),
    (3, 1.3, -1),
    (1.5, 1.3, 1),
    (0, 3, 2),
    (-2, 5, 0.5),
    (-3, 4, -2),
)
ROUND_TIP = (-3.5, 0, -2.5)

PARAMETERS = (
    Parameter("width", 0.1, "m", "of the ribbons", 1e-3, 1.0),
    Parameter("across", 5, "1", "vertices over the width of a ribbon", 2, 40, quick=3),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("speed", 0.5, "m/s", "at which the ends of each ribbon are pulled", 0.0, 10.0),
    Parameter("pull", 0.4, "m", "way of the ends of each ribbon", 0.0, 10.0, quick=0.2),
    Parameter("damping", 2.0, "1/s", "of the edges", 0.0, 1e3),
    *contact.parameters(0.005, 1e-3, 1.2, 0.4, friction=0.2, gravity=0.0),
)

QUANTITIES = (
    *contact.MEETINGS,
    Quantity("apart", "width", "by which the bights have left each other", 0, 0),
    Quantity("pull", "N", "force of the ends of one ribbon in the end"),
    Quantity("speed", "m/s", "rms speed in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Pull the knot tight and look at every step."""
    variables = {
        "speed": values["speed"],
        "pull_time": values["pull"] / max(values["speed"], 1e-12),
        "damping": values["damping"],
    }
    runs = contact.play(values, runner, scene(values), variables)
    pictures.side_view(runs[0], runner.picture, (0, 1))
    return {
        **contact.meetings(runs),
        "apart": contact.worst(runs, _apart) / values["width"],
        "pull": contact.worst(runs, _pull),
        "speed": contact.worst(runs, lambda run: run.speed()),
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return the two ribbons of the loose knot."""
    return Scene([_ribbon(values, BIGHT, BIGHT_TIP, 1), _ribbon(values, ROUND, ROUND_TIP, 2)])


def _ribbon(values: Mapping[str, Value], half: tuple, tip: tuple, held: int) -> Piece:
    """Return a ribbon along a half way, its tip, and the mirror image of the half."""
    there = np.array([*half, tip], float)
    back = there[-2::-1] * [1, -1, 1]
    points = values["width"] * np.concatenate([there, back])
    chords = np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))
    curve = make_interp_spline(np.concatenate([[0], chords / chords[-1]]), points)
    return ribbon(curve, values["width"], values["across"], values["areal"], held)


def _apart(run: contact.Scenario) -> float:
    """Return how far the tip of the bight is before that of the other ribbon, m, or 0."""
    tips = [_tip(run, number, np.max if number == 0 else np.min) for number in (0, 1)]
    return max(0.0, tips[1] - tips[0])


def _tip(run: contact.Scenario, number: int, extreme) -> float:
    """Return x of the tip of a ribbon, which is in the middle of it, in the end, m."""
    positions = run.positions()[run.scene.parts == number]
    middle: NDArray = positions[len(positions) // 4 : -(len(positions) // 4)]
    return float(extreme(middle[:, 0]))


def _pull(run: contact.Scenario) -> float:
    """Return the mean force on the ends of the first ribbon in the last tenth of the time, N."""
    thermo = run.run.thermo
    return float(np.mean(thermo["c_pull"][compare.late(thermo["Time"], 0.1)]))


CASE = Case(
    "knot",
    "reef knot of two ribbons: no intersection, and it holds",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
