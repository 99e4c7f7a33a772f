"""Settings of an example against half the spacing."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sphcloth.errors import UserError
from sphcloth.validation import halves
from sphcloth.validation.runner import Run

SHORT = {"t_end": "0.1", "frames": "4", "spacing": "0.1", "mesh": "0.1"}


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list]:
    out = tmp_path_factory.mktemp("halves")
    return out, halves.study(
        "cloth_on_water", "tiny", SHORT, {"density": ("summation", "calibrated")}, out
    )


def test_each_setting_has_a_row_and_the_fine_run_has_no_error(rows: tuple[Path, list]) -> None:
    out, found = rows
    assert [row["density"] for row in found] == ["summation", "calibrated"]
    assert json.loads((out / "halves.json").read_text()) == found
    fine = Run(out / "half", "cloth_on_water")
    against_itself = halves.compare(fine, halves.course(fine), 0.1)
    assert [against_itself[name] for name in halves.QUANTITIES] == [0.0] * 5
    assert len(fine.trajectory[0]) > 4 * len(Run(out / "summation", fine.name).trajectory[0])


def test_errors_are_rms_over_the_frames_in_spacings(rows: tuple[Path, list]) -> None:
    run = Run(rows[0] / "calibrated", "cloth_on_water")
    course = halves.course(run)
    frame = run.trajectory[-1]
    water = frame.types == 1
    assert course["water, height"][-1] == pytest.approx(frame.positions[water, 2].mean())
    assert course["cloth, along"][-1] == pytest.approx(frame.positions[~water, 0].mean())
    speeds = np.linalg.norm(frame.velocities[water], axis=1)
    assert course["kinetic energy"][-1] == pytest.approx(np.mean(speeds**2) / 2)
    higher = course | {"water, height": course["water, height"] + 0.03}
    found = halves.compare(run, higher, 0.1)
    assert found["water, height"] == pytest.approx(0.3)
    assert found["cloth, height"] == 0.0


def test_water_at_rest_stays_at_rest_where_its_density_is_calibrated(
    rows: tuple[Path, list],
) -> None:
    """A lattice that is summed has the wrong pressure at the walls, and sets itself in motion."""
    summed, calibrated = rows[1]
    assert calibrated["kinetic energy"] < 0.2 * summed["kinetic energy"]
    assert calibrated["largest compression"] < 0.5 * summed["largest compression"]


def test_runs_with_other_frames_are_not_compared(rows: tuple[Path, list]) -> None:
    run = Run(rows[0] / "calibrated", "cloth_on_water")
    fewer = {name: values[1:] for name, values in halves.course(run).items()}
    with pytest.raises(UserError, match="frames, the fine run"):
        halves.compare(run, fewer, 0.1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hammock"], "hammock has a source"),
        (["banner"], "banner has no water"),
        (["nothing"], "no example 'nothing'"),
        (["curtain", "--vary", "depth=1,2"], "no variable 'depth'"),
        (["curtain", "--size", "huge"], "no size 'huge'"),
        (["curtain", "--vary", "density"], "--vary density: expected NAME=A,B,..."),
    ],
)
def test_what_cannot_be_compared_is_an_error(
    arguments: list[str], message: str, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "sphcloth.validation.halves", *arguments]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert message in done.stderr
    assert not done.stdout
