"""The two things that ``sphcloth mesh`` does: meshes to cloth, and a dump to meshes."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from scipy.spatial.transform import Rotation

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.meshing import report
from sphcloth.meshing.cloth import Cloth, Material, build_cloth, check_type
from sphcloth.meshing.lammps_files import ATOM_STYLES, write_data, write_groups, write_molecule
from sphcloth.meshing.load import LARGEST, read_surface
from sphcloth.meshing.pins import select_vertices
from sphcloth.meshing.sequence import write_sequence
from sphcloth.meshing.sewing import Seams, weld
from sphcloth.meshing.surface import Surface, check_manifold, join, orient
from sphcloth.results import write_json
from sphcloth.trajectory import Trajectory

REST_KINDS = ("model", "flat")
RESERVED_GROUPS = ("all", "cloth", "pins")
T = TypeVar("T")


@dataclass(frozen=True)
class Placement:
    """Where the vertices of a file go: scaled, then rotated, then moved.

    Attributes:
        scale: factor on all coordinates.
        rotate: degrees about x, then y, then z, about the origin.
        translate: displacement.
    """

    scale: float = 1.0
    rotate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    translate: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Raise UserError for a scale that is not positive, or a value that is no number."""
        if not 0 < self.scale < np.inf:
            raise UserError(f"--scale {self.scale:g}: must be positive")
        if not np.isfinite([*self.rotate, *self.translate]).all():
            raise UserError("--rotate and --translate: three finite numbers each")

    def apply(self, surface: Surface) -> Surface:
        """Return the surface at its new place.

        Raises:
            UserError: coordinates too large for the number format.
        """
        rotation = Rotation.from_euler("xyz", self.rotate, degrees=True)
        vertices = rotation.apply(surface.vertices * self.scale) + self.translate
        if not np.all(np.abs(vertices) < LARGEST):
            raise UserError(f"--scale {self.scale:g}: coordinates become too large")
        return replace(surface, vertices=vertices)


@dataclass(frozen=True)
class Recipe:
    """All that turns files into a cloth.

    Attributes:
        materials: one for all files, or one for each.
        placement: where the vertices go.
        merge: vertices of a file closer than this become one; None takes 1e-7 of its extent.
        sew: borders of different pieces closer than this are joined; None joins none.
        seam_type: bond type of seams; None welds instead.
        pins: selections of held vertices, see :func:`sphcloth.meshing.pins.select_vertices`.
        pin_type: atom type of held vertices; None keeps their type.
    """

    materials: Sequence[Material]
    placement: Placement = field(default_factory=Placement)
    merge: float | None = None
    sew: float | None = None
    seam_type: int | None = None
    pins: Sequence[str] = ()
    pin_type: int | None = None

    def __post_init__(self) -> None:
        """Raise UserError for values that do not go together."""
        if self.merge is not None and not 0 <= self.merge < np.inf:
            raise UserError(f"--merge {self.merge:g}: must be 0 or more")
        if self.seam_type is not None and self.sew is None:
            raise UserError("--seam-type needs --sew DISTANCE")
        if self.pin_type is not None and not self.pins:
            raise UserError("--pin-type needs --pin SELECTION")
        for option, number in (("--seam-type", self.seam_type), ("--pin-type", self.pin_type)):
            if number is not None:
                check_type(option, number)
        if self.seam_type in {material.bond_type for material in self.materials}:
            raise UserError(f"--seam-type {self.seam_type} is the type of the edges: use another")
        if self.pin_type in {material.vertex_type for material in self.materials}:
            raise UserError(f"--pin-type {self.pin_type} is the type of the others: use another")

    def build(self, files: Sequence[Path]) -> tuple[Cloth, list[str]]:
        """Read, repair, place, sew and orient; return the cloth and what was done.

        Raises:
            UserError: anything that cannot be made a cloth, by its name.
        """
        repairs: list[str] = []
        surface = join([self._read(file, repairs) for file in files])
        seams = None
        if self.sew is not None:
            found = Seams.find(surface, self.sew)
            if self.seam_type is None:
                surface, done = weld(surface, found)
                repairs += done
            else:
                seams = found.pairs
                repairs.append(f"{len(seams):,} seam bonds, up to {found.widest:g} long")
            repairs += found.unpaired_note()
        check_manifold(surface)
        surface, turned = orient(surface)
        if turned:
            repairs.append(f"{turned:,} triangles turned over, so that all are wound alike")
        cloth = build_cloth(
            surface,
            per_file(self.materials, len(files), "materials"),
            seams=seams,
            seam_type=self.seam_type or 0,
            pinned=self._pinned(surface),
            pin_type=self.pin_type,
            names=group_names(files),
        )
        return cloth, repairs

    def _read(self, file: Path, repairs: list[str]) -> Surface:
        surface, done = read_surface(file, self.merge)
        repairs += [f"{file}: {repair}" for repair in done]
        return self.placement.apply(surface)

    def _pinned(self, surface: Surface) -> NDArray[np.bool_]:
        chosen = np.zeros(len(surface.vertices), bool)
        for selection in self.pins:
            chosen |= select_vertices(surface, selection)
        return chosen


@dataclass(frozen=True)
class Output:
    """Where the cloth goes.

    Attributes:
        data: data file, or None.
        molecule: molecule template, or None.
        groups: script of groups; None puts it beside the data file as ``.groups``.
        json_file: the summary as JSON, or None.
        atom_style: ``hybrid sph molecular`` or ``molecular``.
        margin: distance from cloth to box; None takes the longest edge.
        box: XLO XHI YLO YHI ZLO ZHI of the box, instead of a margin.
        mass_per_atom: whether each vertex has a mass of its own.
        rest: ``model`` or ``flat``; changes only what is said about the hinges.
    """

    data: Path | None = None
    molecule: Path | None = None
    groups: Path | None = None
    json_file: Path | None = None
    atom_style: str = ATOM_STYLES[0]
    margin: float | None = None
    box: tuple[float, float, float, float, float, float] | None = None
    mass_per_atom: bool = False
    rest: str = REST_KINDS[0]

    def __post_init__(self) -> None:
        """Raise UserError for values that do not exist or do not go together."""
        if self.data is None and self.molecule is None:
            raise UserError("nothing to write: give --data OUT.data or --molecule OUT.mol")
        if self.atom_style not in ATOM_STYLES:
            raise UserError(f"--atom-style '{self.atom_style}': use {' or '.join(ATOM_STYLES)}")
        if self.rest not in REST_KINDS:
            raise UserError(f"--rest {self.rest}: use {' or '.join(REST_KINDS)}")
        if self.margin is not None and not 0 <= self.margin < np.inf:
            raise UserError(f"--margin {self.margin:g}: must be 0 or more")
        if self.margin is not None and self.box is not None:
            raise UserError("--margin and --box exclude each other")
        if self.groups is not None and self.data is None:
            raise UserError("--groups needs --data: groups go by the atom IDs of the data file")

    @property
    def groups_file(self) -> Path | None:
        """Where the groups go: only with a data file, whose atom IDs are known."""
        return self.data and (self.groups or self.data.with_suffix(".groups"))

    @property
    def paths(self) -> list[Path]:
        """All files for LAMMPS and the summary."""
        files = (self.data, self.groups_file, self.molecule, self.json_file)
        return [path for path in files if path is not None]

    def check_paths(self, sources: Sequence[Path]) -> None:
        """Raise UserError if a file would replace a mesh, or another file written."""
        taken = {path.resolve() for path in sources}
        for path in self.paths:
            if path.resolve() in taken:
                raise UserError(f"{path} is a mesh or is written twice: use another name")
            taken.add(path.resolve())

    def write(self, cloth: Cloth, summary: report.MeshSummary, repairs: Sequence[str]) -> None:
        """Write all files; ``repairs`` is for the summary.

        Raises:
            UserError: a file cannot be written, or cannot hold this cloth.
        """
        try:
            for path in self.paths:
                path.parent.mkdir(parents=True, exist_ok=True)
            self._write(cloth, summary, repairs)
        except OSError as error:
            raise UserError(f"{error.filename} cannot be written: {error.strerror}") from None

    def _write(self, cloth: Cloth, summary: report.MeshSummary, repairs: Sequence[str]) -> None:
        if self.data is not None:
            write_data(cloth, self.data, self._box(cloth), self.atom_style, self.mass_per_atom)
            write_groups(cloth, self.groups_file, self.mass_per_atom)
        if self.molecule is not None:
            write_molecule(cloth, self.molecule, self.mass_per_atom)
        if self.json_file is not None:
            values = summary.as_json() | {"repairs": list(repairs)}
            write_json(self.json_file, values)

    def script(self, cloth: Cloth) -> list[str]:
        """Return the lines of an input script that use the file."""
        if self.data is not None:
            return report.script_for_data(cloth, self.data, self.groups_file, self.mass_per_atom)
        return report.script_for_molecule(cloth, self.molecule, self.mass_per_atom)

    def _box(self, cloth: Cloth) -> NDArray[np.float64]:
        if self.box is not None:
            return np.array(self.box).reshape(3, 2).T
        margin = cloth.surface.edge_lengths.max() if self.margin is None else self.margin
        low, high = cloth.surface.vertices.min(axis=0), cloth.surface.vertices.max(axis=0)
        return np.array([low - margin, high + margin])


def make_cloth(files: Sequence[Path], recipe: Recipe, output: Output, console: Console) -> None:
    """Turn meshes into files for LAMMPS, and print what was done and what comes next.

    Raises:
        UserError: input that cannot be made a cloth, or a file that cannot be written.
    """
    if output.molecule is not None and recipe.pins and recipe.pin_type is None and not output.data:
        raise UserError("a molecule template has no groups: give pins a type with --pin-type N")
    output.check_paths(files)
    cloth, repairs = recipe.build(files)
    summary = report.MeshSummary.of(cloth)
    output.write(cloth, summary, repairs)
    notes = [] if output.mass_per_atom else report.mass_notes(cloth, output.data is not None)
    for note in repairs + notes:
        console.print(f"  {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    summary.show(console)
    console.print(f"written: {', '.join(map(str, output.paths))}", markup=False, soft_wrap=True)
    console.print("\nin the input script:")
    for line in output.script(cloth):
        console.print(f"  {line}", markup=False, highlight=False, soft_wrap=True)
    if output.rest == "flat" and len(cloth.dihedrals):
        console.print(f"  # flat at rest: {_flat_hint(cloth)}", markup=False, soft_wrap=True)


def make_sequence(
    dump: Path,
    data: Path | None,
    out: Path | None,
    form: str,
    log: Path | None,
    chosen: tuple[int, int | None, int],
    console: Console,
) -> None:
    """Write the cloth of a dump as numbered meshes.

    Args:
        dump: the dump.
        data: data file with the triangles of the cloth.
        out: folder of the sequence.
        form: ``obj``, ``ply`` or ``vtk``.
        log: log of the run for physical times, or None.
        chosen: first, last (None: the dump's last) and every.
        console: where progress appears.

    Raises:
        UserError: a file or an option that is missing or wrong.
    """
    if data is None or out is None:
        raise UserError("--from-dump needs --data SCENE.data and --out FOLDER")
    mesh = ClothMesh.read(data)
    first, last, every = chosen
    frames = Trajectory(dump, log)

    def show(numbers: range) -> Iterable[int]:
        return track(numbers, "writing", console=console, transient=True)

    paths = write_sequence(frames, mesh, out, form, first=first, last=last, every=every, show=show)
    console.print(
        f"{len(paths):,} meshes of {len(mesh.ids):,} vertices and {len(mesh.triangles):,} "
        f"triangles: {paths[0]} to {paths[-1].name}",
        markup=False,
        soft_wrap=True,
    )


def per_file(values: Sequence[T], n: int, what: str) -> list[T]:
    """Return one value for each of n files: one stands for all.

    Raises:
        UserError: neither one nor n values.
    """
    if len(values) not in (1, n):
        raise UserError(f"{len(values)} {what} for {n} files: give one, or one for each file")
    return list(values) * (n if len(values) == 1 else 1)


def make_materials(
    areal: Sequence[float] | None, types: dict[str, Sequence[int]], n: int
) -> list[Material]:
    """Return the material of each of n files.

    Args:
        areal: masses per area, one or n.
        types: name of a field of Material -> numbers, one or n.
        n: number of files.

    Raises:
        UserError: no mass, or neither one nor n values.
    """
    if not areal:
        raise UserError("give the mass per area with --areal-mass")
    masses = per_file(areal, n, "values of --areal-mass")
    columns = {
        name: per_file(values, n, f"values of --{name.replace('_', '-')}")
        for name, values in types.items()
    }
    return [
        Material(masses[k], **{name: values[k] for name, values in columns.items()})
        for k in range(n)
    ]


def group_names(files: Sequence[Path]) -> list[str]:
    """Return a name for each file that LAMMPS takes for a group; no two are equal."""
    names: list[str] = []
    for number, file in enumerate(files, 1):
        name = stem = re.sub(r"\W", "_", Path(file).stem, flags=re.ASCII) or "mesh"
        numbers = itertools.count(number)
        while name in names or name in RESERVED_GROUPS:
            name = f"{stem}_{next(numbers)}"
        names.append(name)
    return names


def _flat_hint(cloth: Cloth) -> str:
    """Return the coefficients that make hinges flat at rest, as a piece of text."""
    types = np.unique(cloth.dihedrals[:, 0])
    return ", ".join(f"'dihedral_coeff {t} K rest flat'" for t in types)
