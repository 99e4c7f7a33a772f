"""What the comparison of a log with the reference log lets pass, and what it does not."""

import re
from pathlib import Path

import numpy as np
import pytest
import reference_logs
from reference_logs import RUNS, TIMES, apart, columns, compare, log_of

EXAMPLE = "curtain"


@pytest.fixture
def changed(tmp_path):
    """Return a function that writes the reference log with one number of a column changed."""

    def write(column: str, row: int, change: float) -> Path:
        text = log_of(EXAMPLE, 1).read_text()
        names = re.search(r"^keywords: \[(.*)\]", text, re.M)[1].replace("'", "").split(", ")
        rows = list(re.finditer(r"^  - \[(.*)\]$", text, re.M))
        words = rows[row][1].split(", ")
        words[names.index(column)] = f"{float(words[names.index(column)]) + change:.17g}"
        log = tmp_path / "log.lammps"
        log.write_text(text[: rows[row].start(1)] + ", ".join(words) + text[rows[row].end(1) :])
        return log

    return write


def scale(column: str) -> float:
    return np.nanmax(np.abs(columns(log_of(EXAMPLE, 1))[column]))


@pytest.mark.parametrize("example", RUNS)
@pytest.mark.parametrize("ranks", [1, 4])
def test_reference_logs_are_like_themselves(example, ranks):
    share, where = apart(log_of(example, ranks), example)
    assert share <= 1.0 / TIMES, where


@pytest.mark.parametrize(("row", "allowed"), [(5, 0), (-1, 1)])
def test_what_is_more_than_allowed_differs(changed, row, allowed):
    """Early rows must agree better than late ones."""
    limit = reference_logs.ALIKE[allowed] * scale("v_fluid")
    assert compare(changed("v_fluid", row, 0.9 * limit), EXAMPLE, 1, alike=True)
    assert not compare(changed("v_fluid", row, 1.1 * limit), EXAMPLE, 1, alike=True)


def test_a_number_that_is_none_differs(changed):
    assert not compare(changed("v_fluid", 5, np.nan), EXAMPLE, 1, alike=True)


def test_a_row_that_is_missing_differs(tmp_path):
    log = tmp_path / "log.lammps"
    text = log_of(EXAMPLE, 1).read_text()
    log.write_text(text.replace(re.findall(r"^  - .*\n", text, re.M)[40], ""))
    assert apart(log, EXAMPLE)[0] == np.inf
