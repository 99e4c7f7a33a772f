"""Two free sheets that meet in flight, without gravity.

Exact: momentum and angular momentum are those at the start, to round-off, since contact and edges
only exchange impulses; and energy is never gained, since contact without restitution and friction
only take it. The limits that all scenes share are in
:mod:`sphcloth.validation.layers.contact`.

Angular momentum is asked less strictly: positions and velocities of a log belong to times that are
half a step apart, and a sweep over edges changes it by the turn of an edge in a substep.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact, pictures
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import sheet
from sphcloth.validation.runner import Runner

PARAMETERS = (
    Parameter("across", 24, "1", "vertices along a side of a sheet", 4, 400, quick=8),
    Parameter("side", 1.0, "m", "of the larger sheet", 0.1, 100.0),
    Parameter("smaller", 0.6, "1", "side of the other sheet over that", 0.1, 1.0),
    Parameter("gap", 0.03, "m", "between the sheets", 1e-4, 1.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area of the larger sheet", 1e-4, 1e3),
    Parameter("ratio", 3.0, "1", "mass per area of the smaller one over that", 1e-3, 1e3),
    Parameter("speed", 1.0, "m/s", "of each sheet", 1e-3, 100.0),
    *contact.parameters(0.005, 1e-3, 0.5, 0.2, friction=0.2, gravity=0.0),
)

QUANTITIES = (
    *contact.MEETINGS,
    Quantity("momentum", "1", "change / momentum of one sheet", 1e-10, 1e-10),
    Quantity("turn", "1", "change of angular momentum / (m v side)", 1e-2, 1e-2),
    Quantity("growth", "1", "largest gain of energy / energy at first", 1e-3, 1e-3),
    Quantity("kept", "1", "energy in the end / energy at first"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Let the sheets meet and look at every step."""
    runs = contact.play(values, runner, scene(values), {"speed": values["speed"]})
    one = values["areal"] * values["side"] ** 2 * values["speed"]
    pictures.side_view(runs[0], runner.picture)
    return {
        **contact.meetings(runs),
        "momentum": contact.worst(runs, lambda run: _change(run, "v_p")) / one,
        "turn": contact.worst(runs, lambda run: _change(run, "v_l")) / (one * values["side"]),
        "growth": contact.worst(runs, lambda run: np.max(_kept(run)) - 1),
        "kept": contact.worst(runs, lambda run: _kept(run)[-1]),
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return a sheet below z = 0 and a smaller, heavier one above it, not in the middle."""
    gap, side, small = values["gap"] / 2, values["side"], values["smaller"] * values["side"]
    large = sheet(side, values["across"], -gap, values["areal"])
    other = sheet(small, values["across"], gap, values["ratio"] * values["areal"], turned=0.4)
    other.positions[:, 0] += 0.2 * side
    return Scene([large, other])


def _change(run: contact.Scenario, name: str) -> float:
    """Return the largest change of a vector of the log, whose columns end in x, y and z."""
    vector = np.stack([run.run.thermo[f"{name}{axis}"] for axis in "xyz"], axis=1)
    return float(np.max(np.linalg.norm(vector - vector[0], axis=1)))


def _kept(run: contact.Scenario) -> np.ndarray:
    """Return the kinetic energy over that at first, in each row of the log."""
    energy = run.run.thermo["c_motion"]
    return energy / energy[0]


CASE = Case(
    "collision",
    "two free sheets that meet in flight: momentum and energy",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
