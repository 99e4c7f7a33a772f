"""Writes cloth as LAMMPS reads it: a data file, a molecule template, a script of groups."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.mesh import MASS_SECTION
from sphcloth.meshing.cloth import Cloth

ATOM_STYLES = ("hybrid sph molecular", "molecular")

# LAMMPS has 32 groups; some are for the scene
MAX_GROUPS = 20


def write_data(
    cloth: Cloth,
    path: str | Path,
    box: NDArray[np.float64],
    atom_style: str = ATOM_STYLES[0],
    mass_per_atom: bool = False,
) -> None:
    """Write a data file for ``read_data``.

    The section Masses is left out where the file names a type that it does not use: the script
    knows the mass of that one.

    Args:
        cloth: what to write.
        path: the file.
        box: lower and upper corner, shape (2, 3); no vertex may be outside.
        atom_style: ``hybrid sph molecular`` or ``molecular``.
        mass_per_atom: also write the section ``VertexMass``, for ``property/atom rmass``.

    Raises:
        UserError: a vertex outside of the box, or a box without volume.
    """
    _check_box(cloth, box)
    ids = np.arange(1, len(cloth.types) + 1)
    with Path(path).open("w", encoding="utf-8") as file:
        _write_header(file, cloth, box)
        if has_masses(cloth):
            _write_section(file, "Masses", "%d %.17g", list(cloth.mass_of_type.items()))
        _write_atoms(file, cloth, atom_style)
        for name, rows in _topology(cloth):
            _write_section(file, name, "%d", np.column_stack([np.arange(1, len(rows) + 1), rows]))
        if mass_per_atom:
            _write_section(file, MASS_SECTION, "%d %.17g", np.column_stack([ids, cloth.masses]))


def write_molecule(cloth: Cloth, path: str | Path, mass_per_atom: bool = False) -> None:
    """Write a molecule template for ``molecule`` and ``create_atoms ... mol``.

    Args:
        cloth: what to write.
        path: the file.
        mass_per_atom: also write the mass of each vertex, for ``property/atom rmass``.
    """
    ids = np.arange(1, len(cloth.types) + 1)
    topology = _topology(cloth)
    with Path(path).open("w", encoding="utf-8") as file:
        file.write(f"# cloth by sphcloth mesh: {', '.join(cloth.names)}\n\n{len(ids)} atoms\n")
        file.writelines(f"{len(rows)} {name.lower()}\n" for name, rows in topology)
        rows = np.column_stack([ids, cloth.surface.vertices])
        _write_section(file, "Coords", "%d %.17g %.17g %.17g", rows)
        _write_section(file, "Types", "%d", np.column_stack([ids, cloth.types]))
        if len(cloth.names) > 1:
            _write_section(file, "Molecules", "%d", np.column_stack([ids, cloth.molecules]))
        if mass_per_atom:
            _write_section(file, "Masses", "%d %.17g", np.column_stack([ids, cloth.masses]))
        for name, rows in topology:
            _write_section(file, name, "%d", np.column_stack([np.arange(1, len(rows) + 1), rows]))


def write_groups(cloth: Cloth, path: str | Path, mass_per_atom: bool = False) -> None:
    """Write a script for ``include`` behind ``read_data``: groups, and masses of types.

    The group ``cloth`` holds all vertices, ``pins`` those that are held, and with several files
    each has a group of its own, if they are no more than LAMMPS has groups. Groups go by molecule
    and atom ID.
    """
    lines = ["# by sphcloth mesh, for 'include' behind read_data"]
    several = len(cloth.names) > 1
    lines.append(f"group cloth molecule {f'1:{len(cloth.names)}' if several else 1}")
    if several and len(cloth.names) <= MAX_GROUPS:
        lines += [f"group {name} molecule {n}" for n, name in enumerate(cloth.names, 1)]
    lines += [f"group pins id {part}" for part in _id_ranges(np.flatnonzero(cloth.pinned) + 1)]
    if not has_masses(cloth) and not mass_per_atom:
        lines += [f"mass {t} {mass:.17g}" for t, mass in cloth.mass_of_type.items()]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def has_masses(cloth: Cloth) -> bool:
    """Tell whether the cloth has vertices of all types up to its largest."""
    return len(cloth.mass_of_type) == cloth.type_counts["atom"]


def _check_box(cloth: Cloth, box: NDArray[np.float64]) -> None:
    low, high = box
    if not np.all(low < high):
        raise UserError(
            f"the box from {low} to {high} has no volume: give a --margin above 0, or a --box"
        )
    outside = np.any((cloth.surface.vertices < low) | (cloth.surface.vertices >= high), axis=1)
    if outside.any():
        raise UserError(
            f"{np.count_nonzero(outside)} vertices are not inside of the box, one at "
            f"{cloth.surface.vertices[np.argmax(outside)]}: give a larger --box"
        )


def _write_header(file: TextIO, cloth: Cloth, box: NDArray[np.float64]) -> None:
    file.write(f"cloth by sphcloth mesh: {', '.join(cloth.names)}\n\n{len(cloth.types)} atoms\n")
    file.writelines(f"{len(rows)} {name.lower()}\n" for name, rows in _topology(cloth))
    for kind, count in cloth.type_counts.items():
        if count:
            file.write(f"{count} {kind} types\n")
    for axis, (low, high) in zip("xyz", box.T, strict=True):
        file.write(f"{low:.17g} {high:.17g} {axis}lo {axis}hi\n")


def _write_atoms(file: TextIO, cloth: Cloth, atom_style: str) -> None:
    """Write the section Atoms; SPH's density, energy and heat capacity are 0, 0 and 1."""
    n = len(cloth.types)
    place = ["%.17g"] * 3
    columns = [np.arange(1, n + 1), cloth.types, *cloth.surface.vertices.T]
    if atom_style == "molecular":
        columns.insert(1, cloth.molecules)
        form = ["%d", "%d", "%d", *place]
    else:
        columns += [np.zeros(n), np.zeros(n), np.ones(n), cloth.molecules]
        form = ["%d", "%d", *place, "%g", "%g", "%g", "%d"]
    rows = np.column_stack([*columns, np.zeros((n, 3))])
    title = f"Atoms # {atom_style.split()[0]}"
    _write_section(file, title, " ".join([*form, "%d", "%d", "%d"]), rows)


def _write_section(file: TextIO, name: str, form: str, rows: Iterable) -> None:
    file.write(f"\n{name}\n\n")
    np.savetxt(file, np.asarray(rows), fmt=form)


def _topology(cloth: Cloth) -> list[tuple[str, NDArray[np.int64]]]:
    """Return the sections that are not empty: type, then atom IDs from 1."""
    sections = {"Bonds": cloth.bonds, "Angles": cloth.angles, "Dihedrals": cloth.dihedrals}
    one = np.array([0, 1, 1, 1, 1])
    return [(name, rows + one[: rows.shape[1]]) for name, rows in sections.items() if len(rows)]


def _id_ranges(ids: NDArray[np.int64], per_line: int = 12) -> list[str]:
    """Return ascending IDs as LAMMPS ranges, a few on each line."""
    runs = np.split(ids, np.flatnonzero(np.diff(ids) > 1) + 1) if len(ids) else []
    words = [str(run[0]) if len(run) == 1 else f"{run[0]}:{run[-1]}" for run in runs]
    return [" ".join(words[n : n + per_line]) for n in range(0, len(words), per_line)]
