"""``sphcloth bench pair``: what a step costs beside LAMMPS's own SPH styles.

Times are those that LAMMPS prints.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.spatial import cKDTree

from sphcloth.bench.timing import Runner, Timing, cell, figure
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.pair"
CODES = ("stock", "double", "mixed")
SCENES = ("dam", "block")
SKINS = (0.1, 0.2, 0.3, 0.4, 0.6)
EQUAL_SKIN = 0.2  # of the support, where pair times are compared

# floating-point operations of one pair, counted in core/sph/density_loops.h: distance, kernel, sum;
# distance, kernel, pressure, artificial viscosity and the four sums
FLOPS_PER_LISTED, FLOPS_PER_PAIR = 8, 10 + 46


class PairRunner(Runner):
    """Runs the script with one resolution."""

    def __init__(self, folder: Path, across: int, steps: int) -> None:
        super().__init__(SCRIPT, folder, across=across, steps=steps)
        self.across = across
        self.steps = steps

    def best_skin(self, scene: str, code: str) -> float:
        """Return the skin with the least time per step, in units of the support."""
        steps = 3 * self.steps  # several list builds
        return min(
            SKINS,
            key=lambda skin: self.time(scene=scene, code=code, skin=skin, steps=steps).loop,
        )

    def pairs_inside(self, scene: str) -> float:
        """Return the mean number of neighbors inside the support, from the positions alone."""
        lines = (self.folder / f"start.{scene}.data").read_text().split("Atoms", 1)[1].splitlines()
        rows = [line.split() for line in lines[2:]]
        end = next(k for k, row in enumerate(rows) if not row)
        x = np.array([row[5:8] for row in rows[:end]], dtype=float)
        box = [1.0, 1.0, 1.0] if scene == "block" else None
        tree = cKDTree(x % 1.0 if box else x, boxsize=box)
        return 2.0 * len(tree.query_pairs(2.0 / self.across, output_type="ndarray")) / len(x)


def peak_flops() -> float:
    """Return the rate of a large matrix product on one core, in operations per second."""
    code = (
        "import numpy as np, time; a = np.random.rand(1500, 1500); a @ a; t = time.perf_counter();"
        "[a @ a for _ in range(4)]; print(4 * 2 * 1500**3 / (time.perf_counter() - t))"
    )
    one = {f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL")}
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | one, capture_output=True, text=True
    )
    return float(done.stdout)


def bench_pair(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the block, 48 for 110 592 particles.
        steps: length of a timed run.
        console: where the table goes.
    """
    peak = peak_flops()
    result: dict = {
        "bench": "pair",
        "particles": across**3,
        "rounds": rounds,
        "peak_gflops": peak / 1e9,
        "versions": versions("lammps", "sphcloth"),
        "scenes": {},
    }
    with tempfile.TemporaryDirectory() as folder:
        run = PairRunner(Path(folder), across, steps)
        for scene in SCENES:
            with console.status(f"{scene}: preparing"):
                run(task="start", scene=scene)
            result["scenes"][scene] = measure_scene(run, scene, rounds, peak, console)
            show(scene, result["scenes"][scene], console)
    return result


def measure_scene(run: PairRunner, scene: str, rounds: int, peak: float, console: Console) -> dict:
    """Measure one scene with all codes."""
    with console.status(f"{scene}: best skins"):
        skins = {code: run.best_skin(scene, code) for code in CODES}
    equal: dict[str, list[Timing]] = {code: [] for code in CODES}
    best: dict[str, list[Timing]] = {code: [] for code in CODES}
    two: list[Timing] = []
    long = 3 * run.steps
    for k in range(rounds):
        with console.status(f"{scene}: round {k + 1} of {rounds}"):
            for code in CODES:
                equal[code].append(run.time(scene=scene, code=code, skin=EQUAL_SKIN))
                best[code].append(run.time(scene=scene, code=code, skin=skins[code], steps=long))
            two.append(run.time(2, scene=scene, code="double", skin=skins["double"], steps=long))
    inside = run.pairs_inside(scene)
    figures: dict = {"neighbors_inside": inside, "codes": {}}
    for code in CODES:
        pair = [t.per_particle(t.pair) for t in equal[code]]
        rate = inside * FLOPS_PER_PAIR / statistics.median(pair) * 1e9
        figures["codes"][code] = {
            "pair_ns": figure(pair),
            "pair_ns_per_neighbor": figure([ns / inside for ns in pair]),
            "list_ns_per_step": figure([t.per_particle(t.lists) for t in equal[code]]),
            "steps_per_build": figure([t.steps / max(t.builds, 1) for t in best[code]]),
            "share_of_peak": None if code == "stock" else rate / peak,
            "best_skin": skins[code],
            "step_ns_at_best_skin": figure([t.per_particle(t.loop) for t in best[code]]),
            "bytes_per_particle": equal[code][0].memory / equal[code][0].particles,
        }
    for code in CODES[1:]:
        figures[f"pair_ratio_{code}"] = figure(
            [a.pair / b.pair for a, b in zip(equal["stock"], equal[code], strict=True)]
        )
        figures[f"run_ratio_{code}"] = figure(
            [a.loop / b.loop for a, b in zip(best["stock"], best[code], strict=True)]
        )
    figures["two_ranks"] = figure(
        [a.loop / b.loop for a, b in zip(best["double"], two, strict=True)]
    )
    return figures


def show(scene: str, figures: dict, console: Console) -> None:
    """Print the figures of one scene."""
    table = Table(title=f"{scene}, {figures['neighbors_inside']:.1f} neighbors in the support")
    for head in ("", *CODES):
        table.add_column(head, justify="left" if not head else "right")
    rows = {
        "pair, ns per particle and step": "pair_ns",
        "pair, ns per neighbor": "pair_ns_per_neighbor",
        "lists, ns per particle and step": "list_ns_per_step",
        "best skin / support": "best_skin",
        "step at the best skin, ns per particle": "step_ns_at_best_skin",
        "steps from build to build there": "steps_per_build",
        "bytes per particle": "bytes_per_particle",
        "share of the core's peak": "share_of_peak",
    }
    for label, key in rows.items():
        table.add_row(label, *(cell(figures["codes"][code][key]) for code in CODES))
    for label, key in {"pair time of stock over this": "pair", "whole run": "run"}.items():
        table.add_row(label, "1", *(cell(figures[f"{key}_ratio_{code}"]) for code in CODES[1:]))
    table.add_row("two ranks over one", "", cell(figures["two_ranks"]), "")
    console.print(table)
