"""``sphcloth stress``: choose cases, run them, show the table, write the JSON."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.results import make_folder, mark, versions, write_json
from sphcloth.stress.case import SCHEMES, Case
from sphcloth.stress.cases import all_cases
from sphcloth.stress.random_run import random_scenes
from sphcloth.stress.runner import Verdict, run_case


def stress(
    name: str | None,
    schemes: str | None,
    ranks: str | None,
    quick: bool,
    out: Path | None,
    json_file: Path | None,
    console: Console,
) -> list[Verdict]:
    """Run one case or all, show the table and return what was found.

    Args:
        name: of a case; None: all.
        schemes: names with commas between them; None: all that a case names.
        ranks: numbers with commas between them; None: 1, 2 and 4, with quick 1 and 2.
        quick: the smaller variants.
        out: folder that keeps what the runs wrote; None: nothing is kept.
        json_file: where the result goes, after each case; None: nowhere.
        console: where progress and the table go.

    Raises:
        UserError: an unknown case or scheme, or a number of ranks that is none.
    """
    chosen = _find_cases(name)
    wanted = _find_schemes(schemes)
    counts = _find_ranks(ranks or ("1,2" if quick else "1,2,4"))
    if out is not None:
        make_folder(out)
    found: list[Verdict] = []
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch, console.status("") as status:
        for k, case in enumerate(chosen):
            status.update(f"{case.name}, {k + 1} of {len(chosen)}")
            found += run_case(case, wanted, counts, quick, out or Path(scratch))
            if json_file is not None:
                _write(found, json_file, time.monotonic() - start)
    show(chosen, found, console)
    return found


def stress_random(
    seed: int,
    count: int,
    schemes: str | None,
    out: Path | None,
    json_file: Path | None,
    console: Console,
) -> list[Verdict]:
    """Run random scenes and return what was found; a scene that fails leaves its files in out.

    Args:
        seed: of the first scene.
        count: how many.
        schemes: with which each of them is run, names with commas between them; None: with the one
            that the seed draws.
        out: folder for them; None: ``stress-random``.
        json_file: where the result goes, after each scene; None: nowhere.
        console: where progress and failures go.

    Raises:
        UserError: a seed or a count that is none, or an unknown scheme.
    """
    wanted = [None] if schemes is None else _find_schemes(schemes)
    if out is not None:
        make_folder(out)
    found: list[Verdict] = []
    start = time.monotonic()
    with console.status("") as status:
        for one in random_scenes(seed, count, out or Path("stress-random"), console, wanted):
            found.append(one)
            status.update(f"{one.case}, {len(found)} of {count * len(wanted)}")
            if json_file is not None:
                _write(found, json_file, time.monotonic() - start)
    _show_sum(found, console)
    return found


def _find_cases(name: str | None) -> list[Case]:
    known = all_cases()
    if name is not None and name not in known:
        raise UserError(f"no case '{name}': choose from {', '.join(known)}")
    return list(known.values()) if name is None else [known[name]]


def _find_schemes(text: str | None) -> list[str]:
    names = list(SCHEMES) if text is None else [word.strip() for word in text.split(",")]
    for scheme in names:
        if scheme not in SCHEMES:
            raise UserError(f"--scheme {scheme}: choose from {', '.join(SCHEMES)}")
    return names


def _find_ranks(text: str) -> list[int]:
    try:
        counts = [int(word) for word in text.split(",")]
    except ValueError:
        counts = [0]
    if min(counts) < 1:
        raise UserError(f"--ranks {text}: expected whole numbers above 0, as in --ranks 1,2,4")
    return counts


def show(cases: Sequence[Case], found: Sequence[Verdict], console: Console) -> None:
    """Print a row for each case and scheme, a mark for each number of ranks, and the breaches."""
    counts = sorted({verdict.ranks for verdict in found})
    heads = [f"{n} rank{'s'[: n > 1]}" for n in counts]
    table = Table("case", "must", "scheme", *heads, "s")
    for case in cases:
        for scheme in dict.fromkeys(v.scheme for v in found if v.case == case.name):
            here = {v.ranks: v for v in found if (v.case, v.scheme) == (case.name, scheme)}
            marks = [mark(here[n].passed, "breach") if n in here else "" for n in counts]
            wall = f"{sum(v.wall_s for v in here.values()):.1f}"
            table.add_row(case.name, case.must, scheme, *marks, wall)
    console.print(table)
    breaches = [verdict for verdict in found if not verdict.passed]
    for v in breaches:
        where = f"{v.case}, {v.scheme}, {v.ranks} ranks: {'; '.join(v.complaints)}"
        console.print(f"[red]breach[/] {escape(where)}", highlight=False, soft_wrap=True)
    _show_sum(found, console)


def _show_sum(found: Sequence[Verdict], console: Console) -> None:
    n = sum(not verdict.passed for verdict in found)
    verdict = f"[red]{n} breaches[/]" if n else "[green]no breach[/]"
    console.print(f"{len(found)} runs: {verdict}", highlight=False)


def show_cases(console: Console) -> None:
    """Print every case with what must happen."""
    table = Table("case", "must", "schemes", "ranks")
    for case in all_cases().values():
        schemes = "all" if set(case.schemes) == set(SCHEMES) else "\n".join(case.schemes)
        table.add_row(case.name, case.must, schemes, ", ".join(map(str, case.ranks)))
    console.print(table)


def _write(found: Sequence[Verdict], path: Path, wall_s: float) -> None:
    """Write all that was found as JSON."""
    result = {
        "runs": [asdict(verdict) | {"passed": verdict.passed} for verdict in found],
        "breaches": sum(not verdict.passed for verdict in found),
        "passed": all(verdict.passed for verdict in found),
        "wall_s": wall_s,
        "versions": versions(),
    }
    write_json(path, result)
