"""Thermo output: runs joined, rows lost to an early end tolerated, steps turned into times."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable, error_lines

FIRST_RUN = """\
LAMMPS (22 Jul 2025)
---
keywords: ['Step', 'Time', 'Dt', 'v_fluid', ]
data:
  - [0, 0, 1e-05, 10, ]
  - [100, 0.001, 2e-05, 20, ]
...
Loop time of 1.5 on 2 procs for 100 steps with 20 atoms
"""
SECOND_RUN = """\
---
keywords: ['Step', 'Time', 'Dt', 'v_fluid', ]
data:
  - [100, 0.001, 2e-05, 20, ]
  - [200, 0.004, 4e-05, 30, ]
...
Loop time of 0.5 on 2 procs for 100 steps with 30 atoms
"""


def read(tmp_path: Path, text: str) -> ThermoTable:
    path = tmp_path / "log.lammps"
    path.write_text(text)
    return ThermoTable.read(path)


def test_runs_are_joined_without_the_repeated_row(tmp_path: Path) -> None:
    table = read(tmp_path, FIRST_RUN + SECOND_RUN)
    assert table["Step"].tolist() == [0, 100, 200]
    assert table["v_fluid"].tolist() == [10, 20, 30]
    assert table.loop_seconds == 2.0


def test_each_run_has_its_own_rows_and_wall_time(tmp_path: Path) -> None:
    stopped = SECOND_RUN[: SECOND_RUN.index("...")]
    for text, seconds in (
        (FIRST_RUN + SECOND_RUN, [1.5, 0.5]),
        (FIRST_RUN + stopped, [1.5, 0.0]),
        (FIRST_RUN.replace("Loop", "# Loop") + SECOND_RUN, [0.0, 0.5]),
    ):
        runs = read(tmp_path, text).runs
        assert [run["Step"].tolist() for run in runs] == [[0, 100], [100, 200]]
        assert [run.loop_seconds for run in runs] == seconds
        assert ThermoTable.read(tmp_path / "log.lammps", last_run=True).loop_seconds == seconds[-1]


def test_exponents_without_a_point_are_numbers(tmp_path: Path) -> None:
    assert read(tmp_path, FIRST_RUN)["Dt"].tolist() == [1e-5, 2e-5]


def test_a_column_of_one_run_is_nan_in_the_others(tmp_path: Path) -> None:
    renamed = SECOND_RUN.replace("v_fluid", "v_other")
    table = read(tmp_path, FIRST_RUN + renamed)
    np.testing.assert_array_equal(table["v_fluid"], [10, 20, np.nan])
    np.testing.assert_array_equal(table["v_other"], [np.nan, np.nan, 30])


@pytest.mark.parametrize("cut", ["...\n", " 30, ]\n...\n"])
def test_an_unfinished_run_gives_its_complete_rows(tmp_path: Path, cut: str) -> None:
    text = FIRST_RUN + SECOND_RUN
    table = read(tmp_path, text[: text.rindex(cut)])
    assert table["Step"].tolist() == ([0, 100, 200] if cut == "...\n" else [0, 100])


def test_a_run_cut_before_its_first_row_leaves_the_one_before(tmp_path: Path) -> None:
    for cut in ("data:", "keywords:", "---"):
        table = read(tmp_path, FIRST_RUN + SECOND_RUN[: SECOND_RUN.index(cut)] + cut)
        assert table["Step"].tolist() == [0, 100]


def test_time_is_exact_at_rows_linear_between_and_goes_on_past_the_end(tmp_path: Path) -> None:
    times = read(tmp_path, FIRST_RUN + SECOND_RUN).time_at([0, 50, 100, 150, 200, 210])
    np.testing.assert_allclose(times, [0, 0.0005, 0.001, 0.0025, 0.004, 0.0043], rtol=1e-14)


def test_times_of_rows_are_exact_to_the_last_bit() -> None:
    rows, times = np.array([0.0, 49, 98, 200]), np.array([0.0, 1.0, 1.1, 3.0])
    table = ThermoTable({"Step": rows, "Time": times}, 0.0)
    assert 49 * (1 / 49) < 1
    np.testing.assert_array_equal(table.time_at(rows), times)
    outside = 2 * rows[[0, -1]] - rows[[1, -2]]
    expected = 2 * times[[0, -1]] - times[[1, -2]]
    np.testing.assert_allclose(table.time_at(outside), expected, rtol=1e-12)


def test_time_of_one_row_is_known_there_only(tmp_path: Path) -> None:
    table = read(tmp_path, FIRST_RUN.replace("  - [100, 0.001, 2e-05, 20, ]\n", ""))
    np.testing.assert_array_equal(table.time_at([0, 1]), [0, np.nan])


def test_steps_that_go_back_have_no_time(tmp_path: Path) -> None:
    table = read(tmp_path, FIRST_RUN + SECOND_RUN.replace("[100,", "[0,"))
    with pytest.raises(UserError, match="goes back"):
        table.time_at([50])


def test_a_log_without_thermo_output_says_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="thermo_modify line yaml"):
        read(tmp_path, "LAMMPS (22 Jul 2025)\nERROR: Unknown command: rum 10\n")
    assert error_lines(tmp_path / "log.lammps") == ["ERROR: Unknown command: rum 10"]


def test_an_echo_of_the_script_is_no_error(tmp_path: Path) -> None:
    log = tmp_path / "log.lammps"
    log.write_text("""if "foo != bar" then "print 'ERROR: no bar'" quit\nERROR: no bar\n""")
    assert error_lines(log) == ["ERROR: no bar"]


@pytest.mark.parametrize("more", [b"---\n...\n", b"\xff\n", b"Step Temp\n1 2\n3 x\n"])
def test_errors_are_found_whatever_else_a_log_holds(tmp_path: Path, more: bytes) -> None:
    log = tmp_path / "log.lammps"
    log.write_bytes(b"  ERROR: it broke\n" + more + b"exited on signal 9\n")
    assert error_lines(log) == ["ERROR: it broke", "exited on signal 9"]


@pytest.mark.parametrize(
    "other", ["--\nLoop time of 0.1 on 1 procs\n", "Step Temp\n1 2\n", "------ Step 1\n"]
)
def test_lines_that_are_not_thermo_output_are_passed_over(tmp_path: Path, other: str) -> None:
    table = read(tmp_path, other + FIRST_RUN + other + SECOND_RUN)
    assert table["Step"].tolist() == [0, 100, 200]
    with pytest.raises(UserError, match="no thermo output"):
        read(tmp_path, other)


def test_an_unknown_column_names_those_there_are(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no thermo column v_none: .* Step Time Dt v_fluid"):
        read(tmp_path, FIRST_RUN)["v_none"]
