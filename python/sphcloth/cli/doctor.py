"""``sphcloth doctor``."""

from __future__ import annotations

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile

EXAMPLES = """
Examples:

sphcloth doctor

sphcloth doctor --json doctor.json
"""


def doctor(
    json_file: JsonFile = None,
) -> None:
    """Check that LAMMPS, MPI and the styles work together on this machine."""
    from sphcloth.doctor import examine
    from sphcloth.programs import endings_interrupt

    with endings_interrupt():
        findings = examine()
    findings.show(Console())
    if json_file is not None:
        findings.write(json_file)
    raise typer.Exit(0 if findings.passed else 1)
