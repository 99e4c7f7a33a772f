"""Whether cloth goes through itself, other cloth or an obstacle: from positions alone, by ipctk.

The IPC toolkit asks every pair of an edge and a triangle, and every pair of paths, without anything
of the contact under test. It is an optional dependency, imported when a mesh is first asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame

REMEDY = "pip install 'sphcloth[oracle]'"
# distances are looked for up to so many thicknesses
REACH = 1.2


@dataclass(frozen=True)
class Intersections:
    """Asks a mesh, at given positions of its vertices, where it meets itself.

    Parts that share a vertex are no pair. Vertices from ``moving`` on are those of obstacles,
    which do not meet one another.

    Attributes:
        triangles: indices of vertices, shape (T, 3); vertices without a triangle are left alone.
        n_vertices: number of vertices.
        moving: number of vertices of cloth, the first ones; None for all.

    Raises:
        UserError: ipctk is not installed.
    """

    triangles: NDArray[np.int64]
    n_vertices: int
    moving: int | None = None

    def __post_init__(self) -> None:
        check_installed()

    @classmethod
    def of(cls, mesh: ClothMesh, moving: int | None = None) -> Intersections:
        """Take the triangles of a mesh; ``moving`` as in the class."""
        return cls(mesh.triangles, len(mesh.ids), moving)

    @cached_property
    def edges(self) -> NDArray[np.int64]:
        """Edges of the triangles, each once, shape (E, 2)."""
        a, b, c = self.triangles.T
        sides = np.stack([np.concatenate([a, b, c]), np.concatenate([b, c, a])], axis=1)
        return np.unique(np.sort(sides, axis=1), axis=0)

    def intersect(self, positions: NDArray[np.float64]) -> bool:
        """Tell whether an edge goes through a triangle anywhere; positions have shape (V, 3)."""
        import ipctk

        return ipctk.has_intersections(self._mesh, _dense(positions), ipctk.LBVH())

    def pairs(self, positions: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the edges and triangles that meet, shape (K, 2): numbers of edge and triangle."""
        import ipctk

        if not self.intersect(positions):
            return np.empty((0, 2), np.int64)
        points, search = _dense(positions), ipctk.LBVH()
        search.build(points, self.edges.astype(np.int32), self.triangles.astype(np.int32), 0.0)
        near = search.detect_edge_face_candidates()
        asked = np.array([(pair.edge_id, pair.face_id) for pair in near]).reshape(-1, 2)
        asked = asked[self._may_meet(asked)]
        met = [
            ipctk.is_edge_intersecting_triangle(*points[self.edges[e]], *points[self.triangles[t]])
            for e, t in asked
        ]
        return asked[np.array(met, bool)]

    def count(self, positions: NDArray[np.float64]) -> int:
        """Return the number of pairs of an edge and a triangle that meet."""
        return len(self.pairs(positions))

    def counts(self, positions: NDArray[np.float64]) -> tuple[int, int]:
        """Return the number of pairs that meet: of cloth and cloth, of cloth and obstacle."""
        pairs = self.pairs(positions)
        edges, corners = self.edges[pairs[:, 0], 0], self.triangles[pairs[:, 1], 0]
        of_cloth = int(np.sum((edges < self._moving) & (corners < self._moving)))
        return of_cloth, len(pairs) - of_cloth

    def is_free(self, before: NDArray[np.float64], after: NDArray[np.float64]) -> bool:
        """Tell whether all vertices can move on straight lines without that parts meet."""
        import ipctk

        return ipctk.is_step_collision_free(
            self._mesh, _dense(before), _dense(after), 0.0, ipctk.LBVH()
        )

    def crossed(self, before: NDArray[np.float64], after: NDArray[np.float64]) -> tuple[bool, bool]:
        """Tell whether straight paths meet: of cloth and cloth, or else of cloth and obstacle."""
        if self.is_free(before, after):
            return False, False
        if self._moving == self.n_vertices:
            return True, False
        of_cloth = not self._cloth.is_free(before[: self._moving], after[: self._moving])
        return of_cloth, not of_cloth

    def gap(self, positions: NDArray[np.float64], reach: float) -> float:
        """Return the smallest distance of parts without a common vertex, inf beyond a reach."""
        import ipctk

        near, points = ipctk.NormalCollisions(), _dense(positions)
        near.build(self._mesh, points, reach, 0.0, ipctk.LBVH())
        if not len(near):
            return math.inf
        return math.sqrt(near.compute_minimum_distance(self._mesh, points))

    def _may_meet(self, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tell which pairs of edge and triangle share no vertex and do not lie in obstacles."""
        edges, corners = self.edges[pairs[:, 0]], self.triangles[pairs[:, 1]]
        apart = ~np.any(edges[:, :, None] == corners[:, None, :], axis=(1, 2))
        return apart & ((edges[:, 0] < self._moving) | (corners[:, 0] < self._moving))

    @property
    def _moving(self) -> int:
        return self.n_vertices if self.moving is None else self.moving

    @cached_property
    def _cloth(self) -> Intersections:
        """The same without obstacles."""
        return Intersections(self.triangles[self.triangles[:, 0] < self._moving], self._moving)

    @cached_property
    def _mesh(self):
        import ipctk

        ipctk.set_num_threads(1)
        # places at rest do not matter: one of their own for each vertex
        rest = np.arange(3.0 * self.n_vertices).reshape(-1, 3)
        faces, edges = self.triangles.astype(np.int32), self.edges.astype(np.int32)
        mesh = ipctk.CollisionMesh(_dense(rest), _dense(edges), _dense(faces))
        if self.moving is not None:
            mesh.can_collide = ipctk.make_static_obstacle_filter(self.moving)
        return mesh


@dataclass(frozen=True)
class Passage:
    """What :func:`inspect` finds in a run; cloth is that with cloth, not that with obstacles.

    Attributes:
        frames: number of frames.
        met: frames in which cloth meets cloth.
        met_obstacles: frames in which cloth meets an obstacle.
        most: pairs of an edge and a triangle that meet in the frame with most of them.
        not_free: steps from frame to frame in which straight paths of cloth and cloth meet.
        not_free_obstacles: steps in which those of cloth and an obstacle meet.
        first: step of the first frame, or of the end of the first step, that is not free of any
            kind; -1 where all are.
        gap: smallest distance over the thickness, inf where none is below ``REACH``; 0 where parts
            meet.
    """

    frames: int
    met: int
    met_obstacles: int
    most: int
    not_free: int
    not_free_obstacles: int
    first: int
    gap: float


def inspect(
    oracle: Intersections,
    mesh: ClothMesh,
    frames: Iterable[Frame],
    thickness: float,
    gap_every: int = 1,
) -> Passage:
    """Ask every frame of a run, and every step from one to the next.

    The paths between frames are straight: dump every step. Where a frame has parts that meet, the
    steps to it and from it are not free. Distances are measured in one frame of ``gap_every``,
    since they cost more than all else.
    """
    steps, met, crossed, gaps, before = [], [], [], [], None
    for number, frame in enumerate(frames):
        positions = unwrapped(mesh, frame)
        steps.append(frame.step)
        met.append(oracle.counts(positions))
        gaps.append(0.0 if any(met[-1]) else math.inf)
        if not any(met[-1]) and number % gap_every == 0:
            gaps[-1] = oracle.gap(positions, REACH * thickness) / thickness
        crossed.append((False, False) if before is None else oracle.crossed(before, positions))
        before = positions
    there = np.array(met) > 0
    swept = np.array(crossed)
    swept[1:] |= there[1:] | there[:-1]
    bad = np.any(there | swept, axis=1)
    return Passage(
        frames=len(steps),
        met=int(there[:, 0].sum()),
        met_obstacles=int(there[:, 1].sum()),
        most=max(map(sum, met)),
        not_free=int(swept[:, 0].sum()),
        not_free_obstacles=int(swept[:, 1].sum()),
        first=steps[int(np.argmax(bad))] if bad.any() else -1,
        gap=min(gaps),
    )


class MostMet:
    """The number of edges and triangles that meet, in the frame with most of such pairs."""

    def __init__(self, mesh: ClothMesh, cloth: NDArray[np.bool_]) -> None:
        """Take a mesh of cloth and obstacles.

        Args:
            mesh: of both.
            cloth: which of its triangles are cloth, shape (T,); others do not meet one another.

        Raises:
            UserError: ipctk is not installed.
        """
        moving, resting = np.unique(mesh.triangles[cloth]), np.unique(mesh.triangles[~cloth])
        self._mesh, self.count = mesh, 0
        self._order = np.concatenate([moving, np.setdiff1d(resting, moving)])
        place = np.empty(len(mesh.ids), np.int64)
        place[self._order] = np.arange(len(self._order))
        self._oracle = Intersections(place[mesh.triangles], len(self._order), len(moving))

    def watch(self, frame: Frame) -> None:
        """Count those of a frame."""
        positions = unwrapped(self._mesh, frame)[self._order]
        self.count = max(self.count, self._oracle.count(positions))


def unwrapped(mesh: ClothMesh, frame: Frame) -> NDArray[np.float64]:
    """Return the vertices' positions without periodic wraps, shape (V, 3).

    Raises:
        UserError: the box is periodic and the dump has no columns ix iy iz.
    """
    positions = mesh.positions(frame)
    if not any(frame.periodic):
        return positions
    return positions + mesh.vectors(frame, "ix", "iy", "iz") @ frame.cell


def check_installed() -> None:
    """Raise UserError, with the command that installs it, where there is no ipctk."""
    if find_spec("ipctk") is None:
        raise UserError(f"intersections are found by ipctk, which is not installed: {REMEDY}")


def _dense(values: NDArray) -> NDArray:
    return np.asfortranarray(values)
