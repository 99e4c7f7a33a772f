"""The cloth's triangles, from the data file that ``write_data`` makes of a scene."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from MDAnalysis.topology.LAMMPSParser import DATAParser
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sphcloth.arguments import types
from sphcloth.errors import UserError
from sphcloth.trajectory import Frame

# section for 'fix property/atom' that 'sphcloth mesh' puts at the end of a data file
MASS_SECTION = "VertexMass"


class _Parser(DATAParser):
    """Reads a data file up to the section that MDAnalysis does not know."""

    def iterdata(self) -> Iterator[str]:
        return itertools.takewhile(lambda line: line != MASS_SECTION, super().iterdata())


def read_sections(data: Path) -> dict[str, list[str]]:
    """Return the lines of each section of a data file.

    Raises:
        UserError: no such file, or a file of another form.
    """
    if not data.is_file():
        raise UserError(f"no data file {data}")
    try:
        with _Parser(data) as parser:
            header, sections = parser.grab_datafile()
    except (ValueError, IndexError, EOFError):  # the last: of an empty file
        sections = {}
    if "Atoms" not in sections:
        raise UserError(f"{data} is no data file: write it with 'write_data FILE nofix'")
    _check_counts(header, sections, data)
    return sections


def read_masses(data: str | Path) -> dict[int, float]:
    """Return atom type -> mass of a data file; UserError if it has no section Masses."""
    lines = read_sections(Path(data)).get("Masses")
    if not lines:
        raise UserError(f"{data} has no section Masses: each atom has a mass of its own there")
    try:
        masses = {int(kind): float(mass) for kind, mass in (line.split()[:2] for line in lines)}
    except ValueError as error:
        raise UserError(
            f"{data}: the section Masses is not a type and a mass in each line"
        ) from error
    for kind, mass in masses.items():
        if not 0 < mass < np.inf:
            raise UserError(f"{data}: the mass of type {kind} is {mass:g}")
    return masses


def _check_counts(header: dict[str, str], sections: dict[str, list[str]], data: Path) -> None:
    """Raise UserError where a section does not have as many lines as the head of the file says."""
    for section in ("Atoms", "Bonds", "Angles", "Dihedrals"):
        told, there = header.get(section.lower(), "0").strip(), len(sections.get(section, []))
        if told != str(there):
            raise UserError(
                f"{data}: {there} lines in the section {section}, the head of the file says "
                f"'{told}': it was cut off or damaged, write it again"
            )


@dataclass(frozen=True)
class ClothMesh:
    """Triangles over the vertices of the cloth.

    Attributes:
        ids: atom ids of the vertices in ascending order, shape (V,).
        triangles: indices into ``ids``, shape (T, 3), all wound in the same sense.
        kinds: angle type of each triangle, shape (T,); None if they are not known.
    """

    ids: NDArray[np.int64]
    triangles: NDArray[np.int64]
    kinds: NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        """Raise UserError if two neighboring triangles are wound in opposite senses."""
        if len(np.unique(self._sides, axis=0)) < len(self._sides):
            raise UserError("neighboring cloth triangles are wound in opposite senses")

    @classmethod
    def read(cls, data: str | Path) -> ClothMesh:
        """Read the mesh from a data file: each LAMMPS angle is a triangle.

        Raises:
            UserError: no such file, a file of another form, or no triangle in it.
        """
        data = Path(data)
        sections = read_sections(data)
        if not sections.get("Angles"):
            raise UserError(f"{data} holds no cloth: its triangles are LAMMPS angles, it has none")
        return cls.of_angles(sections["Angles"], data)

    @classmethod
    def of_angles(cls, lines: Sequence[str], data: Path) -> ClothMesh:
        """Make the mesh of the lines of the section Angles of a data file.

        Raises:
            UserError: a line that does not name three atoms.
        """
        # MDAnalysis' own angles are turned around where the first atom is the larger one
        try:
            rows = np.array([line.split()[1:5] for line in lines], dtype=np.int64).reshape(-1, 4)
            ids, triangles = np.unique(rows[:, 1:], return_inverse=True)
            if ids[0] < 1:
                raise ValueError(f"{ids[0]} is no ID of an atom")
        except (ValueError, OverflowError) as error:
            raise UserError(
                f"{data}: the section Angles cannot be read: write it with 'write_data FILE nofix'"
            ) from error
        return cls(ids, triangles.reshape(-1, 3), rows[:, 0])

    def of_kinds(self, chosen: Collection[int]) -> ClothMesh:
        """Return the triangles of some angle types, over the same vertices.

        Raises:
            UserError: the types of the triangles are not known, or a type that is no whole number
                from 1 on.
        """
        return self._only(self._is_of(chosen))

    def without_kinds(self, chosen: Collection[int]) -> ClothMesh:
        """Return the other triangles, likewise; without a choice it is this mesh."""
        return self._only(~self._is_of(chosen)) if chosen else self

    def _is_of(self, chosen: Collection[int]) -> NDArray[np.bool_]:
        if self.kinds is None:
            raise UserError("the angle types of the triangles are not known: read a data file")
        return np.isin(self.kinds, types("angle type", chosen))

    def _only(self, chosen: NDArray[np.bool_]) -> ClothMesh:
        return ClothMesh(self.ids, self.triangles[chosen], self.kinds[chosen])

    @cached_property
    def edges(self) -> NDArray[np.int64]:
        """Edges of the triangles, each once, as indices into ``ids``, shape (E, 2)."""
        return np.unique(np.sort(self._sides, axis=1), axis=0)

    @property
    def border_edges(self) -> int:
        """Number of edges with a triangle on one side only; 0 for a closed mesh."""
        return 2 * len(self.edges) - len(self._sides)

    @cached_property
    def _sides(self) -> NDArray[np.int64]:
        """The three sides of each triangle in its sense, shape (3 T, 2)."""
        a, b, c = self.triangles.T
        return np.stack([np.concatenate([a, b, c]), np.concatenate([b, c, a])], axis=1)

    @cached_property
    def pieces(self) -> NDArray[np.int64]:
        """Number of the connected piece of each vertex, in the order of their ids, shape (V,)."""
        a, b, c = self.triangles.T
        links = (np.ones(2 * len(a)), (np.concatenate([a, b]), np.concatenate([b, c])))
        graph = coo_array(links, shape=(len(self.ids),) * 2)
        return connected_components(graph, directed=False)[1]

    def positions(self, frame: Frame) -> NDArray[np.float64]:
        """Return the vertices' positions in a frame, shape (V, 3), as the dump has them.

        A sheet through a periodic face is in parts there: see
        :class:`sphcloth.unwrapping.Unwrapper`.

        Raises:
            UserError: the frame lacks a vertex.
        """
        return frame.positions[rows_of(self.ids, frame)]

    def vectors(self, frame: Frame, *names: str) -> NDArray[np.float64]:
        """Return columns of a frame for the vertices, shape (V, number of names).

        Raises:
            UserError: the frame lacks a vertex or a column.
        """
        return frame.vectors(*names)[rows_of(self.ids, frame)]

    def corners(self, frame: Frame) -> NDArray[np.float64]:
        """Return the corners of each triangle in a frame, shape (T, 3 corners, 3).

        Through periodic faces they are side by side, each triangle by itself: a sheet that closes
        through such a face has no place as a whole.
        """
        corners = self.positions(frame)[self.triangles]
        with np.errstate(invalid="ignore"):  # positions that are not finite stay what they are
            offsets = corners - corners[:, :1]
            # the difference is 0, to the last bit, where nothing is wrapped
            return corners + (frame.shortest(offsets) - offsets)

    def edge_lengths(self, frame: Frame) -> NDArray[np.float64]:
        """Return the lengths of the edges in a frame, through periodic faces, too, shape (E,)."""
        start, end = np.moveaxis(self.positions(frame)[self.edges], 1, 0)
        return np.linalg.norm(frame.shortest(end - start), axis=1)


def rows_of(ids: NDArray[np.int64], frame: Frame) -> NDArray[np.int64]:
    """Return the rows of some vertices of cloth in a frame.

    Raises:
        UserError: the frame lacks a vertex.
    """
    rows = np.minimum(np.searchsorted(frame.ids, ids), len(frame) - 1)
    lost = ids[frame.ids[rows] != ids] if len(frame) else ids
    if len(lost):
        raise UserError(f"cloth vertex {lost[0]} is not in the dump at step {frame.step}")
    return rows
