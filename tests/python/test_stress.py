"""Some cases of the stress test, and that each check sees a breach.  `make stress` runs all."""

import json
import os
import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import make_frame, square_sheet
from typer.testing import CliRunner

from sphcloth.cli import app
from sphcloth.stress import case as checks
from sphcloth.stress import command
from sphcloth.stress.case import SCHEMES, Case, Outcome
from sphcloth.stress.cases import all_cases
from sphcloth.stress.runner import run_case, run_script

SOME = [
    ("impact-3-normal", "constant", 2),
    ("sliver", "individual", 1),
    ("one-link", "constant", 2),
    ("nan-in-water", "constant", 1),
    *((name, "global", 1) for name, case in all_cases().items() if "global" in case.schemes),
]


@pytest.mark.parametrize(("name", "scheme", "ranks"), SOME)
def test_an_extreme_does_what_it_must(name, scheme, ranks, tmp_path):
    found = list(run_case(all_cases()[name], [scheme], [ranks], True, tmp_path))
    assert [verdict.complaints for verdict in found] == [[]]


def test_every_extreme_says_what_must_happen():
    for name, case in all_cases().items():
        assert case.script.is_file() and case.must and case.name == name
        assert set(case.schemes) <= set(SCHEMES)


# ---- a breach is seen: frames of a good run, and one thing wrong ---------------------------------

MESH, FLAT = square_sheet(4)


def outcome(*frames, code=0, text="", scheme="global", log=None):
    made = Outcome(None, {"scheme": scheme}, code, text)
    # as if they had been read
    vars(made).update(frames=[with_mass(f) for f in frames], mesh=MESH, log=Log(log or {}))
    return made


class Log:
    """The columns of a thermo table."""

    def __init__(self, columns):
        self.columns = {name: np.array(values, float) for name, values in columns.items()}

    def __getitem__(self, name):
        return self.columns[name]


def with_mass(frame, v=(0.0, 0.0, 1.0)):
    more = dict(zip(("vx", "vy", "vz"), np.outer(v, np.ones(len(frame))), strict=True))
    ones = np.ones(len(frame))
    return replace(frame, columns={"mass": ones, "rho": 1000 * ones} | more | frame.columns)


def at(z, step=0, **columns):
    frame = make_frame(step, [[0.5, 0.5, z]], FLAT)
    given = {name: np.full(len(frame), value) for name, value in columns.items()}
    return replace(frame, columns=frame.columns | given)


GOOD = outcome(at(0.1), at(0.2, 1), at(0.2, 2), log={"Dt": [1e-3, 1e-3], "Atoms": [3, 3]})
SEEN = {
    "nan": (checks.is_finite, outcome(at(0.1, vx=np.nan), log={})),
    "nan in the log": (checks.is_finite, outcome(at(0.1), log={"Dt": [np.inf]})),
    "crossed": (checks.nothing_crosses, outcome(at(0.1), at(-0.1, 1))),
    "lost": (checks.nothing_lost, outcome(at(0.1), make_frame(1, [], FLAT))),
    "momentum": (checks.momentum(1e-9), outcome(at(0.1), at(0.1, 1), at(0.1, 2, vx=1e-8))),
    "center": (checks.center_stays(1e-9), outcome(at(0.1), at(0.1 + 1e-7, 1))),
    "column": (checks.column("Dt", 0, 2e-3), outcome(at(0.1), log={"Dt": [1e-3, 3e-3]})),
    "last row": (checks.column("Dt", 2, 3, last=True), outcome(at(0.1), log={"Dt": [2.5, 1.0]})),
    "density": (checks.compressed_by(0.1), outcome(at(0.1, rho=1101.0))),
    "speed": (checks.speed_below(2.0), outcome(at(0.1), at(0.1, 1, vy=2.0))),
    "strain": (
        checks.strain_below(1e-3, 1e-3),
        outcome(at(0.1), log={"Dt": [1e-3, 8e-3], "v_strain": [0.0, 0.017]}),
    ),
    "moved": (checks.stays_where_it_is(1, 1e-6), outcome(at(0.1), at(0.1 + 1e-5, 1))),
}


@pytest.mark.parametrize(("check", "bad"), SEEN.values(), ids=SEEN)
def test_a_check_sees_its_breach_and_nothing_else(check, bad):
    assert check(bad)
    if "Dt" not in bad.log.columns:
        assert check(GOOD) == "" or check.__name__ in ("nothing_moves", "it_stays")


CASE = Case("none", "nothing", "sheet", ())
WRONG = {
    "hung": (CASE, replace(GOOD, code=None), "did not end in time"),
    "crash": (CASE, replace(GOOD, code=-11), "code -11"),
    "error": (CASE, replace(GOOD, code=1, text="ERROR: Lost atoms"), "Lost atoms"),
    "no error": (replace(CASE, error="fix step"), GOOD, "without the error"),
    "another error": (
        replace(CASE, error="fix step"),
        replace(GOOD, code=1, text="ERROR: Lost atoms"),
        "Lost atoms",
    ),
    "crash for an error": (
        replace(CASE, error="fix step"),
        replace(GOOD, code=-6, text="ERROR: fix step"),
        "code -6",
    ),
}


@pytest.mark.parametrize(("case", "ended", "complaint"), WRONG.values(), ids=WRONG)
def test_a_wrong_end_is_a_breach(case, ended, complaint):
    assert complaint in case.complaints(ended, None)[0]


def test_an_error_may_be_allowed():
    end = replace(GOOD, code=1, text="ERROR: fix step sph/integrate: below min")
    assert replace(CASE, or_error="below min").complaints(end, None) == []
    assert replace(CASE, error="below min").complaints(end, None) == []


def test_another_result_on_ranks_is_a_breach():
    there = outcome(at(0.1), at(0.2, 1), at(0.2 + 1e-6, 2), log={})
    assert CASE.complaints(GOOD, GOOD) == []
    assert "from where it is on one rank" in CASE.complaints(there, GOOD)[0]
    fewer = outcome(at(0.1), make_frame(2, [], FLAT), log={})
    assert "on one rank" in CASE.complaints(fewer, GOOD)[0]


def test_what_one_rank_says_last_is_not_lost(monkeypatch, tmp_path):
    """Of ranks that let each other pass on one core two of three lost it, before they waited."""
    monkeypatch.setenv("MPIR_CVAR_ENABLE_HEAVY_YIELD", "0")
    case = all_cases()["nan-in-cloth"]
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        for _ in range(4):
            ended = run_script(case.script, tmp_path / "run", case.settings, 2)
            assert re.search(case.error, ended.text), ended.text
    finally:
        os.sched_setaffinity(0, cores)


def test_exit_code_and_json(monkeypatch, tmp_path):
    good = replace(all_cases()["one-link"], schemes=("global",), ranks=(1,))
    bad = replace(good, name="bad", error="an error that never comes")
    monkeypatch.setattr(command, "all_cases", lambda: {"one-link": good, "bad": bad})
    file = tmp_path / "stress.json"
    for name, code in (("one-link", 0), ("bad", 1)):
        done = CliRunner().invoke(app, ["stress", name, "--ranks", "1", "--json", str(file)])
        assert done.exit_code == code, done.output
        found = json.loads(file.read_text())
        assert found["passed"] == (code == 0) and found["breaches"] == code
    assert "without the error" in done.output


def test_what_was_found_is_there_when_the_rest_fails(monkeypatch, tmp_path):
    one = replace(all_cases()["one-link"], schemes=("global",), ranks=(1,))
    none = replace(one, name="none", scene="none")
    monkeypatch.setattr(command, "all_cases", lambda: {"one-link": one, "none": none})
    file = tmp_path / "stress.json"
    done = CliRunner().invoke(app, ["stress", "--ranks", "1", "--json", str(file)])
    assert isinstance(done.exception, FileNotFoundError)
    assert [run["case"] for run in json.loads(file.read_text())["runs"]] == ["one-link"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none-such"], "no case 'none-such': choose from stiffness-0"),
        (["--scheme", "local"], "--scheme local: choose from constant"),
        (["--ranks", "0"], "--ranks 0: expected whole numbers above 0"),
        (["--ranks", "two"], "--ranks two: expected"),
    ],
)
def test_wrong_use(words, message):
    done = CliRunner().invoke(app, ["stress", *words])
    assert message in str(done.exception)
