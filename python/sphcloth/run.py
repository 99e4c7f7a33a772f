"""Run a packaged example through LAMMPS, with a progress bar.

What measures and draws takes longer to load than all else before LAMMPS starts: it is loaded while
LAMMPS runs.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import yaml
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from sphcloth.dump import has_frame
from sphcloth.errors import UserError
from sphcloth.examples import Example, find_example
from sphcloth.programs import endings_interrupt, kill, lammps_on
from sphcloth.results import SUMMARY_PICTURES, Numbered, make_folder, pictures_in
from sphcloth.resume import first_step, join, kept, newest_restart, set_aside

LOG, SCREEN = "log.lammps", "screen.txt"
POLL_SECONDS = 0.2
GRACE_SECONDS = 10.0
# commands whose arguments may be files that LAMMPS reads
READERS = ("read_data", "read_restart", "read_dump", "include", "molecule", "variable")


@dataclass(frozen=True)
class Outcome:
    """How LAMMPS ended: its exit status, and whether the user stopped it."""

    status: int
    interrupted: bool


def run_example(
    name: str,
    size: str,
    ranks: int,
    out: Path,
    settings: Mapping[str, str],
    frames: int | None,
    console: Console,
    json_file: Path | None = None,
    resume: bool = False,
) -> int:
    """Run an example, draw it and print its summary.

    Args:
        name: the example's name.
        size: one of the sizes in its ``sizes.toml``.
        ranks: number of MPI ranks.
        out: folder for all that the run writes; made if need be, files of an earlier run go.
        settings: script variables that differ from the size's.
        frames: number of pictures; None draws nothing.
        console: where progress and summary appear.
        json_file: where the summary is written beside ``summary.json``.
        resume: go on from the newest restart file in ``out``, instead of starting anew.

    Returns:
        Exit code: 0 if LAMMPS ended well, nothing crossed the sheet and the mass balance is
        exact, otherwise 1.

    Raises:
        UserError: an unknown name, size or variable, a missing program, nothing to go on from, or
            another run in the same folder.
    """
    example = find_example(name)
    variables = example.variables(size, settings)
    t_end = _end_time(example.defaults() | variables)
    make_folder(out)
    check_no_link(out / "pictures")
    with _alone_in(out):
        return _run(example, ranks, out, variables, t_end, frames, console, json_file, resume)


def _run(
    example: Example,
    ranks: int,
    out: Path,
    variables: dict[str, str],
    t_end: float,
    frames: int | None,
    console: Console,
    json_file: Path | None,
    resume: bool,
) -> int:
    """Run an example in a folder that is its own; see :func:`run_example`."""
    log, dump = out / LOG, out / f"{example.name}.lammpstrj"
    if resume:
        variables |= _go_on(example, out, log, dump)
    else:
        _remove_old_run(out, example.name)
    _remove_old_results(out)
    copy_companions(example.script, out)
    command = lammps_command(example.script.resolve(), ranks, variables)
    with _loading(["sphcloth.summary", *(["sphcloth.pictures"] if frames else [])]):
        outcome = run_lammps(command, out, t_end, console)
    join(log, dump)
    if outcome.interrupted and (first_step(log) is None or not has_frame(dump)):
        console.print("[yellow]stopped before the first row and frame: nothing to sum up[/]")
        return 1
    if outcome.interrupted:
        console.print("[yellow]stopped: the summary is of what was reached[/]")
    elif outcome.status != 0:
        _show_failure(out, outcome.status, console)
        return 1
    with console.status("measuring and drawing"):
        from sphcloth.summary import summarize

        summary = summarize(out, example.name, frames)
    for file in (out / "summary.json", json_file):
        if file is not None:
            summary.write(file)
    summary.show(console)
    return 0 if summary.passed and not outcome.interrupted else 1


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder; UserError where one is there. It leaves no file behind."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        if not _locked(handle):
            raise UserError(
                f"--out {folder}: another run is writing there: wait for its end, or choose "
                "another folder"
            )
        yield
    finally:
        os.close(handle)


def _locked(handle: int) -> bool:
    """Lock an open folder until it is closed; False where another has locked it."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass  # a file system without locks
    return True


@contextmanager
def _loading(modules: Sequence[str]) -> Iterator[None]:
    """Load modules beside the block; one that cannot be loaded says so where it is imported."""
    with ThreadPoolExecutor(1) as pool:
        for module in modules:
            pool.submit(import_module, module)
        yield


def _go_on(example: Example, out: Path, log: Path, dump: Path) -> dict[str, str]:
    """Set aside what a run has written; return the variables with which the script goes on."""
    if "again" not in example.defaults():
        raise UserError(f"{example.name} cannot go on: its script has no variable 'again'")
    variables = {"again": "yes", "state": newest_restart(out, example.name).name}
    join(log, dump)
    set_aside(log, dump)
    return variables


def _end_time(variables: Mapping[str, str]) -> float:
    """Return the physical time at which the run ends."""
    try:
        return float(variables["t_end"])
    except KeyError:
        raise UserError("the script has no 'variable t_end index': no end to wait for") from None
    except ValueError:
        raise UserError(f"t_end = {variables['t_end']} is not a number") from None


def _remove_old_run(out: Path, name: str) -> None:
    """Remove the files that LAMMPS wrote in an earlier run."""
    files = [out / file for file in (LOG, SCREEN, f"{name}.lammpstrj", f"{name}.data")]
    _remove([*files, *map(kept, files)])
    Numbered(out, f"{name}.restart.", 1, "").remove()


def _remove_old_results(out: Path) -> None:
    """Remove what was found in an earlier run, lest one that fails early shows its numbers."""
    _remove(out / name for name in ("summary.json", *SUMMARY_PICTURES))
    pictures_in(out / "pictures").remove()


def _remove(files: Iterable[Path]) -> None:
    for file in files:
        file.unlink(missing_ok=True)


def copy_companions(script: Path, folder: Path) -> None:
    """Copy the files beside a script that it reads to the folder in which it will run."""
    for file in companions(script):
        shutil.copy(file, folder)


def companions(script: Path) -> list[Path]:
    """Return the files beside a script that it names in a command that reads files."""
    words = set()
    for line in script.read_text(encoding="utf-8", errors="replace").splitlines():
        command, *arguments = line.split() or [""]
        if command in READERS:
            words.update(arguments)
    found = [script.parent / word for word in sorted(words) if "/" not in word]
    return [file for file in found if file.is_file()]


def check_no_link(folder: Path) -> None:
    """Raise UserError where a folder of the output is a link: what goes would be elsewhere."""
    if folder.is_symlink():
        raise UserError(f"{folder} is a link to {folder.readlink()}: remove it first")


def lammps_command(
    script: Path, ranks: int, variables: Mapping[str, str], jobs: int = 1
) -> list[str]:
    """Return the command line that runs a script with these variables, one of so many jobs."""
    values = [text for name, value in variables.items() for text in ("-var", name, value)]
    return [*lammps_on(ranks, jobs=jobs), "-in", str(script), "-log", LOG, *values]


def run_lammps(command: list[str], out: Path, t_end: float, console: Console) -> Outcome:
    """Run LAMMPS in ``out`` and show how far it is until it ends or the user stops it."""
    with _started(command, out) as process, _progress(console) as progress:
        task = progress.add_task("starting", total=t_end)
        try:
            for row in _follow(out / LOG, process):
                progress.update(task, completed=row["Time"], description=_describe(row, t_end))
        except KeyboardInterrupt:
            _stop(process)
            return Outcome(process.returncode, interrupted=True)
        progress.update(task, completed=t_end if process.returncode == 0 else None)
    return Outcome(process.returncode, interrupted=False)


@contextmanager
def _started(command: list[str], out: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Start LAMMPS and make sure that it has ended when the block is left."""
    with endings_interrupt():
        process = start_lammps(command, out)
        try:
            yield process
        finally:
            if process.poll() is None:
                kill(process)


def start_lammps(command: list[str], out: Path) -> subprocess.Popen[bytes]:
    """Start LAMMPS in a session of its own: a Ctrl-C reaches it through us alone, and once."""
    with (out / SCREEN).open("wb") as screen:
        return subprocess.Popen(
            command,
            cwd=out,
            stdin=subprocess.DEVNULL,
            stdout=screen,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )


def _follow(log: Path, process: subprocess.Popen[bytes]) -> Iterator[dict[str, float]]:
    """Yield the newest thermo row whenever the log has grown, until the process has ended."""
    offset, names, rest = 0, [], ""
    while process.poll() is None:
        time.sleep(POLL_SECONDS)
        if not log.is_file():
            continue
        with log.open(encoding="utf-8", errors="replace") as file:
            file.seek(offset)
            *lines, rest = (rest + file.read()).split("\n")
            offset = file.tell()
        newest = None
        for line in lines:
            if line.startswith("keywords: ["):
                names, newest = yaml.safe_load(line)["keywords"], None
            elif line.startswith("  - [") and names:
                newest = line
        if newest and "Time" in names:
            yield dict(zip(names, map(float, yaml.safe_load(newest)[0]), strict=True))


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=20),
        TextColumn("{task.percentage:3.0f} %"),
        TimeRemainingColumn(compact=True),
        console=console,
    )


def _describe(row: Mapping[str, float], t_end: float) -> str:
    """Return the progress line's text for a thermo row."""
    parts = [f"t {row['Time']:.3g}/{t_end:g}", f"step {row['Step']:,.0f}"]
    if "Dt" in row:
        parts.append(f"dt {row['Dt']:.1e}")
    if "v_fluid" in row:
        parts.append(f"{row['v_fluid']:,.0f} particles")
    return "  ".join(parts)


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Pass an interrupt on to LAMMPS; kill it if it has not ended when the grace is over."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(GRACE_SECONDS)
    except (subprocess.TimeoutExpired, KeyboardInterrupt):
        kill(process)


def wait_for_lammps(command: list[str], out: Path, timeout: float) -> int | None:
    """Run LAMMPS to its end; returns its status, None if it was killed after timeout in s."""
    with endings_interrupt():
        process = start_lammps(command, out)
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            if process.poll() is None:
                kill(process)


def last_words(out: Path) -> list[str]:
    """Return the last words of LAMMPS, or else of the launcher in a folder."""
    from sphcloth.log import error_lines

    screen = (out / SCREEN).read_text(errors="replace").splitlines()
    return error_lines(out / LOG) or screen[-5:]


def _show_failure(out: Path, status: int, console: Console) -> None:
    """Print the last words of LAMMPS."""
    console.print(f"[red]LAMMPS ended with status {status}[/]")
    for line in last_words(out):
        console.print(f"  {line}", markup=False, soft_wrap=True)
    console.print(f"  log: {out / LOG}", markup=False, soft_wrap=True)
