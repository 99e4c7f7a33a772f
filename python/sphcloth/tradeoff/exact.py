"""A trade-off against exact solutions: a validation case with many settings."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.programs import kill
from sphcloth.results import argument
from sphcloth.run import LOG, SCREEN
from sphcloth.tradeoff.front import Point
from sphcloth.tradeoff.runs import Crew, Record, Setting, Workshop
from sphcloth.tradeoff.scene import Quantity, Scene, column
from sphcloth.tradeoff.study import RUNS, Plan, Study, combinations
from sphcloth.validation import schemes
from sphcloth.validation.case import Case

# of a case: all that it wrote, and what it measured
OUTPUT, MEASURED = "case", "case.json"
COMMAND = (sys.executable, "-c", "from sphcloth.cli import main; main()", "validate")
END_SECONDS = 20.0


def scene_of(case: Case, names: list[str]) -> Scene:
    """Return a case as a scene whose quantities are what the case measures.

    Args:
        case: whose measured values that have no unit are errors.
        names: of the quantities; the first one ranks the settings.

    Raises:
        UserError: no quantity, or one that the case does not measure.
    """
    known = {each.name: each for each in case.quantities}
    if not names:
        raise UserError(
            f"which error of {case.name}? give --quantity with one of {', '.join(known)}"
        )
    for name in names:
        if name not in known:
            raise UserError(
                f"--quantity {name}: {case.name} does not measure it: choose from "
                f"{', '.join(known)}"
            )
    quantities = tuple(
        Quantity(name, known[name].description, column(name), "absolute value") for name in names
    )
    return Scene(case.name, case.summary, case.script, quantities)


def study_case(
    case: Case,
    scene: Scene,
    plan: Plan,
    out: Path,
    console: Console,
    *,
    ranks: int = 1,
    jobs: int = 1,
    repeat: int = 1,
    fresh: bool = False,
) -> Study:
    """Run a case with all settings; the error of each is what the case measures.

    The first name that is varied takes the place of the scheme: settings are compared in groups of
    its values. Costs are those of the run with the most updates, the finest one.

    Args:
        case: what to run.
        scene: of :func:`scene_of`.
        plan: with which settings; its schemes, reference and begins are not used.
        out: output folder; runs that are in it already are not made again.
        console: where the progress appears.
        ranks: number of MPI ranks of a run.
        jobs: number of cases side by side.
        repeat: how often each wall time is measured; the shortest counts.
        fresh: forget what is in the folder.

    Raises:
        UserError: nothing is varied, or a setting that the case does not allow.
    """
    settings = settings_of(case, plan)
    workshop = CaseWorkshop(scene, out / RUNS, ranks, jobs, console, case)
    workshop.open(fresh)
    records = workshop.run(settings, repeat)
    names = [each.name for each in scene.quantities]
    points = [
        _point(setting, record, workshop.errors(setting, names))
        for setting, record in zip(settings, records, strict=True)
    ]
    return Study(scene, plan, ranks, None, points, any(each.side_by_side for each in records))


def settings_of(case: Case, plan: Plan) -> list[Setting]:
    """Return all combinations of what is varied; UserError for what the case does not allow."""
    if not plan.vary:
        known = ", ".join(each.name for each in case.parameters)
        raise UserError(f"nothing to vary: give --vary NAME=A,B,... with one of {known}")
    if both := set(plan.vary) & set(plan.settings):
        raise UserError(f"--set {min(both)}: it is varied as well: leave one out")
    group = next(iter(plan.vary))
    found = []
    for varied in combinations(plan.vary):
        values = case.values(dict(plan.settings) | varied, plan.quick)
        schemes.check(values)
        variables = {name: argument(value) for name, value in values.items()}
        found.append(Setting(f"{group} {varied[group]}", varied, variables))
    return found


@dataclass(frozen=True)
class CaseWorkshop(Workshop):
    """Where the runs of a case are made, each by ``sphcloth validate``.

    Attributes:
        case: what to run.
    """

    case: Case
    kept: ClassVar[str] = SCREEN

    def crew(self, timeout: float) -> Crew:
        """Return what runs the cases: each ends its own LAMMPS when it is asked to end."""
        return Crew(timeout, _end)

    def command(self, setting: Setting) -> list[str]:
        """Return the command of a run, whose working directory is its folder."""
        settings = [f"{name}={value}" for name, value in setting.variables.items()]
        options = [word for text in settings for word in ("--set", text)]
        where = ["--out", OUTPUT, "--json", MEASURED, "--ranks", str(self.ranks)]
        return [*COMMAND, self.case.name, *options, *where]

    def record(self, setting: Setting, failure: str | None, elapsed: float) -> Record:
        """Read what a run has cost; a case that misses its limits has measured all the same."""
        measured = (self.folder(setting) / MEASURED).is_file()
        return super().record(setting, None if measured else failure or "no result", elapsed)

    def thermo(self, setting: Setting) -> ThermoTable:
        """Return the thermo output of the run with the most updates, the finest one."""
        logs = (self.folder(setting) / OUTPUT).rglob(LOG)
        return max(map(ThermoTable.read, logs), key=lambda table: table["v_updates"][-1])

    def errors(self, setting: Setting, names: list[str]) -> dict[str, float | None]:
        """Return the absolute values of what a case has measured; nothing if it failed."""
        path = self.folder(setting) / MEASURED
        if not path.is_file():
            return {}
        metrics: Mapping = json.loads(path.read_text(encoding="utf-8"))["metrics"]
        values = {name: metrics[name]["value"] for name in names}
        return {name: None if value is None else abs(value) for name, value in values.items()}

    def sources(self) -> Iterable[Path]:
        """Return the files of the case."""
        files = sorted(self.case.folder.rglob("*"))
        return (file for file in files if file.is_file() and file.suffix != ".pyc")


def _point(setting: Setting, record: Record, errors: Mapping[str, float | None]) -> Point:
    _, *others = setting.values.items()
    label = ", ".join(f"{name} {value}" for name, value in others) or "-"
    named = setting.scheme, label, setting.values
    if record.failure is not None:
        return Point(*named, {}, record.failure)
    missing = [name for name, value in errors.items() if value is None]
    if missing:
        return Point(*named, {}, f"{missing[0]} is not a number")
    return Point(*named, dict(errors), None, record.updates, record.steps, record.wall_s)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Let a case end its LAMMPS and itself."""
    os.killpg(process.pid, signal.SIGTERM)
    try:
        process.wait(END_SECONDS)
    except subprocess.TimeoutExpired:
        kill(process)
