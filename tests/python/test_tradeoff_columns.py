"""Columns that a trade-off asks for are looked for before its first run."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console
from test_tradeoff import SPRING, plan

from sphcloth.errors import UserError
from sphcloth.tradeoff.command import all_scenes, find_scene
from sphcloth.tradeoff.runs import Workshop
from sphcloth.tradeoff.study import all_settings, study


@pytest.fixture
def spring(tmp_path: Path) -> Path:
    script = tmp_path / "in.spring"
    script.write_text(SPRING)
    return script


@pytest.fixture
def quiet() -> Console:
    return Console(file=io.StringIO())


def test_a_column_that_is_missing_is_missed_before_the_first_run(
    spring: Path, tmp_path: Path, quiet: Console
) -> None:
    scene = find_scene(str(spring), ["v_none"], last_run=False)
    wish = plan(vary={"dt": ("0.1",)}, reference={"dt": "0.001"})
    with pytest.raises(UserError, match="no thermo column v_none: the log has Step Time"):
        study(scene, wish, tmp_path, quiet)
    assert not list(tmp_path.rglob("result.json"))


def test_a_column_that_comes_later_is_not_missed(
    spring: Path, tmp_path: Path, quiet: Console
) -> None:
    more = "variable y equal v_x\nthermo_style custom step time v_y\nthermo_modify line yaml\n"
    spring.write_text(f"{SPRING}{more}run 20\n")
    scene = find_scene(str(spring), ["v_y"], last_run=True)
    wish = plan(vary={"dt": ("0.1",)}, reference={"dt": "0.01"}, settings={"last": "0.1"})
    workshop = Workshop(scene, tmp_path / "runs", 1, 1, quiet)
    workshop.check_columns(all_settings(scene, wish)[0])


def test_packaged_scenes_can_be_looked_at() -> None:
    assert all(scene.has_one_table for scene in all_scenes().values())
