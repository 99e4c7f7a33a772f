"""Strain, elastic energy and volume of the cloth in a frame, and the forces of its pins."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.arguments import POSITIVE, numbers
from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame
from sphcloth.unwrapping import Unwrapper

Array = NDArray[np.float64]


def edge_strain(mesh: ClothMesh, frame: Frame, rest: Frame) -> Array:
    """Return length / rest length - 1 of each edge of the triangles, shape (E,).

    Args:
        mesh: the sheet; the order is that of :attr:`ClothMesh.edges`.
        frame: the sheet as it is.
        rest: the sheet as it was when ``fix pbd/cloth`` was defined.

    Raises:
        UserError: an edge without length at rest.
    """
    before = mesh.edge_lengths(rest)
    if not np.all(before > 0):
        raise UserError(f"an edge has no length at step {rest.step}: that is no rest shape")
    return mesh.edge_lengths(frame) / before - 1


def elastic_energy(mesh: ClothMesh, frame: Frame, rest: Frame, compliance: ArrayLike) -> float:
    """Return sum (l - d)^2 / (2 A) over the edges of the triangles.

    Args:
        mesh: the sheet.
        frame: the sheet as it is.
        rest: the sheet with its rest lengths d.
        compliance: A of ``bond_coeff``, distance over force; one for all, or shape (E,).

    Raises:
        UserError: a compliance that is not above 0, since rigid edges store nothing, or not one for
            each edge.
    """
    remedy = f"it must be above 0, one for all or one for each of the {len(mesh.edges)} edges"
    compliance = numbers(
        "elastic_energy: compliance",
        compliance,
        remedy,
        low=POSITIVE,
        shapes={(), (len(mesh.edges),)},
    )
    longer = mesh.edge_lengths(frame) - mesh.edge_lengths(rest)
    return float(np.sum(longer**2 / (2 * compliance)))


def enclosed_volume(mesh: ClothMesh, frame: Frame) -> float:
    """Return the volume inside closed meshes, positive if triangles run counter-clockwise outside.

    The sum of the tetrahedra from the mean of the vertices to the triangles, wherever periodic
    faces cut the mesh.

    Raises:
        UserError: the mesh has a border, or closes through a periodic face.
    """
    if mesh.border_edges:
        raise UserError(
            f"enclosed_volume: the mesh has a border of {mesh.border_edges} edges: it encloses "
            "nothing"
        )
    vertices = Unwrapper(mesh)(frame)
    start, end = vertices[mesh.edges].swapaxes(0, 1)
    if not np.allclose(
        np.linalg.norm(end - start, axis=1), mesh.edge_lengths(frame), equal_nan=True
    ):
        raise UserError(
            f"enclosed_volume: the mesh closes through a periodic face at step {frame.step}: it "
            "encloses nothing"
        )
    corners = (vertices - vertices.mean(axis=0))[mesh.triangles]
    return float(np.sum(np.linalg.det(corners)) / 6)


def pin_force(mesh: ClothMesh, frame: Frame, *columns: str) -> Array:
    """Return the sum of the forces that hold the vertices, shape (3,).

    Args:
        mesh: the sheet.
        frame: dumped with the forces of ``compute pbd/atom ... fx fy fz``.
        columns: names of the three columns, such as ``c_hold[1]``, ``c_hold[2]``, ``c_hold[3]``.

    Raises:
        UserError: a column is missing.
    """
    return mesh.vectors(frame, *columns).sum(axis=0)
