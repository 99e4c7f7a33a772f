"""A light sheet, level at first, that is held at one edge and falls, at several stiffnesses."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references import light_cloth
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

FRAMES = 20
# the runs of the order of convergence: time steps in that of the case
REFINED = (1.0, 0.5, 0.25)

PARAMETERS = (
    Parameter("rows", 40, "1", "vertices along each side", 6, 400, quick=20),
    Parameter("size", 1.0, "m", "side of the sheet", 1e-2, 100.0),
    Parameter("areal", 0.15, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("softest", 1e2, "N/m", "least stiffness of an edge", 1.0, 1e9),
    Parameter("stiffest", 1e5, "N/m", "largest stiffness of an edge", 1.0, 1e9),
    Parameter("runs", 4, "1", "number of stiffnesses", 2, 20),
    GRAVITY,
    Parameter("time", 0.2, "s", "time of the fall", 1e-3, 10.0),
    *cloth.solver(1e-3, 10),
)

QUANTITIES = (
    Quantity("lowest", "1", "height of the lowest vertex / reference - 1, the worst", 0.02, 0.02),
    Quantity("lowest_reference", "m", "of the chain of the rows"),
    Quantity("growth", "1", "largest gain of energy over m g times the fall", 1e-3, 1e-3),
    Quantity("strain_softest", "1", "largest strain with the least stiffness"),
    Quantity("strain_stiffest", "1", "largest strain with the largest stiffness"),
    Quantity(
        "rows", "1", "rms distance of the stiffest sheet's rows from the chain's, over the side"
    ),
    *order_quantities("in dt of that distance"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run all stiffnesses, and the largest one with smaller time steps."""
    deepest = light_cloth.lowest(values["rows"], values["size"], values["gravity"], values["time"])
    stiffnesses = np.geomspace(values["softest"], values["stiffest"], values["runs"])
    runs = [
        _run({**values, "stiffness": float(stiffness)}, runner, f"stiffness_{stiffness:.3g}")
        for stiffness in stiffnesses
    ]
    stiff = {**values, "stiffness": values["stiffest"]}
    finer = [
        _run({**stiff, "dt": share * values["dt"]}, runner, f"dt_{share:g}")
        for share in REFINED[1:]
    ]
    lowest = [_lowest(run) / deepest - 1 for run in runs]
    rows = [_rows(run, values) for run in (runs[-1], *finer)]
    _plot(runs, stiffnesses, values, deepest, runner.picture)
    return {
        "lowest": max(lowest, key=abs),
        "lowest_reference": deepest,
        "growth": max(_growth(run, values, deepest) for run in runs),
        "strain_softest": float(np.max(runs[0].thermo["c_strain"])),
        "strain_stiffest": float(np.max(runs[-1].thermo["c_strain"])),
        "rows": rows[0],
        **compare.orders(rows, [1 / share for share in REFINED]),
    }


def _run(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    dropped = ("softest", "stiffest", "runs", "time")
    shared = {name: values[name] for name in values if name not in dropped}
    steps = cloth.stepping(values["time"], values["dt"], FRAMES)
    return runner.run(label, values["time"], shared | steps)


def _lowest(run: Run) -> float:
    return float(np.min(run.trajectory[-1].positions[:, 2]))


def _rows(run: Run, values: Mapping[str, Value]) -> float:
    """Return the rms distance of the rows' means from the chain's masses, over the side."""
    first, last = run.trajectory[0].positions, run.trajectory[-1].positions
    by_row = np.argsort(first[:, 0], kind="stable").reshape(values["rows"], -1)
    middles = last[by_row].mean(axis=1)[1:, [0, 2]] + [values["size"] / 2, 0]
    chain = light_cloth.falling_sheet(values["rows"], values["size"], values["gravity"])
    return (
        compare.rms(np.linalg.norm(middles - chain.positions(values["time"]), axis=1))
        / values["size"]
    )


def _growth(run: Run, values: Mapping[str, Value], deepest: float) -> float:
    """Return by how much kinetic and potential energy ever exceed those at first.

    Elastic energy is left out: it is none at first, and never negative.
    """
    energy = cloth.energies(run, float(run.thermo["v_each"][-1]), values["gravity"])
    scale = values["areal"] * values["size"] ** 2 * values["gravity"] * abs(deepest)
    return float(np.max(energy - energy[0])) / scale


def _plot(
    runs: list[Run],
    stiffnesses: NDArray,
    values: Mapping[str, Value],
    deepest: float,
    path: Path,
) -> None:
    """Draw the sheets from the side in the end, and their lowest vertices over time."""
    figure, (side, lowest) = compare.panels(1, 2)
    chain = light_cloth.falling_sheet(values["rows"], values["size"], values["gravity"])
    exact = chain.positions(values["time"])
    side.plot(exact[:, 0] - values["size"] / 2, exact[:, 1], "k-", label="chain of the rows")
    for run, stiffness in zip(runs, stiffnesses, strict=True):
        x, _, z = run.trajectory[-1].positions.T
        side.plot(x, z, ".", ms=2, label=f"{stiffness:g} N/m")
        heights = [np.min(frame.positions[:, 2]) for frame in run.trajectory]
        lowest.plot(run.trajectory.times, heights, ".-", label=f"{stiffness:g} N/m")
    side.set(xlabel="x (m)", ylabel="z (m)")
    side.legend()
    lowest.axhline(deepest, color="k", lw=0.8)
    lowest.set(xlabel="time (s)", ylabel="lowest vertex (m)")
    compare.save(figure, path)


CASE = Case(
    "light-cloth",
    "fall of a light sheet held at an edge: chain of rigid links",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
