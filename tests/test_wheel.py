"""The wheel is complete: put together of what is installed here, it runs in a fresh environment.

``make wheel-check`` compiles for all releases, and installs everything.
"""

import platform
import re
import sys
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from sphcloth.plugin import LIBRARIES, PLUGIN, WHEELS, lammps_release

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "packaging"))

import check_wheel  # noqa: E402
import make_wheels  # noqa: E402


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    site = folder / "site/sphcloth"
    site.mkdir(parents=True)
    for name in ("lib", "examples"):
        (site / name).symlink_to(LIBRARIES.parent / name)
    pure = make_wheels.without_libraries(folder / "pure")
    return make_wheels.complete(pure, folder / "site", platform.machine(), folder / "complete")


def test_it_works_where_nothing_else_of_sphcloth_is(wheel, tmp_path, capfd):
    check_wheel.quick_check(wheel, tmp_path)
    assert "all registered" in capfd.readouterr().out
    assert (tmp_path / "pour_2/summary.json").is_file()


def test_it_has_a_plugin_examples_and_the_right_requirement(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        info = next(name for name in names if name.endswith("/METADATA"))
        metadata = archive.read(info).decode()
    assert wheel.name.endswith(f"-py3-none-linux_{platform.machine()}.whl")
    assert f"sphcloth/lib/{lammps_release()}/{PLUGIN}" in names
    assert "sphcloth/examples/pour/in.pour" in names
    assert re.search(r"^Requires-Dist: lammps\[mpi\].*$", metadata, re.M)[0].endswith(
        make_wheels.fits()
    )


@pytest.mark.parametrize(
    ("tags", "runs"),
    [
        ("manylinux_2_27_x86_64.manylinux_2_28_x86_64", True),
        ("manylinux_2_27_aarch64", True),
        ("manylinux_2_28_aarch64", True),
        ("manylinux_2_31_aarch64", False),
        ("linux_aarch64", False),
    ],
)
def test_a_wheel_for_older_libraries_runs_on_newer_ones(tags, runs):
    assert make_wheels.runs_on(f"sphcloth-0.1.0-py3-none-{tags}.whl", "manylinux_2_28") == runs


def test_updates_of_a_release_fit_and_other_releases_do_not():
    fits = Requirement(make_wheels.fits()).specifier
    for release in WHEELS.values():
        assert release in fits
    assert "2025.7.22.9.0" in fits
    assert "2023.8.2.3.1" not in fits and "2025.9.10.0.0" not in fits


def test_the_builder_says_which_line_it_did_not_find(tmp_path):
    (tmp_path / "WHEEL").write_text("Wheel-Version: 1.0\n")
    with pytest.raises(SystemExit, match="0 lines of WHEEL match"):
        make_wheels.edit(tmp_path / "WHEEL", r"^Tag: .*$", "Tag: py3-none-any")
