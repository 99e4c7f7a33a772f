"""Strings as thin tubes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sphcloth.rendering.surface import Surface

SIDES = 6


def tubes(points: NDArray[np.float64], links: NDArray[np.int64], radius: float) -> Surface:
    """Return a prism around each edge; ends are open.

    Args:
        points: shape (N, 3).
        links: the ends of each edge, shape (L, 2).
        radius: of the prisms.
    """
    start, end = points[links[:, 0]], points[links[:, 1]]
    along = end - start
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.divide(along, length, out=np.zeros_like(along), where=length > 0)
    # across the edge and the axis that it is farthest from
    axis = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    first = np.cross(along, axis)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(along, first)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    rim = (
        np.cos(angle)[:, None] * first[:, None, :] + np.sin(angle)[:, None] * second[:, None, :]
    )  # shape (L, SIDES, 3)
    corners = np.stack([start[:, None] + radius * rim, end[:, None] + radius * rim], axis=1)
    a = np.arange(SIDES)
    b = (a + 1) % SIDES
    faces = np.concatenate(
        [np.stack([a, b, a + SIDES], axis=1), np.stack([b, b + SIDES, a + SIDES], axis=1)]
    )
    triangles = faces[None] + 2 * SIDES * np.arange(len(links))[:, None, None]
    return Surface.of(corners.reshape(-1, 3), triangles.reshape(-1, 3))
