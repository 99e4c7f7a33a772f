"""What the comparison of a log with the reference log lets pass, and what it does not."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import reference_logs
from reference_logs import (
    CHAOTIC,
    LOGS,
    NUDGED,
    RUNS,
    TIMES,
    apart,
    chaotic,
    columns,
    compare,
    event,
    log_of,
    logs_of,
    nudged,
    off,
    rows_beside,
    way_of,
)

from sphcloth.examples import find_example

EXAMPLE = "curtain"


@pytest.fixture(autouse=True)
def examples(tmp_path_factory, monkeypatch):
    """Logs that a test may add to: a copy, without one of a nudged run."""
    folder = tmp_path_factory.mktemp("examples")
    for log in reference_logs.EXAMPLES.glob("*/log.*"):
        (folder / log.parent.name).mkdir(exist_ok=True)
        shutil.copy(log, folder / log.parent.name)
    monkeypatch.setattr(reference_logs, "EXAMPLES", folder)
    log_of(EXAMPLE, NUDGED[0]).unlink(missing_ok=True)


@pytest.fixture
def changed(tmp_path):
    """Return a function that writes the reference log with one number of a column changed."""

    def write(column: str, row: int, change: float) -> Path:
        text = log_of(EXAMPLE, "1").read_text()
        names = re.search(r"^keywords: \[(.*)\]", text, re.M)[1].replace("'", "").split(", ")
        rows = list(re.finditer(r"^  - \[(.*)\]$", text, re.M))
        words = rows[row][1].split(", ")
        words[names.index(column)] = f"{float(words[names.index(column)]) + change:.17g}"
        log = tmp_path / "log.lammps"
        log.write_text(text[: rows[row].start(1)] + ", ".join(words) + text[rows[row].end(1) :])
        return log

    return write


def scale(column: str) -> float:
    return np.nanmax(np.abs(columns(log_of(EXAMPLE, "1"))[column]))


@pytest.mark.parametrize("example", RUNS)
@pytest.mark.parametrize("which", LOGS)
def test_reference_logs_are_like_themselves(example, which):
    log = log_of(example, which)
    if log.exists():
        share, where = apart(log, example)
        assert share <= 1.0 / TIMES, where


@pytest.mark.parametrize("example", RUNS)
def test_an_example_has_its_logs_and_no_others(example):
    folder = Path(__file__).parents[1] / "examples" / example
    expected = {log_of(example, which).name for which in logs_of(example)}
    assert {path.name for path in folder.glob("log.22Jul2025.*")} == expected
    assert len(expected) == 2 + CHAOTIC.get(example, 1)


@pytest.mark.parametrize(("row", "allowed"), [(2, 0), (-1, 1)])
def test_what_is_more_than_allowed_differs(changed, row, allowed):
    """Early rows must agree better than late ones."""
    limit = reference_logs.ALIKE[allowed] * scale("v_fluid")
    assert compare(changed("v_fluid", row, 0.9 * limit), EXAMPLE, "1", alike=True)
    assert not compare(changed("v_fluid", row, 1.1 * limit), EXAMPLE, "1", alike=True)


def test_a_number_that_is_none_differs(changed):
    assert not compare(changed("v_fluid", 5, np.nan), EXAMPLE, "1", alike=True)


def test_a_row_that_is_missing_differs(tmp_path):
    log = shorter(log_of(EXAMPLE, "1"), tmp_path / "log.lammps")
    rows = len(columns(log_of(EXAMPLE, "1"))["Step"])
    assert apart(log, EXAMPLE) == (np.inf, f"rows: {rows - 1}, not {rows}")


def shorter(log: Path, copy: Path) -> Path:
    """Copy a log without its last row."""
    text = log.read_text()
    copy.write_text(text.replace(re.findall(r"^  - .*\n", text, re.M)[-1], ""))
    return copy


def test_what_a_nudge_changes_is_allowed_from_then_on(changed):
    """And a row before, as rows are far apart."""
    change = 100 * reference_logs.ALIKE[1] * scale("v_fluid")
    assert not compare(changed("v_fluid", 8, change), EXAMPLE, "1", alike=True)
    shutil.copy(changed("v_fluid", 8, 0.11 * change), log_of(EXAMPLE, NUDGED[0]))
    for row in (7, 8, 12):
        assert compare(changed("v_fluid", row, change), EXAMPLE, "1", alike=True)
    assert not compare(changed("v_fluid", 6, change), EXAMPLE, "1", alike=True)
    assert not compare(changed("v_fluid", 8, 1.2 * change), EXAMPLE, "1", alike=True)
    assert not compare(changed("v_strain", 8, 0.1 * scale("v_strain")), EXAMPLE, "1", alike=True)


def test_where_a_nudge_changes_the_number_of_rows_it_may_differ(tmp_path):
    short = shorter(log_of(EXAMPLE, "1"), tmp_path / "log.lammps")
    shutil.copy(short, log_of(EXAMPLE, NUDGED[0]))
    assert apart(short, EXAMPLE)[0] <= 1.0
    for _ in range(TIMES - 1):
        shorter(short, short)
    assert apart(short, EXAMPLE)[0] <= 1.0
    assert apart(shorter(short, short), EXAMPLE)[0] == np.inf


def test_where_steps_move_by_one_a_row_has_what_the_next_has():
    """Rows are ten steps of 0.1 apart; from the fourth row on a nudge moves them by a share."""
    steps = np.array([10.0 * np.arange(8)] * 2)
    times = 0.1 * steps
    beside = {}
    for share in (0.9, 1.1, 25.0):
        times[1, 4:] = times[0, 4:] + 0.1 * share
        beside[share] = rows_beside(steps, times)
    assert beside[0.9].tolist() == [0] * 8
    assert beside[1.1].tolist() == [0, 0, 0, 1, 1, 1, 1, 1]  # with a row to spare
    assert beside[25.0].tolist() == [0, 0, 0, 3, 3, 3, 3, 3]
    poured = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 9.0, 9.0, 9.0])
    known = np.array([poured, poured])
    for later, allowed in ((-1, True), (1, True), (-2, False), (2, False)):
        ours = np.interp(np.arange(8) - later, np.arange(8), poured)
        assert (off(ours, known, beside[1.1]).max() <= 1.0) == allowed
    assert off(np.roll(poured, -1), known, beside[0.9]).max() > 1.0


def test_where_logs_are_chaotic_an_event_may_come_at_any_time():
    """A count may then differ by what events may, though all logs still have the same."""
    late = np.array([[0, 0, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 1, 1]])
    never = np.zeros((2, 8))
    drifts = 1.0 + np.array([0, 0, 0, 2, 2, 2, 2, 2]) * np.array([[0.0], [reference_logs.ALIKE[1]]])
    steady = np.tile(np.arange(8.0), (2, 1))
    assert chaotic([drifts, steady, steady, steady]).tolist() == [False] * 2 + [True] * 6
    assert not chaotic([drifts, *[steady] * 4]).any()
    assert (event(late), event(9.5 * late), event(never), event(steady)) == (1, 9.5, 0, 0)
    assert event(steady + 1e-12 * np.arange(2)[:, None]) == 0
    beside, none = np.zeros(8, int), np.zeros(8)
    early = np.array([0, 0, 1, 1, 1, 1, 1, 1])
    assert off(early, late, beside, event(late) * np.ones(8)).max() <= 1.0
    assert off(early, late, beside, none).max() > 1.0
    assert off(early, never, beside, event(never) * np.ones(8)).max() > 1.0
    assert off(TIMES * 1.1 * early, late, beside, event(late) * np.ones(8)).max() > 1.0


@pytest.mark.parametrize("example", RUNS)
def test_a_nudge_displaces_before_the_first_run(example):
    script = find_example(example).script.read_text()
    before, told, after = nudged(script).partition("variable nudge_x")
    told, line, after = after.partition("displace_atoms all move v_nudge_x v_nudge_y v_nudge_z")
    assert line and told.count("variable") == 2
    units, _, rest = after.partition("\n")
    assert units == " units box" and before + rest == script
    assert re.match(r"run\s", rest) and not re.search(r"^run\s", before, re.MULTILINE)


@pytest.mark.parametrize("which", NUDGED)
def test_a_nudge_changes_digits_and_little_else(tmp_path, which):
    before = find_example("banner").script.read_text()
    log = reference_logs.run_nudged("banner", which, tmp_path / "run")
    assert find_example("banner").script.read_text() == before
    ours, reference = columns(log), columns(log_of("banner", "1"))
    assert ours["c_corner"] != reference["c_corner"]
    assert ours["c_corner"] == pytest.approx(reference["c_corner"], rel=1e-4)


def test_nudges_differ():
    assert len({nudged("run 1\n", which) for which in NUDGED}) == len(NUDGED)


def test_a_script_without_a_run_is_no_use():
    with pytest.raises(ValueError, match="begins with 'run'"):
        nudged("units si\n")


def test_ways_to_nudge_are_numbered():
    ways = ("nudged", "nudged2", "nudged12", "nudged1", "1", "4")
    assert [way_of(which) for which in ways] == [1, 2, 12, 0, 0, 0]
    script = "run 1\n"
    assert "random(0,1,1)" in nudged(script) and "random(0,1,12)" in nudged(script, "nudged4")
    assert len({nudged(script, f"nudged{way}") for way in range(2, 12)}) == 10
