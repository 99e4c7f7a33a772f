"""Error of the cloth solver against its cost, and the trap of a fixed k.

``python -m sphcloth.validation.workprecision pendulum --out FOLDER`` runs the chain of the case
``pendulum`` with many settings and plots its error over the number of projections.
``... trap`` plots how far a single bond, and a chain, stretch over the iterations with k and with
compliance, by the script of ``hanging-chain``.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth.results import Value, write_json
from sphcloth.validation import compare
from sphcloth.validation.cases import hanging_chain, pendulum
from sphcloth.validation.runner import Runner

# the pendulum: seconds, links, and the numbers of steps and sweeps
LINKS, TIME = 10, 1.0
STEPS = (100, 200, 500, 1000, 2000, 5000)
MARKS = "os^vD*Px"

# the trap: the same load with each
SWEEPS = (1, 2, 5, 10, 20, 50, 100)
TRAP_DT = 0.01
# what the plot shows of a stretch that vanishes
LEAST = 1e-4


@dataclass(frozen=True)
class Point:
    """One run.

    Attributes:
        setting: the curve it belongs to.
        cost: what it cost, or its number of sweeps.
        value: its error, or its stretch.
    """

    setting: str
    cost: float
    value: float


def pendulum_points(runner: Runner) -> list[Point]:
    """Return the error of a chain of links that swings from level, for many settings."""
    base = pendulum.CASE.values({}, quick=False) | {"links": LINKS, "time": TIME}
    settings = {
        "k 1, current direction, 10 sweeps": {"iterations": 10, "direction": "current"},
        "k 1, current direction, 100 sweeps": {"iterations": 100, "direction": "current"},
        "k 1, start direction, 10 sweeps": {"iterations": 10, "direction": "start"},
        "k 1, start direction, 100 sweeps": {"iterations": 100, "direction": "start"},
        "k 1, substeps, current direction": {"solver": "substeps", "direction": "current"},
        "k 1, substeps, start direction": {"solver": "substeps", "direction": "start"},
        "compliance 1e-7, start direction, 10 sweeps": {
            "iterations": 10,
            "direction": "start",
            "model": "compliance",
            "compliance": 1e-7,
        },
        "k 0.9, start direction, 10 sweeps": {"iterations": 10, "direction": "start", "k": 0.9},
    }
    points = []
    for name, changes in settings.items():
        for steps in STEPS:
            # one sweep in a substep: ten substeps in a step
            each = base | {"iterations": 10} | changes | {"dt": TIME / steps}
            label = f"{len(points):03d}"
            run = pendulum.run_pendulum(each, runner, label)
            error = float(np.max(pendulum.path_errors(run, each)))
            sweeps = float(run.thermo["Step"][-1]) * each["iterations"]
            points.append(Point(name, sweeps * LINKS, error))
    return points


def trap_points(runner: Runner) -> list[Point]:
    """Return the stretch over that of the springs for one bond and a chain, over the sweeps."""
    base = hanging_chain.CASE.values({}, quick=False) | {"dt": TRAP_DT}
    loads = {
        "one bond": {"links": 1, "mass": 0.1, "length": 1.0, "compliance": 1e-2},
        "20 bonds": {"links": 20, "mass": 0.05, "length": 0.05, "compliance": 1e-3},
    }
    points = []
    for load, physics in loads.items():
        chain = hanging_chain.chain_of(base | physics)
        for model, changes in {
            "a tenth in each sweep": {"model": "k", "tenth": True},
            "k 0.5": {"model": "k", "k": 0.5},
            "k 0.5, half the step": {"model": "k", "k": 0.5, "dt": TRAP_DT / 2},
            "k 1": {"model": "k", "k": 1.0},
            "compliance": {},
            "compliance, half the step": {"dt": TRAP_DT / 2},
        }.items():
            for sweeps in SWEEPS:
                each = base | physics | changes | {"iterations": sweeps}
                if each.pop("tenth", False):  # what a code without equation (9) does with 0.1
                    each["k"] = 1 - 0.9**sweeps
                run = hanging_chain.run_chain(each, runner, f"{len(points):03d}")
                length = -float(hanging_chain.heights_of(run)[-1])
                stretch = (length - chain.links * chain.length) / chain.stretch
                points.append(Point(f"{load}, {model}", sweeps, stretch))
    return points


def curves(points: Sequence[Point]) -> dict[str, list[Point]]:
    """Return the points of each setting, in their order."""
    return {
        name: [point for point in points if point.setting == name]
        for name in dict.fromkeys(point.setting for point in points)
    }


def plot_pendulum(points: Sequence[Point], path: Path) -> None:
    """Draw error over cost, with lines of first and second order."""
    figure, (axes,) = compare.panels(1)
    figure.set_size_inches(9, 6)
    for mark, (name, curve) in zip(MARKS, curves(points).items(), strict=True):
        cost, error = zip(*((point.cost, point.value) for point in curve), strict=True)
        axes.loglog(cost, error, f"{mark}-", label=name)
    axes.set(xlabel="projections of a bond", ylabel="largest error of the tip / length")
    axes.legend(fontsize="small")
    compare.save(figure, path)


def plot_trap(points: Sequence[Point], path: Path) -> None:
    """Draw stretch over sweeps, one panel for each load."""
    figure, panels = compare.panels(1, 2)
    for name, curve in curves(points).items():
        load, _, model = name.partition(", ")
        axes = panels[0] if load == "one bond" else panels[1]
        sweeps, stretch = zip(*((point.cost, point.value) for point in curve), strict=True)
        line = "--" if "half" in model else "-"
        floor = [max(value, LEAST) for value in stretch]
        axes.loglog(sweeps, floor, f"{'s' if 'compliance' in model else 'o'}{line}", label=model)
        axes.set(title=load, xlabel="iterations", ylabel="stretch over alpha T")
    for axes in panels:
        axes.legend(fontsize="small")
    compare.save(figure, path)


Plot = Callable[[Sequence[Point], Path], None]
STUDIES: Mapping[str, tuple[object, Callable[[Runner], list[Point]], Plot]] = {
    "pendulum": (pendulum.CASE, pendulum_points, plot_pendulum),
    "trap": (hanging_chain.CASE, trap_points, plot_trap),
}


def study(name: str, out: Path, console: Console) -> dict[str, list[dict[str, Value]]]:
    """Run one study; writes its plot and its points to a folder."""
    case, measure, plot = STUDIES[name]
    runner = Runner(case.script, out / name, 1, console)
    points = measure(runner)
    plot(points, out / f"{name}.png")
    found = {key: [asdict(point) for point in curve] for key, curve in curves(points).items()}
    write_json(out / f"{name}.json", found)
    return found


def main() -> None:
    """Run the study that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("study", choices=tuple(STUDIES))
    parser.add_argument("--out", type=Path, default=Path("workprecision"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    console = Console()
    for name, curve in study(options.study, options.out, console).items():
        values = "  ".join(f"{point['cost']:g}: {point['value']:.3g}" for point in curve)
        console.print(f"{name:45s} {values}", highlight=False, soft_wrap=True)


if __name__ == "__main__":
    main()
