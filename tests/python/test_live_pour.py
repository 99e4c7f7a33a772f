"""The example live_pour: a jet whose speed Python changes while LAMMPS runs."""

from __future__ import annotations

import importlib.util
import itertools
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "examples" / "live_pour" / "live_pour.py"


@pytest.fixture
def live_pour(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """The script as a module, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    spec = importlib.util.spec_from_file_location("live_pour", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "live_pour", module)
    spec.loader.exec_module(module)
    return module


def test_the_jet_gets_faster_until_the_water_is_compressed(live_pour) -> None:
    states = list(live_pour.live_pour(allowed=0.003, radius=0.15, end=0.4))
    for before, after in itertools.pairwise(states):
        faster = before.compression <= 0.003
        assert after.speed == pytest.approx(before.speed * (1.1 if faster else 0.8)) or (
            after.speed == live_pour.SLOWEST and not faster
        )
    assert {state.compression > 0.003 for state in states} == {False, True}
    assert states[0].particles == 32 < states[-1].particles
    assert all(state.particles % 32 == 0 for state in states)
    assert all(0 < state.shortest <= state.longest <= 0.002 for state in states)
    assert min(state.active for state in states) < 0.9 < max(state.active for state in states)
    assert max(state.sag for state in states) > 0.02


def test_layers_keep_their_distance_when_the_speed_changes(live_pour) -> None:
    lmp = live_pour.lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(live_pour.SCENE + "fix gravity all gravity 0 vector 0 0 -1\n")
    jet = live_pour.Jet(lmp, 0.03)
    for speed in (1.0, 1.2, 0.9):
        jet.pour(speed)
        lmp.command("run 35")
    owned = lmp.extract_setting("nlocal")
    water = lmp.numpy.extract_atom("type")[:owned] == 1
    heights = sorted({round(z, 9) for z in lmp.numpy.extract_atom("x")[:owned][water, 2]})
    gaps = [above - below for below, above in itertools.pairwise(heights)]
    assert len(gaps) == 4
    assert min(gaps) > 0.03


def test_rows_and_picture(live_pour, monkeypatch, tmp_path: Path, capsys) -> None:
    monkeypatch.setattr(
        sys, "argv", ["live_pour.py", "--time", "0.25", "--picture", str(tmp_path / "jet.png")]
    )
    live_pour.main()
    head, *rows = capsys.readouterr().out.splitlines()
    assert head.split()[:4] == ["time", "jet", "particles", "compression"]
    assert len(rows) == 2
    assert [float(row.split()[0]) for row in rows] == pytest.approx([0.04, 0.24])
    assert (tmp_path / "jet.png").stat().st_size > 5000
