"""Every table of measurements stands below the command that makes it, with what the command takes.

In docs/evidence a table is one of measurements if a cell below its head has a digit outside of code,
formulas and links; on other pages, if a cell is a number or has one with a unit, but for sizes and
defaults. The remark `<!-- not measured: REASON -->` above a table says that its numbers are not.
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

REMARK = re.compile(r"<!-- not measured: \w.*? -->")
# what is between these in a cell is a name, a formula or a reference
NAMES = re.compile(r"`[^`]*`|\$[^$]*\$|\]\([^)]*\)")
# a cell of a page of reference that looks like a result
RESULT = re.compile(
    r"\**[-+]?\d[\d.,]*(?:e-?\d+)?\**|.*\d(?: ?%| (?:s|ms|ns|min|minutes|J|N|mm|times)\b).*"
)
# columns of numbers that are chosen, and the first cells of tables of sizes
CHOSEN = ("default", "number", "index", "value")
SIZES = "`--size`"
COMMAND = re.compile(r"`((?:sphcloth|python -m sphcloth[.\w]*|make|lmp -in) [^`]+|make [-\w]+)`")
COST = re.compile(r"\b(?:wall time|updates|seconds?|minutes?|hours?|\d s)\b", re.IGNORECASE)


@dataclass(frozen=True)
class Table:
    """A table of a page.

    Attributes:
        page: relative to the root.
        line: of its head.
        above: the page from the last head of a section to the table, its first line included.
        section: all of that section.
        head: its cells.
        rows: the cells of each line below its head.
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
        said = self.above.rstrip().splitlines()[-1:]
        if any(REMARK.fullmatch(line.strip()) for line in said):
            return False
        if self.page.startswith("docs/evidence"):
            return any(re.search(r"\d", cell) for row in self.rows for cell in row)
        if self.head[0] == SIZES:
            return False
        return any(
            RESULT.fullmatch(cell)
            for row in self.rows
            for name, cell in zip(self.head, row, strict=True)
            if name not in CHOSEN
        )

    @property
    def commands(self) -> list[str]:
        """The command lines in what is above it: of blocks, and of code within a line."""
        blocks = re.findall(r"^```sh\n(.*?)^```$", self.above, re.MULTILINE | re.DOTALL)
        plain = re.sub(r"^```.*?^```$", "", self.above, flags=re.MULTILINE | re.DOTALL)
        lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
        return [*lines, *COMMAND.findall(" ".join(plain.split()))]


def tables_of(page: Path, text: str) -> Iterator[Table]:
    """Yield the tables of a page outside of its code."""
    lines = text.split("\n")
    heads = [n for n, line in enumerate(lines) if re.match(r"#+ ", line)]
    inside = False
    for n, line in enumerate(lines):
        inside ^= bool(re.match(r" *```", line))
        if inside or not re.match(r" *\|[-:| ]*-[-:| ]*\|$", line):
            continue
        end = next((m for m in range(n, len(lines)) if "|" not in lines[m]), len(lines))
        first = max((head for head in heads if head < n), default=0)
        last = next((head for head in heads if head > n), len(lines))
        yield Table(
            str(page.relative_to(ROOT)),
            n,
            "\n".join(lines[first : n - 1]),
            "\n".join(lines[first:last]),
            cells(lines[n - 1]),
            tuple(cells(NAMES.sub("", row)) for row in lines[n + 1 : end]),
        )


def cells(line: str) -> tuple[str, ...]:
    """Return the cells of a line of a table; a formula may have the sign between them in it."""
    return tuple(cell.strip() for cell in line.strip().strip("|").split("|"))


def exists(command: str) -> bool:
    """Say whether a program of the package takes the command line."""
    program, *rest = shlex.split(command, comments=True) or [""]
    check = CHECKS.get(Path(program).name if "/" in program else program)
    try:
        return check is not None and (check(rest) or True)
    except Exception:
        return False


TABLES = [table for page in PAGES for table in tables_of(page, page.read_text())]
MEASURED = [
    pytest.param(table, id=f"{table.page}:{table.line}") for table in TABLES if table.measured
]


@pytest.mark.parametrize("table", MEASURED)
def test_a_table_of_measurements_has_its_command_above(table: Table) -> None:
    assert any(exists(command) for command in table.commands), (
        f"no command that exists above the table, in its section: {table.commands}"
    )
    assert COST.search(table.section), "how long does the command take?"
