"""The pages of the documentation and the blocks of code in them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "examples").glob("*/README.md")),
]
TUTORIAL = ROOT / "docs" / "tutorial.ipynb"


BLOCK = r"(?:^<!-- ((?:run by|not run:) .*?) -->\n)?^```(\w*)\n(.*?)^```$"


@dataclass(frozen=True)
class Block:
    """A block of code: its page and line, its language and text, and what is said above it."""

    page: str
    line: int
    language: str
    text: str
    remark: str | None

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"


def blocks_of(page: Path) -> Iterator[Block]:
    text = page.read_text()
    for found in re.finditer(BLOCK, text, re.MULTILINE | re.DOTALL):
        line = text.count("\n", 0, found.start()) + 1
        yield Block(str(page.relative_to(ROOT)), line, found[2], found[3], found[1])


BLOCKS = [block for page in PAGES for block in blocks_of(page)]


def is_script(block: Block) -> bool:
    return "create_box" in block.text and "\nrun " in block.text
