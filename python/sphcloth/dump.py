"""Where the frames of a LAMMPS text dump are in its file, and what their headers say."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError

REQUIRED_COLUMNS = ("id", "type", "x", "y", "z")

# line of a frame's header -> how it must begin
_HEADER = {
    0: "ITEM: TIMESTEP",
    2: "ITEM: NUMBER OF ATOMS",
    4: "ITEM: BOX BOUNDS",
    8: "ITEM: ATOMS",
}
HEADER_LINES = 9
# what LAMMPS counts has 64 bits
_COUNT = re.compile(r"[0-9]{1,18}")


@dataclass(frozen=True)
class Entry:
    """Where one frame stands in the file, and its header."""

    offset: int
    size: int
    line: int
    step: int
    natoms: int
    box: NDArray[np.float64]
    columns: list[str]
    periodic: tuple[bool, ...]
    tilt: tuple[float, ...]


def frame_texts(dump: Path) -> Iterator[tuple[int, bytes]]:
    """Yield the step and the text of each complete frame of a text dump.

    Raises:
        UserError: not a dump (with the line), or columns missing.
    """
    with dump.open("rb") as file, dump.open("rb") as texts:
        for entry in index(file, dump):
            yield entry.step, texts.read(entry.size)


def has_frame(dump: Path) -> bool:
    """Return whether there is a dump file with a complete frame."""
    if not dump.is_file():
        return False
    with dump.open("rb") as file:
        return next(index(file, dump), None) is not None


def index(file: BinaryIO, path: Path) -> Iterator[Entry]:
    """Yield the place of each complete frame; warn about an incomplete last one."""
    line, offset = 1, 0
    while header := [
        text.decode(errors="replace") for text in itertools.islice(file, HEADER_LINES)
    ]:
        _check_header(header, path, line)
        is_whole = len(header) == HEADER_LINES and header[-1].endswith("\n")
        natoms = int(header[3]) if is_whole else 0
        if not is_whole or _skip_lines(file, natoms) < natoms:
            warnings.warn(f"{path}: the frame at line {line} is cut off: left out", stacklevel=3)
            return
        columns, about_box = header[8].split()[2:], header[4].split()[3:]
        is_tilted = about_box[:3] == ["xy", "xz", "yz"]
        bounds = _read_bounds(header[5:8], 3 if is_tilted else 2, path, line + 5)
        end = file.tell()
        periodic = tuple(flags == "pp" for flags in about_box[-3:])
        tilt = tuple(bounds[:, 2]) if is_tilted else (0.0, 0.0, 0.0)
        size, box = end - offset, bounds[:, :2].T
        yield Entry(offset, size, line, int(header[1]), natoms, box, columns, periodic, tilt)
        line, offset = line + HEADER_LINES + natoms, end


def _read_bounds(rows: list[str], width: int, path: Path, line: int) -> NDArray[np.float64]:
    """Return the numbers in the lines about the box, shape (3, width)."""
    try:
        bounds = np.array([row.split() for row in rows], dtype=np.float64)
    except ValueError as error:
        raise UserError(f"{path}, line {line}: not the bounds of a box") from error
    if bounds.shape != (3, width) or not np.isfinite(bounds).all():
        raise UserError(f"{path}, line {line}: not the bounds of a box")
    return bounds


def _skip_lines(file: BinaryIO, wanted: int) -> int:
    """Read past some lines; return how many of them were there with their end."""
    return sum(row.endswith(b"\n") for row in itertools.islice(file, wanted))


def _check_header(header: list[str], path: Path, line: int) -> None:
    """Raise UserError where a complete line of a frame's header is not what it should be."""
    complete = [text for text in header if text.endswith("\n")]
    for number, text in enumerate(complete):
        expected = _HEADER.get(number)
        if expected and not text.startswith(expected):
            raise UserError(
                f"{path}, line {line + number}: expected '{expected}', found "
                f"'{text.strip()[:60]}': a text dump without 'dump_modify time' or 'units' is read"
            )
        if number in (1, 3) and not _COUNT.fullmatch(text.strip()):
            raise UserError(f"{path}, line {line + number}: '{text.strip()[:60]}' is no count")
        if number == 4 and len(text.split()) not in (6, 9):
            raise UserError(
                f"{path}, line {line + number}: '{text.strip()[:60]}' does not say, as in "
                "'xy xz yz pp pp ff', how a box along the axes is tilted and bounded"
            )
    if len(complete) == HEADER_LINES:
        _check_columns(complete[8].split()[2:], path)


def _check_columns(columns: list[str], path: Path) -> None:
    absent = [name for name in REQUIRED_COLUMNS if name not in columns]
    if absent:
        raise UserError(
            f"{path} lacks the column {' '.join(absent)}: write it with "
            "'dump ID all custom N FILE id type x y z vx vy vz'"
        )
    if len(set(columns)) < len(columns):
        raise UserError(f"{path} has two columns of one name: {' '.join(columns)}")
