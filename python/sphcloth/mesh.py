"""The cloth's triangles, from the data file that ``write_data`` makes of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from MDAnalysis.topology.LAMMPSParser import DATAParser
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.trajectory import Frame

# a row of the Atoms section under 'atom_style hybrid sph molecular'; resid is the molecule
ATOM_STYLE = "id type x y z rho esph cv resid ix iy iz"


@dataclass(frozen=True)
class ClothMesh:
    """Triangles over the vertices of the cloth.

    Attributes:
        ids: atom ids of the vertices in ascending order, shape (V,).
        triangles: indices into ``ids``, shape (T, 3), all wound in the same sense.
    """

    ids: NDArray[np.int64]
    triangles: NDArray[np.int64]

    def __post_init__(self) -> None:
        """Raise UserError if two neighbouring triangles are wound in opposite senses."""
        corners = self.triangles
        edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        if len(np.unique(edges, axis=0)) < len(edges):
            raise UserError("neighbouring cloth triangles are wound in opposite senses")

    @classmethod
    def read(cls, data: str | Path) -> ClothMesh:
        """Read the mesh from a data file: each LAMMPS angle is a triangle.

        Raises:
            UserError: no such file, a file of another form, or no triangle in it.
        """
        data = Path(data)
        if not data.is_file():
            raise UserError(f"no data file {data}")
        try:
            with DATAParser(data) as parser:
                topology = parser.parse(atom_style=ATOM_STYLE)
        except (ValueError, KeyError, IndexError) as error:
            raise UserError(
                f"{data} cannot be read: write it with 'write_data FILE nofix' under "
                "'atom_style hybrid sph molecular'"
            ) from error
        atoms = np.array(topology.angles.values, dtype=np.int64)
        if not len(atoms):
            raise UserError(f"{data} holds no cloth: its triangles are LAMMPS angles, it has none")
        used, triangles = np.unique(atoms, return_inverse=True)
        ids = np.asarray(topology.ids.values, dtype=np.int64)[used]
        order = np.argsort(ids)
        return cls(ids[order], np.argsort(order)[triangles.reshape(-1, 3)])

    def positions(self, frame: Frame) -> NDArray[np.float64]:
        """Return the vertices' positions in a frame, shape (V, 3).

        The sheet must not reach through a periodic boundary: positions are those of the dump.

        Raises:
            UserError: the frame lacks a vertex.
        """
        rows = np.searchsorted(frame.ids, self.ids)
        rows = np.minimum(rows, len(frame) - 1)
        lost = self.ids[frame.ids[rows] != self.ids]
        if len(lost):
            raise UserError(f"cloth vertex {lost[0]} is not in the dump at step {frame.step}")
        return frame.positions[rows]

    def corners(self, frame: Frame) -> NDArray[np.float64]:
        """Return the corners of each triangle in a frame, shape (T, 3 corners, 3)."""
        return self.positions(frame)[self.triangles]
