"""What a trade-off shows: tables on the screen, CSV, JSON and figures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sphcloth.tradeoff.figures import draw
from sphcloth.tradeoff.front import BASELINES, COSTS, Choice, Point
from sphcloth.tradeoff.study import Study

# marks of the Pareto fronts in the table
MARKS = {"updates": "U", "wall_s": "W"}


def write_all(study: Study, out: Path) -> list[Path]:
    """Write CSV, JSON and figures to a folder; returns all files."""
    table, result = out / f"{study.scene.name}.csv", out / f"{study.scene.name}.json"
    write_csv(study, table)
    study.write(result)
    return [table, result, *draw(study, out)]


def write_csv(study: Study, path: Path) -> None:
    """Write one row for each setting, the reference first; what a failed run lacks is empty."""
    names = list(dict.fromkeys(name for point in study.points for name in point.values))
    quantities = [quantity.name for quantity in study.scene.quantities]
    fronts = {cost: study.front(cost) for cost in COSTS}
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        heads = [f"error_{name}" for name in quantities]
        if study.plan.over:
            heads += [f"worst_{name}" for name in quantities]
        heads += [f"front_{cost}" for cost in COSTS]
        rows.writerow(["role", "scheme", *names, "steps", *COSTS, *heads, "failure"])
        first = [("reference", study.reference)] if study.reference else []
        for role, point in [*first, *(("", p) for p in study.points)]:
            rows.writerow(
                [
                    role,
                    point.scheme,
                    *(point.values.get(name) for name in names),
                    point.steps,
                    *(point.cost(cost) for cost in COSTS),
                    *(point.errors.get(name) for name in quantities),
                    *(point.worst.get(name) for name in quantities if study.plan.over),
                    *(int(point in fronts[cost]) for cost in COSTS),
                    point.failure,
                ]
            )


def show(study: Study, console: Console) -> None:
    """Print all settings, why some failed, and the cheapest ones within the error."""
    console.print(_settings_table(study))
    for point in study.points:
        if point.failure is not None:
            console.print(
                f"{_failed(study)}: {point.scheme}, {point.label}: {point.failure}",
                markup=False,
                highlight=False,
                soft_wrap=True,
            )
    for cost in COSTS:
        _show_choices(study, cost, console)
    if study.side_by_side:
        console.print(
            "[yellow]wall times were measured side by side: particle updates are the better "
            "measure here; --jobs 1 --fresh measures each run alone[/]"
        )


def _settings_table(study: Study) -> Table:
    quantities = [quantity.name for quantity in study.scene.quantities]
    table = _table(
        study,
        escape(f"{study.scene.name}: {study.scene.summary}"),
        ("updates", "wall s", *(f"error {name}" for name in quantities)),
    )
    table.add_column("", no_wrap=True)
    table.caption = "U, W: on the Pareto front by particle updates, by wall time"
    fronts = {cost: study.front(cost) for cost in COSTS}
    if (exact := study.reference) is not None:
        setting = escape(f"{exact.scheme}, {exact.label}")
        table.add_row("reference", setting, *_cost_cells(exact))
    for point in study.points:
        if point.failure is not None:
            table.add_row(*_names(point), "", "", f"[red]{_failed(study)}[/]")
            continue
        errors = [f"{point.errors[name]:.1e}" for name in quantities]
        marks = [mark for cost, mark in MARKS.items() if point in fronts[cost]]
        table.add_row(*_names(point), *_cost_cells(point), *errors, "".join(marks))
    return table


def _names(point: Point) -> tuple[str, str]:
    return escape(point.scheme), escape(point.label)


def _failed(study: Study) -> str:
    return "unstable" if study.reference else "failed"


def _cost_cells(point: Point) -> tuple[str, str]:
    return f"{point.updates:.2e}", f"{point.wall_s:.3g}"


def _table(study: Study, title: str, numbers: Sequence[str]) -> Table:
    """Return a table of settings with these columns of numbers, whose heads are one word a line."""
    table = Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("scheme" if study.reference else "group", no_wrap=True)
    table.add_column("setting", min_width=12)
    for head in numbers:
        table.add_column(escape(head).replace(" ", "\n"), justify="right", no_wrap=True)
    return table


def _show_choices(study: Study, cost: str, console: Console) -> None:
    """Print the cheapest setting of each scheme by one of the costs."""
    found = study.choices(cost)
    name, error = study.quantity.name, study.plan.error
    if not found:
        told = f"no setting has an error of {name} of at most {error:g}"
        console.print(told, markup=False, highlight=False)
        return
    best = study.best(cost)
    compared = BASELINES if study.reference else ()
    baselines = [f"best {scheme} over this" for scheme in compared]
    title = escape(f"cheapest by {COSTS[cost]}, error of {name} at most {error:g}")
    table = _table(study, title, ("error", COSTS[cost], *baselines))
    for scheme, choice in found.items():
        mark = " (best)" if scheme == best else ""
        table.add_row(f"{escape(scheme)}{mark}", *_choice_cells(choice, name, cost, compared))
    console.print(table)


def _choice_cells(choice: Choice, quantity: str, cost: str, compared: Sequence[str]) -> list[str]:
    point = choice.point
    saved = [choice.saving[scheme] for scheme in compared]
    savings = ["n/a" if each is None else f"{each:.2f}" for each in saved]
    return [
        escape(point.label),
        f"{point.errors[quantity]:.1e}",
        f"{point.cost(cost):.3g}",
        *savings,
    ]
