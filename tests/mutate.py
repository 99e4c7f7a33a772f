"""Deliberate bugs in the numerics: each must be caught by a test.

``python tests/mutate.py [NAME ...]`` copies the sources, puts one bug after the other in, builds
and runs the tests that should see it. Nothing of the tree or the installed package is touched.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[1]
SOURCE = Path("src/USER-SPHCLOTH")
BIN = Path(sys.executable).parent


@dataclass(frozen=True)
class Bug:
    """What is put in the place of what, in which file, and the tests that must see it."""

    name: str
    file: str
    old: str
    new: str
    tests: str


STEPPING, PARALLEL = "tests/styles/test_stepping.py", "tests/styles/test_parallel.py"
SOURCES, BLOCK = "tests/styles/test_sources.py", "tests/styles/test_block.py"
PAIR, CLOTH = "tests/styles/test_pair_sph_tait.py", "tests/styles/test_cloth.py"
CONTACT, WATCH = "tests/styles/test_contact.py", "tests/styles/test_watch.py"

BUGS = [
    Bug("sources: no way since the opening", "fix_sph_emit.cpp",
        "centre + pattern[k] + age * velocity", "centre + pattern[k]", SOURCES),
    Bug("sources: each rank counts its own", "fix_sph_emit.cpp",
        "MPI_Allreduce(&made, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);", "all = made;", SOURCES),
    Bug("drain: only the last is counted", "fix_sph_drain.cpp",
        "taken[k] += all[1 + k]", "taken[k] = all[1 + k]", SOURCES),
    Bug("watch: what left counts as lost", "fix_sph_watch.cpp",
        "b.mass += sink->compute_vector(0)", "b.mass -= sink->compute_vector(0)", WATCH),
    Bug("watch: kinetic energy without its half", "fix_sph_watch.cpp",
        "mine[KINETIC] += 0.5 * mass", "mine[KINETIC] += mass", WATCH),
    Bug("cloth: ghosts of a colour are old", "fix_pbd_cloth.cpp",
        "    halo.forward(constraints.channel_of_edge_colour(c), way.data(), false);\n  } else {",
        "  } else {", PARALLEL),
    Bug("cloth: twice the impulse is lent", "fix_pbd_cloth.cpp",
        "part = 0.5 * (1.0 - 1.0 / substeps())", "part = 1.0 - 1.0 / substeps()",
        "tests/styles/test_cloth.py tests/python/test_cloth_cases.py"),
    Bug("cloth: pins pull the wrong way", "fix_pbd_cloth.cpp",
        "Vec3(-hold[i][0], -hold[i][1], -hold[i][2])", "Vec3(hold[i][0], hold[i][1], hold[i][2])",
        "tests/styles/test_cloth_held.py"),
    Bug("pair: ghosts without density and pressure", "pair_sph_tait.cpp",
        "  comm->forward_comm(this, 2);\n  if (extrapolate)", "  if (extrapolate)", PARALLEL),
    Bug("pair: one mass for all of a type", "pair_sph_tait.cpp",
        "if (mass[t] != amount[i]) mass[t] = 0.0;", "", PAIR),
    Bug("pair: stored energy of a unit mass", "pair_sph_tait.cpp",
        "amount[i] * stored_energy(", "stored_energy(", PAIR),
    Bug("step: place before velocity", "fix_sph_integrate.cpp",
        "      v[i][d] += kick * f[i][d];\n      x[i][d] += dt * v[i][d];",
        "      x[i][d] += dt * v[i][d];\n      v[i][d] += kick * f[i][d];", STEPPING),
    Bug("step: the first rank decides", "fix_sph_integrate.cpp",
        "MPI_Allreduce(&in, &out, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);",
        "out = in; MPI_Bcast(&out, 1, MPI_DOUBLE_INT, 0, world);", PARALLEL),
    Bug("block: impulses reach twice as far", "block_steps.cpp",
        "row[UNTIL] = now + half;", "row[UNTIL] = now + 2.0 * half;", BLOCK),
    Bug("block: nobody wakes across ranks", "block_steps.cpp",
        "  comm->reverse_comm(fix, 1);\n", "", BLOCK),
    Bug("contact: a hole in every triangle", "core/contact.h",
        "weight.minCoeff() >= -SEAM", "weight.minCoeff() >= 0.05", CONTACT),
    Bug("cloth: compliance of the wrong sign", "core/constraints.h",
        "by * (error + a * lambda)", "by * (error - a * lambda)",
        "tests/python/test_cloth_cases.py tests/styles/test_cloth.py"),
    Bug("limits: sound over the whole support", "core/criteria.h",
        "lambda.acoustic * smoothing / s.sound", "lambda.acoustic * s.support / s.sound", STEPPING),
]  # fmt: skip


class Tree:
    """A copy of the sources, with a package that holds the plugin built of them."""

    def __init__(self, folder: Path) -> None:
        self.sources, self.build = folder / "tree", folder / "build"
        for name in ("src", "cmake", "python", "tests", "examples", "docs"):
            shutil.copytree(
                ROOT / name, self.sources / name, ignore=_no_rubbish, dirs_exist_ok=True
            )
        for name in ("CMakeLists.txt", "pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(ROOT / name, self.sources)
        self.environment = os.environ | {
            "PYTHONPATH": str(self.sources / "python"),
            "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}",
        }
        python = f"-DPython_EXECUTABLE={sys.executable}"
        self._must(
            "cmake", "-S", self.sources, "-B", self.build, "-DCMAKE_BUILD_TYPE=Release", python
        )
        self.make()

    def make(self) -> None:
        """Build the plugin and put it into the package."""
        self._must("cmake", "--build", self.build, "-j2")
        library = self.sources / "python" / "sphcloth" / "lib"
        library.mkdir(exist_ok=True)
        (library / "sphclothplugin.so").unlink(missing_ok=True)
        shutil.copy(self.build / "sphclothplugin.so", library)

    def _must(self, *command: object) -> None:
        done = subprocess.run(
            [str(word) for word in command], env=self.environment, capture_output=True, text=True
        )
        if done.returncode:
            sys.exit(
                f"{' '.join(map(str, command))} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
            )

    def caught(self, bug: Bug) -> str:
        """Put a bug in, run its tests, take it out; return the test that saw it, or nothing."""
        path = self.sources / SOURCE / bug.file
        right = path.read_text()
        if right.count(bug.old) != 1:
            sys.exit(f"{bug.name}: {right.count(bug.old)} times in {bug.file}: {bug.old!r}")
        path.write_text(right.replace(bug.old, bug.new))
        try:
            self.make()
            done = subprocess.run(
                [
                    sys.executable,
                    "-m",
                    "pytest",
                    "-xq",
                    "-p",
                    "no:cacheprovider",
                    *bug.tests.split(),
                ],
                cwd=self.sources,
                env=self.environment,
                capture_output=True,
                text=True,
            )
        finally:
            path.write_text(right)
        failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
        return failed[0].split(" - ")[0].split("::")[-1] if done.returncode == 1 and failed else ""


def _no_rubbish(_: str, names: list[str]) -> set[str]:
    return {name for name in names if name in ("__pycache__", "lib") or name.endswith(".png")}


def main() -> int:
    """Return 0 if every bug is caught."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", help="bugs whose name holds one of these; all without")
    parser.add_argument("--folder", type=Path, help="keep copy and build here, for another time")
    given = parser.parse_args()
    bugs = [b for b in BUGS if not given.names or any(name in b.name for name in given.names)]
    table, missed = Table("bug", "file", "caught by"), 0
    with tempfile.TemporaryDirectory() as scratch:
        tree = Tree(given.folder or Path(scratch))
        for bug in bugs:
            seen = tree.caught(bug)
            missed += not seen
            table.add_row(bug.name, bug.file, seen or "[red]nobody[/]")
            print(f"{bug.name}: {seen or 'nobody'}", flush=True)
    Console().print(table)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
