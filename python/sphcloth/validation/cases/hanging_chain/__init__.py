"""A chain of masses on compliant links that hangs at rest, in three dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.hanging_chain import HangingChain
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import order_quantities
from sphcloth.validation.runner import Run, Runner

# drag that calms the slowest motion along the chain without a swing, in its angular frequency
DRAG = 2.0
# largest rate of the drag times the step: it is explicit
STRONGEST_DRAG = 0.5
# the table: sweeps, and the shares of the time step
SWEEPS = (5, 20, 50, 100)
STEPS = (1.0, 0.5, 0.25)

PARAMETERS = (
    Parameter("links", 20, "1", "links N, a mass below each", 1, 200),
    Parameter("mass", 0.05, "kg", "mass m of each", 1e-6, 1e3),
    Parameter("length", 0.05, "m", "length of a link at rest", 1e-3, 10.0),
    Parameter("compliance", 1e-3, "m/N", "compliance alpha of a link", 1e-9, 1.0),
    GRAVITY,
    Parameter("settle", 60.0, "1/omega", "time to rest, omega the slowest", 5.0, 1e4),
    Parameter("table", "all", "1", "sweeps of the table", choices=("all", "few"), quick="few"),
    *cloth.solver(1 / 60, 100, direction="current"),
)

QUANTITIES = (
    Quantity("stretch", "1", "stretch / alpha m g N (N + 1) / 2 - 1", 1e-6, 1e-6),
    Quantity("force", "1", "force of the support / weight - 1", 1e-6, 1e-6),
    Quantity("shape", "1", "largest error of a height over the stretch", 1e-6, 1e-6),
    Quantity("speed", "m/s", "largest speed of a mass in the end"),
    Quantity("force_5", "1", "force / weight - 1 with 5 sweeps"),
    Quantity("stretch_5", "1", "stretch / reference - 1 with 5 sweeps"),
    *(Quantity(f"stretch_{n}", "1", f"the same with {n} sweeps") for n in SWEEPS[1:]),
    *order_quantities("in dt of the stretch with 5 sweeps"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run the chain to rest, and again for a table over sweeps and time steps."""
    chain = chain_of(values)
    run = run_chain(values, runner, "converged")
    heights, force = heights_of(run), float(run.thermo["c_force[3]"][-1])
    at_rest = chain.links * chain.length
    errors, forces = {}, {}
    for share in STEPS:
        for sweeps in _sweeps(values):
            changed = {**values, "dt": share * values["dt"], "iterations": sweeps}
            each = run_chain(changed, runner, f"dt_{share:g}_sweeps_{sweeps}")
            errors[share, sweeps] = (-heights_of(each)[-1] - at_rest) / chain.stretch - 1
            forces[share, sweeps] = each.thermo["c_force[3]"][-1] / _carried(chain) - 1
    few = SWEEPS[0]
    _plot(chain, heights, values["dt"], errors, runner.picture)
    return {
        "stretch": (-heights[-1] - at_rest) / chain.stretch - 1,
        "force": force / _carried(chain) - 1,
        "shape": float(np.max(np.abs(heights - chain.heights))) / chain.stretch,
        "speed": float(np.max(np.abs(run.trajectory[-1].velocities))),
        "stretch_5": errors[1.0, few],
        "force_5": forces[1.0, few],
        **{f"stretch_{sweeps}": errors.get((1.0, sweeps), math.nan) for sweeps in SWEEPS[1:]},
        **compare.orders([errors[share, few] for share in STEPS], [1 / share for share in STEPS]),
    }


def _sweeps(values: Mapping[str, Value]) -> tuple[int, ...]:
    return SWEEPS if values["table"] == "all" else SWEEPS[:1]


def chain_of(values: Mapping[str, Value]) -> HangingChain:
    """Return the reference."""
    names = ("links", "mass", "length", "compliance", "gravity")
    return HangingChain(*(values[name] for name in names))


def _carried(chain: HangingChain) -> float:
    """Return what the fix reports: the support's force and the weight of the fixed vertex, N."""
    return chain.support + chain.mass * chain.gravity


def run_chain(values: Mapping[str, Value], runner: Runner, label: str) -> Run:
    """Run the script until the chain is at rest."""
    chain = chain_of(values)
    time = values["settle"] / chain.slowest
    shared = {name: values[name] for name in values if name not in ("settle", "table")}
    steps = cloth.stepping(time, values["dt"], frames=10)
    drag = min(DRAG * chain.slowest, STRONGEST_DRAG / values["dt"])
    return runner.run(label, time, shared | steps | {"drag": drag})


def heights_of(run: Run) -> NDArray[np.float64]:
    """Return the heights of the masses in the last frame, from the top, m."""
    return run.trajectory[-1].positions[1:, 2]


def _plot(
    chain: HangingChain,
    heights: NDArray,
    dt: float,
    errors: Mapping[tuple[float, int], float],
    path: Path,
) -> None:
    """Draw the masses' places, and the error of the stretch over the sweeps."""
    figure, (places, table) = compare.panels(1, 2)
    number = np.arange(1, chain.links + 1)
    places.plot(number, chain.heights, "k-", label="exact")
    places.plot(number, heights, ".", label="fix pbd/cloth")
    places.set(xlabel="mass", ylabel="height (m)")
    places.legend()
    for share in STEPS:
        done = [sweeps for sweeps in SWEEPS if (share, sweeps) in errors]
        error = [max(abs(errors[share, sweeps]), math.ulp(1.0)) for sweeps in done]
        table.loglog(done, error, "o-", label=f"dt {1e3 * share * dt:.3g} ms")
    table.set(xlabel="sweeps in a step", ylabel="error of the stretch / stretch")
    table.legend()
    compare.save(figure, path)


CASE = Case(
    "hanging-chain",
    "stretch and force of a chain of compliant links: statics",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
