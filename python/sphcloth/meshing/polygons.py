"""Polygons of a mesh file: VTK cuts those that fans of triangles, as of trimesh, would fold.

trimesh gives triangles alone, so the corners of polygons are read here: of PLY from what it has
read, of OBJ and OFF from their lines. The other formats hold triangles.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from sphcloth.errors import UserError
from sphcloth.meshing.surface import Surface

# twice an area turned over, over the square of the longest diagonal, below which it is round-off
FOLD = 1e-6


@dataclass(frozen=True)
class Polygons:
    """The faces of a file.

    Attributes:
        vertices: positions, shape (V, 3).
        corners: indices into ``vertices``, face after face.
        sizes: number of corners of each face, three or more.
    """

    vertices: NDArray[np.float64]
    corners: NDArray[np.int64]
    sizes: NDArray[np.int64]

    def of_size(self, size: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the numbers of the faces of a size, and their corners, shape (M, size)."""
        numbers = np.flatnonzero(self.sizes == size)
        starts = np.cumsum(self.sizes) - self.sizes
        return numbers, self.corners[starts[numbers, None] + np.arange(size)]

    @property
    def faces(self) -> list[NDArray[np.int64]]:
        """The corners of each face."""
        return np.split(self.corners, np.cumsum(self.sizes)[:-1])


def read_polygons(path: Path, loaded: trimesh.Trimesh) -> Polygons | None:
    """Return the faces of a file.

    Args:
        path: of a file that trimesh has read.
        loaded: what it has read.

    Returns:
        None if all faces are triangles.

    Raises:
        ValueError: what is no number, or a corner that is not in the file.
    """
    reader = _READERS.get(path.suffix.lower())
    vertices, faces = reader(path, loaded) if reader else (np.empty((0, 3)), [])
    if all(len(face) <= 3 for face in faces):
        return None
    kept = [face for face in faces if len(face) > 2]
    corners = np.fromiter(map(int, itertools.chain.from_iterable(kept)), np.int64)
    if corners.min() < 0 or corners.max() >= len(vertices):
        raise ValueError("a polygon has a corner that is not in the file")
    positions = np.asarray(vertices, np.float64).reshape(-1, 3)
    return Polygons(positions, corners, np.array([len(face) for face in kept]))


def cut_folded(surface: Surface, polygons: Polygons | None) -> Surface:
    """Return a surface in which no polygon is folded over itself.

    Args:
        surface: of fans.
        polygons: of the same file, None if they are triangles.

    Raises:
        UserError: a polygon that crosses itself, or is too far from flat.
    """
    folded = _folded(polygons) if polygons else []
    if not folded:
        return surface
    faces = polygons.faces
    pieces = [_fan(face) for face in faces]
    clipped = _clipped(polygons.vertices, [faces[number] for number in folded])
    for number, ears in zip(folded, clipped, strict=True):
        pieces[number] = ears
    return Surface.of(polygons.vertices, np.concatenate(pieces))


def _fan(face: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.column_stack([np.full(len(face) - 2, face[0]), face[1:-1], face[2:]])


def _folded(polygons: Polygons) -> list[int]:
    """Return the numbers of the polygons that a fan folds."""
    folded: list[int] = []
    for size in np.unique(polygons.sizes[polygons.sizes > 3]):
        numbers, faces = polygons.of_size(size)
        corners = polygons.vertices[faces]
        folded += numbers[_is_turned_over(corners, _fan_areas(corners))].tolist()
    return sorted(folded)


def _fan_areas(corners: NDArray) -> NDArray[np.float64]:
    """Return twice the area vectors of the fans of polygons, shape (M, K, 3); (M, K - 2, 3)."""
    sides = corners[:, 1:] - corners[:, :1]
    with np.errstate(invalid="ignore", over="ignore"):
        return np.cross(sides[:, :-1], sides[:, 1:])


def _is_turned_over(corners: NDArray, areas: NDArray) -> NDArray[np.bool_]:
    """Tell of which polygons a triangle lies upside down.

    Polygons that enclose nothing have no sense: all of their triangles must be flat.

    Args:
        corners: of the polygons, shape (M, K, 3).
        areas: twice the area vectors of their triangles, shape (M, T, 3).
    """
    # coordinates that are no numbers, or too large, are found later
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        normals = _fan_areas(corners).sum(axis=1)
        sizes = np.linalg.norm(normals, axis=-1)
        diagonals = np.sum((corners - corners[:, :1]) ** 2, axis=-1)
        slack = FOLD * diagonals.max(axis=-1)
        heights = np.sum(areas * normals[:, None], axis=-1) / sizes[:, None]
        turned = np.any(heights < -slack[:, None], axis=-1)
        thick = np.any(np.linalg.norm(areas, axis=-1) > slack[:, None], axis=-1)
    return np.where(sizes > slack, turned, thick)


def _clipped(vertices: NDArray, faces: Sequence[NDArray]) -> list[NDArray[np.int64]]:
    """Cut polygons by VTK's ear clipping; UserError for one that cannot be cut."""
    import pyvista

    body = pyvista.PolyData.from_irregular_faces(vertices, faces)
    body.cell_data["polygon"] = np.arange(len(faces))
    cut = body.triangulate()
    triangles, owner = cut.regular_faces.reshape(-1, 3), cut.cell_data["polygon"]
    pieces = [triangles[owner == number].astype(np.int64) for number in range(len(faces))]
    for face, ears in zip(faces, pieces, strict=True):
        a, b, c = vertices[ears.T]
        areas = np.cross(b - a, c - a)
        if len(ears) < len(face) - 2 or _is_turned_over(vertices[face][None], areas[None])[0]:
            where = "({:g}, {:g}, {:g})".format(*vertices[face].mean(axis=0))
            raise UserError(
                f"the polygon of {len(face)} corners around {where} crosses or touches itself, or "
                "is far from flat: cut it into triangles in the program that made it"
            )
    return pieces


def _read_obj(path: Path, _: trimesh.Trimesh) -> _Lists:
    """Read the lines of vertices and faces, with corners counted from 1 or back from the last."""
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    vertices, faces = [], []
    if not re.search(r"^[ \t]*f(?:[ \t]+\S+){4}", text, re.MULTILINE):
        return vertices, faces
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.partition("/")[0]) for word in words[1:]]
            faces.append([n - 1 if n > 0 else n + len(vertices) for n in corners])
    return vertices, faces


def _read_off(path: Path, _: trimesh.Trimesh) -> _Lists:
    """Read the counts, the vertices, and the faces with their numbers of corners."""
    text = re.sub("#.*", "", path.read_text(encoding="utf-8", errors="replace"))
    lines = re.split("C?OFF", text, maxsplit=1)[1].splitlines()
    rows = [line.split() for line in lines if line.strip()]
    n, m = map(int, rows[0][:2])
    faces = [row[1 : 1 + int(row[0])] for row in rows[n + 1 : n + m + 1]]
    return [row[:3] for row in rows[1 : n + 1]], faces


def _read_ply(_: Path, loaded: trimesh.Trimesh) -> _Lists:
    """Take what trimesh has read: lists of corners by name, or with their lengths."""
    elements = loaded.metadata["_ply_raw"]
    vertices = np.column_stack([elements["vertex"]["data"][axis] for axis in "xyz"])
    faces = elements["face"]["data"]
    known = faces.dtype.names if isinstance(faces, np.ndarray) else list(faces)
    wanted = ("vertex_indices", "vertex_index", *known)
    corners = faces[next(name for name in wanted if name in known)]
    return vertices, corners["f1"] if corners.dtype.names else corners


# positions, and corners by face
_Lists = tuple[ArrayLike, Sequence[Sequence]]
_READERS: dict[str, Callable[[Path, trimesh.Trimesh], _Lists]] = {
    ".obj": _read_obj,
    ".off": _read_off,
    ".ply": _read_ply,
}
