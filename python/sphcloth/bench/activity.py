"""``sphcloth bench activity``: what a step costs where only some particles are updated.

A block at rest under block steps, with a corner in which steps are an eighth: most steps
update the corner alone, some what is beside it, one in eight all particles.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import cell, figure
from sphcloth.errors import UserError
from sphcloth.results import versions

SCRIPT = Path(str(resources.files("sphcloth.bench") / "in.activity"))
SHARES = (0.01, 0.05, 0.2)  # of the particles in the corner
NEAR = 0.5  # a share that differs from the usual one by no more of it is one, too
FEW = 5  # steps of a kind, at least


@dataclass(frozen=True)
class Steps:
    """Medians of one run, in ns per particle of the block.

    Attributes:
        active: share of the particles that the usual step updates.
        few: its time.
        whole: time of a step that updates all.
    """

    active: float
    few: float
    whole: float

    @property
    def left_out(self) -> float:
        """What a particle costs in a step that does not update it, ns."""
        return (self.few - self.active * self.whole) / (1 - self.active)


def bench_activity(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the block.
        steps: length of a timed run.
        console: where the table goes.
    """
    found: dict[float, list[Steps]] = {share: [] for share in SHARES}
    for k in range(rounds):
        for share in SHARES:
            with console.status(f"round {k + 1} of {rounds}: {share:.0%} in the corner"):
                seconds, active = time_steps(across, share, steps)
            found[share].append(usual_steps(seconds / across**3 * 1e9, active))
    result = {
        "bench": "activity",
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "particles": across**3,
        "corners": [{"share": share} | figures_of(of_rounds) for share, of_rounds in found.items()],
    }
    show(result, console)
    return result


def time_steps(
    across: int, share: float, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return wall time (s), from forces to forces, and share of updated particles of each step."""
    from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, lammps

    times, active = [], []
    words = ("-log", "none", "-screen", "none", "-var", "across", across, "-var", "share", share)
    lmp = lammps(cmdargs=[str(word) for word in words])

    def note(*_: object) -> None:
        active.append(lmp.extract_fix("step", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, 1))
        times.append(time.perf_counter())

    try:
        lmp.file(str(SCRIPT))
        lmp.set_fix_external_callback("clock", note)
        lmp.command(f"run {steps}")
    finally:
        lmp.close()
    return np.diff(times), np.array(active[1:])


def usual_steps(ns: NDArray[np.float64], active: NDArray[np.float64]) -> Steps:
    """Pick the steps that update all particles, and the usual ones of the others.

    Args:
        ns: time of each step per particle of the block.
        active: share of the particles that it updates.

    Raises:
        UserError: there are too few of one of them.
    """
    whole = active == 1
    usual = np.median(active[~whole]) if not whole.all() else 1.0
    few = ~whole & (np.abs(active - usual) <= NEAR * usual)
    if min(np.count_nonzero(few), np.count_nonzero(whole)) < FEW:
        raise UserError("bench activity: too few steps: raise --steps")
    return Steps(float(usual), float(np.median(ns[few])), float(np.median(ns[whole])))


def figures_of(rounds: list[Steps]) -> dict:
    """Return the cost of both kinds of steps, and of a particle that is left out.

    The last follows from t = a t_all + (1 - a) t_out, where a share a is updated.
    """
    return {
        "active": rounds[0].active,
        "step_ns": figure([each.few for each in rounds]),
        "all_ns": figure([each.whole for each in rounds]),
        "over_all": figure([each.few / each.whole for each in rounds]),
        "left_out_ns": figure([each.left_out for each in rounds]),
    }


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(
        title=f"block steps, {result['particles']} particles, {result['rounds']} rounds;\n"
        "ns per particle of the block"
    )
    heads = ("updated", "step", "step of all", "over that", "per particle\nleft out")
    for head in heads:
        table.add_column(head, justify="right")
    for corner in result["corners"]:
        names = ("step_ns", "all_ns", "over_all", "left_out_ns")
        table.add_row(f"{corner['active']:.1%}", *(cell(corner[name]) for name in names))
    console.print(table)
