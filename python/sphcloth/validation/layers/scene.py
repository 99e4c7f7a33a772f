"""A scene of several meshes as a data file that LAMMPS reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.mesh import ClothMesh
from sphcloth.meshing.cloth import Cloth, Material, build_cloth
from sphcloth.meshing.lammps_files import write_data
from sphcloth.meshing.surface import Surface
from sphcloth.metrics.intersections import Intersections
from sphcloth.validation.layers.shapes import Piece

# atom types: of no water at all, of free vertices, of two groups of pins, of obstacles
WATER, FREE, FIRST, SECOND, OBSTACLE = 1, 2, 3, 4, 5
# room around the scene for all that moves, in its size
ROOM = 3.0


@dataclass(frozen=True)
class Scene:
    """Meshes side by side; those of obstacles are last.

    Attributes:
        pieces: of the scene.
    """

    pieces: Sequence[Piece]

    def __post_init__(self) -> None:
        """Raise ValueError where an obstacle is before a cloth."""
        order = [piece.is_obstacle for piece in self.pieces]
        if order != sorted(order):
            raise ValueError("obstacles come after all cloth")

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions of all vertices at the start, m, shape (V, 3)."""
        return np.concatenate([piece.positions for piece in self.pieces])

    @property
    def parts(self) -> NDArray[np.int64]:
        """Number of the piece of each vertex, shape (V,)."""
        return np.repeat(np.arange(len(self.pieces)), [len(p.positions) for p in self.pieces])

    @property
    def moving(self) -> int:
        """Number of vertices of cloth, which are the first ones."""
        return sum(len(piece.positions) for piece in self.pieces if not piece.is_obstacle)

    @cached_property
    def mesh(self) -> ClothMesh:
        """All triangles; IDs are those of the data file, from 1."""
        surface = self._cloth.surface
        return ClothMesh(np.arange(1, len(surface.vertices) + 1), surface.triangles)

    @property
    def oracle(self) -> Intersections:
        """What finds intersections of the scene's triangles; UserError without ipctk."""
        return Intersections.of(self.mesh, self.moving)

    @property
    def masses(self) -> NDArray[np.float64]:
        """Mass of each vertex, kg, shape (V,); those of obstacles count as well."""
        return self._cloth.masses

    @cached_property
    def rigid(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The edges of cloth that are rigid, shape (E, 2), and their lengths at rest, m, (E,)."""
        bonds = self._cloth.bonds
        edges = bonds[(bonds[:, 0] == 1) & (bonds[:, 1] < self.moving), 1:]
        return edges, self._lengths(edges)

    @property
    def longest_edge(self) -> float:
        """Length of the longest edge at rest, m."""
        return float(np.max(self._lengths(self.mesh.edges)))

    def _lengths(self, edges: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the lengths of edges at rest, m, shape (E,)."""
        start, end = np.concatenate([piece.rest for piece in self.pieces])[edges.T]
        return np.linalg.norm(end - start, axis=1)

    def jittered(self, by: float, seed: int) -> Scene:
        """Return the scene with free vertices displaced at random.

        Args:
            by: largest displacement in each direction, m.
            seed: of the random numbers.
        """
        random = np.random.default_rng(seed)
        pieces = []
        for piece in self.pieces:
            moved = by * random.uniform(-1, 1, piece.positions.shape)
            if piece.is_obstacle:
                moved[:] = 0
            moved[piece.held > 0] = 0
            pieces.append(replace(piece, positions=piece.positions + moved))
        return Scene(pieces)

    def write(self, path: Path) -> None:
        """Write the data file, with sections ``VertexMass`` and ``Rest`` behind the usual ones."""
        positions = self.positions
        low, high = positions.min(axis=0), positions.max(axis=0)
        room = ROOM * np.max(high - low)
        write_data(self._cloth, path, np.stack([low - room, high + room]), mass_per_atom=True)
        rest = np.concatenate([piece.rest for piece in self.pieces])
        ids = np.arange(1, len(rest) + 1)
        with path.open("a", encoding="utf-8") as file:
            file.write("\nRest\n\n")
            np.savetxt(file, np.column_stack([ids, rest]), fmt="%d %.17g %.17g %.17g")

    @cached_property
    def _cloth(self) -> Cloth:
        starts = np.cumsum([0, *(len(piece.positions) for piece in self.pieces)])
        triangles = [p.triangles + start for p, start in zip(self.pieces, starts, strict=False)]
        part = np.repeat(np.arange(len(triangles)), [len(of_piece) for of_piece in triangles])
        rest = np.concatenate([piece.rest for piece in self.pieces])
        # masses are those of the rest shape, places those of the start
        surface = Surface(rest, np.concatenate(triangles), part)
        materials = [Material(piece.areal, dihedral_type=piece.fold) for piece in self.pieces]
        cloth = build_cloth(surface, materials)
        diagonals = np.array([piece.is_woven for piece in self.pieces])[part]
        bonds = cloth.bonds.copy()
        bonds[_longest(surface)[diagonals], 0] = 2
        types = np.concatenate([_types(piece) for piece in self.pieces])
        placed = Surface(self.positions, surface.triangles, part)
        return replace(cloth, surface=placed, types=types, bonds=bonds)


def _longest(surface: Surface) -> NDArray[np.int64]:
    """Return the number of the longest edge of each triangle, shape (T,)."""
    sides = surface.side_lengths.reshape(-1, 3)
    of_triangle = surface.edge_of_half_edge.reshape(-1, 3)
    return of_triangle[np.arange(len(sides)), np.argmax(sides, axis=1)]


def _types(piece: Piece) -> NDArray[np.int64]:
    """Return the atom type of each vertex."""
    if piece.is_obstacle:
        return np.full(len(piece.positions), OBSTACLE)
    return np.choose(piece.held, [FREE, FIRST, SECOND])
