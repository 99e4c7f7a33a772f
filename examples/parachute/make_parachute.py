"""Write canopy.obj: a round flat sheet with a vent, folded into pleats.  Lengths in m."""

import sys
from itertools import pairwise

import numpy as np
import trimesh

RADIUS, VENT = 1.0, 0.08  # of the sheet, and of the hole in its middle
LINES = 12  # each at a fold that points inward
INNER = np.radians(12)  # between these folds and the axis


def spines() -> np.ndarray:
    """Return the directions of the folds: sectors of the sheet between them stay flat."""
    # cos(sector) = cos(inner) cos(outer) + sin(inner) sin(outer) cos(sector)
    sector = np.pi / LINES
    a, b = np.cos(INNER), np.sin(INNER) * np.cos(sector)
    outer = np.arctan2(b, a) + np.arccos(np.cos(sector) / np.hypot(a, b))
    tilt = np.tile([INNER, outer], LINES)
    turn = sector * np.arange(2 * LINES)
    return np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt)], 1)


def between(start: np.ndarray, end: np.ndarray, share: float) -> np.ndarray:
    """Return the direction at a share of the angle between two."""
    angle = np.arccos(start @ end)
    return (np.sin((1 - share) * angle) * start + np.sin(share * angle) * end) / np.sin(angle)


def canopy(edge: float) -> trimesh.Trimesh:
    """Return the folded sheet; edges are about as long as `edge`."""
    folds = spines()
    radii = np.linspace(VENT, RADIUS, round((RADIUS - VENT) / edge) + 1)
    parts = [max(1, round(np.pi / LINES * r / edge)) for r in radii]  # of a sector's arc
    x, rings = [], []
    for radius, n in zip(radii, parts, strict=True):
        rings.append(np.arange(len(x), len(x) + n * len(folds)))
        for fold, following in zip(folds, np.roll(folds, -1, axis=0), strict=True):
            x += [radius * between(fold, following, i / n) for i in range(n)]
    faces = []
    for (inner, n), (outer, m) in pairwise(zip(rings, parts, strict=True)):
        for sector in range(len(folds)):
            a = np.take(inner, np.arange(n + 1) + n * sector, mode="wrap")
            b = np.take(outer, np.arange(m + 1) + m * sector, mode="wrap")
            faces += strip(a, b, sector % 2)
    return trimesh.Trimesh(x, faces, process=False)


def strip(a: np.ndarray, b: np.ndarray, turned: int) -> list[tuple[int, int, int]]:
    """Return triangles between two rows of vertices, always ahead where the row is behind."""
    faces, i, j = [], 0, 0
    while i < len(a) - 1 or j < len(b) - 1:
        ahead = (j + 1) * (len(a) - 1) - (i + 1) * (len(b) - 1)
        if ahead < 0 or (ahead == 0 and not turned):
            faces.append((a[i], b[j], b[j + 1]))
            j += 1
        else:
            faces.append((a[i], b[j], a[i + 1]))
            i += 1
    return faces


canopy(float(sys.argv[1])).export("canopy.obj", digits=6)
