"""A long strip between two clamped edges, bulged by a pressure: inextensible and elastic."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.bulge import Bulge
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.gas import GasMesh, run
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# rate of the drag in that of the lowest mode of a string under the tension
DRAG = 2.0

PARAMETERS = (
    Parameter("span", 1.0, "m", "distance of the clamped edges", 1e-2, 100.0),
    Parameter("slack", 1.2, "1", "length of the inextensible strip over the span", 1.01, 1.5),
    Parameter("strain", 0.01, "1", "pressure * span / stiffness of the elastic strip", 1e-4, 0.1),
    Parameter("pressure", 100.0, "Pa", "over that on the other side", 1e-3, 1e6),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("links", 32, "1", "cells from edge to edge", 8, 200, quick=16),
    Parameter("settle", 25.0, "1/omega", "time to rest, omega the lowest mode", 1.0, 1e3),
    *cloth.solver(1e-4, 20, method="substeps", quick_dt=2e-4),
    *schemes.parameters(ceiling=1.0),
)

QUANTITIES = (
    Quantity("height", "1", "of the inextensible strip / reference - 1", 0.01, 0.01),
    Quantity("shape", "span", "largest distance of a row from the arc", 0.01, 0.01),
    Quantity("height_elastic", "1", "of the elastic strip / reference - 1", 0.01, 0.01),
    Quantity("tension", "1", "of the elastic strip by its strain / reference - 1", 0.01, 0.01),
    Quantity("force", "1", "of the clamps along z / pressure on the span - 1", 0.01, 0.01),
    Quantity("strain", "1", "largest strain of the inextensible strip"),
    *order_quantities("in the links of the height of the inextensible strip"),
    Quantity("order_elastic", "1", "the same of the elastic strip"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three numbers of links to rest, of both strips, and compare with the arc."""
    cells = three(values["links"], share=0.25)
    arcs = {"inextensible": _arc(values, False), "elastic": _arc(values, True)}
    runs = {
        kind: Refinement.of(partial(_run, values, arc, runner, kind), cells)
        for kind, arc in arcs.items()
    }
    errors = {
        kind: refined.each(partial(_height_error, arcs[kind])) for kind, refined in runs.items()
    }
    rows = _rows(runs["inextensible"].fine)
    fine, arc = runs["elastic"].fine, arcs["elastic"]
    _plot(runs, arcs, runner.picture)
    load = values["pressure"] * values["span"] * values["span"] / values["links"]
    return {
        "height": errors["inextensible"][-1],
        "shape": float(np.max(_distances(rows, arcs["inextensible"]))) / values["span"],
        "height_elastic": errors["elastic"][-1],
        "tension": _strain(fine, values) * arc.stiffness / arc.tension - 1,
        "force": -float(fine.thermo["c_pins[3]"][-1]) / load - 1,
        "strain": float(runs["inextensible"].fine.thermo["c_strain"][-1]),
        **runs["inextensible"].orders(errors["inextensible"]),
        "order_elastic": runs["elastic"].orders(errors["elastic"])["order"],
    }


def _arc(values: Mapping[str, Value], elastic: bool) -> Bulge:
    span, pressure = values["span"], values["pressure"]
    if not elastic:
        return Bulge(span, values["slack"] * span, pressure)
    return Bulge(span, span, pressure, pressure * span / values["strain"])


def _mesh(values: Mapping[str, Value], arc: Bulge, links: int) -> GasMesh:
    """Return a strip of one cell in width: flat, or straight from each edge up to the middle."""
    along, width = np.linspace(0, 1, links + 1), values["span"] / links
    height = math.sqrt(max(0.0, arc.length**2 - arc.span**2)) / 2
    line = np.stack(
        [(along - 0.5) * arc.span, 0 * along, height * (1 - np.abs(2 * along - 1))], axis=1
    )
    x = np.repeat(line, 2, axis=0)
    x[1::2, 1] = width
    a = 2 * np.arange(links)
    triangles = np.concatenate(
        [np.stack([a, a + 2, a + 1], axis=1), np.stack([a + 1, a + 2, a + 3], axis=1)]
    )
    edges = np.concatenate([np.stack([a, a + 2], axis=1), np.stack([a + 1, a + 3], axis=1)])
    masses = np.full(len(x), values["areal"] * arc.length / links * width / 2)
    pinned = np.zeros(len(x), dtype=bool)
    pinned[[0, 1, -2, -1]] = True
    # of a row, half the width of the strip
    compliance = arc.length / links / (arc.stiffness * width / 2)
    return GasMesh(x, triangles, edges, np.full(len(edges), compliance), masses, pinned)


def _run(
    values: Mapping[str, Value], arc: Bulge, runner: Runner, kind: str, label: str, links: int
) -> Run:
    mode = math.pi / arc.length * math.sqrt(arc.tension / values["areal"])
    time = values["settle"] / mode
    given = {
        "drag": DRAG * mode,
        "gas": f"pressure {values['pressure']!r} toward 0 0 1",
        **cloth.stepping(time, values["dt"], frames=10),
    }
    return run(values, runner, f"{kind}_{label}", _mesh(values, arc, links), time, given)


def _rows(run: Run) -> NDArray[np.float64]:
    """Return x and z of the rows across the strip in the last frame."""
    return run.trajectory[-1].positions.reshape(-1, 2, 3).mean(axis=1)[:, [0, 2]]


def _height_error(arc: Bulge, run: Run, _: int) -> float:
    return float(_rows(run)[:, 1].max() / arc.height - 1)


def _distances(rows: NDArray[np.float64], arc: Bulge) -> NDArray[np.float64]:
    center = arc.height - arc.radius
    return np.abs(np.hypot(rows[:, 0], rows[:, 1] - center) - arc.radius)


def _strain(run: Run, values: Mapping[str, Value]) -> float:
    """Return the strain of all rows together."""
    length = np.linalg.norm(np.diff(_rows(run), axis=0), axis=1).sum()
    return float(length / values["span"] - 1)


def _plot(runs: Mapping[str, Refinement], arcs: Mapping[str, Bulge], path: Path) -> None:
    """Draw both strips from the side."""
    figure, sides = compare.panels(1, 2)
    for side, (kind, arc) in zip(sides, arcs.items(), strict=True):
        side.plot(*arc.shape(200), "k-", label="circular arc")
        side.plot(*_rows(runs[kind].fine).T, "o", mfc="none", label="fix cloth/gas")
        side.set(xlabel="x (m)", ylabel="z (m)", title=kind, aspect="equal")
        side.legend()
    compare.save(figure, path)


CASE = Case(
    "bulge",
    "a clamped strip bulged by a pressure: a circular arc",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
