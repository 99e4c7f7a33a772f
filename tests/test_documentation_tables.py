"""Every table of measurements stands below the command that makes it, and says what that takes.

Every table of docs/evidence is one of measurements; on other pages, one with a cell that is a
number, or has one with a unit, but for sizes and defaults. `<!-- not measured: REASON -->` above a
table says that it is none. `<!-- table NAME -->` begins one that `make reliability-page` makes. A
table with a column `command` has its commands there.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from doc_pages import PAGES, ROOT
from test_documentation_commands import CHECKS

from sphcloth.stress.page import TABLES as MADE

REMARK = re.compile(r"<!-- not measured: \w.*? -->")
GENERATED = re.compile(r"<!-- table (\w+) -->(?!.*<!-- end -->)", re.DOTALL)
# what is between these in a cell is a name, a formula or a reference
NAMES = re.compile(r"`[^`]*`|\$[^$]*\$|\]\([^)]*\)")
# a cell of a page of reference that looks like a result
RESULT = re.compile(
    r"\**[-+]?\d[\d.,]*(?:e-?\d+)?\**|.*\d(?: ?%| (?:s|ms|ns|min|minutes|J|N|mm|times)\b).*"
)
# columns of numbers that are chosen, and the first cell of tables of sizes
CHOSEN = ("default", "number", "index", "value")
SIZES = "`--size`"
COMMAND = re.compile(r"`((?:sphcloth|make|lmp -in|pytest) [^`]+|python -m sphcloth[^`]*)`")
COST = re.compile(
    r"\b(?:wall times?|updates|seconds?|minutes?|hours?|\d+ s|rounds)\b", re.IGNORECASE
)


@dataclass(frozen=True)
class Table:
    """A table of a page.

    Attributes:
        page: relative to the root.
        line: of its head.
        above: the page from the head of the section to that of the table, both included.
        section: all of that section.
        head: its cells.
        rows: the cells of each line below its head, as they stand there.
    """

    page: str
    line: int
    above: str
    section: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    @property
    def measured(self) -> bool:
        """Whether it has numbers that are not said to be something else."""
        if REMARK.fullmatch(self.above.splitlines()[-2].strip()) or self.head[0] == SIZES:
            return False
        return self.page.startswith("docs/evidence") or any(
            RESULT.fullmatch(NAMES.sub("", cell))
            for row in self.rows
            for name, cell in zip(self.head, row, strict=True)
            if name not in CHOSEN
        )

    @property
    def generated(self) -> bool:
        """Whether a program writes it into the page."""
        begun = GENERATED.findall(self.above)
        return bool(begun) and begun[-1] in MADE

    @property
    def commands(self) -> list[str]:
        """The command lines in what is above it, of blocks and of code within a line."""
        if "command" in self.head:
            column = self.head.index("command")
            return [found for row in self.rows for found in COMMAND.findall(row[column])]
        blocks = re.findall(r"^ *```sh\n(.*?)^ *```$", self.above, re.MULTILINE | re.DOTALL)
        plain = re.sub(r"^ *```.*?^ *```$", "", self.above, flags=re.MULTILINE | re.DOTALL)
        lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
        return [*lines, *COMMAND.findall(" ".join(plain.split()))]


def tables_of(page: Path) -> Iterator[Table]:
    """Yield the tables of a page, but for those in its blocks of code."""
    lines, inside = page.read_text().split("\n"), False
    heads = []
    for n, line in enumerate(lines):
        inside ^= bool(re.match(r" *```", line))
        if not inside and re.match(r"#+ ", line):
            heads.append(n)
        if inside or not re.match(r" *\|[-:| ]*-[-:| ]*\|$", line):
            continue
        end = next((m for m in range(n, len(lines)) if "|" not in lines[m]), len(lines))
        first = heads[-1]
        last = next((m for m in range(n, len(lines)) if re.match(r"#+ ", lines[m])), len(lines))
        yield Table(
            str(page.relative_to(ROOT)),
            n,
            "\n".join(lines[first:n]),
            "\n".join(lines[first:last]),
            cells_of(lines[n - 1]),
            tuple(cells_of(row) for row in lines[n + 1 : end]),
        )


def cells_of(line: str) -> tuple[str, ...]:
    """Return the cells of a line of a table."""
    return tuple(cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|")))


def check_pytest(words: list[str]) -> None:
    """The files are there."""
    assert all((ROOT / word).is_file() for word in words if not word.startswith("-"))


def exists(command: str) -> bool:
    """Say whether a program of the package takes the command line."""
    program, *rest = shlex.split(command, comments=True) or [""]
    name = Path(program).name if "/" in program else program
    check = {**CHECKS, "pytest": check_pytest}.get(name)
    try:
        if check:
            check(rest)
    except Exception:  # whatever a parser says to words that it does not take
        return False
    return check is not None


TABLES = [table for page in PAGES for table in tables_of(page)]
MEASURED = [
    pytest.param(table, id=f"{table.page}:{table.line}") for table in TABLES if table.measured
]


@pytest.mark.parametrize("table", MEASURED)
def test_a_table_of_measurements_has_its_command_above(table: Table) -> None:
    assert table.generated or any(exists(command) for command in table.commands), (
        f"no command that exists above the table, in its section: {table.commands}"
    )
    assert table.generated or COST.search(table.section), "how long does the command take?"


def test_a_table_without_its_command_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("test_documentation_tables.ROOT", tmp_path)
    page = tmp_path / "docs" / "evidence" / "page.md"
    page.parent.mkdir(parents=True)
    table = "| case | error |\n|---|---|\n| `couette` | 0.11 % |\n"
    command = "`sphcloth validate couette --quick`, 2 s:\n\n"
    for text, measured, made in (
        (f"# A\n\n{table}", True, False),
        (f"# A\n\n{command}{table}", True, True),
        (f"# A\n\n{command}# B\n\n{table}", True, False),
        (f"# A\n\n{command.replace('couette', 'no-such-case')}{table}", True, False),
        (f"# A\n\n<!-- not measured: an example -->\n{table}", False, False),
        (f"# A\n\n```text\n{table}```\n", None, None),
    ):
        page.write_text(text)
        found = list(tables_of(page))
        assert [one.measured for one in found] == ([] if measured is None else [measured])
        assert all(any(map(exists, one.commands)) == made for one in found)
