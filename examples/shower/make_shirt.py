"""Write shirt.obj: a T-shirt of two panels that share their seams and bulge away from each other.

How far they bulge is the square root of a membrane's sag over the outline: ellipses across the body
and the sleeves, with a smooth passage between them, and nothing at the seams.  Lengths in m.
"""

import sys

import numpy as np
import trimesh
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve

# breadth over the sleeves and of the body, height from hem to shoulder, height of the sleeves
SPAN, CHEST, TALL, SLEEVE = 0.96, 0.5, 0.7, 0.24
# depth over breadth, of body and sleeves
BULGE = 0.6
# the opening at the neck: half of its breadth, and how deep it is cut in front and in the back
NECK, FRONT, BACK = 0.12, 0.1, 0.04
ARMPIT = TALL - SLEEVE
# lengths below this are none
NONE = 1e-9


def arc(low: float, high: float, cells: int) -> np.ndarray:
    """Return places from low to high that are even on a half circle over them."""
    return (low + high - (high - low) * np.cos(np.pi * np.arange(cells + 1) / cells)) / 2


def even(low: float, high: float, cells: int) -> np.ndarray:
    """Return evenly spaced places, without the last."""
    return np.linspace(low, high, cells, endpoint=False)


def middles(places: np.ndarray) -> np.ndarray:
    """Return what is halfway between each two places."""
    return (places[1:] + places[:-1]) / 2


def outline(mesh: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of the columns (x) and rows (z) of a grid over the shirt."""
    side, end = CHEST / 2, SPAN / 2
    reach, rows = round((end - side) / mesh), round(ARMPIT / mesh)
    across, around = 2 * round(0.6 * CHEST / mesh), round(1.2 * SLEEVE / mesh)
    sleeve = even(end, side, reach)
    x = np.concatenate([-sleeve, arc(-side, side, across), sleeve[::-1]])
    return x, np.concatenate([even(0, ARMPIT, rows), arc(ARMPIT, TALL, around)])


def sag(x: np.ndarray, z: np.ndarray, is_cell: np.ndarray, is_seam: np.ndarray) -> np.ndarray:
    """Return u with Laplacian -1 on the cells of a grid and u = 0 on the seams."""
    number = np.arange(is_seam.size).reshape(is_seam.shape)
    hx, hz = (h[is_cell] for h in np.meshgrid(np.diff(x), np.diff(z), indexing="ij"))
    a, b, c, d = (
        corner[is_cell]
        for corner in (number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:])
    )
    i, j = np.concatenate([a, c, a, b]), np.concatenate([b, d, c, d])
    weight = np.concatenate([hz / hx, hz / hx, hx / hz, hx / hz]) / 2
    links = coo_matrix((weight, (i, j)), (number.size, number.size))
    links = (links + links.T).tocsr()
    area = np.bincount(np.concatenate([a, b, c, d]), np.tile(hx * hz / 4, 4), number.size)
    free = (area > 0) & ~is_seam.ravel()
    u = np.zeros(number.size)
    matrix = diags(np.asarray(links.sum(axis=1)).ravel()) - links
    u[free] = spsolve(matrix[free][:, free].tocsc(), area[free])
    return u.reshape(is_seam.shape)


def panel(
    x: np.ndarray, z: np.ndarray, is_cell: np.ndarray, depth: np.ndarray, cut: float
) -> trimesh.Trimesh:
    """Return one panel, whose upper end the neck lowers; cells are cut alternatingly."""
    cut_here = cut * np.sqrt(np.maximum(0, 1 - (x / NECK) ** 2))
    above_armpit = np.maximum(0, z - ARMPIT) / SLEEVE
    vertices = np.stack([x, depth, z - cut_here * above_armpit], axis=-1)
    number = np.arange(x.size).reshape(x.shape)
    i, j = np.nonzero(is_cell)
    a, b, c, d = number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]
    odd = ((i + j) % 2 == 1)[:, None]
    lower = np.where(odd, np.stack([a, b, d], axis=1), np.stack([a, b, c], axis=1))
    upper = np.where(odd, np.stack([b, c, d], axis=1), np.stack([a, c, d], axis=1))
    return trimesh.Trimesh(vertices.reshape(-1, 3), np.concatenate([lower, upper]), process=False)


def shirt(mesh: float) -> trimesh.Trimesh:
    """Return the shirt with edges of about a length; it is open at hem, neck and sleeves."""
    columns, rows = outline(mesh)
    x, z = np.meshgrid(columns, rows, indexing="ij")
    x_cell, z_cell = np.meshgrid(*(middles(places) for places in (columns, rows)), indexing="ij")
    is_cell = (np.abs(x_cell) < CHEST / 2) | (z_cell > ARMPIT)
    is_side = (z < ARMPIT + NONE) & (np.abs(x) > CHEST / 2 - NONE)
    is_shoulder = (z > TALL - NONE) & (np.abs(x) > NECK - NONE)
    depth = BULGE * np.sqrt(2 * sag(columns, rows, is_cell, is_side | is_shoulder))
    front, back = panel(x, z, is_cell, -depth, FRONT), panel(x, z, is_cell, depth, BACK)
    back.invert()
    # what is at the same place in both panels is a seam
    cloth = trimesh.util.concatenate([front, back])
    cloth.merge_vertices(digits_vertex=9)
    cloth.remove_unreferenced_vertices()
    return cloth


shirt(float(sys.argv[1])).export("shirt.obj", digits=5)
