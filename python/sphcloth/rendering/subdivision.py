"""Smooth meshes from coarse ones: Loop's subdivision as a matrix.

New vertices are weighted means of the old ones, whatever their positions: the matrix is made once
for a mesh and then smooths every frame (C. Loop, Smooth subdivision surfaces based on triangles,
1987; weights of vertices by J. Warren). Vertices at a border stay where they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse


@dataclass(frozen=True)
class Refinement:
    """A finer mesh, and where its vertices are.

    Attributes:
        weights: of the coarse vertices in the fine ones, shape (fine, coarse).
        triangles: of fine vertices, shape (T, 3), wound as the coarse ones.
    """

    weights: sparse.csr_array
    triangles: NDArray[np.int64]

    @classmethod
    def of(cls, triangles: NDArray, vertices: int, max_triangles: int) -> Refinement:
        """Divide each triangle into four, again and again while there are not too many.

        Vertices of no triangle are left out.
        """
        weights, fine = sparse.eye_array(vertices, format="csr"), triangles
        while 4 * len(fine) <= max_triangles:
            step, fine = _divide(fine, weights.shape[0])
            weights = step @ weights
        used, fine = np.unique(fine, return_inverse=True)
        return cls(weights[used], fine.reshape(-1, 3))


def _divide(triangles: NDArray, n: int) -> tuple[sparse.csr_array, NDArray[np.int64]]:
    """Return the weights of one division of a mesh with n vertices, and its triangles."""
    corners = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    edges, edge, sides = np.unique(
        np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    edge = edge.ravel()
    opposite = triangles[:, [2, 0, 1]].ravel()
    weights = sparse.vstack(
        [
            _vertex_weights(edges, sides, n),
            _edge_weights(edges, sides, edge, opposite, n),
        ]
    ).tocsr()
    ab, bc, ca = (n + edge.reshape(-1, 3)).T
    a, b, c = triangles.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return weights, np.concatenate([np.stack(part, axis=1) for part in parts])


def _vertex_weights(edges: NDArray, sides: NDArray, n: int) -> sparse.csr_array:
    """Return the weights of the old vertices: each moves towards the mean of its neighbors."""
    start, end = np.concatenate([edges, edges[:, ::-1]]).T
    links = sparse.coo_array((np.ones(len(start)), (start, end)), shape=(n, n)).tocsr()
    valence = np.maximum(links.sum(axis=1), 1)
    share = np.where(valence == 3, 9 / 16, 3 / 8)
    # an edge with one side is a border; one with more than two has no smooth surface either
    share[edges[sides != 2]] = 0
    return sparse.diags_array(1 - share) + sparse.diags_array(share / valence) @ links


def _edge_weights(
    edges: NDArray, sides: NDArray, edge: NDArray, opposite: NDArray, n: int
) -> sparse.csr_array:
    """Return the weights of the new vertices, one on each edge."""
    inner = sides == 2
    number = np.arange(len(edges))
    of_ends = np.where(inner, 3 / 8, 1 / 2)
    at_inner = inner[edge]
    rows = np.concatenate([number, number, edge[at_inner]])
    columns = np.concatenate([*edges.T, opposite[at_inner]])
    values = np.concatenate([of_ends, of_ends, np.full(at_inner.sum(), 1 / 8)])
    return sparse.coo_array((values, (rows, columns)), shape=(len(edges), n)).tocsr()
