"""``sphcloth stress``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile
from sphcloth.errors import UserError

EXAMPLES = """
Examples:

sphcloth stress --quick

sphcloth stress impact-3-normal --scheme global,block --ranks 1,2

sphcloth stress random --seed 1 --count 300 --scheme global,block

sphcloth stress --json stress.json
"""


def stress(
    case: Annotated[
        str | None,
        typer.Argument(
            metavar="CASE",
            help="Name of a case; all without one; --list shows them. random: scenes from a seed.",
        ),
    ] = None,
    scheme: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,...",
            help="Schemes: constant, global, individual, block.",
            show_default="all that are meaningful; random: the one that a seed draws",
        ),
    ] = None,
    ranks: Annotated[
        str | None,
        typer.Option(
            metavar="N,M,...", help="Numbers of MPI ranks.", show_default="1,2,4; quick 1,2"
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Run the smaller variants.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="Keep what the runs wrote in this folder.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="With random: seed of the first scene.", show_default="1")
    ] = None,
    count: Annotated[
        int | None, typer.Option(help="With random: how many scenes.", show_default="20")
    ] = None,
    json_file: JsonFile = None,
    show_list: Annotated[
        bool, typer.Option("--list", help="Show all cases and what must happen.")
    ] = False,
) -> None:
    """Run the extremes, or random scenes; exit code 1 if one does not do what it must."""
    from sphcloth.programs import endings_interrupt
    from sphcloth.stress import command

    console = Console()
    if show_list:
        command.show_cases(console)
        return
    if case == "random":
        if ranks is not None or quick:
            idle = "--quick" if quick else f"--ranks {ranks}"
            raise UserError(f"{idle}: a random scene draws its size and ranks: leave it out")
        first, scenes = 1 if seed is None else seed, 20 if count is None else count
        with endings_interrupt():
            found = command.stress_random(first, scenes, scheme, out, json_file, console)
        raise typer.Exit(0 if all(verdict.passed for verdict in found) else 1)
    for option, value in (("--seed", seed), ("--count", count)):
        if value is not None:
            raise UserError(
                f"{option} {value}: only random scenes have it: sphcloth stress random, or leave "
                "it out"
            )
    with endings_interrupt():
        found = command.stress(case, scheme, ranks, quick, out, json_file, console)
    raise typer.Exit(0 if all(verdict.passed for verdict in found) else 1)
