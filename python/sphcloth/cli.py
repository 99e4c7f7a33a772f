"""The command ``sphcloth``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from sphcloth.errors import UserError

app = typer.Typer(
    help="SPH water on cloth in LAMMPS.", no_args_is_help=True, pretty_exceptions_enable=False
)


@app.callback()
def sphcloth() -> None:
    """Keep the names of the commands, however few there are."""


@app.command()
def doctor(
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the findings here too.")
    ] = None,
) -> None:
    """Check that LAMMPS, MPI and the styles work together on this machine."""
    from sphcloth.doctor import examine

    findings = examine()
    findings.show(Console())
    if json_file is not None:
        findings.write(json_file)
    raise typer.Exit(0 if findings.passed else 1)


@app.command()
def run(
    example: Annotated[str, typer.Argument(metavar="EXAMPLE", help="Name of a packaged example.")],
    size: Annotated[
        str, typer.Option(help="One of the sizes in the example's sizes.toml.")
    ] = "small",
    ranks: Annotated[int, typer.Option(min=1, help="Number of MPI ranks.")] = 1,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-EXAMPLE-SIZE")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a variable of the script."),
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw pictures afterwards.")] = True,
    frames: Annotated[int, typer.Option(min=1, help="Number of pictures.")] = 12,
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
    )
    raise typer.Exit(code)


@app.command()
def validate(
    case: Annotated[
        str | None, typer.Argument(metavar="CASE", help="Name of a case; --list shows them.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter of the case."),
    ] = None,
    ranks: Annotated[int, typer.Option(min=1, help="Number of MPI ranks.")] = 1,
    quick: Annotated[
        bool, typer.Option("--quick", help="Run the smaller variant with its own limits.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-validate-CASE")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the result here too.")
    ] = None,
    show_list: Annotated[
        bool, typer.Option("--list", help="Show all cases and their parameters.")
    ] = False,
) -> None:
    """Compare a case with its reference solution; exit code 0 only if all limits are met."""
    from sphcloth.examples import parse_settings
    from sphcloth.validation.validate import find_case, show_cases
    from sphcloth.validation.validate import validate as run_case

    console = Console()
    if show_list:
        show_cases(console)
        return
    if case is None:
        raise UserError("which case? sphcloth validate --list shows them")
    found = find_case(case)
    folder = out or Path(f"sphcloth-validate-{case}")
    result = run_case(found, parse_settings(settings or []), ranks, quick, folder, console)
    if json_file is not None:
        result.write(json_file)
    result.show(found, console)
    raise typer.Exit(0 if result.passed else 1)


@app.command()
def bench(
    name: Annotated[str, typer.Argument(metavar="NAME", help="What to measure: pair, cloth.")],
    rounds: Annotated[int, typer.Option(min=1, help="How often everything is measured.")] = 5,
    across: Annotated[
        int | None,
        typer.Option(
            min=8,
            max=400,
            help="Particles along an edge of the block (pair), vertices along a side (cloth).",
            show_default="48 or 160",
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(min=5, help="Length of a timed run.", show_default="30 or 40"),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the figures here.")
    ] = None,
) -> None:
    """Measure speed as ratios, side by side in one run, with the spread."""
    import json

    from sphcloth.bench.cloth import bench_cloth
    from sphcloth.bench.pair import bench_pair

    known = {"pair": (bench_pair, 48, 30), "cloth": (bench_cloth, 160, 40)}
    if name not in known:
        raise UserError(f"no benchmark '{name}': use {', '.join(known)}")
    measure, usual_across, usual_steps = known[name]
    figures = measure(rounds, across or usual_across, steps or usual_steps, Console())
    if json_file is not None:
        json_file.write_text(json.dumps(figures, indent=2) + "\n")


def main() -> None:
    """Run the command line; a mistake of the user's is one line and exit code 2."""
    try:
        app()
    except UserError as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False)
        sys.exit(2)
