"""References of the cases with water and cloth, and the cases as small as they can be."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.references.added_mass_piston import Piston
from sphcloth.references.blob_on_free_sheet import Collision
from sphcloth.references.jet_on_sheet import TurnedJet
from sphcloth.validation import validate
from sphcloth.validation.cases.added_mass_piston import Swing
from sphcloth.validation.cases.blob_on_free_sheet import rise
from sphcloth.validation.cases.lintearia import modes
from sphcloth.validation.lattice import KERNELS, cubic_density_sum


def run_case(name: str, out: Path, **settings: str) -> validate.Result:
    case, console = validate.find_case(name), Console(file=io.StringIO())
    return validate.validate(case, settings, 1, True, out, console)


def test_a_column_that_cannot_be_compressed_adds_its_mass() -> None:
    stiff = Piston(3.0, 1e6, 0.5, 1000.0, 1e5)
    assert stiff.rigid_period == pytest.approx(2 * math.pi * math.sqrt(503 / 1e6))
    assert stiff.period == pytest.approx(stiff.rigid_period, rel=1e-7)


def test_a_column_that_yields_is_slower_by_a_sixth_of_its_compliance() -> None:
    """For small omega h / c the column adds h / (3 rho c^2) to the spring's compliance."""
    piston = Piston(0.0, 1e6, 0.5, 1000.0, 300.0)
    softer = 1 + 1e6 * 0.5 / (3 * 1000.0 * 300.0**2)
    assert piston.period / piston.rigid_period == pytest.approx(math.sqrt(softer), rel=1e-5)


def test_a_stiff_spring_leaves_the_column_to_itself() -> None:
    """A sheet that hardly moves is the fixed end of a rod with a quarter of a wave."""
    piston = Piston(1e-3, 1e13, 0.5, 1000.0, 100.0)
    assert piston.period == pytest.approx(4 * 0.5 / 100.0, rel=1e-4)


@pytest.mark.parametrize("areal", [0.01, 1.0, 100.0, 1e4])
def test_the_frequency_solves_the_condition_at_the_sheet(areal: float) -> None:
    piston = Piston(areal, 1e6, 0.5, 1000.0, 111.8)
    omega = piston.frequency
    pull = 1000.0 * 111.8 * omega * math.tan(omega * 0.5 / 111.8)
    assert (1e6 - areal * omega**2) / pull == pytest.approx(1, rel=1e-9)
    assert piston.period > piston.rigid_period


def test_an_exact_swing_is_found() -> None:
    time = np.linspace(0, 1, 400)
    height = 0.1 + 0.01 * time - 3e-3 * np.exp(-0.2 * time) * np.sin(40 * time)
    swing = Swing.of(time, height, 38.0)
    assert swing.period == pytest.approx(2 * math.pi / 40, rel=1e-7)
    assert swing.loss == pytest.approx(-math.expm1(-0.2 * 2 * math.pi / 40), rel=1e-6)
    assert swing.scatter < 1e-7


def test_a_collision_keeps_what_momentum_demands() -> None:
    collision = Collision(4.0, 1.0, 10.0, 30.0)
    assert collision.momentum == pytest.approx([20 * math.sqrt(3), 0, -20])
    assert collision.energy == pytest.approx(200)
    momentum = float(np.linalg.norm(collision.momentum))
    assert collision.least_energy == pytest.approx(momentum**2 / (2 * 5))


def test_a_rise_is_seen_wherever_it_begins() -> None:
    assert rise(np.array([3.0, 2.0, 2.5, 1.0, 1.2])) == pytest.approx(0.5)
    assert rise(np.array([3.0, 2.0, 2.0, 1.0])) == 0


def test_force_of_a_turned_jet() -> None:
    jet = TurnedJet(0.1, 2.0, 1000.0)
    assert jet.flow == pytest.approx(0.2)
    assert jet.force(90.0) == pytest.approx(400)
    assert jet.force(180.0) == pytest.approx(800)
    assert jet.force(0.0) == pytest.approx(0)
    assert jet.force(120.0, 0.5) == pytest.approx(500)


def test_cubic_density_sum() -> None:
    assert cubic_density_sum("wendland/c2", 2.0) == pytest.approx(1.0338, abs=1e-4)
    for kernel in KERNELS:
        assert cubic_density_sum(kernel, 12.0) == pytest.approx(1, abs=1e-4)


def test_a_sheet_under_water_swings_on_and_does_not_gain(tmp_path: Path) -> None:
    """With densities that follow velocities instead of ways it gained 3 % in each period."""
    settings = {"runs": "1", "lightest": "100", "heaviest": "100", "iterations": "10"}
    result = run_case("added-mass-piston", tmp_path, **settings, periods="3")
    assert result.passed
    assert abs(result.metrics["loss"].value) < 0.01
    assert (tmp_path / "added-mass-piston.png").stat().st_size > 10_000


def test_a_drop_on_a_free_sheet_keeps_momentum(tmp_path: Path) -> None:
    settings = {"across": "3", "length": "8", "width": "6", "most_ranks": "1", "radius": "0.05"}
    result = run_case("blob-on-free-sheet", tmp_path, **settings)
    for name in ("momentum", "energy_rise", "crossed"):
        assert result.metrics[name].passed, (name, result.metrics[name].value)


@pytest.mark.parametrize("coupling", ["contact", "pressure"])
def test_rigid_edges_return_hardly_more_than_they_stored(tmp_path: Path, coupling: str) -> None:
    """What they store is in no sum; as stiff as each step makes them they gained 11 and 3 %.

    The springs of the solver hold up to 1.6 % of the energy of a drop, and give it back.
    """
    settings = {"across": "3", "length": "8", "width": "6", "most_ranks": "1", "radius": "0.05"}
    settings |= {"compliance": "0", "coupling": coupling, "scheme": "global"}
    result = run_case("blob-on-free-sheet", tmp_path, **settings)
    assert result.metrics["energy_rise"].value < 0.02
    for log in tmp_path.glob("*/log.lammps"):
        thermo = ThermoTable.read(log)
        energy = thermo["v_kinetic"] + thermo["v_internal"]
        assert energy.max() <= energy[0] * (1 + 1e-9), log


@pytest.mark.usefixtures("finest_only")
def test_a_jet_pulls_at_the_pins(tmp_path: Path) -> None:
    settings = {"across": "4", "thickness": "0.2", "speed": "1", "length": "15"}
    result = run_case("jet-on-sheet", tmp_path, **settings)
    assert abs(result.metrics["balance"].value) < 0.1
    assert result.metrics["passed_through"].passed


@pytest.mark.usefixtures("finest_only")
def test_a_jet_on_a_sheet_that_is_a_wall_pulls_at_the_pins(tmp_path: Path) -> None:
    settings = {"coupling": "wall", "gap": "0.5", "areal": "50", "length": "15"}
    result = run_case("jet-on-sheet", tmp_path, **settings, across="4", thickness="0.2", speed="1")
    # a sheet that heavy still swings
    assert abs(result.metrics["balance"].value) < 0.2
    assert result.metrics["passed_through"].passed


@pytest.mark.usefixtures("finest_only")
def test_a_weight_on_a_sheet_that_is_a_wall_hangs_at_the_pins(tmp_path: Path) -> None:
    settings = {"mode": "wall", "across": "12", "time": "8"}
    result = run_case("pinned-weight", tmp_path, **settings)
    for name in ("pins", "pins_by_atom", "crossed"):
        assert result.metrics[name].passed, (name, result.metrics[name].value)


@pytest.mark.usefixtures("finest_only")
def test_the_example_pour_hangs_on_its_pins(tmp_path: Path) -> None:
    result = run_case("pour", tmp_path, across="14", time="3", water="0.02")
    for name in ("momentum", "crossed"):
        assert result.metrics[name].passed, (name, result.metrics[name].value)
    assert abs(result.metrics["pins"].value) < 0.03
    assert abs(result.metrics["sag"].value) < 0.01
    assert (tmp_path / "pour.png").stat().st_size > 10_000


def test_a_pool_on_a_sheet_stays_above_it_and_is_drawn(tmp_path: Path) -> None:
    result = run_case("lintearia", tmp_path, settle="1", layers="3")
    for name in ("crossed", "below", "length"):
        assert result.metrics[name].passed, (name, result.metrics[name].value)
    modes.main([str(tmp_path), "--out", str(tmp_path / "modes.png")])
    assert (tmp_path / "modes.png").stat().st_size > 10_000


@pytest.mark.usefixtures("finest_only")
def test_a_light_wet_sheet_comes_to_rest(tmp_path: Path) -> None:
    """Edges that hardly stretch ring, and the water at 0.05 m/s, where substeps are too long."""
    result = run_case("lintearia", tmp_path, D="0.9", A="0.03", strain="5e-4", settle="3")
    assert result.metrics["speed"].value < 0.03


def test_a_mesh_that_would_meet_its_own_image_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="mesh 4 with layers 4"):
        run_case("lintearia", tmp_path, mesh="4")
