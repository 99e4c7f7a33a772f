"""``sphcloth render``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, grouped

EXAMPLES = """
Examples:

sphcloth render pour.lammpstrj --frames 12 --out pictures

sphcloth render pour.lammpstrj --time 0.5:2 --format mp4 --size 1920x1080

sphcloth render pour.lammpstrj --frames 1 --turntable --format gif --size 640x480

sphcloth render run.dump --data run.data --fluid 1,3 --color-by speed --camera 4,-6,3
"""


@dataclass(frozen=True)
class Frames:
    """Which frames to draw."""

    frames: Annotated[
        int | None, typer.Option(min=1, help="Draw so many frames.", show_default="all")
    ] = None
    every: Annotated[int | None, typer.Option(min=1, help="Draw every so many frames.")] = None
    time: Annotated[
        str | None, typer.Option(metavar="FROM:TO", help="Draw the frames between two times.")
    ] = None


@dataclass(frozen=True)
class View:
    """How the scene is seen."""

    spheres: Annotated[bool, typer.Option("--spheres", help="Draw water as balls.")] = False
    camera: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Where the camera stands.")
    ] = None
    target: Annotated[str | None, typer.Option(metavar="X,Y,Z", help="What it looks at.")] = None
    turntable: Annotated[bool, typer.Option("--turntable", help="Walk around the scene once.")] = (
        False
    )
    size: Annotated[str, typer.Option(metavar="WxH", help="Pixels of a picture.")] = "1280x960"


@dataclass(frozen=True)
class Particles:
    """Which atoms are what, and their color."""

    spacing: Annotated[
        float | None,
        typer.Option(help="Of the particles.", show_default="from the data file, or found out"),
    ] = None
    color_by: Annotated[
        str, typer.Option(help="speed, pressure, density or none: water's own color.")
    ] = "none"
    old_color_by: Annotated[
        str | None, typer.Option("--colour-by", help="The same as --color-by.", hidden=True)
    ] = None
    fluid: Annotated[
        str | None,
        typer.Option(metavar="TYPES", help="Types of water.", show_default="from the data file"),
    ] = None
    cloth: Annotated[
        str | None,
        typer.Option(
            metavar="TYPES",
            help="Types of the vertices of cloth; other triangles are obstacles.",
            show_default="all triangles that ever move",
        ),
    ] = None


@grouped
def render(
    *,
    dump: Annotated[Path, typer.Argument(metavar="DUMP", help="Text dump by 'dump custom'.")],
    data: Annotated[
        Path | None,
        typer.Option(
            help="Data file: triangles of the cloth, and which types are water.",
            show_default="DUMP with .data, if there is one",
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder.", show_default="DUMP-pictures")] = None,
    frames: Frames,
    log: Annotated[
        Path | None,
        typer.Option(help="Log with the times.", show_default="log.lammps beside DUMP"),
    ] = None,
    view: View,
    form: Annotated[str, typer.Option("--format", help="png, gif or mp4.")] = "png",
    particles: Particles,
    jobs: Annotated[
        int,
        typer.Option(min=0, help="Processes that draw, 0 for one on each core."),
    ] = 0,
    json_file: JsonFile = None,
) -> None:
    """Draw a dump: water as a surface, cloth, walls; pictures or a film."""
    from sphcloth.rendering import command

    report = command.render(
        dump,
        out or Path(f"{dump.stem}-pictures"),
        data=data,
        log=log,
        frames=command.Frames(frames.frames, frames.every, frames.time),
        choice=command.make_choice(
            particles.fluid,
            particles.cloth,
            particles.spacing,
            particles.old_color_by or particles.color_by,
        ),
        view=command.View(view.camera, view.target, view.turntable, view.size, view.spheres),
        form=form,
        jobs=jobs,
        console=Console(),
    )
    if json_file is not None:
        command.write_report(report, json_file)
