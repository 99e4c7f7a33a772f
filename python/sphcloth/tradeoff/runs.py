"""Runs of a scene: each in a folder of its own, which a later call finds again."""

from __future__ import annotations

import hashlib
import json
import math
import re
import shutil
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from sphcloth.errors import UserError
from sphcloth.fix_values import column
from sphcloth.log import ThermoTable
from sphcloth.plugin import PLUGIN, lammps_release, plugin_folder
from sphcloth.programs import endings_interrupt, installed_version, kill
from sphcloth.results import make_folder, write_json
from sphcloth.run import (
    LOG,
    check_no_link,
    companions,
    copy_companions,
    lammps_command,
    last_words,
    start_lammps,
    wait_for_lammps,
)
from sphcloth.tradeoff.scene import Scene

RECORD = "result.json"
# a run is stopped when it takes so many times as long as the reference, and these seconds
TIMEOUT_FACTOR, GRACE_SECONDS = 3.0, 120.0
# ends all runs of a script after a second
LOOK = "timer timeout 0:0:1 every 1"
STOPPED = "stopped; what has finished is kept: the same command goes on from there"
# schemes under which a step is not a step of every particle
PARTIAL = ("individual", "block")
REMEDY = "'compute updates all sph/step updates', and c_updates to thermo_style"


@dataclass(frozen=True)
class Setting:
    """One run of a scene.

    Attributes:
        scheme: of the time step.
        values: what is varied, by name.
        variables: all variables of the script that differ from its defaults.
    """

    scheme: str
    values: dict[str, str]
    variables: dict[str, str]

    @property
    def label(self) -> str:
        """The values that are varied, in a few words."""
        return ", ".join(f"{name} {value}" for name, value in self.values.items()) or "-"


@dataclass(frozen=True)
class Record:
    """What is kept of a run beside its log.

    Attributes:
        scheme: of the time step.
        values: what was varied.
        variables: what the script was given.
        failure: why there is no result, in LAMMPS's words; None if there is one.
        elapsed_s: wall time from the start of LAMMPS to its end.
        side_by_side: whether other runs of the study shared the machine.
        updates: how often a particle was updated; None if the run failed, as what follows.
        steps: number of time steps.
        walls_s: wall time of the time loop, by LAMMPS, each time that it was measured.
    """

    scheme: str
    values: dict[str, str]
    variables: dict[str, str]
    failure: str | None
    elapsed_s: float
    side_by_side: bool
    updates: float | None = None
    steps: int | None = None
    walls_s: tuple[float, ...] = ()

    @property
    def wall_s(self) -> float | None:
        """The shortest wall time: what else the machine had to do only makes it longer."""
        return min(self.walls_s, default=None)

    def is_complete(self, repeat: int) -> bool:
        """Tell whether the wall time was measured so often, or there is none to measure."""
        return self.failure is not None or len(self.walls_s) >= repeat


@dataclass(frozen=True)
class Workshop:
    """Where the runs of a scene are made.

    Attributes:
        scene: what to run.
        out: folder in which every run has its own.
        ranks: number of MPI ranks of a run.
        jobs: number of runs side by side.
        console: where the progress appears.
    """

    scene: Scene
    out: Path
    ranks: int
    jobs: int
    console: Console
    kept: ClassVar[str] = LOG  # what a run must have left beside its record

    def open(self, fresh: bool) -> None:
        """Refuse a folder that is a link, and forget what is in it if asked to."""
        make_folder(self.out.parent)
        check_no_link(self.out)
        if fresh:
            shutil.rmtree(self.out, ignore_errors=True)

    def folder(self, setting: Setting) -> Path:
        """Return the folder of a run: its name says all that decides the result."""
        what = [self._fingerprint, self.ranks, sorted(setting.variables.items())]
        key = hashlib.sha256(json.dumps(what).encode()).hexdigest()[:12]
        return self.out / f"{setting.scheme.replace(' ', '-')}-{key}"

    def find(self, setting: Setting) -> Record | None:
        """Return what an earlier call has kept of a run; None if it is missing."""
        path = self.folder(setting) / RECORD
        if not path.is_file() or not path.with_name(self.kept).is_file():
            return None
        try:
            kept = json.loads(path.read_text(encoding="utf-8"))
            return Record(**kept | {"walls_s": tuple(kept["walls_s"])})
        except (ValueError, LookupError, TypeError) as error:
            raise UserError(f"{path}: not what a run keeps ({error}): remove its folder") from error

    def crew(self, timeout: float) -> Crew:
        """Return what runs the commands, each for so many seconds at most."""
        return Crew(timeout)

    def command(self, setting: Setting) -> list[str]:
        """Return the command of a run, whose working directory is its folder."""
        script = self.scene.script.resolve()
        return lammps_command(script, self.ranks, setting.variables, self.jobs)

    def record(self, setting: Setting, failure: str | None, elapsed: float) -> Record:
        """Read what a run has cost; ``elapsed`` is the time that it took, s."""
        what = setting.scheme, setting.values, setting.variables
        measured = *what, failure, elapsed, self.jobs > 1
        if failure is not None:
            return Record(*measured)
        table = self.thermo(setting)
        steps = int(table["Step"][-1] - table["Step"][0])
        updates = count_updates(table, self.scene.text, setting.scheme)
        return Record(*measured, updates, steps, (table.loop_seconds,))

    def run(
        self, settings: list[Setting], repeat: int = 1, timeout: float = math.inf
    ) -> list[Record]:
        """Return the records of all settings; runs what is missing, ``jobs`` at a time.

        Args:
            settings: what to run, in this order.
            repeat: how often each wall time is measured: all settings once, then all again, so
                that a slow spell of the machine does not hit one setting alone.
            timeout: seconds after which a run is given up.

        Raises:
            UserError: the user stopped it. What has finished is kept.
        """
        # settings that come to the same, such as steps that are rounded, are one run
        each_once = list({self.folder(setting): setting for setting in settings}.values())
        for times in range(1, repeat + 1):
            missing = [each for each in each_once if not self._has(each, times)]
            if missing:
                self._run_missing(missing, timeout)
        return [self.find(setting) for setting in settings]

    def check_columns(self, setting: Setting) -> None:
        """Raise UserError for a quantity that the log will lack, after a second of a run.

        Does nothing for a run that was kept, a script that may change its columns, or one that
        fails: what is wrong with it the run itself will tell.
        """
        if self.find(setting) is not None or not self.scene.has_one_table:
            return
        with tempfile.TemporaryDirectory() as name:
            folder, script = Path(name), Path(name) / "in.look"
            copy_companions(self.scene.script, folder)
            script.write_text(f'{LOOK}\ninclude "{self.scene.script.resolve()}"\n')
            command = lammps_command(script, self.ranks, setting.variables, self.jobs)
            wait_for_lammps(command, folder, GRACE_SECONDS)
            try:
                table = ThermoTable.read(folder / LOG, self.scene.last_run)
            except UserError:
                return
        for each in self.scene.quantities:
            each.history(table)

    def thermo(self, setting: Setting) -> ThermoTable:
        """Return the thermo output of a run, or of its last part if only that counts."""
        return ThermoTable.read(self.folder(setting) / LOG, self.scene.last_run)

    def _has(self, setting: Setting, times: int) -> bool:
        record = self.find(setting)
        return record is not None and record.is_complete(times)

    def sources(self) -> Iterable[Path]:
        """Return the files that decide what a run does, in a fixed order."""
        return (self.scene.script, *companions(self.scene.script))

    @cached_property
    def _fingerprint(self) -> str:
        """A hash of the sources and of the code that runs them."""
        digest = hashlib.sha256(_code().encode())
        for file in self.sources():
            digest.update(file.read_bytes())
        return digest.hexdigest()

    def _run_missing(self, missing: list[Setting], timeout: float) -> None:
        crew = self.crew(timeout)
        bar = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=20),
            MofNCompleteColumn(),
            console=self.console,
        )
        with bar, endings_interrupt(), ThreadPoolExecutor(self.jobs) as pool:
            task = bar.add_task("starting", total=len(missing))
            jobs = {pool.submit(self._make, setting, crew): setting for setting in missing}
            try:
                for done in as_completed(jobs):
                    done.result()
                    setting = jobs[done]
                    bar.update(task, advance=1, description=f"{setting.scheme}, {setting.label}")
            except BaseException as error:
                crew.stop()
                pool.shutdown(wait=False, cancel_futures=True)
                if isinstance(error, KeyboardInterrupt):
                    raise UserError(STOPPED) from None
                raise

    def _make(self, setting: Setting, crew: Crew) -> None:
        """Run one setting and keep what it showed."""
        folder, before = self.folder(setting), self.find(setting)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        copy_companions(self.scene.script, folder)
        begin = time.monotonic()
        failure = crew.run(self.command(setting), folder)
        if crew.stopped:
            return
        record = self.record(setting, failure, time.monotonic() - begin)
        if before is not None and record.failure is None:
            walls, shared = before.walls_s + record.walls_s, before.side_by_side
            record = replace(record, walls_s=walls, side_by_side=shared or record.side_by_side)
        write_json(folder / RECORD, asdict(record))


class Crew:
    """The LAMMPS processes that run at the moment."""

    def __init__(self, timeout: float, end: Callable[[subprocess.Popen[bytes]], None] = kill):
        self.timeout = timeout
        self.end = end
        self.stopped = False
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()

    def run(self, command: list[str], folder: Path) -> str | None:
        """Run LAMMPS to its end; returns why it failed, or None."""
        with self._lock:
            if self.stopped:
                return "stopped"
            process = start_lammps(command, folder)
            self._running.add(process)
        begin = time.monotonic()
        try:
            status = process.wait(None if math.isinf(self.timeout) else self.timeout)
        except subprocess.TimeoutExpired:
            self.end(process)
            return f"not finished after {time.monotonic() - begin:.0f} s: given up"
        finally:
            with self._lock:
                self._running.discard(process)
        return None if status == 0 else " ".join(last_words(folder)) or f"exit status {status}"

    def stop(self) -> None:
        """Kill all, and start no more."""
        with self._lock:
            self.stopped = True
            for process in self._running:
                if process.poll() is None:
                    self.end(process)


def integrate_fix(script: str) -> str | None:
    """Return the ID of fix sph/integrate in a script; None if it has none."""
    found = re.search(r"^\s*fix\s+(\w+)\s+\S+\s+sph/integrate\b", script, re.MULTILINE)
    return found and found[1]


def count_updates(table: ThermoTable, script: str, scheme: str) -> float:
    """Return how often a particle was updated in a run.

    That is `updates` of compute sph/step, from a column ``v_updates`` or ``c_updates`` or that of
    fix sph/integrate itself, or else, right where all particles take every step, the atoms summed
    over the steps.

    Raises:
        UserError: steps are individual and the log has neither column.
    """
    counted = column(integrate_fix(script) or "step", "sph/integrate", "updates")
    for name in ("v_updates", "c_updates", counted):
        if name in table:
            return float(table[name][-1] - table[name][0])
    if scheme in PARTIAL:
        raise UserError(f"{scheme} steps, but the log has no particle updates: add {REMEDY}")
    if "Atoms" not in table:
        raise UserError(f"no particle updates in the log: add {REMEDY}, or atoms")
    return float(np.trapezoid(table["Atoms"], table["Step"]))


@cache
def _code() -> str:
    """Return the versions and a hash of the plugin: another build is another result."""
    plugin = plugin_folder(lammps_release()) / PLUGIN
    versions = [installed_version(name) for name in ("lammps", "sphcloth")]
    return " ".join([*versions, hashlib.sha256(plugin.read_bytes()).hexdigest()])
