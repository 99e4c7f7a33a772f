"""Validation by LAMMPS's own styles: a script runs and is measured as the case is."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.references.dam_break import Column
from sphcloth.validation.cases.dam_break import Front
from sphcloth.validation.stock import CODES, StockRunner, compare_stock, find, pairs

SMALL = {"across": "16", "gap": "1e-3"}


@pytest.fixture
def quiet() -> Console:
    return Console(file=io.StringIO())


@pytest.mark.parametrize(("code", "limit"), [("sph", 0.12), ("rheo", 0.03)])
def test_plates_of_particles_reach_a_steady_flow(
    tmp_path: Path, quiet: Console, code: str, limit: float
) -> None:
    settings = SMALL | {"behind": "0"}
    measured, runner = compare_stock("poiseuille", code, settings, tmp_path, quiet)
    assert 0 < measured["profile_1"] < limit
    assert runner.particle_updates() > 1e4


@pytest.mark.usefixtures("finest_only")
def test_units_do_not_matter_to_rheo(tmp_path: Path, quiet: Console) -> None:
    # the same flow, ten times as wide: Reynolds and Mach number, gap and density differ
    wide = SMALL | {"gap": "1e-2", "drive": "1e-7", "rho0": "800"}
    one, _ = compare_stock("poiseuille", "rheo", SMALL, tmp_path / "one", quiet)
    two, _ = compare_stock("poiseuille", "rheo", wide, tmp_path / "two", quiet)
    assert two["profile"] == pytest.approx(one["profile"], rel=1e-6)
    assert two["drag"] == pytest.approx(one["drag"], abs=1e-6)


@pytest.mark.parametrize(
    ("code", "settings"),
    [("sph", {"support": "3"}), ("rheo", {"step": "0.15"})],
)
@pytest.mark.usefixtures("finest_only")
def test_a_wave_swings(tmp_path: Path, quiet: Console, code: str, settings: dict[str, str]) -> None:
    settings = settings | {"layers": "12", "settle": "1", "periods": "1", "sound": "6"}
    measured, _ = compare_stock("standing-wave", code, settings, tmp_path, quiet)
    assert abs(measured["period"]) < 0.12
    assert 0 < measured["damping"] < 2


@pytest.mark.parametrize(
    ("code", "settings"),
    [("sph", {"alpha": "0.1"}), ("rheo", {"step": "0.15"})],
)
@pytest.mark.usefixtures("finest_only")
def test_a_drop_swings(tmp_path: Path, quiet: Console, code: str, settings: dict[str, str]) -> None:
    settings = settings | {"across": "10", "sound": "10"}
    measured, _ = compare_stock("oscillating-drop", code, settings, tmp_path, quiet)
    assert abs(measured["period"]) < 0.03
    assert 0 < measured["energy_loss"] < 1


@pytest.mark.parametrize(
    ("code", "settings"),
    [("sph", {"support": "3"}), ("rheo", {"step": "0.15"})],
)
@pytest.mark.usefixtures("finest_only")
def test_a_plate_of_particles_stops_a_jet(
    tmp_path: Path, quiet: Console, code: str, settings: dict[str, str]
) -> None:
    settings = settings | {"across": "8", "length": "8", "sound": "6"}
    measured, _ = compare_stock("jet", code, settings, tmp_path, quiet)
    assert abs(measured["force"]) < 0.1
    assert abs(measured["leaving"]) < 0.1


@pytest.mark.parametrize(
    ("code", "settings"),
    [
        ("sph", {}),
        # what is too light is set to the rest density, by its present value
        ("sph", {"tension": "no"}),
        ("rheo", {"step": "0.2"}),
        ("rheo", {"step": "0.2", "tension": "no", "tank": "reflect"}),
    ],
)
def test_a_column_stands_behind_its_gate_and_then_collapses(
    tmp_path: Path, quiet: Console, code: str, settings: dict[str, str]
) -> None:
    # one coarse run: the case itself needs three, and at least 24 particles over the width
    column = Column(0.05715, 9.81)
    across, settle = 8, 2 * column.time
    runner = StockRunner(find("dam-break", code)[1], tmp_path, 1, quiet, extra=settings)
    shared = {"across": across, "t_settle": settle}
    run = runner.run("tiny", settle + 2 * column.time, shared)
    foremost = run.trajectory[0].positions[:, 0].max()
    assert foremost + 0.5 * column.width / across == pytest.approx(column.width, rel=0.1)
    front = Front.of(run, column)
    assert 1.4 < front.places[-1] < 2.6
    thermo = run.thermo
    assert thermo["v_densest"].max() > 1e-3
    energy = thermo["v_kinetic"] + thermo["v_potential"] + thermo["v_elastic"]
    assert energy[-1] < energy[0]
    assert thermo["v_mass"][-1] == pytest.approx(1000 * 2 * column.width**2)


def test_unknown_script_and_variable_are_refused(tmp_path: Path, quiet: Console) -> None:
    assert len(pairs()) == 8
    assert all(set(codes) == set(CODES) for codes in pairs().values())
    with pytest.raises(UserError, match="no script for jet by sphinx"):
        compare_stock("jet", "sphinx", {}, tmp_path, quiet)
    with pytest.raises(UserError, match="no variable 'nonsense'"):
        compare_stock("poiseuille", "sph", {"nonsense": "1"}, tmp_path, quiet)
