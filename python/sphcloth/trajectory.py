"""LAMMPS text dumps in which the number of atoms varies, frame by frame through MDAnalysis.

MDAnalysis reads a dump with a constant number of atoms. A pouring scene has none, so the file is
indexed once and each frame's text goes to MDAnalysis' reader on its own.
"""

from __future__ import annotations

import io
import itertools
import warnings
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import overload

import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.lib.util import NamedStream
from numpy.typing import NDArray

from sphcloth.arguments import types
from sphcloth.dump import HEADER_LINES, REQUIRED_COLUMNS, Entry, index
from sphcloth.errors import UserError
from sphcloth.log import ThermoTable

# frames that are looked at before measuring or drawing, to find what there is
SAMPLE = 8
# what LAMMPS counts is exact as a number of double precision up to here
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
        """Return displacements, shape (..., 3), without the periodic wraps that are in them.

        They must be shorter than half the distance of opposite faces of the box.
        """
        wraps = np.round(displacements @ np.linalg.inv(self.cell)) * self.periodic
        return displacements - wraps @ self.cell

    def select(self, atom_type: int | Collection[int]) -> Frame:
        """Return the atoms of one type, or of several, as a frame of their own.

        It is empty where there are none of the type.

        Raises:
            UserError: a type that is no whole number from 1 on.
        """
        chosen = np.isin(self.types, types("select: type", atom_type))
        columns = {name: values[chosen] for name, values in self.columns.items()}
        return replace(self, columns=columns)

    def vectors(self, *names: str) -> NDArray[np.float64]:
        """Return some columns side by side, shape (N, number of names); UserError if absent."""
        absent = [name for name in names if name not in self.columns]
        if absent:
            raise UserError(
                f"the dump has no column {' '.join(absent)}: add it to 'dump custom', what a "
                "compute finds as c_ID with 'dump_modify colname c_ID NAME'"
            )
        return np.stack([self.columns[name] for name in names], axis=1)


class Trajectory(Sequence[Frame]):
    """The frames of a text dump (``dump custom``), read when they are asked for."""

    def __init__(
        self,
        dump: str | Path,
        log: str | Path | ThermoTable | None = None,
        columns: Collection[str] | None = None,
    ) -> None:
        """Index a dump file.

        Args:
            dump: text dump with at least the columns id, type, x, y and z; columns are numbers.
            log: log of the same run, or its table, for the physical time of each frame.
            columns: those that frames shall have beside these five, as far as they are in the
                dump; None for all. What is left out takes no time.

        A last frame that is not complete is left out with a warning, and so are frames that repeat
        the step before them, as the first one of a run that goes on in the dump of another.

        Raises:
            UserError: no such file, not a dump (with the line), columns missing, no frame, or steps
                that go back.
        """
        self.path = Path(dump)
        if not self.path.is_file():
            raise UserError(f"no dump file {self.path}")
        with self.path.open("rb") as file:
            self._entries = _in_order(list(index(file, self.path)), self.path)
        if not self._entries:
            raise UserError(f"{self.path} holds no complete frame")
        self.steps = np.array([entry.step for entry in self._entries])
        self.counts = np.array([entry.natoms for entry in self._entries])
        self.times = np.full(len(self.steps), np.nan)
        if log is not None:
            table = log if isinstance(log, ThermoTable) else ThermoTable.read(log)
            self.times = table.time_at(self.steps)
        self._columns = None if columns is None else {*REQUIRED_COLUMNS, *columns}

    def __len__(self) -> int:
        return len(self._entries)

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> list[Frame]: ...
    def __getitem__(self, index: int | slice) -> Frame | list[Frame]:
        """Read one frame, or those of a slice; negative indices count from the end."""
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        entry = self._entries[index]
        names = [name for name in entry.columns if self._columns is None or name in self._columns]
        columns = _read_columns(self.path, entry, names)
        time = float(self.times[index])
        return Frame(entry.step, time, entry.box, columns, entry.periodic, entry.tilt)


def evenly_spaced(total: int, wanted: int) -> list[int]:
    """Return up to ``wanted`` indices out of ``total``: the last, the first, and some between."""
    last_first = np.linspace(total - 1, 0, min(wanted, total))
    return np.unique(last_first.round().astype(int)).tolist()


def samples(trajectory: Trajectory) -> list[Frame]:
    """Return a few frames that tell what there is in a dump."""
    return [trajectory[index] for index in evenly_spaced(len(trajectory), SAMPLE)]


def successive(frames: Iterable[Frame], what: str) -> Iterator[tuple[Frame, Frame]]:
    """Yield each frame and the next, between which ``what`` follows the atoms.

    Raises:
        UserError: steps that go back.
    """
    for before, after in itertools.pairwise(frames):
        if after.step < before.step:
            raise UserError(
                f"{what}: a frame of step {after.step} follows one of step {before.step}: atoms "
                "are followed from frame to frame, give them in the order of their steps"
            )
        yield before, after


def _in_order(entries: list[Entry], path: Path) -> list[Entry]:
    """Return the frames without those that repeat a step; UserError where steps go back."""
    for before, after in itertools.pairwise(entries):
        if after.step < before.step:
            raise UserError(
                f"{path}, line {after.line}: a frame of step {after.step} follows one of step "
                f"{before.step}: give each run a dump of its own, or leave out of the first what "
                f"comes behind step {after.step}"
            )
    kept = [first for _, (first, *_) in itertools.groupby(entries, lambda entry: entry.step)]
    repeated = len(entries) - len(kept)
    if repeated:
        warnings.warn(
            f"{path}: frames that repeat the step before them are left out: {repeated} of "
            f"{len(entries)}",
            stacklevel=3,
        )
    return kept


class _FrameReader(DumpReader):
    """Reads a text of one frame: there is no need to count the lines first."""

    n_frames = 1


def _read_columns(path: Path, entry: Entry, names: list[str]) -> dict[str, NDArray[np.float64]]:
    """Return some columns of one frame, sorted by id.

    All are asked for as additional columns: those stay float64 and where they are, whereas the
    reader's own positions are float32 and shifted by the box's lower corner. Velocities and forces
    have other names for the reader, which would also make a float32 copy of them.
    """
    with path.open("rb") as file:
        file.seek(entry.offset)
        text = file.read(entry.size).decode(errors="replace")
    *head, rows = text.split("\n", HEADER_LINES)
    head[-1] = " ".join(["ITEM: ATOMS", *map(_renamed, entry.columns)])
    renamed = "\n".join([*head, rows])
    stream = NamedStream(io.StringIO(renamed), f"{path.name}.lammpsdump")
    try:
        reader = _FrameReader(
            stream, "unscaled", additional_columns=[_renamed(name) for name in names], dt=1.0
        )
    except (ValueError, IndexError) as error:
        raise UserError(f"{path}, line {_bad_line(text, entry)}: not a row of numbers") from error
    columns = {name: reader.ts.data[_renamed(name)] for name in names}
    _check_atoms(columns, path, entry)
    return columns


def _renamed(column: str) -> str:
    """Return the name of a column for the reader, which knows an ID and a place by their names."""
    return column if column in ("id", "x", "y", "z") else f"column_{column}"


def _check_atoms(columns: dict[str, NDArray[np.float64]], path: Path, entry: Entry) -> None:
    """Raise UserError where an atom is there twice, or has an ID or type that none can have."""
    where = f"{path}, frame at line {entry.line}"
    for name in ("id", "type"):
        wrong = ~((columns[name] >= 1) & (columns[name] < _MOST))
        if wrong.any():
            raise UserError(f"{where}: {columns[name][wrong][0]:g} is no {name} of an atom")
    twice = columns["id"][1:][np.diff(columns["id"]) == 0]
    if len(twice):
        raise UserError(f"{where}: atom {twice[0]:.0f} is there twice")


def _bad_line(text: str, entry: Entry) -> int:
    """Return the line in the file of the first atom whose row cannot be read."""
    for number, row in enumerate(text.splitlines()[HEADER_LINES:], entry.line + HEADER_LINES):
        try:
            values = [float(field) for field in row.split()]
        except ValueError:
            return number
        if len(values) != len(entry.columns):
            return number
    return entry.line
