"""The command ``sphcloth``: one file a command, which imports what it needs only when it runs."""

from __future__ import annotations

import sys
import warnings

import typer
from rich.console import Console
from rich.text import Text

from sphcloth.cli import (
    advise,
    bench,
    doctor,
    mesh,
    render,
    report,
    run,
    stress,
    tradeoff,
    validate,
)
from sphcloth.errors import UserError

app = typer.Typer(
    help="SPH water on cloth in LAMMPS.", no_args_is_help=True, pretty_exceptions_enable=False
)


@app.callback()
def sphcloth() -> None:
    """Keep the names of the commands, however few there are."""


# in the order of the help
app.command(epilog=doctor.EXAMPLES)(doctor.doctor)
app.command(epilog=run.EXAMPLES)(run.run)
app.command(epilog=validate.EXAMPLES)(validate.validate)
app.command(epilog=mesh.EXAMPLES)(mesh.mesh)
app.command(epilog=render.EXAMPLES)(render.render)
app.command(epilog=bench.EXAMPLES)(bench.bench)
app.command(epilog=tradeoff.EXAMPLES)(tradeoff.tradeoff)
app.command(epilog=advise.EXAMPLES)(advise.advise)
app.command(epilog=report.EXAMPLES)(report.report)
app.command(epilog=stress.EXAMPLES)(stress.stress)


def main() -> None:
    """Run the command line; a mistake of the user's is one line and exit code 2."""
    warnings.showwarning = _show_warning
    try:
        app()
    except UserError as error:
        _say("error:", "bold red", str(error))
        sys.exit(2)


def _show_warning(message: Warning | str, *_where: object) -> None:
    _say("warning:", "yellow", str(message))


def _say(head: str, style: str, words: str) -> None:
    """Print a line to the error output; the words are the user's, and no markup."""
    Console(stderr=True).print(Text.assemble((head, style), f" {words}"), soft_wrap=True)
