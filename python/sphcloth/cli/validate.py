"""``sphcloth validate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, Ranks
from sphcloth.errors import UserError

EXAMPLES = """
Examples:

sphcloth validate --list; sphcloth validate --list hydrostatic

sphcloth validate hydrostatic --quick

sphcloth validate oscillating-drop --set sigma=0.3 --ranks 2 --json drop.json

sphcloth validate all --schemes --quick
"""


def validate(
    case: Annotated[
        str | None, typer.Argument(metavar="CASE", help="Name of a case; --list shows them.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter of the case."),
    ] = None,
    ranks: Ranks = 1,
    quick: Annotated[
        bool, typer.Option("--quick", help="Run the smaller variant with its own limits.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-validate-CASE")
    ] = None,
    json_file: JsonFile = None,
    schemes: Annotated[
        bool,
        typer.Option(
            "--schemes", help="Run by every scheme of the time step and compare; CASE may be all."
        ),
    ] = False,
    show_list: Annotated[
        bool, typer.Option("--list", help="Show all cases, or with CASE its parameters.")
    ] = False,
) -> None:
    """Compare a case with its reference solution; exit code 0 only if all limits are met."""
    from sphcloth.examples import parse_settings
    from sphcloth.validation.compare_schemes import cases_with_schemes, compare_schemes, show
    from sphcloth.validation.validate import find_case, show_case, show_cases
    from sphcloth.validation.validate import validate as run_case

    console = Console()
    if show_list:
        show_cases(console) if case is None else show_case(find_case(case), console)
        return
    if case is None:
        raise UserError("which case? sphcloth validate --list shows them")
    folder = out or Path(f"sphcloth-validate-{case}")
    if schemes:
        given = parse_settings(settings or [])
        if "scheme" in given or json_file is not None:
            raise UserError("--schemes runs every scheme: leave out --set scheme and --json")
        compared = [
            compare_schemes(each, given, ranks, quick, folder / each.name, console)
            for each in cases_with_schemes(case)
        ]
        show(compared, console)
        raise typer.Exit(0 if all(each.passed for each in compared) else 1)
    found = find_case(case)
    result = run_case(found, parse_settings(settings or []), ranks, quick, folder, console)
    if json_file is not None:
        result.write(json_file)
    result.show(found, console)
    raise typer.Exit(0 if result.passed else 1)
