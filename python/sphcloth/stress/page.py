"""Tables of ``docs/evidence/reliability.md`` from what the runs wrote.

``python -m sphcloth.stress.page build/reliability docs/evidence/reliability.md`` replaces what
stands between ``<!-- table NAME -->`` and ``<!-- end -->``. A table whose file is not there stays.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated
from xml.etree import ElementTree

import typer
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.results import markdown_table as table

MEGABYTE = 2.0**20


def _by(found: Sequence[dict], *names: str) -> dict[tuple, list[dict]]:
    """Return what was found by the values of some names, in the order in which they come."""
    groups: dict[tuple, list[dict]] = {}
    for one in found:
        groups.setdefault(tuple(one[name] for name in names), []).append(one)
    return groups


def extremes(path: Path) -> str:
    """Runs and breaches of ``sphcloth stress`` by scheme and ranks."""
    runs = json.loads(path.read_text())["runs"]
    counts = sorted({run["ranks"] for run in runs})
    groups = _by(runs, "scheme", "ranks")
    rows = [
        [scheme, *(_breaches(groups.get((scheme, n), [])) for n in counts)]
        for (scheme,) in _by(runs, "scheme")
    ]
    heads = ["scheme", *(f"{n} rank{'s'[: n > 1]}" for n in counts)]
    bad = [
        f"* `{r['case']}`, {r['scheme']}, {r['ranks']} ranks: {'; '.join(r['complaints'])}"
        for r in runs
        if not r["passed"]
    ]
    told = f"{len(runs)} runs of {len(_by(runs, 'case'))} cases, {len(bad)} breaches."
    return _told(told, "\n".join([table(heads, rows), *([""] if bad else []), *bad]))


def _told(line: str, rows: str) -> str:
    """Return a table below a line that sums it up."""
    return f"**{line}**\n\n{rows}"


def _breaches(runs: Sequence[dict]) -> str:
    return f"{len(runs)} runs, {sum(not run['passed'] for run in runs)} breaches"


def equality(path: Path) -> str:
    """Largest difference of a place over the spacing, by way and box and scheme."""
    found = json.loads(path.read_text())
    kinds = list(_by(found, "box", "scheme"))
    rows = []
    for way, here in _by(found, "way", "ranks").items():
        by_kind = {(one["box"], one["scheme"]): one for one in here}
        rows.append([_way(*way), *(_difference(by_kind.get(kind)) for kind in kinds)])
    wrong = sum(not one["passed"] for one in found)
    heads = ["way", *(f"{box}, `{scheme}`" for box, scheme in kinds)]
    return _told(f"{len(found)} ends compared, {wrong} differ.", table(heads, rows))


def _way(name: str, ranks: int) -> str:
    return name if "rank" in name or ranks == 1 else f"{name}, {ranks} ranks"


def _difference(one: dict | None) -> str:
    if one is None:
        return ""
    if one["place"] is None:
        return f"**{one['complaint'][:60]}**"
    text = f"{one['place']:.0e}" if one["place"] else "0"
    return text if one["passed"] else f"**{text}**"


def kills(path: Path) -> str:
    """Killed runs by scheme and ranks."""
    found = json.loads(path.read_text())
    rows = [
        [
            f"`{scheme}`",
            ranks,
            len(here),
            sum(one["in_time"] for one in here),
            sum(one["had_file"] for one in here),
            sum(not one["complaint"] for one in here),
        ]
        for (scheme, ranks), here in _by(found, "scheme", "ranks").items()
    ]
    wrong = sum(bool(one["complaint"]) for one in found)
    heads = ["scheme", "ranks", "runs", "killed in time", "had a restart file", "same to the bit"]
    return _told(f"{len(found)} runs killed, {wrong} ended otherwise.", table(heads, rows))


def bugs(path: Path) -> str:
    """Deliberate bugs, and the test that sees each."""
    found = json.loads(path.read_text())
    told = f"{sum(bool(one['caught']) for one in found)} of {len(found)} bugs caught."
    rows = [[one["bug"], _test(one["caught"]), one["seconds"]] for one in found]
    return _told(told, table(["bug", "caught by", "s"], rows))


def mutants(path: Path) -> str:
    """Mutants by folder and operator, verdicts on those not caught at first, faults of the past."""
    found = json.loads(path.read_text())
    all_of_them = found["mutants"]
    total, *_, equivalent, open_, left = _counts(all_of_them)
    caught = total - equivalent - open_ - left
    told = (
        f"{total} mutants of {found['places']} places: {caught} caught, {equivalent} equivalent, "
        f"{left} not caught, {open_} open; {100.0 * caught / max(1, total - equivalent):.1f} % of "
        "those that are not equivalent are caught."
    )
    heads = ["mutants", "caught", "by new tests", "equivalent", "open", "not caught"]
    parts = [
        table(
            [head, *heads], [[name, *_counts(of)] for (name,), of in _by(all_of_them, head).items()]
        )
        for head in ("folder", "operator")
    ]
    verdicts = [
        [f"`{Path(one['file']).name}:{one['line']}`", _code(one), _verdict(one)]
        for one in all_of_them
        if one["new"] or not one["caught"]
    ]
    faults = [
        [one["what"], f"`{Path(one['file']).name}`", _code(one), _test(one["caught"])]
        for one in found["faults"]
    ]
    parts += [
        table(["place", "mutant", "verdict"], verdicts),
        table(["fault of the past", "file", "mutant", "caught by"], faults),
    ]
    return _told(told, "\n\n".join(parts))


def _counts(some: Sequence[dict]) -> list[int]:
    """Return how many: all, caught by old tests, by new ones, equivalent, open, not caught."""
    kinds = [_kind(one) for one in some]
    names = ("caught", "new", "equivalent", "open", "left")
    return [len(some), *(kinds.count(name) for name in names)]


def _kind(one: dict) -> str:
    if one["caught"]:
        return "new" if one["new"] else "caught"
    if one["equivalent"]:
        return "equivalent"
    return "left" if one["judged"] else "open"


def _code(one: dict) -> str:
    """Return both ways to write it, as a cell of a table."""
    ways = [f"`` {way} ``" for way in (one["right"], one["wrong"]) if way]
    ways += ["nothing"] * (2 - len(ways))
    return " → ".join(ways).replace("|", "\\|")


def _verdict(one: dict) -> str:
    match _kind(one):
        case "equivalent":
            return f"equivalent: {one['equivalent']}"
        case "left":
            return f"**not caught** by {one['tried']} tests, {one['left']} that reach it left out"
        case "open":
            return f"open: not caught by {one['tried']} tests so far"
    return f"caught by {_test(one['caught'])}"


def _test(caught: str) -> str:
    file, _, test = caught.partition("::")
    if not test:
        return caught or "**none**"
    return f"`{Path(file).name}`: `{test}`"


def fuzz(path: Path) -> str:
    """Commands and files that were damaged, from the report of pytest."""
    rows = []
    for case in ElementTree.parse(path).iter("testcase"):
        counts = {p.get("name"): int(p.get("value", 0)) for p in case.iter("property")}
        if "tried" in counts:
            kind = re.sub(r".*\[(.*)\]", r"\1", case.get("name", ""))
            wrong = "**yes**" if case.find("failure") is not None else "0"
            rows.append([kind, counts["tried"], counts["refused"], wrong])
        elif case.find("failure") is not None:
            rows.append([case.get("name"), 0, 0, "**yes**"])
    told = f"{sum(row[1] for row in rows)} commands and files."
    return _told(told, table(["kind", "tried", "refused by name", "wrong"], rows))


def steps(path: Path) -> str:
    """Drift over a million steps."""
    heads = ["scheme", "steps", "time, s", "mass", "momentum", "energy, largest rise", "left"]
    rows = [
        [
            f"`{one['scheme']}`",
            one["steps"],
            f"{one['time']:.0f}",
            *(f"{one[name]:.0e}" for name in ("mass", "momentum", "energy_rise")),
            f"{one['energy_left']:.3f}",
            one["memory"],
        ]
        for one in json.loads(path.read_text())["found"]
    ]
    return table([*heads, "heap, bytes"], rows)


def pouring(path: Path) -> str:
    """Memory over an hour: at the begin, when the scene was full, and in the end."""
    found = json.loads(path.read_text())["found"]
    looks = found["looks"]
    rows = [
        [
            f"{look['wall_s'] / 60:.0f}",
            look["step"],
            look["atoms"],
            look["poured"],
            *(f"{look[name] / MEGABYTE:.2f}" for name in ("resident", "heap", "own")),
        ]
        for look in looks[:: max(1, (len(looks) - 1) // 6)]
    ]
    heads = ["min", "step", "atoms", "poured", "resident, MB", "heap, MB", "LAMMPS says, MB"]
    return table(heads, rows)


def instances(path: Path) -> str:
    """What an instance leaves behind."""
    rows = [
        [one["kind"], one["times"], f"{one['heap']:.1f}", f"{one['resident']:.0f}"]
        for one in json.loads(path.read_text())["found"]
    ]
    return table(["cycle", "times", "heap, bytes each", "resident, bytes each"], rows)


# name of the table -> the file that it is made of, and how
TABLES: dict[str, tuple[str, Callable[[Path], str]]] = {
    "stress": ("stress.json", extremes),
    "equality": ("equality.json", equality),
    "equality_large": ("equality_large.json", equality),
    "kill": ("kill.json", kills),
    "mutate": ("mutate.json", bugs),
    "mutants": ("mutants.json", mutants),
    "fuzz": ("fuzz.xml", fuzz),
    "steps": ("steps.json", steps),
    "pour": ("pour.json", pouring),
    "instances": ("instances.json", instances),
}


def renewed(text: str, folder: Path) -> tuple[str, list[str]]:
    """Return a page with the tables whose files are in a folder, and the names of those.

    Raises:
        UserError: the page has no place for a table, or a file is of another form.
    """
    made = []
    for name, (file, make) in TABLES.items():
        if not (folder / file).is_file():
            continue
        pattern = rf"(<!-- table {name} -->\n).*?(<!-- end -->)"
        try:
            rows = make(folder / file)
        except (ValueError, KeyError, TypeError, ElementTree.ParseError) as error:
            raise UserError(f"{folder / file}: not what a run writes ({error!r})") from error
        text, places = re.subn(pattern, lambda m, r=rows: f"{m[1]}{r}\n{m[2]}", text, flags=re.S)
        if places != 1:
            raise UserError(f"the page has {places} places for the table {name}, not one")
        made.append(name)
    return text, made


def main(
    folder: Annotated[Path, typer.Argument(help="With what the runs wrote.")],
    page: Annotated[Path, typer.Argument(help="Page in which the tables are renewed.")],
) -> None:
    """Renew the tables of the page on reliability."""
    text, made = renewed(page.read_text(encoding="utf-8"), folder)
    page.write_text(text, encoding="utf-8")
    kept = [name for name in TABLES if name not in made]
    Console().print(
        f"renewed: {', '.join(made) or 'none'}; as they were: {', '.join(kept) or 'none'}"
    )


if __name__ == "__main__":
    typer.run(main)
