"""LAMMPS text dumps in which the number of atoms varies, frame by frame through MDAnalysis.

MDAnalysis reads a dump with a constant number of atoms. A pouring scene has none, so the file is
indexed once and each frame's text goes to MDAnalysis' reader on its own.
"""

from __future__ import annotations

import io
import itertools
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import BinaryIO

import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.lib.util import NamedStream
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable

REQUIRED_COLUMNS = ("id", "type", "x", "y", "z")

# line of a frame's header -> how it must begin
_HEADER = {
    0: "ITEM: TIMESTEP",
    2: "ITEM: NUMBER OF ATOMS",
    4: "ITEM: BOX BOUNDS",
    8: "ITEM: ATOMS",
}
_HEADER_LINES = 9
# what LAMMPS counts has 64 bits
_COUNT = re.compile(r"[0-9]{1,18}")
# and is exact as a number of double precision up to here
_MOST = 2.0**53


@dataclass(frozen=True)
class Frame:
    """The atoms of one dumped step, sorted by id.

    Attributes:
        step: time step.
        time: physical time, NaN if the trajectory was opened without its log.
        box: lower and upper corner of the (bounding) box, shape (2, 3).
        columns: dump column -> float64 values, shape (N,), as written in the file.
        periodic: whether each of the three directions is periodic.
        tilt: xy, xz and yz of the box, 0 if it is rectangular.
    """

    step: int
    time: float
    box: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    periodic: tuple[bool, ...] = (False, False, False)
    tilt: tuple[float, ...] = (0.0, 0.0, 0.0)

    def __len__(self) -> int:
        return len(self.columns["id"])

    @cached_property
    def ids(self) -> NDArray[np.int64]:
        """Atom ids in ascending order, shape (N,)."""
        return self.columns["id"].astype(np.int64)

    @cached_property
    def types(self) -> NDArray[np.int64]:
        """Atom types, shape (N,)."""
        return self.columns["type"].astype(np.int64)

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Positions in the coordinates of the script, shape (N, 3)."""
        return self.vectors("x", "y", "z")

    @cached_property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities, shape (N, 3); UserError if the dump has none."""
        return self.vectors("vx", "vy", "vz")

    @cached_property
    def cell(self) -> NDArray[np.float64]:
        """The edges of the box that start at its lower corner, one in each row, shape (3, 3)."""
        xy, xz, yz = self.tilt
        # the bounding box is larger by what the tilted edges reach beyond the others
        beyond = np.array([np.ptp([0, xy, xz, xy + xz]), abs(yz), 0])
        cell = np.diag(self.box[1] - self.box[0] - beyond)
        cell[[1, 2, 2], [0, 0, 1]] = self.tilt
        return cell

    def shortest(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return displacements, shape (N, 3), without the periodic wraps that are in them.

        They must be shorter than half the distance of opposite faces of the box.
        """
        wraps = np.round(displacements @ np.linalg.inv(self.cell)) * self.periodic
        return displacements - wraps @ self.cell

    def select(self, atom_type: int) -> Frame:
        """Return the atoms of one type as a frame of their own."""
        chosen = self.types == atom_type
        columns = {name: values[chosen] for name, values in self.columns.items()}
        return replace(self, columns=columns)

    def vectors(self, *names: str) -> NDArray[np.float64]:
        """Return some columns side by side, shape (N, number of names); UserError if absent."""
        absent = [name for name in names if name not in self.columns]
        if absent:
            raise UserError(f"the dump has no column {' '.join(absent)}: add it to 'dump custom'")
        return np.stack([self.columns[name] for name in names], axis=1)


@dataclass(frozen=True)
class _Entry:
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


class Trajectory(Sequence[Frame]):
    """The frames of a text dump (``dump custom``), read when they are asked for."""

    def __init__(self, dump: str | Path, log: str | Path | None = None) -> None:
        """Index a dump file.

        Args:
            dump: text dump with at least the columns id, type, x, y and z; columns are numbers.
            log: log of the same run, for the physical time of each frame.

        A last frame that is not complete is left out with a warning.

        Raises:
            UserError: no such file, not a dump (with the line), columns missing, or no frame.
        """
        self.path = Path(dump)
        if not self.path.is_file():
            raise UserError(f"no dump file {self.path}")
        with self.path.open("rb") as file:
            self._entries = list(_index(file, self.path))
        if not self._entries:
            raise UserError(f"{self.path} holds no complete frame")
        self.steps = np.array([entry.step for entry in self._entries])
        self.counts = np.array([entry.natoms for entry in self._entries])
        self.times = np.full(len(self.steps), np.nan)
        if log is not None:
            self.times = ThermoTable.read(log).time_at(self.steps)

    def __len__(self) -> int:
        return len(self._entries)

    def __getitem__(self, index: int) -> Frame:  # type: ignore[override]
        """Read one frame; negative indices count from the end."""
        entry = self._entries[index]
        columns = _read_columns(self.path, entry)
        time = float(self.times[index])
        return Frame(entry.step, time, entry.box, columns, entry.periodic, entry.tilt)


def frame_texts(dump: Path) -> Iterator[tuple[int, bytes]]:
    """Yield the step and the text of each complete frame of a text dump.

    Raises:
        UserError: not a dump (with the line), or columns missing.
    """
    with dump.open("rb") as file, dump.open("rb") as texts:
        for entry in _index(file, dump):
            yield entry.step, texts.read(entry.size)


def has_frame(dump: Path) -> bool:
    """Return whether there is a dump file with a complete frame."""
    if not dump.is_file():
        return False
    with dump.open("rb") as file:
        return next(_index(file, dump), None) is not None


def _index(file: BinaryIO, path: Path) -> Iterator[_Entry]:
    """Yield the place of each complete frame; warn about an incomplete last one."""
    line, offset = 1, 0
    while header := [
        text.decode(errors="replace") for text in itertools.islice(file, _HEADER_LINES)
    ]:
        _check_header(header, path, line)
        is_whole = len(header) == _HEADER_LINES and header[-1].endswith("\n")
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
        yield _Entry(offset, size, line, int(header[1]), natoms, box, columns, periodic, tilt)
        line, offset = line + _HEADER_LINES + natoms, end


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
    if len(complete) == _HEADER_LINES:
        _check_columns(complete[8].split()[2:], path)


def _check_columns(columns: list[str], path: Path) -> None:
    absent = [name for name in REQUIRED_COLUMNS if name not in columns]
    if absent:
        raise UserError(
            f"{path} lacks the column {' '.join(absent)}: write it with "
            "'dump ID all custom N FILE id type x y z vx vy vz rho'"
        )
    if len(set(columns)) < len(columns):
        raise UserError(f"{path} has two columns of one name: {' '.join(columns)}")


def _read_columns(path: Path, entry: _Entry) -> dict[str, NDArray[np.float64]]:
    """Return all columns of one frame, sorted by id.

    Positions are asked for as additional columns: those stay float64 and where they are, whereas
    the reader's own positions are float32 and shifted by the box's lower corner.
    """
    with path.open("rb") as file:
        file.seek(entry.offset)
        text = file.read(entry.size).decode(errors="replace")
    stream = NamedStream(io.StringIO(text), f"{path.name}.lammpsdump")
    try:
        reader = DumpReader(stream, "unscaled", additional_columns=entry.columns, dt=1.0)
    except (ValueError, IndexError) as error:
        raise UserError(f"{path}, line {_bad_line(text, entry)}: not a row of numbers") from error
    columns = {name: reader.ts.data[name] for name in entry.columns}
    _check_atoms(columns, path, entry)
    return columns


def _check_atoms(columns: dict[str, NDArray[np.float64]], path: Path, entry: _Entry) -> None:
    """Raise UserError where an atom is there twice, or has an ID or type that none can have."""
    where = f"{path}, frame at line {entry.line}"
    for name in ("id", "type"):
        wrong = ~((columns[name] >= 1) & (columns[name] < _MOST))
        if wrong.any():
            raise UserError(f"{where}: {columns[name][wrong][0]:g} is no {name} of an atom")
    twice = columns["id"][1:][np.diff(columns["id"]) == 0]
    if len(twice):
        raise UserError(f"{where}: atom {twice[0]:.0f} is there twice")


def _bad_line(text: str, entry: _Entry) -> int:
    """Return the line in the file of the first atom whose row cannot be read."""
    for number, row in enumerate(text.splitlines()[_HEADER_LINES:], entry.line + _HEADER_LINES):
        try:
            values = [float(field) for field in row.split()]
        except ValueError:
            return number
        if len(values) != len(entry.columns):
            return number
    return entry.line
