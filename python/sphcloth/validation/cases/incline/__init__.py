"""A sheet that lies on a tilted sheet, all vertices of which are held.

Exact: on a plane steeper than the angle of friction the sheet slides with g (sin - mu cos), without
friction with g sin, and on one that is not it stays. The coefficients of the three runs are
``friction``, 0 and ``sticking`` times that of the angle of friction. The normal force is m g cos,
in the impulse of contact on the held vertices.

The limit of an acceleration is 1 % of g sin: friction is a share of the normal impulse whenever
rows slide, and these add up to the weight over any time. Friction that is taken from the velocities
after a move lets a sheet creep at g sin times a substep, which is 2 substeps / time of the way
without friction, 7e-4 here; the limit of ``creep`` is three times that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.incline import Incline
from sphcloth.validation import compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.layers import contact
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import Piece, sheet
from sphcloth.validation.runner import Runner

# share of the time after which velocities are fitted
BEGIN = 0.2

PARAMETERS = (
    Parameter("angle", 30.0, "degrees", "of the plane", 1.0, 80.0),
    Parameter("sticking", 1.5, "tan(angle)", "coefficient of the run that sticks", 1.0, 100.0),
    Parameter("across", 12, "1", "vertices along a side of the sheet", 3, 200, quick=6),
    Parameter("side", 0.4, "m", "of the sheet", 0.01, 10.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    *contact.exact_parameters(0.005, 1e-3, 0.3, 0.3, friction=0.3, jitter=0.0),
)

QUANTITIES = (
    Quantity("slides", "1", "error of the acceleration / (g sin)", 0.01, 0.01),
    Quantity("smooth", "1", "the same without friction", 0.01, 0.01),
    Quantity("creep", "1", "way of the sheet that sticks / way without friction", 2e-3, 2e-3),
    Quantity("normal", "1", "mean normal force on the held sheet / (m g cos) - 1", 0.01, 0.01),
    Quantity("lifted", "thickness", "change of the distance of the sheets in the end", 0.1, 0.1),
    Quantity("strain", "1", "largest strain of an edge", 0.01, 0.01),
    Quantity("acceleration", "m/s^2", "of the sheet that slides"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Let the sheet slide, slide without friction, and stick."""
    start = scene(values)
    downhill, normal = _axes(values)
    coefficients = {
        "slides": values["friction"],
        "smooth": 0.0,
        "sticks": values["sticking"] * math.tan(math.radians(values["angle"])),
    }
    runs = {
        label: contact.play(values | {"friction": mu}, runner, start, {}, label=label)[0]
        for label, mu in coefficients.items()
    }
    exact = {
        label: Incline(values["angle"], mu, values["gravity"]) for label, mu in coefficients.items()
    }
    found = {label: _acceleration(run, downhill) for label, run in runs.items()}
    _plot(runs, exact, downhill, runner.picture)
    free = exact["smooth"].acceleration
    slides = runs["slides"]
    return {
        "slides": (found["slides"] - exact["slides"].acceleration) / free,
        "smooth": (found["smooth"] - free) / free,
        "creep": runs["sticks"].moved[-1] @ downhill / (0.5 * free * values["time"] ** 2),
        "normal": _normal_force(slides, normal, values) - 1,
        "lifted": slides.moved[-1] @ normal / values["thickness"],
        "strain": max(run.strain for run in runs.values()),
        "acceleration": found["slides"],
    }


def scene(values: Mapping[str, Value]) -> Scene:
    """Return the sheet at the thickness above a larger, held one."""
    edge = values["side"] / (values["across"] - 1)
    # room for the whole way, in edges that are no multiple of the sheet's
    way = 0.5 * values["gravity"] * values["time"] ** 2
    wide = 2.2 * (values["side"] + way)
    below = sheet(wide, round(wide / edge / 1.1) + 1, 0.0, values["areal"])
    below.held[:] = 1
    above = sheet(values["side"], values["across"], values["thickness"], values["areal"], 0.3)
    return Scene([_tilted(piece, values["angle"]) for piece in (below, above)])


def _tilted(piece: Piece, angle: float) -> Piece:
    """Return a mesh turned about the y axis, so that x goes down."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    positions = piece.positions @ turn.T
    return Piece(positions, positions, piece.triangles, piece.areal, piece.held)


def _axes(values: Mapping[str, Value]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit vectors downhill and normal to the plane, upwards."""
    c, s = math.cos(math.radians(values["angle"])), math.sin(math.radians(values["angle"]))
    return np.array([c, 0, -s]), np.array([s, 0, c])


def _acceleration(run: contact.Scenario, downhill: NDArray[np.float64]) -> float:
    """Return the slope of the speed downhill over time, m/s^2."""
    thermo = run.run.thermo
    time = thermo["Time"]
    late = time >= BEGIN * time[-1]
    mass = np.sum(run.scene.masses[run.free])
    return float(np.polyfit(time[late], (run.momentum() @ downhill)[late] / mass, 1)[0])


def _normal_force(
    run: contact.Scenario, normal: NDArray[np.float64], values: Mapping[str, Value]
) -> float:
    """Return the mean force of contact on the held sheet over that of the weight."""
    thermo = run.run.thermo
    given = np.stack([thermo[f"c_given[{n}]"] for n in (1, 2, 3)], axis=1) @ normal
    weight = np.sum(run.scene.masses[run.free]) * values["gravity"]
    expected = weight * math.cos(math.radians(values["angle"])) * thermo["Time"][-1]
    return float(-given[-1] / expected)


def _plot(
    runs: Mapping[str, contact.Scenario],
    exact: Mapping[str, Incline],
    downhill: NDArray[np.float64],
    path: Path,
) -> None:
    """Draw the ways over time."""
    figure, (way,) = compare.panels(1)
    for label, run in runs.items():
        time = run.run.trajectory.times
        (line,) = way.plot(time, run.moved @ downhill, ".", ms=3, label=label)
        way.plot(time, 0.5 * exact[label].acceleration * time**2, color=line.get_color(), lw=0.8)
    way.set(xlabel="time (s)", ylabel="way downhill (m)")
    way.legend()
    compare.save(figure, path)


CASE = Case(
    "incline",
    "sheet on a tilted sheet: Coulomb's friction",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
