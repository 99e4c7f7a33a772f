"""Cloth as LAMMPS holds it: atoms, bonds, angles and dihedrals with types and masses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, eye_array

from sphcloth.errors import UserError
from sphcloth.meshing.surface import Surface, lengths

# pair styles have a table of all pairs of types
LARGEST_TYPE = 1000


@dataclass(frozen=True)
class Material:
    """What one mesh file becomes.

    Attributes:
        areal_mass: mass per area.
        vertex_type: atom type of the vertices.
        bond_type: bond type of the edges.
        angle_type: angle type of the triangles.
        dihedral_type: dihedral type of the hinges, 0 for no hinges.
    """

    areal_mass: float
    vertex_type: int = 1
    bond_type: int = 1
    angle_type: int = 1
    dihedral_type: int = 1

    def __post_init__(self) -> None:
        """Raise UserError for a mass that is not positive or a type below its least number."""
        if not 0 < self.areal_mass < np.inf:
            raise UserError(f"--areal-mass {self.areal_mass:g}: the mass per area must be positive")
        for name, minimum in (("vertex", 1), ("bond", 1), ("angle", 1), ("dihedral", 0)):
            check_type(f"--{name}-type", getattr(self, f"{name}_type"), minimum)


def check_type(option: str, number: int, minimum: int = 1) -> None:
    """Raise UserError for a number that is no type of LAMMPS, which keeps tables of all."""
    if number < minimum:
        raise UserError(f"{option} {number}: types count from {minimum}")
    if number > LARGEST_TYPE:
        raise UserError(f"{option} {number}: give a number up to {LARGEST_TYPE}")


@dataclass(frozen=True)
class Cloth:
    """Atoms and topology; indices count from 0, IDs in files from 1.

    Attributes:
        surface: positions and triangles, all wound in the same sense within a piece.
        molecules: molecule ID of each vertex, from 1 in the order of the files, shape (V,).
        types: atom type of each vertex, shape (V,).
        masses: a third of the mass of the triangles around each vertex, shape (V,).
        bonds: type and two vertices, shape (B, 3); seam bonds are last.
        angles: type and three corners, shape (T, 4).
        dihedrals: type, wing, edge, edge, wing, shape (H, 5).
        pinned: whether each vertex is held, shape (V,).
        names: name of each molecule, used for groups.
    """

    surface: Surface
    molecules: NDArray[np.int64]
    types: NDArray[np.int64]
    masses: NDArray[np.float64]
    bonds: NDArray[np.int64]
    angles: NDArray[np.int64]
    dihedrals: NDArray[np.int64]
    pinned: NDArray[np.bool_]
    names: list[str] = field(default_factory=lambda: ["cloth"])

    @property
    def seams(self) -> NDArray[np.int64]:
        """Type and two vertices of each seam bond, shape (S, 3)."""
        return self.bonds[len(self.surface.edges) :]

    @property
    def type_counts(self) -> dict[str, int]:
        """Largest type number of atoms, bonds, angles and dihedrals."""
        columns = {
            "atom": self.types,
            "bond": self.bonds[:, 0],
            "angle": self.angles[:, 0],
            "dihedral": self.dihedrals[:, 0],
        }
        return {kind: int(types.max(initial=0)) for kind, types in columns.items()}

    @property
    def mass_of_type(self) -> dict[int, float]:
        """Mean mass of the vertices of each atom type: what ``mass`` needs to keep the total."""
        return {int(t): float(self.masses[self.types == t].mean()) for t in np.unique(self.types)}

    def room_per_atom(self) -> dict[str, int]:
        """Return the largest numbers that one atom stores with ``newton on``.

        Bonds are stored with their first atom, angles and dihedrals with their second. Special
        neighbors are those up to three bonds away.
        """
        n = len(self.types)
        owners = {"bond": self.bonds[:, 1], "angle": self.angles[:, 2]}
        owners["dihedral"] = self.dihedrals[:, 2]
        room = {kind: int(np.bincount(o, minlength=n).max()) for kind, o in owners.items()}
        return room | {"special": self._largest_special(n)}

    def _largest_special(self, n: int) -> int:
        """Return the largest number of atoms within three bonds of one atom."""
        a, b = self.bonds[:, 1:].T
        one = coo_array((np.ones(len(a), bool), (a, b)), shape=(n, n)).tocsr()
        near = one + one.T + eye_array(n, dtype=bool, format="csr")
        return int(np.diff((near @ near @ near).indptr).max()) - 1


def build_cloth(
    surface: Surface,
    materials: Sequence[Material],
    *,
    seams: NDArray[np.int64] | None = None,
    seam_type: int = 0,
    pinned: NDArray[np.bool_] | None = None,
    pin_type: int | None = None,
    names: Sequence[str] = ("cloth",),
) -> Cloth:
    """Give a surface masses and types.

    Args:
        surface: oriented, at most two triangles at each edge.
        materials: one for each part of the surface.
        seams: pairs of vertices that get a bond more, shape (S, 2).
        seam_type: bond type of the seams.
        pinned: which vertices are held, shape (V,).
        pin_type: atom type of these, if of their own.
        names: name of each part.

    Raises:
        UserError: a vertex of no mass, or of one that is no number.
    """
    triangle_values = {
        name: np.array([getattr(material, name) for material in materials])[surface.part]
        for name in ("areal_mass", "angle_type")
    }
    vertex_part = _smallest(surface.part.repeat(3), surface.triangles.reshape(-1), surface.vertices)
    edge_part = _smallest(surface.part.repeat(3), surface.edge_of_half_edge, surface.edges)
    hinge_part = edge_part[surface.edge_of_half_edge[surface.hinge_half_edges[:, 0]]]
    bond_types = np.array([material.bond_type for material in materials])[edge_part]
    hinge_types = np.array([material.dihedral_type for material in materials])[hinge_part]
    types = np.array([material.vertex_type for material in materials])[vertex_part]
    pinned = np.zeros(len(types), bool) if pinned is None else pinned
    if pin_type is not None:
        types = np.where(pinned, pin_type, types)
    seams = np.empty((0, 2), np.int64) if seams is None else seams
    with np.errstate(over="ignore"):  # found below
        masses = surface.lumped(surface.areas * triangle_values["areal_mass"])
    if not np.all(masses > 0):
        raise UserError("a vertex has no mass: the areas are too small for the number format")
    if not np.isfinite(masses).all():
        raise UserError(
            "a vertex has a mass that is not finite: area or mass per area are too large"
        )
    return Cloth(
        surface=surface,
        molecules=vertex_part + 1,
        types=types,
        masses=masses,
        bonds=np.concatenate(
            [
                np.column_stack([bond_types, surface.edges]),
                np.column_stack([np.full(len(seams), seam_type), seams]),
            ]
        ),
        angles=np.column_stack([triangle_values["angle_type"], surface.triangles]),
        dihedrals=np.column_stack([hinge_types, surface.hinges])[hinge_types > 0],
        pinned=pinned,
        names=list(names),
    )


def longest_bond(cloth: Cloth) -> float:
    """Return the length of the longest bond, edge or seam."""
    return float(lengths(cloth.surface.vertices, cloth.bonds[:, 1:]).max())


def _smallest(values: NDArray[np.int64], owner: NDArray[np.int64], owners: NDArray) -> NDArray:
    """Return the smallest of the values of each owner, shape (len(owners),)."""
    minimum = np.full(len(owners), np.iinfo(np.int64).max)
    np.minimum.at(minimum, owner, values)
    return minimum
