"""Reads a triangle mesh of any format that trimesh knows, and repairs it.

What can be repaired without a change of the shape is repaired and reported; all else is an error.
The repairs of trimesh do not do: it merges vertices by rounding, which leaves two apart that are
close on the two sides of a step, and drops flat triangles, which opens cracks.
"""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from trimesh.grouping import unique_rows

from sphcloth.errors import UserError
from sphcloth.meshing.polygons import Polygons, cut_folded, read_polygons
from sphcloth.meshing.surface import Surface, clusters

# squares of coordinates must be numbers, and so must their sums
LARGEST = 1e100
# vertices closer than this share of the mesh's extent are one: single precision in STL and PLY
MERGE_SHARE = 1e-7
# a triangle lower than this share of its longest side has no usable normal
FLAT = 1e-6
# a chain of so many flat triangles along one edge is mended
FLAT_PASSES = 20


def read_surface(path: str | Path, merge: float | None = None) -> tuple[Surface, list[str]]:
    """Read a mesh and repair it.

    Args:
        path: OBJ, STL, PLY or any other format of trimesh.
        merge: vertices closer than this become one, in the units of the file; None takes 1e-7
            of the extent.

    Returns:
        The surface, without flat triangles, duplicates and unused vertices, and a sentence for
        each kind of repair.

    Raises:
        UserError: no such file, not a mesh, no triangle, coordinates that are no numbers, or
            flat triangles that cannot be mended, or a polygon that crosses itself.
    """
    path = Path(path)
    surface, polygons = _read(path)
    try:
        return repair(cut_folded(surface, polygons), merge)
    except UserError as error:
        raise UserError(f"{path}: {error}") from None


def repair(surface: Surface, merge: float | None = None) -> tuple[Surface, list[str]]:
    """Repair a surface; arguments, result and errors as of :func:`read_surface`."""
    surface, unused = drop_unused_vertices(surface)
    _check_coordinates(surface)
    surface, merged = merge_vertices(surface, merge)
    surface, collapsed = drop_collapsed(surface)
    surface, repeated = drop_repeated(surface)
    surface, flat = mend_flat(surface)
    surface, left = drop_unused_vertices(surface)
    if not len(surface.triangles):
        raise UserError("no triangle is left: all of them are flat or have edges of length zero")
    counts = [
        (merged, "vertices at the same place merged"),
        (collapsed, "triangles with an edge of length zero removed"),
        (repeated, "repeated triangles removed"),
        (flat, "flat triangles removed, their neighbors cut anew"),
        (unused + left, "vertices without a triangle removed"),
    ]
    return surface, [f"{count:,} {what}" for count, what in counts if count]


def drop_unused_vertices(surface: Surface) -> tuple[Surface, int]:
    """Remove vertices that no triangle has; return also how many. Order is kept."""
    used, triangles = np.unique(surface.triangles, return_inverse=True)
    kept = Surface(surface.vertices[used], triangles.reshape(-1, 3), surface.part)
    return kept, len(surface.vertices) - len(used)


def merge_vertices(surface: Surface, distance: float | None) -> tuple[Surface, int]:
    """Make one vertex, the first, of all that are closer than a distance; return how many went."""
    if distance is None:
        distance = MERGE_SHARE * float(np.ptp(surface.vertices, axis=0).max(initial=0.0))
    _, first, place = np.unique(
        surface.vertices + 0.0, axis=0, return_index=True, return_inverse=True
    )
    exact = first[place.reshape(-1)]
    close = cKDTree(surface.vertices[first]).query_pairs(distance, output_type="ndarray")
    links = np.concatenate([first[close], np.stack([np.arange(len(exact)), exact], axis=1)])
    merged = replace_vertices(surface, clusters(links, len(surface.vertices)))
    return merged, len(surface.vertices) - len(merged.vertices)


def replace_vertices(surface: Surface, cluster: NDArray[np.int64]) -> Surface:
    """Put the first vertex of each cluster, shape (V,), in place of all others of it."""
    _, first, inverse = np.unique(cluster, return_index=True, return_inverse=True)
    kept, number = np.unique(first[inverse], return_inverse=True)
    return Surface(surface.vertices[kept], number[surface.triangles], surface.part)


def drop_collapsed(surface: Surface) -> tuple[Surface, int]:
    """Remove triangles that have a corner twice; return also how many."""
    a, b, c = surface.triangles.T
    whole = (a != b) & (b != c) & (c != a)
    return surface.select(whole), int(np.count_nonzero(~whole))


def drop_repeated(surface: Surface) -> tuple[Surface, int]:
    """Remove triangles whose corners another one has, in any order; return also how many."""
    first, _ = unique_rows(np.sort(surface.triangles, axis=1))
    return surface.select(np.sort(first)), len(surface.triangles) - len(first)


def mend_flat(surface: Surface) -> tuple[Surface, int]:
    """Remove triangles whose corners lie on a line, without opening a crack; return how many.

    The longest side of a flat triangle has the third corner on it. The neighbor there is cut in
    two at this corner. At a border there is no neighbor.

    Raises:
        UserError: flat triangles that only have flat neighbors there.
    """
    removed = 0
    for _ in range(FLAT_PASSES):
        height = 2 * surface.areas / np.maximum(surface.side_lengths.max(axis=1), 1e-300)
        flat = height <= FLAT * surface.side_lengths.max(axis=1)
        if not flat.any():
            return surface, removed
        mended, count = _cut_neighbors(surface, flat)
        if not count:
            break
        removed += count
        surface = drop_repeated(drop_collapsed(mended)[0])[0]
    where = surface.vertices[surface.triangles[np.argmax(flat)]].mean(axis=0)
    raise UserError(
        f"{np.count_nonzero(flat)} flat triangles cannot be mended, one near "
        "({:g}, {:g}, {:g}): merge close vertices with --merge DISTANCE, or remesh".format(*where)
    )


def _cut_neighbors(surface: Surface, flat: NDArray[np.bool_]) -> tuple[Surface, int]:
    """Replace flat triangles and their neighbors by the neighbors' halves; return how many.

    A neighbor that is flat itself, or was cut already, is left for the next pass.
    """
    triangles = surface.triangles.copy()
    gone = np.zeros(len(triangles), bool)
    touched = flat.copy()
    cut = 0
    longest = surface.side_lengths.argmax(axis=1)
    order = np.argsort(surface.edge_of_half_edge, kind="stable")
    first = np.searchsorted(surface.edge_of_half_edge[order], np.arange(len(surface.edges) + 1))
    for t in np.flatnonzero(flat):
        side = 3 * t + longest[t]
        edge = surface.edge_of_half_edge[side]
        others = [half for half in order[first[edge] : first[edge + 1]] if half != side]
        if not others:
            gone[t] = True
        elif len(others) == 1 and not touched[others[0] // 3]:
            neighbor, corner = others[0] // 3, surface.triangles[t, (longest[t] + 2) % 3]
            start, end = surface.half_edges[others[0]]
            tip = surface.triangles[neighbor, (others[0] + 2) % 3]
            triangles[t] = start, corner, tip
            triangles[neighbor] = corner, end, tip
            touched[neighbor] = True
            cut += 1
    kept = Surface(surface.vertices, triangles[~gone], surface.part[~gone])
    return kept, cut + int(np.count_nonzero(gone))


def _read(path: Path) -> tuple[Surface, Polygons | None]:
    """Return the triangles of a file as trimesh reads them, and the polygons that they are of."""
    if not path.is_file():
        raise UserError(f"no mesh file {path}")
    if not path.stat().st_size:
        raise UserError(f"{path} is empty")
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    try:
        loaded = trimesh.load_mesh(path, process=False, skip_materials=True)
        vertices, triangles = np.asarray(loaded.vertices), np.asarray(loaded.faces)
        polygons = read_polygons(path, loaded) if len(triangles) else None
    # trimesh's readers fail in many ways on files of another form
    except Exception as error:
        raise UserError(
            f"{path} cannot be read as a {path.suffix or 'mesh'} file "
            f"({type(error).__name__}: {str(error)[:80]}): use OBJ, STL or PLY"
        ) from error
    if not len(triangles):
        raise UserError(f"{path} holds no triangle")
    if vertices.shape[1:] != (3,) or triangles.shape[1:] != (3,):
        raise UserError(f"{path}: a vertex has not 3 coordinates, or a triangle not 3 vertices")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise UserError(f"{path}: a triangle has a vertex that is not in the file")
    return Surface.of(vertices, triangles), polygons


def _check_coordinates(surface: Surface) -> None:
    bad = ~(np.abs(surface.vertices) < LARGEST).all(axis=1)
    if bad.any():
        raise UserError(
            f"{np.count_nonzero(bad)} vertices have a coordinate that is no number or beyond "
            f"{LARGEST:g}, the first is {surface.vertices[np.argmax(bad)]}"
        )
