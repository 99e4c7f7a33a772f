# SPDX-License-Identifier: GPL-2.0-or-later
# ruff: noqa: F403, F405
"""LAMMPS with the package USER-SPHCLOTH inside, built with the compiler and MPI that Spack has.

In the source tree of SPHCLOTH:

    spack repo add packaging/spack
    spack dev-build sphcloth@main
"""

from spack.package import *
from spack_repo.builtin.build_systems.cmake import CMakePackage


class Sphcloth(CMakePackage):
    """SPH water and position-based cloth for LAMMPS, coupled both ways, with adaptive steps."""

    license("GPL-2.0-or-later")

    # the source tree itself, given by `spack dev-build` or `spack develop`
    version("main")

    variant("shared", default=True, description="LAMMPS as a shared library, for Python")
    variant("rigid", default=True, description="bodies of vertices: LAMMPS's package RIGID")
    variant(
        "sizes",
        default="smallbig",
        values=("smallbig", "bigbig"),
        description="integers of LAMMPS",
    )

    depends_on("cxx", type="build")
    depends_on("cmake@3.20:", type="build")
    depends_on("eigen@3.4:3", type="build")
    depends_on("mpi")

    resource(
        name="lammps",
        git="https://github.com/lammps/lammps.git",
        tag="stable_22Jul2025_update4",
        destination="build",
        placement="lammps",
    )

    @property
    def root_cmakelists_dir(self):
        """LAMMPS's CMake builds, with this package in its tree."""
        return join_path("build", "lammps", "cmake")

    @run_before("cmake")
    def add_the_package(self):
        """Put the package into LAMMPS's tree."""
        add = Executable(join_path(self.stage.source_path, "cmake/package/add_to_lammps.sh"))
        add(join_path(self.stage.source_path, "build", "lammps"))

    def cmake_args(self):
        """Return the options of LAMMPS's CMake."""
        return [
            self.define("BUILD_MPI", True),
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("PKG_RIGID", "rigid"),
            self.define("LAMMPS_SIZES", self.spec.variants["sizes"].value),
            *(self.define(f"PKG_{name}", True) for name in ("USER-SPHCLOTH", "SPH", "MOLECULE")),
        ]
