"""``sphcloth advise``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, Ranks
from sphcloth.errors import UserError

EXAMPLES = """
Examples:

sphcloth advise in.drop

sphcloth advise in.pour --set hold=corners --ranks 2 --probe-steps 3000 --speed 4
"""


def advise(
    script: Annotated[Path, typer.Argument(metavar="IN", help="Input script; it is not changed.")],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Set a variable of the script; NAME= empties it."
        ),
    ] = None,
    old_settings: Annotated[
        list[str] | None, typer.Option("--var", help="The same as --set.", hidden=True)
    ] = None,
    ranks: Ranks = 1,
    steps: Annotated[
        int, typer.Option("--probe-steps", min=1, help="Stop after so many steps.")
    ] = 1000,
    seconds: Annotated[
        float, typer.Option("--probe-time", min=1.0, help="Stop after so many seconds.")
    ] = 60.0,
    speed: Annotated[
        float | None, typer.Option(help="Largest speed that you expect, beside the one measured.")
    ] = None,
    stretch: Annotated[
        float, typer.Option(min=1e-9, help="Largest strain of an edge that you accept.")
    ] = 0.01,
    json_file: JsonFile = None,
) -> None:
    """Run a script for a short time and say what the scene needs, and what it does not."""
    from sphcloth.advice.command import advise as find_advice
    from sphcloth.advice.probe import Probe
    from sphcloth.examples import parse_settings

    _check("--probe-time", seconds)
    _check("--speed", speed)
    _check("--stretch", stretch)
    variables = parse_settings([*(settings or []), *(old_settings or [])])
    probe = Probe(script, variables, ranks, steps, seconds)
    found = find_advice(probe, Console(), speed=speed, stretch=stretch)
    found.show(Console())
    if json_file is not None:
        found.write(json_file)


def _check(option: str, value: float | None) -> None:
    """Raise UserError for a number that is not finite and above 0."""
    if value is not None and not 0 < value < math.inf:
        raise UserError(f"{option} {value:g}: give a finite number above 0")
