"""Packaged scenes of the trade-off, as small as they can be: what happens in them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.log import ThermoTable
from sphcloth.tradeoff.command import all_scenes
from sphcloth.tradeoff.runs import Setting, Workshop


@pytest.mark.parametrize(
    ("scheme", "values"), [("global", {}), ("block", {}), ("block", {"sleep": "0.02"})]
)
def test_a_drop_falls_into_a_pool_and_nothing_is_lost(
    scheme: str, values: dict[str, str], tmp_path: Path
) -> None:
    """It falls freely at first, is slower in the water, and spreads there."""
    scene = all_scenes()["drop-in-pool"]
    small = {"across": "8", "layers": "8", "radius": "0.05", "t_settle": "0.4", "t_fall": "0.2"}
    variables = scene.script_variables(scheme, values | small, quick=True)
    workshop = Workshop(scene, tmp_path, 1, 1, Console(file=io.StringIO()))
    setting = Setting(scheme, values, variables)
    (record,) = workshop.run([setting])
    assert record.failure is None and record.updates > 0
    table = workshop.thermo(setting)
    assert set(table["Atoms"]) == {table["Atoms"][0]} and table["Atoms"][0] > 8**3
    assert table["Time"] == pytest.approx(np.linspace(0.4, 0.6, 11), abs=1e-9)
    fallen = -np.diff(table["v_drop"])
    # kicks and drifts of steps up to 3 ms
    assert fallen[0] == pytest.approx(2.0 * 0.02 + 0.5 * 9.81 * 0.02**2, rel=0.02)
    assert fallen[-1] < 0.5 * fallen[0]
    assert table["v_spread"][-1] > 1.1 * table["v_spread"][0]
    whole = ThermoTable.read(workshop.folder(setting) / "log.lammps")
    assert whole["v_drop"][0] == 0 and whole["Atoms"][0] == 8**3


def test_a_drop_starts_with_its_speed_above_a_pool_at_rest(tmp_path: Path) -> None:
    """The speed is in m/s, whatever the spacing of the lattice of the particles."""
    scene = all_scenes()["resting-pool"]
    small = {"width": "0.4", "t_end": "0.44", "fall": "1.5"}
    setting = Setting("global", {}, scene.script_variables("global", small, quick=True))
    workshop = Workshop(scene, tmp_path, 1, 1, Console(file=io.StringIO()))
    (record,) = workshop.run([setting])
    assert record.failure is None
    table = workshop.thermo(setting)
    fallen = -np.diff(table["v_drop"])
    assert fallen[0] == pytest.approx(1.5 * 0.02 + 0.5 * 9.81 * 0.02**2, rel=0.01)
    # the pool alone, then with the drop
    whole = ThermoTable.read(workshop.folder(setting) / "log.lammps")
    mass = (table["Atoms"][0] - whole["Atoms"][0]) * 1000.0 * 0.02**2 / 1.00512
    assert table["v_kinetic"][0] == pytest.approx(0.5 * mass * 1.5**2, rel=0.01)
