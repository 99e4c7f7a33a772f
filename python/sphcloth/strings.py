"""Strings: edges at vertices that no triangle has, as the lines of a parachute."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh, rows_of
from sphcloth.trajectory import Frame


@dataclass(frozen=True)
class Strings:
    """Edges of a cloth that are beside its triangles.

    Edges between two vertices of triangles, such as seams and diagonals, are not among them.

    Attributes:
        ids: atom ids of their ends in ascending order, shape (N,).
        links: the two ends of each edge, as indices into ``ids``, shape (L, 2).
        vertices: index of each end among the vertices of the triangles, -1 if it has none,
            shape (N,).
    """

    ids: NDArray[np.int64]
    links: NDArray[np.int64]
    vertices: NDArray[np.int64]

    @classmethod
    def of_bonds(cls, lines: Sequence[str], mesh: ClothMesh, data: Path) -> Strings | None:
        """Find the strings in the lines of the section Bonds of a data file; None without any.

        Raises:
            UserError: a line that does not name two atoms.
        """
        try:
            ends = np.array([line.split()[2:4] for line in lines], dtype=np.int64).reshape(-1, 2)
        except (ValueError, OverflowError) as error:
            raise UserError(
                f"{data}: the section Bonds cannot be read: write it with 'write_data FILE nofix'"
            ) from error
        ends = ends[~np.isin(ends, mesh.ids).all(axis=1)]
        if not len(ends):
            return None
        ids, links = np.unique(ends, return_inverse=True)
        places = np.minimum(np.searchsorted(mesh.ids, ids), len(mesh.ids) - 1)
        return cls(ids, links.reshape(-1, 2), np.where(mesh.ids[places] == ids, places, -1))

    @property
    def is_free(self) -> NDArray[np.bool_]:
        """Which ends are no vertices of triangles, shape (N,)."""
        return self.vertices < 0

    @property
    def knots(self) -> NDArray[np.int64]:
        """Free ends where a string ends or more than two edges meet, as indices, shape (K,)."""
        count = np.bincount(self.links.ravel(), minlength=len(self.ids))
        return np.flatnonzero(self.is_free & (count != 2))

    def types(self, frame: Frame) -> frozenset[int]:
        """Return the atom types of the free ends in a frame."""
        return frozenset(frame.types[rows_of(self.ids[self.is_free], frame)].tolist())

    def positions(self, frame: Frame, sheet: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places of all ends, without periodic wraps, shape (N, 3).

        Args:
            frame: where the free ends are.
            sheet: unwrapped positions of the vertices of the triangles, shape (V, 3).

        Raises:
            UserError: the frame lacks an end.
        """
        places = frame.positions[rows_of(self.ids, frame)]
        places[~self.is_free] = sheet[self.vertices[~self.is_free]]
        for children, parents in self._levels:
            places[children] = places[parents] + frame.shortest(places[children] - places[parents])
        return places

    @cached_property
    def _levels(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Free ends and neighbors of each that come before it, from the triangles outward."""
        ways = np.concatenate([self.links, self.links[:, ::-1]])
        placed, levels = ~self.is_free, []
        while not placed.all():
            next_ones = ways[placed[ways[:, 0]] & ~placed[ways[:, 1]]]
            if not len(next_ones):  # a string without triangles: it is where its first end is
                placed[np.flatnonzero(~placed)[0]] = True
                continue
            children, first = np.unique(next_ones[:, 1], return_index=True)
            levels.append((children, next_ones[first, 0]))
            placed[children] = True
        return levels
