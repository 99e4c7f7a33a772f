"""``sphcloth mesh``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, given, grouped
from sphcloth.errors import UserError

EXAMPLES = """
Examples:

sphcloth mesh flag.obj --areal-mass 0.2 --pin 'x<0.01' --data flag.data

sphcloth mesh front.obj back.obj --areal-mass 0.2 --scale 0.01 --sew 0.004 --data shirt.data

sphcloth mesh --from-dump run.lammpstrj --data shirt.data --out meshes --format vtk
"""


@dataclass(frozen=True)
class Written:
    """Files to write."""

    data: Annotated[
        Path | None,
        typer.Option("--data", help="Data file to write; to read, with --from-dump."),
    ] = None
    molecule: Annotated[
        Path | None, typer.Option(help="Molecule template to write, for create_atoms ... mol.")
    ] = None
    groups: Annotated[
        Path | None,
        typer.Option(help="Script of groups to write.", show_default="DATA with .groups"),
    ] = None
    json_file: JsonFile = None


@dataclass(frozen=True)
class Numbering:
    """Masses and types of what the files become."""

    areal_mass: Annotated[
        list[float] | None,
        typer.Option(help="Mass per area; once, or once for each file, as the types below."),
    ] = None
    per_atom_mass: Annotated[
        bool, typer.Option("--per-atom-mass", help="Write each vertex's own mass.")
    ] = False
    vertex_type: Annotated[
        list[int] | None, typer.Option(help="Atom type of vertices.", show_default="1")
    ] = None
    bond_type: Annotated[
        list[int] | None, typer.Option(help="Bond type of edges.", show_default="1")
    ] = None
    angle_type: Annotated[
        list[int] | None, typer.Option(help="Angle type of triangles.", show_default="1")
    ] = None
    dihedral_type: Annotated[
        list[int] | None,
        typer.Option(help="Dihedral type of hinges, 0 for none.", show_default="1"),
    ] = None
    atom_style: Annotated[str, typer.Option(help="hybrid sph molecular, or molecular.")] = (
        "hybrid sph molecular"
    )

    @property
    def types(self) -> dict[str, list[int]]:
        """The types by name, each once for all files or once for each."""
        return {
            "vertex_type": self.vertex_type or [1],
            "bond_type": self.bond_type or [1],
            "angle_type": self.angle_type or [1],
            "dihedral_type": self.dihedral_type or [1],
        }


@dataclass(frozen=True)
class Place:
    """Where the cloth goes, and the box around it."""

    scale: Annotated[float, typer.Option(help="Factor on all coordinates.")] = 1.0
    rotate: Annotated[
        tuple[float, float, float],
        typer.Option(metavar="X Y Z", help="Then degrees about x, then y, then z."),
    ] = (0.0, 0.0, 0.0)
    translate: Annotated[
        tuple[float, float, float], typer.Option(metavar="X Y Z", help="Then a displacement.")
    ] = (0.0, 0.0, 0.0)
    margin: Annotated[
        float | None,
        typer.Option(help="Distance from cloth to box.", show_default="longest edge"),
    ] = None
    box: Annotated[
        tuple[float, float, float, float, float, float] | None,
        typer.Option(metavar="XLO XHI YLO YHI ZLO ZHI", help="The box, instead of a margin."),
    ] = None


@dataclass(frozen=True)
class Joining:
    """Which vertices become one, or are sewn together."""

    merge: Annotated[
        float | None,
        typer.Option(
            help="Vertices of a file closer than this are one.", show_default="1e-7 of its extent"
        ),
    ] = None
    sew: Annotated[
        float | None,
        typer.Option(metavar="DISTANCE", help="Join borders of different pieces so close."),
    ] = None
    seam_type: Annotated[
        int | None, typer.Option(help="Sew with bonds of this type instead of welding.")
    ] = None


@dataclass(frozen=True)
class Rest:
    """Which vertices are held, and what shape has no stress."""

    pins: Annotated[
        list[str] | None,
        typer.Option(
            "--pin",
            metavar="SELECTION",
            help="Held vertices: 'z>0.9 and x<0', 'box XLO XHI YLO YHI ZLO ZHI', 'border' or "
            "'ids 1,5-9'; several add up.",
        ),
    ] = None
    pin_type: Annotated[int | None, typer.Option(help="Atom type of held vertices.")] = None
    rest: Annotated[
        str, typer.Option(help="Hinges rest as the model is, or flat: model or flat.")
    ] = "model"


@dataclass(frozen=True)
class Sequence:
    """The other way: meshes from a dump."""

    from_dump: Annotated[
        Path | None, typer.Option(metavar="DUMP", help="The other way: meshes from a dump.")
    ] = None
    out: Annotated[Path | None, typer.Option(help="Folder for the meshes.")] = None
    form: Annotated[str, typer.Option("--format", help="obj, ply or vtk.")] = "vtk"
    log: Annotated[Path | None, typer.Option(help="Log of the run, for times in ParaView.")] = None
    first: Annotated[int, typer.Option(help="First frame, from 0.")] = 0
    last: Annotated[
        int | None, typer.Option(help="Last frame.", show_default="the dump's last")
    ] = None
    every: Annotated[int, typer.Option(help="Write every so many frames.")] = 1


@grouped
def mesh(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FILE ...", help="Meshes: OBJ, STL, PLY and what trimesh reads."),
    ] = None,
    *,
    written: Written,
    numbering: Numbering,
    place: Place,
    joining: Joining,
    rest: Rest,
    sequence: Sequence,
) -> None:
    """Turn triangle meshes into cloth for LAMMPS, or the cloth of a dump into meshes."""
    from sphcloth.meshing import command

    console = Console()
    if sequence.from_dump is not None:
        if files:
            raise UserError("--from-dump takes no mesh files")
        of_files = [
            *given(written),
            *given(numbering),
            *given(place),
            *given(joining),
            *given(rest),
        ]
        if idle := [option for option in of_files if option != "--data"]:
            raise UserError(f"--from-dump has no use for {idle[0]}: leave it out")
        chosen = (sequence.first, sequence.last, sequence.every)
        command.make_sequence(
            sequence.from_dump,
            written.data,
            sequence.out,
            sequence.form,
            sequence.log,
            chosen,
            console,
        )
        return
    if not files:
        raise UserError("which mesh? sphcloth mesh FILE, or --from-dump DUMP")
    if idle := given(sequence):
        raise UserError(f"{idle[0]} is for --from-dump DUMP alone: leave it out")
    recipe = command.Recipe(
        materials=command.make_materials(numbering.areal_mass, numbering.types, len(files)),
        placement=command.Placement(place.scale, place.rotate, place.translate),
        merge=joining.merge,
        sew=joining.sew,
        seam_type=joining.seam_type,
        pins=rest.pins or [],
        pin_type=rest.pin_type,
    )
    output = command.Output(
        written.data,
        written.molecule,
        written.groups,
        written.json_file,
        numbering.atom_style,
        place.margin,
        place.box,
        numbering.per_atom_mass,
        rest.rest,
    )
    command.make_cloth(files, recipe, output, console)
