"""The cases of cloth on cloth in full, small: within their limits, on ranks and by every scheme."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.trajectory import Trajectory
from sphcloth.validation import compare_schemes, validate
from sphcloth.validation.validate import Result

pytest.importorskip("ipctk", reason="pip install 'sphcloth[oracle]'")

SMALL = {
    "collision": {"time": "0.1"},
    "drape": {"across": "8", "time": "0.2"},
    "incline": {"time": "0.15", "across": "5"},
    "knot": {"time": "0.2"},
    "pressed": {"time": "0.2", "sheets": "2"},
    "stack": {"sheets": "2", "across": "7", "load": "1", "time": "0.2"},
    "twist": {"time": "0.15"},
}
# beyond its limit by chance, and by how much at most: parts come nearer than half of the thickness,
# and never meet
MISSED = {"twist": {"missing": 0.8}}
# ends within round-off of one another: the way to the end multiplies it
SAME = 1e-9


def run(name: str, out: Path, ranks: int = 1, **settings: str) -> Result:
    console = Console(file=io.StringIO())
    given = SMALL[name] | settings
    return validate.validate(validate.find_case(name), given, ranks, True, out, console)


@pytest.mark.parametrize("name", SMALL)
def test_a_small_case_of_cloth_on_cloth_is_within_its_limits(tmp_path: Path, name: str) -> None:
    result = run(name, tmp_path)
    failed = {key: each.value for key, each in result.metrics.items() if each.passed is False}
    assert all(value < MISSED.get(name, {}).get(key, 0) for key, value in failed.items()), failed


@pytest.mark.parametrize("ranks", [2, 4])
def test_sheets_that_met_are_where_they_are_on_one_rank(tmp_path: Path, ranks: int) -> None:
    ends = []
    for n in (1, ranks):
        run("collision", tmp_path / str(n), n)
        trajectory = Trajectory(tmp_path / str(n) / "run" / "collision.lammpstrj")
        ends.append(trajectory[-1].positions)
    assert np.max(np.abs(ends[1] - ends[0])) < SAME


def test_every_scheme_keeps_cloth_out_of_cloth(tmp_path: Path) -> None:
    case, console = validate.find_case("collision"), Console(file=io.StringIO())
    found = compare_schemes.compare_schemes(case, SMALL["collision"], 1, True, tmp_path, console)
    assert found.passed, found.rows()


def test_repeats_take_the_next_seeds_and_the_worst_counts(tmp_path: Path) -> None:
    result = run("collision", tmp_path, repeats="2", jitter="0.1", time="0.03")
    starts = [
        Trajectory(tmp_path / label / "collision.lammpstrj")[0].positions
        for label in ("run", "run1")
    ]
    assert np.any(starts[0] != starts[1])
    assert result.metrics["frames"].value == 2 * 31
