"""Write balloon.obj: two round sheets that are joined along their rims, hanging.  Lengths in m."""

import sys

import numpy as np
import trimesh

RADIUS, BULGE = 0.25, 0.02  # of the sheets, and how far their middles are from the rim


def disc(edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles of a disc of rings; ring k has 6 k vertices."""
    rings = round(RADIUS / edge)
    x, first = [(0.0, 0.0)], [0]
    for k in range(1, rings + 1):
        first.append(len(x))
        angle = 2 * np.pi * np.arange(6 * k) / (6 * k)
        x += list(zip(np.cos(angle) * k / rings, np.sin(angle) * k / rings, strict=True))
    faces = []
    for k in range(1, rings + 1):
        for i in range(6 * k):
            inner = i // k * (k - 1) + i % k  # of the vertex beside it on the ring inside
            a, b = first[k] + i, first[k] + (i + 1) % (6 * k)
            c = first[k - 1] + (inner % (6 * (k - 1)) if k > 1 else 0)
            faces.append((a, b, c))
            if i % k < k - 1:
                faces.append((c, b, first[k - 1] + (inner + 1) % (6 * (k - 1))))
    return np.array(x), np.array(faces)


def balloon(edge: float) -> trimesh.Trimesh:
    """Return both sheets as one mesh; edges are about as long as `edge`."""
    x, faces = disc(edge)
    depth = BULGE * (1 - (x**2).sum(axis=1))
    sheets = [
        np.stack([RADIUS * x[:, 0], sign * depth, RADIUS * x[:, 1]], axis=1) for sign in (-1, 1)
    ]
    mesh = trimesh.Trimesh(np.concatenate(sheets), np.concatenate([faces, faces[:, ::-1] + len(x)]))
    mesh.merge_vertices()
    return mesh


balloon(float(sys.argv[1])).export("balloon.obj", digits=5)
