"""Level sheets that lie on one another, the lowest one held, the upper one pressed by a force.

Exact: at rest contact carries the weight of all that is above it and the load, so the force on the
held sheet is that of all free sheets and the load; and neighboring sheets are a thickness apart.
The force is the impulse of contact on the held vertices over time, in the second half of the run.
The pins hold the lowest sheet as well, so theirs is that of all weights and the load.

The limit of the force is that of :mod:`~sphcloth.validation.cases.pinned_weight`, 0.2 %: what a
drag leaves of the motion. One sweep in each substep hands a load on by one sheet, so the lowest
gap lacks about (sheets^2 + sheets * load) g h^2 with the substep h, 1 % of the thickness by
default; the limit is twice that.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.pressed import Pile
from sphcloth.validation import compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import sheet
from sphcloth.validation.runner import Runner

# share of the time in which forces are averaged
LATE = 0.5

PARAMETERS = (
    Parameter("sheets", 5, "1", "number of free sheets", 1, 100, quick=3),
    Parameter("load", 10.0, "weight", "force on the upper sheet over its weight", 0.0, 1e4),
    Parameter("across", 12, "1", "vertices along a side of a sheet", 3, 200, quick=6),
    Parameter("side", 0.4, "m", "of the free sheets", 0.01, 10.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("drag", 20.0, "1/s", "rate of the drag", 0.0, 1e4),
    *contact.exact_parameters(0.005, 1e-3, 0.5, 0.3, jitter=0.0),
)

QUANTITIES = (
    Quantity("reaction", "1", "force on the held sheet / (weights + load) - 1", 2e-3, 2e-3),
    Quantity("sideways", "1", "horizontal force on it / (weights + load)", 2e-3, 2e-3),
    Quantity("pins", "1", "force of the pins / (all weights + load) - 1", 2e-3, 2e-3),
    Quantity("gaps", "thickness", "largest error of the mean distance of two sheets", 0.02, 0.02),
    Quantity("uneven", "thickness", "largest height of a vertex above the mean of its sheet"),
    Quantity("strain", "1", "largest strain of an edge", 0.01, 0.01),
    Quantity("speed", "m/s", "rms speed in the end"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Let the pile come to rest and weigh it."""
    start = scene(values)
    variables = {
        "load": values["load"],
        "drag": values["drag"],
        "top": values["sheets"] + 1,
    }
    run = contact.play(values, runner, start, variables)[0]
    pile = _pile(start, values)
    force = _force(run)
    total = pile.forces[0]
    heights = _heights(run, values)
    means = heights.mean(axis=1)
    held = float(np.sum(start.masses[~run.free])) * values["gravity"]
    late = compare.late(run.run.thermo["Time"], LATE)
    _plot(run, pile, means, runner.picture)
    return {
        "reaction": -force[2] / total - 1,
        "sideways": float(np.linalg.norm(force[:2])) / total,
        "gaps": float(np.max(np.abs(np.diff([0, *means]) / values["thickness"] - 1))),
        "uneven": float(np.max(np.abs(heights - means[:, None]))) / values["thickness"],
        "strain": run.strain,
        "speed": run.speed(),
        "pins": float(np.mean(run.run.thermo["c_pins[3]"][late])) / (total + held) - 1,
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return a held sheet and free ones above it, a thickness apart, each turned by a little."""
    edge = values["side"] / (values["across"] - 1)
    wide = 1.6 * values["side"]
    below = sheet(wide, round(wide / edge / 1.1) + 1, 0.0, values["areal"])
    below.held[:] = 1
    free = [
        sheet(values["side"], values["across"], n * values["thickness"], values["areal"], 0.1 * n)
        for n in range(1, values["sheets"] + 1)
    ]
    return Scene([below, *free])


def _pile(start: Scene, values: Mapping[str, Value]) -> Pile:
    of_one = np.sum(start.masses[start.parts == 1]) * values["gravity"]
    return Pile(values["sheets"], of_one, values["load"] * of_one, values["thickness"])


def _force(run: contact.Scenario) -> NDArray[np.float64]:
    """Return the mean force of contact on the held sheet, N, shape (3,)."""
    thermo = run.run.thermo
    late = np.flatnonzero(compare.late(thermo["Time"], LATE))[[0, -1]]
    given = np.stack([thermo[f"c_given[{n}]"][late] for n in (1, 2, 3)], axis=1)
    return (given[1] - given[0]) / np.diff(thermo["Time"][late])


def _heights(run: contact.Scenario, values: Mapping[str, Value]) -> NDArray[np.float64]:
    """Return z of the vertices of each free sheet in the end, m, shape (sheets, V)."""
    return run.positions()[run.free, 2].reshape(values["sheets"], -1)


def _plot(run: contact.Scenario, pile: Pile, means: NDArray[np.float64], path: Path) -> None:
    """Draw the impulse on the held sheet over time, and the heights of the sheets."""
    figure, (impulse, heights) = compare.panels(1, 2)
    thermo = run.run.thermo
    impulse.plot(thermo["Time"], -thermo["c_given[3]"], label="contact on the held sheet")
    impulse.plot(thermo["Time"], pile.forces[0] * thermo["Time"], "k--", label="weights and load")
    impulse.set(xlabel="time (s)", ylabel="impulse (N s)")
    impulse.legend()
    numbers = np.arange(1, pile.sheets + 1)
    heights.plot(numbers, pile.heights, "k-", numbers, means, "o", mfc="none")
    heights.set(xlabel="sheet", ylabel="z (m)")
    compare.save(figure, path)


CASE = Case(
    "pressed",
    "sheets on one another: weights, load and distances",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
