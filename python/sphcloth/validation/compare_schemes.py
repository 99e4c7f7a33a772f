"""``sphcloth validate --schemes``: one case by every scheme of the time step, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.results import finite, make_folder, write_json
from sphcloth.validation.case import Case
from sphcloth.validation.schemes import SCHEMES
from sphcloth.validation.validate import Result, all_cases, validate


@dataclass(frozen=True)
class Comparison:
    """What a case measures by each scheme.

    Attributes:
        case: the case.
        results: scheme -> its result, or why there is none.
    """

    case: Case
    results: Mapping[str, Result | str]

    @property
    def passed(self) -> bool:
        """Whether every scheme has a result within all limits."""
        return all(isinstance(each, Result) and each.passed for each in self.results.values())

    def rows(self) -> list[list[str]]:
        """Return a row for each quantity with a limit, and one for the cost over constant."""
        found = []
        done = [each for each in self.results.values() if isinstance(each, Result)]
        for quantity in self.case.quantities if done else ():
            limit = done[0].metrics[quantity.name].limit
            if limit is not None:
                cells = [_value(each, quantity.name) for each in self.results.values()]
                found.append([self.case.name, quantity.name, f"{limit:g}", *cells])
        cost = [_updates(each, self.results[SCHEMES[0]]) for each in self.results.values()]
        return [*found, [self.case.name, "updates", "", *cost]]


def cases_with_schemes(name: str) -> list[Case]:
    """Return the cases that know the parameter ``scheme``: the named one, or all.

    Raises:
        UserError: the named case has no scheme, or there is no such case.
    """
    able = {case.name: case for case in all_cases().values() if case.knows("scheme")}
    if name != "all" and name not in able:
        raise UserError(f"no case '{name}' with a scheme: choose from all, {', '.join(able)}")
    return list(able.values()) if name == "all" else [able[name]]


def compare_schemes(
    case: Case,
    settings: Mapping[str, str],
    ranks: int,
    quick: bool,
    out: Path,
    console: Console,
) -> Comparison:
    """Run a case by every scheme, each in a folder of its own, and write ``schemes.json``.

    Individual steps need summed densities: all schemes take them here where the case
    takes continuity.

    Raises:
        UserError: a setting that is not allowed.
    """
    by_rates = case.knows("density") and case.values({}, quick)["density"] == "continuity"
    densities = {"density": "summation"} if by_rates else {}
    same = densities | dict(settings)
    case.values(same, quick)
    make_folder(out)
    results: dict[str, Result | str] = {}
    for scheme in SCHEMES:
        chosen = same | {"scheme": scheme}
        try:
            results[scheme] = validate(case, chosen, ranks, quick, out / scheme, console)
        except UserError as error:
            results[scheme] = str(error)
            console.print(f"{scheme}: {error}", markup=False, highlight=False)
    written = {
        scheme: finite(asdict(each)) if isinstance(each, Result) else each
        for scheme, each in results.items()
    }
    write_json(out / "schemes.json", written, allow_nan=False)
    return Comparison(case, results)


def show(comparisons: Sequence[Comparison], console: Console) -> None:
    """Print what every scheme measures; a value beyond its limit in red, with a star."""
    table = Table()
    for name in ("case", "quantity", "limit", *SCHEMES):
        table.add_column(name, overflow="fold")
    for comparison in comparisons:
        for row in comparison.rows():
            table.add_row(*row)
    console.print(table, highlight=False)
    for comparison in comparisons:
        for scheme, result in comparison.results.items():
            if isinstance(result, str):
                told = f"{comparison.case.name}, {scheme}: {result}"
                console.print(told, markup=False, highlight=False)


def _value(result: Result | str, name: str) -> str:
    if isinstance(result, str):
        return "no result"
    metric = result.metrics[name]
    return f"[red]{metric.value:.3g} *[/]" if metric.passed is False else f"{metric.value:.3g}"


def _updates(result: Result | str, constant: Result | str) -> str:
    if isinstance(result, str) or isinstance(constant, str):
        return ""
    return f"{result.particle_updates / constant.particle_updates:.2f}"
