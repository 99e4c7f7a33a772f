"""Meshes of the scenes: sheets, ribbons along a curve, a tube, a ball and a plate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from trimesh.creation import icosphere


@dataclass(frozen=True)
class Piece:
    """One connected mesh of a scene.

    Attributes:
        positions: of the vertices at the start, m, shape (V, 3).
        rest: rest positions, m, shape (V, 3).
        triangles: indices of vertices, shape (T, 3), all wound in the same sense.
        areal: mass per area, kg/m^2.
        held: 0 for a free vertex, 1 and 2 for those of the first and second group of pins, (V,).
        is_obstacle: whether it is an obstacle, which does not deform.
        fold: dihedral type of its hinges: 1 for cloth, 2 for what keeps its shape.
        is_woven: whether it gives way to shear: the longest sides of triangles, which are the
            diagonals of cells, are of bond type 2.
    """

    positions: NDArray[np.float64]
    rest: NDArray[np.float64]
    triangles: NDArray[np.int64]
    areal: float
    held: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    is_obstacle: bool = False
    fold: int = 1
    is_woven: bool = False

    def __post_init__(self) -> None:
        """Fill in that no vertex is held where nothing is said."""
        if not len(self.held):
            object.__setattr__(self, "held", np.zeros(len(self.positions), np.int64))


def grid(across: int, along: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a grid over the unit square and its triangles.

    Args:
        across: number of vertices along the first side.
        along: number along the second.

    Returns:
        Places in the unit square, shape (V, 2), and triangles, (T, 3), counter-clockwise, whose
        diagonals alternate. Vertex (i, j) is number ``i * along + j``.
    """
    u, v = np.meshgrid(np.linspace(0, 1, across), np.linspace(0, 1, along), indexing="ij")
    number = np.arange(across * along).reshape(across, along)
    return np.stack([u.ravel(), v.ravel()], axis=1), _triangles(number)


def sheet(side: float, across: int, height: float, areal: float, turned: float = 0.0) -> Piece:
    """Return a level square sheet around the z axis.

    Args:
        side: of the square, m.
        across: vertices along each side.
        height: z of the sheet, m.
        areal: mass per area, kg/m^2.
        turned: angle about the z axis, rad.
    """
    places, triangles = grid(across, across)
    x, y = side * (places.T - 0.5)
    c, s = np.cos(turned), np.sin(turned)
    positions = np.stack([c * x - s * y, s * x + c * y, np.full_like(x, height)], axis=1)
    return Piece(positions, positions, triangles, areal)


def plate(side: float, across: int, height: float) -> Piece:
    """Return a level square plate as an obstacle around the z axis, its top at a height in m."""
    flat = sheet(side, across, height, 1.0)
    return Piece(flat.positions, flat.rest, flat.triangles, 1.0, is_obstacle=True)


def ball(
    radius: float, edge: float, height: float, areal: float = 1.0, *, is_obstacle: bool = True
) -> Piece:
    """Return a ball around the z axis: an obstacle, or a closed cloth that keeps its shape.

    Args:
        radius: of its vertices, m.
        edge: the edges are at most so long, m, but for a few per cent.
        height: z of its center, m.
        areal: mass per area, kg/m^2.
        is_obstacle: whether it is an obstacle.
    """
    # an icosahedron has edges of 1.05 radii; each subdivision halves them
    halvings = int(np.clip(np.ceil(np.log2(1.05 * radius / edge)), 0, 6))
    mesh = icosphere(halvings, radius)
    positions = np.asarray(mesh.vertices) + np.array([0, 0, height])
    faces = np.asarray(mesh.faces, np.int64)
    return Piece(positions, positions, faces, areal, is_obstacle=is_obstacle, fold=2)


def tube(radius: float, length: float, around: int, areal: float) -> Piece:
    """Return an open tube of woven cloth along the x axis, both of whose rims are held.

    Args:
        radius: m.
        length: m.
        around: vertices around it; rows along it keep cells square.
        areal: mass per area, kg/m^2.
    """
    along = max(3, round(length / (2 * np.pi * radius / around)) + 1)
    angle = 2 * np.pi * np.arange(around) / around
    x = length * np.linspace(-0.5, 0.5, along)
    positions = np.stack(
        [
            np.repeat(x, around),
            np.tile(radius * np.cos(angle), along),
            np.tile(radius * np.sin(angle), along),
        ],
        axis=1,
    )
    number = np.arange(along * around).reshape(along, around)
    closed = np.concatenate([number, number[:, :1]], axis=1)
    held = np.zeros(len(positions), np.int64)
    held[number[0]], held[number[-1]] = 1, 2
    return Piece(positions, positions, _triangles(closed), areal, held, is_woven=True)


def ribbon(
    curve: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    width: float,
    across: int,
    areal: float,
    group: int,
) -> Piece:
    """Return a ribbon along a curve, whose first and last row are held.

    Its width turns as little as it can along the curve, and begins as upright as it can. The edges
    are as long at rest as at the start.

    Args:
        curve: place for a parameter from 0 to 1, from shape (N,) to (N, 3), m.
        width: m.
        across: vertices over the width; rows along it keep cells nearly square.
        areal: mass per area, kg/m^2.
        group: of the pins, 1 or 2.
    """
    fine = np.linspace(0, 1, 20_001)
    chords = np.linalg.norm(np.diff(curve(fine), axis=0), axis=1)
    arc = np.concatenate([[0], np.cumsum(chords)])
    along = max(3, round(arc[-1] / width * (across - 1)) + 1)
    middle = curve(np.interp(arc[-1] * np.linspace(0, 1, along), arc, fine))
    places, triangles = grid(along, across)
    sideways = width * (places[:, 1] - 0.5)
    upright = np.repeat(_carried(middle), across, axis=0)
    positions = np.repeat(middle, across, axis=0) + sideways[:, None] * upright
    held = np.repeat(np.r_[group, np.zeros(along - 2, np.int64), group], across)
    return Piece(positions, positions, triangles, areal, held)


def _carried(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a direction across a curve at each place, carried along without a turn, (N, 3)."""
    tangents = np.gradient(places, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    found = [np.array([0.0, 0.0, 1.0])]
    for tangent in tangents:
        across = found[-1] - (found[-1] @ tangent) * tangent
        found.append(across / np.linalg.norm(across))
    return np.array(found[1:])


def _triangles(number: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return two triangles for each cell of a grid of vertices, with alternating diagonals."""
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    odd = (np.add.outer(np.arange(a.shape[0]), np.arange(a.shape[1])) % 2 == 1)[..., None]
    first = np.where(odd, np.stack([a, b, d], -1), np.stack([a, b, c], -1))
    second = np.where(odd, np.stack([b, c, d], -1), np.stack([a, c, d], -1))
    return np.concatenate([first, second], axis=-1).reshape(-1, 3)
