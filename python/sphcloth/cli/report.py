"""``sphcloth report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

EXAMPLES = """
Examples:

sphcloth report

sphcloth report pour build/validate --out report.html --title "Water on a sheet"
"""


def report(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FOLDER ...", help="Where results are.", show_default="here"),
    ] = None,
    out: Annotated[Path, typer.Option(help="The page.")] = Path("sphcloth-report.html"),
    title: Annotated[str, typer.Option(help="Title of the page.")] = "SPHCLOTH report",
    viewers: Annotated[
        int, typer.Option("--trajectories", min=0, help="Show so many trajectories at most.")
    ] = 2,
) -> None:
    """Write one HTML page of what runs have shown: tables, plots, and scenes to turn."""
    from sphcloth.report.command import report as write_report

    write_report(folders or [Path()], out, title, viewers, Console())
