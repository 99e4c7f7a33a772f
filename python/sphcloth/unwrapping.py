"""Undoes the periodic wrapping of a cloth, frame after frame."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame


class Unwrapper:
    """Undoes the periodic wrapping of a cloth, frame after frame.

    With the columns ix, iy and iz the dump says where each vertex is. Without them neighbors are
    put side by side along a tree of edges, and each piece's root goes on from where it was.
    """

    def __init__(self, mesh: ClothMesh) -> None:
        """Choose a root for each piece and the order in which its vertices follow."""
        self._mesh = mesh
        self._levels, self._roots, self._root_of = _tree(mesh)
        self._last_roots: NDArray[np.float64] | None = None

    def __call__(self, frame: Frame) -> NDArray[np.float64]:
        """Return the vertices' unwrapped positions, shape (V, 3).

        Raises:
            UserError: a vertex is not in the frame.
        """
        positions = self._mesh.positions(frame)
        if not any(frame.periodic):
            return positions
        if all(name in frame.columns for name in ("ix", "iy", "iz")):
            return positions + self._mesh.vectors(frame, "ix", "iy", "iz") @ frame.cell
        return self._follow_edges(positions, frame)

    def _follow_edges(self, positions: NDArray, frame: Frame) -> NDArray[np.float64]:
        whole = positions.copy()
        for children, parents in self._levels:
            whole[children] = whole[parents] + frame.shortest(whole[children] - whole[parents])
        roots = whole[self._roots]
        if self._last_roots is not None:
            moved = self._last_roots + frame.shortest(roots - self._last_roots)
            whole += (moved - roots)[self._root_of]
        self._last_roots = whole[self._roots]
        return whole


def _tree(
    mesh: ClothMesh,
) -> tuple[list[tuple[NDArray, NDArray]], NDArray[np.int64], NDArray[np.int64]]:
    """Return children and parents level by level, the roots, and each vertex's root number."""
    n = len(mesh.ids)
    _, roots = np.unique(mesh.pieces, return_index=True)
    # one more node, n, holds all roots
    a, b = np.concatenate([mesh.edges, np.column_stack([roots, np.full_like(roots, n)])]).T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(n + 1, n + 1)).tocsr()
    order, parent = breadth_first_order(graph, n, directed=False)
    depth = np.zeros(n + 1, np.int64)
    for vertex in order[1:]:
        depth[vertex] = depth[parent[vertex]] + 1
    starts = np.searchsorted(depth[order], np.arange(2, depth.max() + 2))
    levels = [order[start:end] for start, end in itertools.pairwise(starts)]
    return [(level, parent[level]) for level in levels], roots, mesh.pieces
