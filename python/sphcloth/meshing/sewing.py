"""Seams: borders of different pieces that lie close to one another are joined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.meshing.load import drop_repeated, replace_vertices
from sphcloth.meshing.surface import Surface, clusters, lengths


@dataclass(frozen=True)
class Seams:
    """Pairs of border vertices to be joined.

    Attributes:
        pairs: vertices of different pieces, shape (S, 2).
        distance: they are no farther apart than this.
        widest: largest distance of a pair.
        unpaired: number of border vertices that are as close to another piece, but nearest to no
            vertex that is also nearest to them.
    """

    pairs: NDArray[np.int64]
    distance: float
    widest: float
    unpaired: int

    @classmethod
    def find(cls, surface: Surface, distance: float) -> Seams:
        """Pair each border vertex with the nearest one of every other piece, if that is mutual.

        Raises:
            UserError: the distance is not positive, or too small for any pair, or so large that
                two vertices of one piece would be joined.
        """
        if not 0 < distance < np.inf:
            raise UserError(f"--sew {distance:g}: the distance must be positive")
        border = np.unique(surface.boundary_edges)
        close = cKDTree(surface.vertices[border]).query_pairs(distance, output_type="ndarray")
        close = border[close].reshape(-1, 2)
        close = close[np.diff(surface.pieces[close], axis=1)[:, 0] != 0]
        pairs = _mutually_nearest(surface, close)
        if not len(pairs):
            raise UserError(
                f"--sew {distance:g}: no borders of different pieces are so close: raise it"
            )
        _check_pieces(surface, pairs, distance)
        return cls(
            pairs,
            distance,
            float(lengths(surface.vertices, pairs).max()),
            len(np.setdiff1d(close, pairs)),
        )

    def middle(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the positions, shape (V, 3), with joined vertices at the center of each other."""
        joined = clusters(self.pairs, len(positions))
        count = np.bincount(joined)
        center = np.stack([np.bincount(joined, axis) / count for axis in positions.T], axis=1)
        return np.where((count[joined] > 1)[:, None], center[joined], positions)

    def unpaired_note(self) -> list[str]:
        """Return a line about border vertices without a partner, or none."""
        if not self.unpaired:
            return []
        return [
            f"{self.unpaired:,} border vertices within {self.distance:g} of another piece have no "
            "partner there: the borders are divided differently"
        ]


def weld(surface: Surface, seams: Seams) -> tuple[Surface, list[str]]:
    """Make one vertex of each seam's two; return the surface and what was done."""
    moved = Surface(seams.middle(surface.vertices), surface.triangles, surface.part)
    welded = replace_vertices(moved, clusters(seams.pairs, len(surface.vertices)))
    welded, repeated = drop_repeated(welded)
    gone = len(surface.vertices) - len(welded.vertices)
    notes = [f"{gone:,} vertices welded into others, up to {seams.widest:g} apart"]
    if repeated:
        notes.append(f"{repeated:,} triangles that came to lie on others removed")
    return welded, notes


def _mutually_nearest(surface: Surface, close: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the pairs, shape (S, 2), out of ``close`` whose ends choose each other.

    Each vertex chooses the nearest one of each other piece; of two as near, the smaller number.
    """
    asked = np.concatenate([close, close[:, ::-1]])
    distance = lengths(surface.vertices, asked)
    piece = surface.pieces[asked[:, 1]]
    asked = asked[np.lexsort((asked[:, 1], distance, piece, asked[:, 0]))]
    choice = np.stack([asked[:, 0], surface.pieces[asked[:, 1]]], axis=1)
    _, first = np.unique(choice, axis=0, return_index=True)
    chosen, uses = np.unique(np.sort(asked[first], axis=1), axis=0, return_counts=True)
    return chosen[uses == 2]


def _check_pieces(surface: Surface, pairs: NDArray[np.int64], distance: float) -> None:
    """Raise UserError if seams join, through other pieces, two vertices of one piece."""
    joined = clusters(pairs, len(surface.vertices))
    sewn = np.unique(pairs)
    key = np.stack([joined[sewn], surface.pieces[sewn]], axis=1)
    _, first, uses = np.unique(key, axis=0, return_index=True, return_counts=True)
    if np.any(uses > 1):
        where = surface.vertices[sewn[first[np.argmax(uses > 1)]]]
        raise UserError(
            f"--sew {distance:g} would join two vertices of one piece near "
            "({:g}, {:g}, {:g}): lower it".format(*where)
        )
