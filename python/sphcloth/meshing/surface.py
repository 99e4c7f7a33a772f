"""A triangulated surface: edges, hinges, pieces and boundaries follow from its triangles.

A half-edge is a side of a triangle with the triangle's sense: number ``3 t + k`` runs from corner
``k`` to corner ``k + 1`` of triangle ``t`` and lies opposite of corner ``k + 2``.

Half-edges and connected pieces are those of trimesh. Edges and hinges are not: their order is that
of the bonds and dihedrals in the files, while trimesh sorts edges and adjacent triangles by a hash
whose order may change, and counts no triangles at an edge. Its areas differ in the last bit, and
with them the masses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from trimesh.geometry import faces_to_edges
from trimesh.graph import connected_component_labels

from sphcloth.errors import UserError


@dataclass(frozen=True)
class Surface:
    """Triangles over vertices.

    Attributes:
        vertices: positions, shape (V, 3).
        triangles: indices into ``vertices``, shape (T, 3).
        part: number of the file that each triangle came from, shape (T,).
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    part: NDArray[np.int64]

    @classmethod
    def of(cls, vertices: NDArray, triangles: NDArray) -> Surface:
        """Make a surface of one part."""
        return cls(
            np.asarray(vertices, np.float64).reshape(-1, 3),
            np.asarray(triangles, np.int64).reshape(-1, 3),
            np.zeros(len(triangles), np.int64),
        )

    @cached_property
    def half_edges(self) -> NDArray[np.int64]:
        """Start and end of each half-edge, shape (3T, 2)."""
        return faces_to_edges(self.triangles)

    @cached_property
    def _numbered(self) -> tuple[NDArray, NDArray, NDArray]:
        """Edges (E, 2), the edge of each half-edge (3T,), and the triangles at each edge (E,)."""
        n = max(len(self.vertices), 1)
        low, high = np.sort(self.half_edges, axis=1).T
        keys, edge_of, uses = np.unique(low * n + high, return_inverse=True, return_counts=True)
        return np.stack([keys // n, keys % n], axis=1), edge_of, uses

    @property
    def edges(self) -> NDArray[np.int64]:
        """Edges in ascending order, the smaller vertex first, shape (E, 2)."""
        return self._numbered[0]

    @property
    def edge_of_half_edge(self) -> NDArray[np.int64]:
        """Number of the edge on which each half-edge lies, shape (3T,)."""
        return self._numbered[1]

    @property
    def triangles_at_edge(self) -> NDArray[np.int64]:
        """How many triangles have each edge, shape (E,)."""
        return self._numbered[2]

    @cached_property
    def hinge_half_edges(self) -> NDArray[np.int64]:
        """The two half-edges of each edge with two triangles, shape (H, 2)."""
        order = np.argsort(self.edge_of_half_edge, kind="stable")
        shared = self.triangles_at_edge[self.edge_of_half_edge[order]] == 2
        return order[shared].reshape(-1, 2)

    @cached_property
    def hinges(self) -> NDArray[np.int64]:
        """Wing, edge, edge, wing of each hinge, shape (H, 4).

        The first triangle runs along the edge from the second to the third vertex, so that a
        hinge's angle has the same sign on a ridge wherever it is. Triangles must be oriented.
        """
        halves = self.hinge_half_edges
        start, end = self.half_edges[halves[:, 0]].T
        ascending = np.where((start < end)[:, None], halves, halves[:, ::-1])
        opposite = np.roll(self.triangles, -2, axis=1).reshape(-1)
        edge = self.half_edges[ascending[:, 0]]
        return np.column_stack([opposite[ascending[:, 0]], edge, opposite[ascending[:, 1]]])

    @cached_property
    def boundary_edges(self) -> NDArray[np.int64]:
        """Edges of one triangle only, shape (B, 2)."""
        return self.edges[self.triangles_at_edge == 1]

    @cached_property
    def pieces(self) -> NDArray[np.int64]:
        """Number of the connected piece of each vertex, from 0, shape (V,)."""
        return clusters(self.edges, len(self.vertices))

    @property
    def n_boundary_loops(self) -> int:
        """Number of connected boundaries: holes and outer borders."""
        labels = clusters(self.boundary_edges, len(self.vertices))
        return len(np.unique(labels[self.boundary_edges]))

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """Areas of the triangles, shape (T,)."""
        a, b, c = self.vertices[self.triangles.T]
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2

    @cached_property
    def side_lengths(self) -> NDArray[np.float64]:
        """Lengths of the half-edges of each triangle, shape (T, 3)."""
        start, end = self.vertices[self.half_edges.T]
        return np.linalg.norm(end - start, axis=1).reshape(-1, 3)

    @cached_property
    def edge_lengths(self) -> NDArray[np.float64]:
        """Lengths of the edges, shape (E,)."""
        return lengths(self.vertices, self.edges)

    @cached_property
    def quality(self) -> NDArray[np.float64]:
        """4 sqrt(3) area / sum of squared sides: 1 if equilateral, 0 if flat, shape (T,)."""
        return 4 * np.sqrt(3) * self.areas / np.sum(self.side_lengths**2, axis=1)

    def lumped(self, per_triangle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give a third of each triangle's value, shape (T,), to each corner; shape (V,)."""
        thirds = np.repeat(per_triangle / 3, 3)
        return np.bincount(self.triangles.reshape(-1), thirds, minlength=len(self.vertices))

    def select(self, kept: NDArray) -> Surface:
        """Return the surface with some of its triangles, by mask (T,) or index; vertices stay."""
        return Surface(self.vertices, self.triangles[kept], self.part[kept])


def clusters(links: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Return the connected component of each of ``n`` nodes under ``links``, shape (L, 2)."""
    return connected_component_labels(links, n).astype(np.int64)


def lengths(positions: NDArray[np.float64], pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the distances of pairs of vertices, shape (P, 2); shape (P,)."""
    return np.linalg.norm(positions[pairs[:, 1]] - positions[pairs[:, 0]], axis=1)


def join(surfaces: list[Surface]) -> Surface:
    """Put surfaces side by side into one; each becomes a part, numbered from 0."""
    first = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    return Surface(
        np.concatenate([surface.vertices for surface in surfaces]),
        np.concatenate([s.triangles + n for s, n in zip(surfaces, first, strict=True)]),
        np.repeat(np.arange(len(surfaces)), [len(surface.triangles) for surface in surfaces]),
    )


def check_manifold(surface: Surface) -> None:
    """Raise UserError if an edge has more than two triangles: it has no one hinge."""
    crowded = np.flatnonzero(surface.triangles_at_edge > 2)
    if len(crowded):
        a, b = (_place(surface.vertices[v]) for v in surface.edges[crowded[0]])
        raise UserError(
            f"{len(crowded)} edges have more than two triangles, the first from {a} to {b}, with "
            f"{surface.triangles_at_edge[crowded[0]]}: split the surface there in a modeller, or "
            "remove what stands on it"
        )


def orient(surface: Surface) -> tuple[Surface, int]:
    """Wind the triangles of each piece in the same sense, that of most of them.

    The surface is covered twice, once per side: two triangles wound alike join the same sides,
    two wound in opposite senses join opposite ones. A piece whose sides meet has one side only.

    Args:
        surface: at most two triangles at each edge.

    Returns:
        The surface, and the number of triangles turned over.

    Raises:
        UserError: a piece has one side only.
    """
    n = len(surface.triangles)
    halves = surface.hinge_half_edges
    start, end = surface.half_edges[halves].transpose(2, 0, 1)
    opposed = (start[:, 0] < end[:, 0]) == (start[:, 1] < end[:, 1])
    one, other = (halves // 3).T
    links = np.concatenate(
        [
            np.stack([one, other + n * opposed], axis=1),
            np.stack([one + n, other + n * ~opposed], axis=1),
        ]
    )
    front, back = clusters(links, 2 * n).reshape(2, n)
    if np.any(front == back):
        where = surface.vertices[surface.triangles[np.argmax(front == back)]].mean(axis=0)
        raise UserError(
            f"the piece around {_place(where)} has one side only, like a Moebius strip: its "
            "triangles cannot be wound in the same sense; cut it open"
        )
    votes = np.bincount(front, minlength=max(front.max(), back.max()) + 1)
    outvoted = (votes[front] < votes[back]) | ((votes[front] == votes[back]) & (front > back))
    triangles = surface.triangles.copy()
    triangles[outvoted] = triangles[outvoted][:, [0, 2, 1]]
    return Surface(surface.vertices, triangles, surface.part), int(np.count_nonzero(outvoted))


def _place(position: NDArray[np.float64]) -> str:
    return "({:g}, {:g}, {:g})".format(*position)
