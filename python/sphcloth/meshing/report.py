"""What a mesh became, and the lines of an input script that go with it."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth.mesh import MASS_SECTION
from sphcloth.meshing.cloth import Cloth, longest_bond
from sphcloth.meshing.lammps_files import has_masses
from sphcloth.results import show_rows

# 4 sqrt(3) area / sum of squared sides: below this a triangle is called thin
THIN = 0.1
# standard deviation of masses over their mean: above this one mass for all is said to be coarse
WIDE = 0.5


@dataclass(frozen=True)
class MeshSummary:
    """Counts and measures of a cloth, in the units of the scene.

    Attributes:
        vertices: number of vertices.
        edges: number of bonds, without seams.
        seams: number of seam bonds.
        triangles: number of triangles.
        hinges: number of hinges.
        pieces: number of connected pieces; seam bonds do not connect.
        boundary_loops: number of connected boundaries: holes and outer borders.
        pinned: number of pinned vertices.
        area: sum of the triangles' areas.
        mass: total mass.
        shortest_edge: length of the shortest edge.
        longest_edge: length of the longest edge.
        worst_quality: 4 sqrt(3) area / sum of squared sides of the worst triangle; 1 is best.
        thin_triangles: number of triangles with a quality below 0.1.
        room_per_atom: bonds, angles, dihedrals and special neighbors that one atom stores at
            most, with ``newton on``.
        types: largest type number of each kind.
    """

    vertices: int
    edges: int
    seams: int
    triangles: int
    hinges: int
    pieces: int
    boundary_loops: int
    pinned: int
    area: float
    mass: float
    shortest_edge: float
    longest_edge: float
    worst_quality: float
    thin_triangles: int
    room_per_atom: dict[str, int]
    types: dict[str, int]

    @classmethod
    def of(cls, cloth: Cloth) -> MeshSummary:
        """Measure a cloth."""
        surface = cloth.surface
        return cls(
            vertices=len(surface.vertices),
            edges=len(surface.edges),
            seams=len(cloth.seams),
            triangles=len(surface.triangles),
            hinges=len(cloth.dihedrals),
            pieces=len(np.unique(surface.pieces)),
            boundary_loops=surface.n_boundary_loops,
            pinned=int(np.count_nonzero(cloth.pinned)),
            area=float(surface.areas.sum()),
            mass=float(cloth.masses.sum()),
            shortest_edge=float(surface.edge_lengths.min()),
            longest_edge=float(surface.edge_lengths.max()),
            worst_quality=float(surface.quality.min()),
            thin_triangles=int(np.count_nonzero(surface.quality < THIN)),
            room_per_atom=cloth.room_per_atom(),
            types=cloth.type_counts,
        )

    def as_json(self) -> dict[str, object]:
        """Return all values for a JSON file."""
        return asdict(self)

    def show(self, console: Console) -> None:
        """Print the values as a table."""
        show_rows(self._rows(), console)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [
            ("vertices", f"{self.vertices:,}"),
            ("edges (bonds)", f"{self.edges:,}"),
            ("triangles (angles)", f"{self.triangles:,}"),
            ("hinges (dihedrals)", f"{self.hinges:,}"),
            ("pieces", f"{self.pieces:,}"),
            ("boundary loops", f"{self.boundary_loops:,}"),
            ("area", f"{self.area:.6g}"),
            ("mass", f"{self.mass:.6g}"),
            ("edge lengths", f"{self.shortest_edge:.4g} to {self.longest_edge:.4g}"),
            ("worst triangle, 1 is best", f"{self.worst_quality:.3g}"),
            ("room per atom", ", ".join(f"{n} {kind}" for kind, n in self.room_per_atom.items())),
        ]
        if self.seams:
            rows.insert(2, ("seam bonds", f"{self.seams:,}"))
        if self.pinned:
            rows.append(("pinned vertices", f"{self.pinned:,}"))
        if self.thin_triangles:
            rows.append(("[yellow]thin triangles[/]", f"{self.thin_triangles:,}"))
        return rows


def script_for_data(cloth: Cloth, data: Path, groups: Path, mass_per_atom: bool) -> list[str]:
    """Return the lines of an input script that read a data file and make it move."""
    lines, section = [], ""
    if mass_per_atom:
        lines.append("fix mass all property/atom rmass ghost yes")
        section = f" fix mass NULL {MASS_SECTION}"
    lines += [f"read_data {_word(data)}{section}", f"include {_word(groups)}"]
    return lines + _motion(cloth)


def script_for_molecule(cloth: Cloth, molecule: Path, mass_per_atom: bool) -> list[str]:
    """Return the lines of an input script that place a molecule template where it was modeled.

    ``create_atoms`` puts the mean of the vertices at the given point.
    """
    types = cloth.type_counts
    room = cloth.room_per_atom()
    kinds = [kind for kind in ("bond", "angle", "dihedral") if types[kind]]
    words = [f"{kind}/types {types[kind]}" for kind in kinds]
    words += [f"extra/{kind}/per/atom {room[kind]}" for kind in [*kinds, "special"]]
    lines = ["fix mass all property/atom rmass ghost yes"] if mass_per_atom else []
    lines.append(f"create_box {types['atom']} BOX {' '.join(words)}")
    lines.append(f"molecule cloth {_word(molecule)}")
    center = " ".join(f"{x:.10g}" for x in cloth.surface.vertices.mean(axis=0))
    lines.append(f"create_atoms 0 single {center} mol cloth 1 rotate 0 0 0 1 units box")
    if not mass_per_atom:
        lines += [f"mass {t} {mass:.10g}" for t, mass in cloth.mass_of_type.items()]
    for name, chosen in (("cloth", cloth.types), ("pins", cloth.types[cloth.pinned])):
        if len(chosen):
            lines.append(f"group {name} type {' '.join(str(t) for t in np.unique(chosen))}")
    return lines + _motion(cloth)


def mass_notes(cloth: Cloth, for_data: bool) -> list[str]:
    """Return what to know where masses belong to types; ``for_data``: of a data file too."""
    notes = []
    spread = [cloth.masses[cloth.types == t].std() / m for t, m in cloth.mass_of_type.items()]
    if max(spread) > WIDE:
        notes.append(
            f"masses within one type scatter by {max(spread):.0%} around their mean, which all "
            "get; --per-atom-mass keeps each vertex's own"
        )
    if for_data and not has_masses(cloth):
        notes.append("no section Masses: some types are not the cloth's; the groups set its masses")
    return notes


def _word(path: Path) -> str:
    """Return a path as one word of an input script."""
    return f'"{path}"' if re.search(r"[^\w./-]", str(path)) else str(path)


def _motion(cloth: Cloth) -> list[str]:
    """Return the styles and the fix that every cloth needs."""
    lines = [
        "special_bonds lj/coul 1 1 1",
        f"comm_modify cutoff {2.2 * longest_bond(cloth):.3g}",
        "bond_style pbd",
        "bond_coeff * 1.0",
    ]
    if len(cloth.seams):
        lines.append(f"bond_coeff {cloth.seams[0, 0]} 1.0 rest zero")
    lines += ["angle_style zero", "angle_coeff *"]
    if len(cloth.dihedrals):
        lines += ["dihedral_style pbd", "dihedral_coeff * 0.02"]
    fix = "fix sheet cloth pbd/cloth"
    fix += " pin pins" if cloth.pinned.any() else ""
    return [*lines, fix]
