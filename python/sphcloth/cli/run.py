"""``sphcloth run``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, Ranks

EXAMPLES = """
Examples:

sphcloth run pour --size small --ranks 2

sphcloth run pour --set hold=corners --set scheme=block --out corners

sphcloth run pour --set keep=500 --out pour; sphcloth run pour --set keep=500 --out pour --resume
"""


def run(
    example: Annotated[str, typer.Argument(metavar="EXAMPLE", help="Name of a packaged example.")],
    size: Annotated[
        str, typer.Option(help="One of the sizes in the example's sizes.toml.")
    ] = "small",
    ranks: Ranks = 1,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-EXAMPLE-SIZE")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Set a variable of the script; NAME= empties it."
        ),
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw pictures afterwards.")] = True,
    frames: Annotated[int, typer.Option(min=1, help="Number of pictures.")] = 12,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Go on from the newest restart file in --out; give the other options again.",
        ),
    ] = False,
    json_file: JsonFile = None,
) -> None:
    """Run an example, draw it and print a summary of what went right or wrong."""
    from sphcloth.examples import parse_settings
    from sphcloth.run import run_example

    code = run_example(
        example,
        size,
        ranks,
        out or Path(f"sphcloth-{example}-{size}"),
        parse_settings(settings or []),
        frames if pictures else None,
        Console(),
        json_file,
        resume,
    )
    raise typer.Exit(code)
