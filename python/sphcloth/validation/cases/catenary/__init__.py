"""A chain of equal links between two fixed points comes to rest, in three dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.catenary import HangingPolygon
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

# rate of the drag in sqrt(g / length)
DRAG = 4.0
# time steps of the runs of the order of convergence, in that of the case
STEPS = (4.0, 2.0, 1.0)

PARAMETERS = (
    Parameter("links", 20, "1", "links N", 4, 200),
    Parameter("length", 1.0, "m", "length L of the chain at rest", 1e-2, 100.0),
    Parameter("span", 0.6, "L", "distance of the fixed points", 0.3, 0.99),
    Parameter("mass", 0.05, "kg", "mass at each joint", 1e-6, 1e3),
    Parameter("compliance", 0.0, "m/N", "compliance of a link; 0 for k = 1", 0.0, 1.0),
    GRAVITY,
    Parameter("settle", 40.0, "sqrt(L/g)", "time to rest", 1.0, 1e4),
    *cloth.solver(1e-3, 1000),
)

QUANTITIES = (
    Quantity("shape", "L", "largest distance of a joint from the polygon", 1e-6, 1e-6),
    Quantity("sag", "L", "sag - reference", 1e-6, 1e-6),
    Quantity("sag_reference", "L", "depth of the lowest joint of the polygon"),
    Quantity("force", "1", "force of the fixed points / weight - 1", 1e-6, 1e-6),
    Quantity("strain", "1", "largest strain of a rigid link"),
    Quantity("speed", "m/s", "largest speed of a joint in the end"),
    Quantity("shape_current", "L", "shape when edges are projected along their current direction"),
    *order_quantities("in dt of shape_current"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run to rest and compare with the polygon, for the order along current directions."""
    polygon = _polygon(values)
    fine = _run(values, runner, "fine")
    steps = [share * values["dt"] for share in STEPS]
    current = [
        _error(_run({**values, "direction": "current", "dt": dt}, runner, label), polygon)
        for label, dt in zip(("coarse", "middle", "current"), steps, strict=True)
    ]
    joints = _joints(fine)
    weight = (polygon.links + 1) * polygon.mass * polygon.gravity
    _plot(polygon, joints, runner.picture)
    return {
        "shape": _error(fine, polygon),
        "sag": (-float(np.min(joints[:, 1])) - polygon.sag) / polygon.length,
        "sag_reference": polygon.sag / polygon.length,
        "force": float(fine.thermo["c_force[3]"][-1]) / weight - 1,
        "strain": float(fine.thermo["c_strain"][-1]),
        "speed": float(np.max(np.abs(fine.trajectory[-1].velocities))),
        "shape_current": current[-1],
        **compare.orders(current, [1 / dt for dt in steps]),
    }


def _polygon(values: Mapping[str, Value]) -> HangingPolygon:
    return HangingPolygon(
        values["links"],
        values["length"],
        values["span"] * values["length"],
        values["mass"],
        values["gravity"],
        values["compliance"],
    )


def _run(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    unit = math.sqrt(values["length"] / values["gravity"])
    time = values["settle"] * unit
    shared = {name: values[name] for name in values if name != "settle"}
    changed = {"span": values["span"] * values["length"], "drag": DRAG / unit}
    return runner.run(label, time, shared | changed | cloth.stepping(time, values["dt"], frames=10))


def _error(run: Run, polygon: HangingPolygon) -> float:
    """Return the largest distance of a joint from the polygon, in L."""
    distance = np.linalg.norm(_joints(run) - polygon.joints, axis=1)
    return float(np.max(distance)) / polygon.length


def _joints(run: Run) -> NDArray[np.float64]:
    """Return x and z of the joints in the last frame, m."""
    return run.trajectory[-1].positions[:, [0, 2]]


def _plot(polygon: HangingPolygon, joints: NDArray, path: Path) -> None:
    """Draw the chain, and the distance of its joints from the polygon."""
    figure, (shape, error) = compare.panels(1, 2)
    shape.plot(*polygon.joints.T, "k-", label="polygon")
    shape.plot(*joints.T, "o", mfc="none", label="fix pbd/cloth")
    shape.set(xlabel="x (m)", ylabel="z (m)", aspect="equal")
    shape.legend()
    distance = np.linalg.norm(joints - polygon.joints, axis=1)
    error.semilogy(np.maximum(distance, 1e-17), "o-")
    error.set(xlabel="joint", ylabel="distance from the polygon (m)")
    compare.save(figure, path)


CASE = Case(
    "catenary",
    "shape of a chain between fixed points: exact polygon",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
