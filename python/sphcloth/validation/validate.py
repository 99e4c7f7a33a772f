"""``sphcloth validate``: find a case, run it, compare, write and show the result."""

from __future__ import annotations

import importlib
import pkgutil
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.results import Value, finite, make_folder, mark, versions, write_json
from sphcloth.validation import cases, schemes
from sphcloth.validation.case import Case, Metric
from sphcloth.validation.runner import Runner


@dataclass(frozen=True)
class Result:
    """All that a validation found; the fields are those of the JSON.

    Attributes:
        case: the case's name.
        parameters: value of every parameter.
        quick: whether it was the quick variant.
        ranks: number of MPI ranks.
        metrics: name -> value, limit, unit and verdict.
        wall_s: wall time of the whole case in seconds.
        particle_updates: number of times a particle was stepped, in all runs.
        versions: package -> version.
    """

    case: str
    parameters: dict[str, Value]
    quick: bool
    ranks: int
    metrics: dict[str, Metric]
    wall_s: float
    particle_updates: float
    versions: dict[str, str]

    @property
    def passed(self) -> bool:
        """Whether every metric that has a limit is within it."""
        return all(metric.passed is not False for metric in self.metrics.values())

    def write(self, path: Path) -> None:
        """Write everything and the verdict as JSON; a value that is no number becomes null."""
        values = finite(asdict(self)) | {"passed": self.passed}
        write_json(path, values, allow_nan=False)

    def show(self, case: Case, console: Console) -> None:
        """Print the metrics as a table, and the verdict."""
        table = Table("metric", "value", "limit", "unit", "", title=self.case)
        for quantity in case.quantities:
            metric = self.metrics[quantity.name]
            limit = "" if metric.limit is None else f"{metric.limit:g}"
            row = quantity.name, f"{metric.value:.4g}", limit, metric.unit, mark(metric.passed)
            table.add_row(*row)
        console.print(table)
        verdict = "[green]passed[/]" if self.passed else "[red]failed[/]"
        cost = f"{self.particle_updates:.3g} particle updates in {self.wall_s:.1f} s"
        console.print(f"{self.case}: {verdict}, {cost}", highlight=False)


def all_cases() -> dict[str, Case]:
    """Return name -> case for every package in :mod:`sphcloth.validation.cases`."""
    modules = pkgutil.iter_modules(cases.__path__, f"{cases.__name__}.")
    found = [importlib.import_module(module.name).CASE for module in modules]
    return {case.name: case for case in found}


def find_case(name: str) -> Case:
    """Return a case; UserError with the names there are if there is none."""
    known = all_cases()
    if name not in known:
        raise UserError(f"no case '{name}': choose from {', '.join(known)}")
    return known[name]


def validate(
    case: Case,
    settings: Mapping[str, str],
    ranks: int,
    quick: bool,
    out: Path,
    console: Console,
) -> Result:
    """Run a case and judge it; writes ``<name>.json`` and ``<name>.png`` to a folder.

    Args:
        case: what to run.
        settings: parameters that differ from those of the size, as texts.
        ranks: number of MPI ranks.
        quick: take the smaller variant with its own limits.
        out: output folder, made if need be.
        console: where progress appears.

    Raises:
        UserError: a setting that is not allowed, or LAMMPS failed.
    """
    values = case.values(settings, quick)
    schemes.check(values)
    make_folder(out)
    for stale in (f"{case.name}.json", f"{case.name}.png"):
        (out / stale).unlink(missing_ok=True)
    runner = Runner(case.script, out, ranks, console)
    start = time.monotonic()
    metrics = case.judge(case.measure(values, runner), quick)
    result = Result(
        case.name,
        values,
        quick,
        ranks,
        metrics,
        time.monotonic() - start,
        runner.particle_updates(),
        versions(),
    )
    result.write(out / f"{case.name}.json")
    return result


def show_cases(console: Console) -> None:
    """Print one line for each case."""
    table = Table("case", "what: compared with what", box=None, pad_edge=False)
    for case in all_cases().values():
        table.add_row(case.name, case.summary)
    console.print(table)
    console.print("[dim]sphcloth validate --list CASE shows its parameters and limits[/]")


def show_case(case: Case, console: Console) -> None:
    """Print what a case measures and its parameters."""
    console.print(f"{case.name}: {case.summary}\n", highlight=False)
    measured = Table("measured", "limit", "quick", "unit", "what", box=None, pad_edge=False)
    for quantity in case.quantities:
        limits = (quantity.limit, quantity.quick_limit)
        texts = ("" if limit is None else f"{limit:g}" for limit in limits)
        measured.add_row(quantity.name, *texts, quantity.unit, quantity.description)
    parameters = Table("parameter", "default", "quick", "unit", "what", box=None, pad_edge=False)
    for parameter in case.parameters:
        values = (parameter.default, parameter.quick)
        texts = ("" if value is None else _short(value) for value in values)
        what = f"{parameter.description}\n[dim]{parameter.allowed}[/]"
        parameters.add_row(parameter.name, *texts, parameter.unit, what)
    console.print(measured, "", parameters, highlight=False)


def _short(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
