"""The trade-off against exact solutions: cases of sphcloth validate with many settings."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from sphcloth.cli import main
from sphcloth.errors import UserError
from sphcloth.tradeoff import exact
from sphcloth.tradeoff.exact import scene_of, settings_of, study_case
from sphcloth.tradeoff.report import show, write_all
from sphcloth.tradeoff.study import Plan, Study
from sphcloth.validation.validate import find_case

CASE = find_case("pendulum")
VARIED = {"solver": ("substeps", "gs"), "iterations": ("3", "6")}


def plan(**changes: object) -> Plan:
    usual = {"vary": VARIED, "settings": {}, "reference": {}, "error": 0.01, "quick": True}
    return Plan(schemes=(), **(usual | changes))


def run(folder: Path, **changes: object) -> Study:
    quiet = Console(file=io.StringIO(), width=100)
    return study_case(CASE, scene_of(CASE, ["period"]), plan(**changes), folder, quiet)


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Return the exit code of ``sphcloth tradeoff``."""
    monkeypatch.setattr(sys, "argv", ["sphcloth", "tradeoff", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_errors_are_what_the_case_measures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command, its files, and a validation by itself."""
    words = ["pendulum", "--exact", "--quick", "--quantity", "period"]
    words += ["--vary", "solver=substeps,gs", "--vary", "iterations=3"]
    assert call(monkeypatch, *words, "--out", str(tmp_path / "study")) == 0
    assert "solver gs" in capsys.readouterr().out
    found = json.loads((tmp_path / "study" / "pendulum.json").read_text())
    assert found["reference"] is None
    assert [point["scheme"] for point in found["points"]] == ["solver substeps", "solver gs"]
    assert [point["label"] for point in found["points"]] == ["iterations 3"] * 2
    alone = tmp_path / "alone.json"
    words = ["validate", "pendulum", "--quick", "--set", "solver=gs", "--set", "iterations=3"]
    monkeypatch.setattr(
        sys, "argv", ["sphcloth", *words, "--json", str(alone), "--out", str(tmp_path / "alone")]
    )
    with pytest.raises(SystemExit):
        main()
    metrics = json.loads(alone.read_text())["metrics"]
    last = found["points"][-1]
    assert last["errors"]["period"] == pytest.approx(abs(metrics["period"]["value"]), rel=1e-12)
    assert 0 < last["updates"] <= json.loads(alone.read_text())["particle_updates"]
    assert {file.suffix for file in (tmp_path / "study").glob("pendulum*")} == {
        ".csv",
        ".json",
        ".png",
        ".svg",
    }


def test_what_is_there_is_not_run_again_and_a_failure_is_a_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = {"solver": ("gs",)}
    (first,) = run(tmp_path, vary=one).points
    assert first.failure is None
    # from here on no case would run
    fails = (sys.executable, "-c", "import sys; sys.exit('error: no such luck')")
    monkeypatch.setattr(exact, "COMMAND", fails)
    assert run(tmp_path, vary=one).points == [first]
    study = run(tmp_path, vary={"solver": ("gs", "jacobi")})
    assert study.points[0] == first
    assert study.points[1].failure == "error: no such luck"
    text = io.StringIO()
    show(study, Console(file=text, width=120))
    assert "failed: solver jacobi" in text.getvalue()
    assert "baseline" not in text.getvalue()
    assert (tmp_path / "pendulum.csv") in write_all(study, tmp_path)


@pytest.mark.parametrize(
    ("changes", "names", "message"),
    [
        ({"vary": {}}, ["period"], "nothing to vary: give --vary"),
        ({"settings": {"solver": "gs"}}, ["period"], "--set solver: it is varied as well"),
        ({"vary": {"color": ("red",)}}, ["period"], "no parameter 'color' of pendulum"),
        ({"vary": {"solver": ("red",)}}, ["period"], "--set solver=red"),
        ({}, [], "which error of pendulum? give --quantity"),
        ({}, ["color"], "--quantity color: pendulum does not measure it"),
    ],
)
def test_a_mistake_names_what_there_is(changes: dict, names: list[str], message: str) -> None:
    with pytest.raises(UserError) as error:
        settings_of(CASE, plan(**changes))
        scene_of(CASE, names)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--scheme", "global"], "has an exact solution and no --scheme"),
        (["--reference", "dt=1"], "has an exact solution and no --reference"),
        (["--last-run"], "no use for --last-run"),
    ],
)
def test_options_of_scenes_are_refused(
    words: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    usual = ["pendulum", "--exact", "--quantity", "period", "--vary", "solver=gs"]
    assert call(monkeypatch, *usual, *words) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_case_is_asked_to_end_before_it_is_killed(tmp_path: Path) -> None:
    """So that it can end the LAMMPS that it has started."""
    script = (
        "import signal, sys, time\n"
        "def end(*_):\n    open('ended', 'w').close()\n    sys.exit(1)\n"
        "signal.signal(signal.SIGTERM, end)\n"
        "print('ready', flush=True)\n"
        "time.sleep(600)\n"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    assert child.stdout is not None
    child.stdout.readline()
    exact._end(child)
    assert child.returncode == 1
    assert (tmp_path / "ended").exists()
