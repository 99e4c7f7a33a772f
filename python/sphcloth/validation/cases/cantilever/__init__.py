"""A strip of cloth, clamped level at one end, that bends under its own weight."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.cantilever import HeavyElastica
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# of the lowest mode of a cantilever: omega = 3.516 sqrt(B / (mass per area * L^4))
LOWEST_MODE = 3.516
# rate of the drag in the lowest mode's angular frequency
DRAG = 2.0

PARAMETERS = (
    Parameter("gamma", 5.0, "1", "w L^3 / B of weight and stiffness", 0.1, 100.0),
    Parameter("free", 1.0, "m", "free length L", 1e-2, 100.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    GRAVITY,
    Parameter("links", 20, "1", "cells along the strip, a clamped one included", 6, 200),
    Parameter("settle", 20.0, "1/omega", "time to rest, omega the lowest mode", 1.0, 1e3),
    *cloth.solver(2e-4, 50, method="substeps", quick_iterations=20),
)

QUANTITIES = (
    Quantity("drop", "1", "drop of the free edge / reference - 1", 0.01, 0.02),
    Quantity("drop_measured", "L", "drop of the free edge"),
    Quantity("drop_reference", "L", "the same of the heavy elastica"),
    Quantity("reach", "1", "reach of the free edge / reference - 1"),
    Quantity("shape", "L", "largest distance of a row from the elastica"),
    Quantity("twist", "L", "difference of height of the two ends of the free edge"),
    Quantity("strain", "1", "largest strain"),
    Quantity("speed", "m/s", "largest speed in the end"),
    *order_quantities("in the links of the drop"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run two numbers of links to rest and compare with the elastica."""
    elastica = HeavyElastica(values["gamma"])
    refined = Refinement.of(partial(_run, values, runner), three(values["links"]))
    fine = refined.fine
    rows = _rows(fine, values)
    exact = _exact(elastica, values["links"])
    drops = [-_rows(run, values)[-1, 1] for run in refined.runs]
    _plot(elastica, rows, runner.picture)
    last = fine.trajectory[-1]
    return {
        "drop": drops[-1] / elastica.drop - 1,
        "drop_measured": drops[-1],
        "drop_reference": elastica.drop,
        "reach": rows[-1, 0] / elastica.reach - 1,
        "shape": float(np.max(np.linalg.norm(rows[2:] - exact[2:], axis=1))),
        "twist": _twist(fine) / values["free"],
        "strain": float(fine.thermo["c_strain"][-1]),
        "speed": float(np.max(np.abs(last.velocities))),
        **refined.orders([drop / elastica.drop - 1 for drop in drops]),
    }


def _run(values: Mapping[str, Value], runner: Runner, label: str, links: int) -> Run:
    lowest = LOWEST_MODE * math.sqrt(values["gravity"] / (values["free"] * values["gamma"]))
    time = values["settle"] / lowest
    shared = {name: values[name] for name in values if name != "settle"}
    steps = cloth.stepping(time, values["dt"], frames=10)
    return runner.run(label, time, shared | steps | {"links": links, "drag": DRAG * lowest})


def _rows(run: Run, values: Mapping[str, Value]) -> NDArray[np.float64]:
    """Return x and z of the rows across the strip in L, x from the middle of the first link."""
    pairs = _pairs(run)
    middle = (pairs[0] + pairs[1]).mean(axis=0) / 2
    return (pairs.mean(axis=1) - middle)[:, [0, 2]] / values["free"]


def _pairs(run: Run) -> NDArray[np.float64]:
    """Return the two vertices of each row in the last frame, shape (rows, 2, 3)."""
    return run.trajectory[-1].positions.reshape(-1, 2, 3)


def _exact(elastica: HeavyElastica, links: int) -> NDArray[np.float64]:
    """Return where the elastica has the rows, in L; the clamp is half way along the first link."""
    along = (np.arange(links + 1) - 0.5) / (links - 0.5)
    return elastica.shape(np.clip(along, 0, 1)).T


def _twist(run: Run) -> float:
    left, right = _pairs(run)[-1]
    return float(right[2] - left[2])


def _plot(elastica: HeavyElastica, rows: NDArray, path: Path) -> None:
    """Draw the strip from the side."""
    figure, (side,) = compare.panels(1)
    side.plot(*elastica.shape(np.linspace(0, 1, 200)), "k-", label="heavy elastica")
    side.plot(*rows.T, "o", mfc="none", label="fix pbd/cloth")
    side.set(xlabel="x (L)", ylabel="z (L)", aspect="equal")
    side.legend()
    compare.save(figure, path)


CASE = Case(
    "cantilever",
    "drop of a strip that bends under its weight: heavy elastica",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
