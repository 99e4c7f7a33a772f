"""Balloons for the tests of fix cloth/gas: spheres of triangles as data files and as scripts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

from sphcloth.meshing.surface import Surface


def icosphere(level: int = 0, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and outward triangles of an icosahedron, each triangle cut in four."""
    sphere = trimesh.creation.icosphere(level, radius)
    return np.array(sphere.vertices), np.array(sphere.faces)


def edges_of(faces: np.ndarray) -> np.ndarray:
    """Return each edge of the triangles once."""
    return Surface.of(np.zeros((faces.max() + 1, 3)), faces).edges


def volume(x: np.ndarray, faces: np.ndarray) -> float:
    """Return what a closed mesh encloses."""
    return float(np.linalg.det(x[faces]).sum() / 6)


def data(path: Path, x, faces, mass, *, box=None, tilt=None, v=None, bonds=True) -> None:
    """Write a data file; vertices outside of a periodic box from 0 to `box` get their image."""
    x, edges = np.asarray(x, dtype=float), edges_of(faces) if bonds else []
    low, high = (
        (np.zeros(3), np.asarray(box, float))
        if box is not None
        else (x.min(0) - 9.0, x.max(0) + 9.0)
    )
    image = np.zeros_like(x)
    if box is not None:
        h = np.diag(high)
        if tilt:
            h[0, 1], h[0, 2], h[1, 2] = tilt
        image = np.floor(np.linalg.solve(h, x.T).T)
        x = x - image @ h.T
    lines = ["balloon", "", f"{len(x)} atoms", f"{len(edges)} bonds", f"{len(faces)} angles"]
    lines += ["1 atom types", "1 bond types", "1 angle types", "9 extra bond per atom"]
    lines += ["9 extra angle per atom"]
    lines += [f"{low[d]:.17g} {high[d]:.17g} {'xyz'[d]}lo {'xyz'[d]}hi" for d in range(3)]
    lines += [f"{tilt[0]} {tilt[1]} {tilt[2]} xy xz yz"] if tilt else []
    lines += ["", "Masses", "", f"1 {mass:.17g}", "", "Atoms # molecular", ""]
    lines += [
        f"{k + 1} 1 1 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g} {n[0]:.0f} {n[1]:.0f} {n[2]:.0f}"
        for k, (p, n) in enumerate(zip(x, image, strict=True))
    ]
    if v is not None:
        lines += ["", "Velocities", ""]
        lines += [f"{k + 1} {u[0]:.17g} {u[1]:.17g} {u[2]:.17g}" for k, u in enumerate(v)]
    if len(edges):
        lines += ["", "Bonds", ""] + [
            f"{k + 1} 1 {i + 1} {j + 1}" for k, (i, j) in enumerate(edges)
        ]
    lines += ["", "Angles", ""]
    lines += [f"{n + 1} 1 {i + 1} {j + 1} {k + 1}" for n, (i, j, k) in enumerate(faces)]
    path.write_text("\n".join(lines) + "\n")


def commands(x: np.ndarray, faces: np.ndarray, first: int = 1) -> str:
    """Return commands that make a mesh atom by atom."""
    lines = [f"create_atoms 1 single {p[0]:.17g} {p[1]:.17g} {p[2]:.17g} units box" for p in x]
    lines += [
        f"create_bonds single/bond 1 {i + first} {j + first} special no" for i, j in edges_of(faces)
    ]
    lines += [
        f"create_bonds single/angle 1 {i + first} {j + first} {k + first} special no"
        for i, j, k in faces
    ]
    return "\n".join(lines) + "\n"
