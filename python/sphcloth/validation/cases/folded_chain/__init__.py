"""A folded chain of rigid links that is let go at one end, in three dimensions."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sphcloth.references import folded_chain
from sphcloth.validation import cloth, compare
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# the coarse run of the order of convergence: share of the links
COARSE = 0.5
# time of the run, in that of the fall of a chain of no thickness, and its frames
UNTIL, FRAMES = 1.15, 1000
# between the shapes of the plot, in L
SHIFT = 0.1

PARAMETERS = (
    Parameter("links", 101, "1", "links N, odd: the next odd number is taken", 11, 401, quick=61),
    Parameter("length", 1.0, "m", "length L of the chain", 1e-2, 100.0),
    Parameter("mass", 1.0, "kg", "mass of the chain", 1e-6, 1e6),
    GRAVITY,
    *cloth.solver(2e-5, 50),
)

QUANTITIES = (
    Quantity("fall", "1", "time of the fall / that of a chain of no thickness - 1", 0.02, 0.04),
    Quantity("fall_links", "1", "time of the fall / that of N rigid links - 1"),
    Quantity("fall_measured", "1", "time of the fall over that of free fall"),
    Quantity("fall_reference", "1", "the same of a chain of no thickness"),
    Quantity("path", "L", "largest distance of the tip from that of N rigid links"),
    Quantity("strain", "1", "largest strain in any frame"),
    *order_quantities("in the links of the time of the fall"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three numbers of links and find when the free end is lowest."""
    links = {label: _odd(n) for label, n in three(values["links"], COARSE).items()}
    refined = Refinement.of(partial(_run, values, runner), links)
    fine = refined.fine
    free = folded_chain.free_fall(values["length"], values["gravity"])
    falls = [_time_of_fall(run) / free for run in refined.runs]
    ideal = folded_chain.fall_over_free_fall()
    chain = folded_chain.folded(links["fine"], values["length"], values["gravity"])
    exact_fall = folded_chain.time_of_fall(chain)
    fallen = fine.trajectory.times <= exact_fall
    exact = chain.positions(fine.trajectory.times[fallen])[:, -1]
    error = np.linalg.norm(_tip(fine)[fallen] - exact, axis=1) / values["length"]
    _plot(fine, exact, free, values["length"], runner.picture)
    return {
        "fall": falls[-1] / ideal - 1,
        "fall_links": falls[-1] * free / exact_fall - 1,
        "fall_measured": falls[-1],
        "fall_reference": ideal,
        "path": float(np.max(error)),
        "strain": float(np.max(fine.thermo["c_strain"])),
        **refined.orders([fall / ideal - 1 for fall in falls]),
    }


def _odd(links: float) -> int:
    return 2 * (round(links) // 2) + 1


def _run(values: Mapping[str, Value], runner: Runner, label: str, links: int) -> Run:
    free = folded_chain.free_fall(values["length"], values["gravity"])
    time = UNTIL * folded_chain.fall_over_free_fall() * free
    changed = {"links": links, **cloth.stepping(time, values["dt"], FRAMES)}
    return runner.run(label, time, {**values, **changed})


def _tip(run: Run) -> NDArray[np.float64]:
    """Return x and z of the free end in each frame relative to the fixed one, m."""
    return np.array([frame.positions[-1, [0, 2]] for frame in run.trajectory])


def _time_of_fall(run: Run) -> float:
    """Return when the free end is lowest for the first time, s."""
    heights, times = _tip(run)[:, 1], run.trajectory.times
    turns = CubicSpline(times, heights).derivative().roots(extrapolate=False)
    first = times[folded_chain.first_lowest(heights)]
    return float(turns[np.argmin(np.abs(turns - first))])


def _plot(run: Run, exact: NDArray, free: float, length: float, path: Path) -> None:
    """Draw some shapes of the chain, and the height of its free end over time."""
    figure, (shapes, height) = compare.panels(1, 2)
    shown = np.arange(0, len(run.trajectory), len(run.trajectory) // 10)
    places = SHIFT * length * np.arange(len(shown))
    for number, place in zip(shown, places, strict=True):
        x, _, z = run.trajectory[number].positions.T
        shapes.plot(place + x, z)
    labels = [f"{time:.2f}" for time in run.trajectory.times[shown] / free]
    shapes.set_xticks(places, labels)
    shapes.set(xlabel="time / time of free fall", ylabel="z (m)")
    times = run.trajectory.times / free
    height.plot(times[: len(exact)], exact[:, 1], "k-", label="rigid links")
    height.plot(times, _tip(run)[:, 1], "--", label="fix pbd/cloth")
    falling = np.linspace(0, 1, 100)
    height.plot(falling, -length * falling**2, ":", label="free fall")
    height.set(xlabel="time / time of free fall", ylabel="height of the free end (m)")
    height.legend()
    compare.save(figure, path)


CASE = Case(
    "folded-chain",
    "fall of a folded chain: conservation of energy",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
