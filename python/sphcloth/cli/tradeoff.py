"""``sphcloth tradeoff``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from sphcloth.cli.options import JsonFile, grouped
from sphcloth.errors import UserError

if TYPE_CHECKING:
    from sphcloth.tradeoff.scene import Scene
    from sphcloth.tradeoff.study import Plan

EXAMPLES = """
Examples:

sphcloth tradeoff dam-break --quick

sphcloth tradeoff two-resolutions --scheme constant,global --vary acoustic=0.5,1.0,1.5 --error 0.02

sphcloth tradeoff my.in --vary dt=1e-3,5e-4 --reference dt=1e-5 --quantity KinEng

sphcloth tradeoff hydrostatic --exact --quick --quantity pressure --vary wall=own,mirror
"""


@dataclass(frozen=True)
class Settings:
    """With what the scene is run."""

    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=A,B,...",
            help="Values to try of a variable of the script, or of a limit of fix sph/integrate; "
            "several make all combinations. In the place of what the scene varies by itself.",
        ),
    ] = None
    scheme: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,...",
            help="Schemes: constant, global, individual, block.",
            show_default="those that the scene names; a script's own",
        ),
    ] = None
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Set a variable in all runs; NAME= empties it."
        ),
    ] = None
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=A,B,...",
            help="Run all, the reference too, with each of these values of a variable, and take "
            "means: for scenes where single runs differ by chance. A setting that fails once has "
            "failed.",
        ),
    ] = None
    reference: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Settings of the run that is taken for exact."),
    ] = None

    def plan(self, scene: Scene, error: float, quick: bool) -> Plan:
        """Return the plan of a study of a scene."""
        from sphcloth.examples import parse_settings
        from sphcloth.tradeoff import command
        from sphcloth.tradeoff.study import Plan

        return Plan(
            command.find_schemes(scene, self.scheme),
            command.parse_variations(self.vary or []),
            parse_settings(self.settings or []),
            parse_settings(self.reference or [], "--reference"),
            error,
            quick,
            command.parse_variations(self.over or [], "--over"),
        )

    def of_case(self, error: float, quick: bool) -> Plan:
        """Return the plan of a study of a validation case."""
        from sphcloth.examples import parse_settings
        from sphcloth.tradeoff import command
        from sphcloth.tradeoff.study import Plan

        given = {"--scheme": self.scheme, "--over": self.over, "--reference": self.reference}
        if found := [option for option, value in given.items() if value]:
            raise UserError(
                f"--exact: a case has an exact solution and no {found[0]}; its scheme is a "
                "parameter: --set scheme=A or --vary scheme=A,B"
            )
        vary = command.parse_variations(self.vary or [])
        settings = parse_settings(self.settings or [])
        return Plan((), vary, settings, {}, error, quick)


@dataclass(frozen=True)
class Effort:
    """How many ranks and runs there are at a time, and how often wall times are measured."""

    ranks: Annotated[int, typer.Option(min=1, help="Number of MPI ranks of a run.")] = 1
    jobs: Annotated[
        int,
        typer.Option(
            min=0,
            help="Runs side by side, 0 for as many as the cores allow. Wall times are only good "
            "with 1.",
        ),
    ] = 1
    repeat: Annotated[
        int,
        typer.Option(min=1, help="How often each wall time is measured; the shortest counts."),
    ] = 1


@grouped
def tradeoff(
    *,
    scene: Annotated[
        str | None,
        typer.Argument(metavar="SCENE", help="A packaged scene (--list), or an input script."),
    ] = None,
    settings: Settings,
    quantity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[:NORM]",
            help="A quantity of the scene or a column of the log; norm rms, max or end. The first "
            "one ranks the settings.",
        ),
    ] = None,
    error: Annotated[
        float, typer.Option(min=0.0, help="Relative error within which the cheapest is sought.")
    ] = 0.01,
    quick: Annotated[bool, typer.Option("--quick", help="Run the smaller variant.")] = False,
    effort: Effort,
    exact: Annotated[
        bool,
        typer.Option(
            "--exact",
            help="SCENE is a case of sphcloth validate: errors are what it measures, --quantity "
            "and --vary take its names, and the first name that is varied groups the settings.",
        ),
    ] = False,
    last_run: Annotated[
        bool,
        typer.Option("--last-run", help="Of a script of your own, look at the last run alone."),
    ] = False,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Forget the runs that are in the folder.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="sphcloth-tradeoff-SCENE")
    ] = None,
    json_file: JsonFile = None,
    show_list: Annotated[bool, typer.Option("--list", help="Show the packaged scenes.")] = False,
) -> None:
    """Run a scene with many settings: error against particle updates and wall time."""
    from sphcloth.tradeoff import command
    from sphcloth.tradeoff.exact import scene_of, study_case
    from sphcloth.tradeoff.report import show, write_all
    from sphcloth.tradeoff.study import study
    from sphcloth.validation.validate import find_case

    console = Console()
    if show_list:
        command.show_scenes(console)
        return
    if scene is None:
        raise UserError("which scene? sphcloth tradeoff --list shows them")
    if exact and last_run:
        raise UserError("--exact: a case has no use for --last-run")
    how = {
        "ranks": effort.ranks,
        "jobs": command.number_of_jobs(effort.jobs, effort.ranks),
        "repeat": effort.repeat,
        "fresh": fresh,
    }
    if exact:
        folder = out or Path(f"sphcloth-tradeoff-{scene}-exact")
        case = find_case(scene)
        found = scene_of(case, quantity or [])
        result = study_case(case, found, settings.of_case(error, quick), folder, console, **how)
    else:
        found = command.find_scene(scene, quantity or [], last_run)
        folder = out or Path(f"sphcloth-tradeoff-{found.name}")
        result = study(found, settings.plan(found, error, quick), folder, console, **how)
    files = write_all(result, folder)
    if json_file is not None:
        result.write(json_file)
    show(result, console)
    console.print("\n".join(map(str, files)), markup=False, highlight=False, soft_wrap=True)
