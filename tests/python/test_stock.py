"""Validation by LAMMPS's own styles: a script runs and is measured as the case is."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.validation.stock import compare_stock, pairs

SMALL = {"across": "16", "gap": "1e-3"}


@pytest.fixture
def quiet() -> Console:
    return Console(file=io.StringIO())


@pytest.mark.parametrize(("code", "limit"), [("sph", 0.12), ("rheo", 0.03)])
def test_plates_of_particles_reach_a_steady_flow(
    tmp_path: Path, quiet: Console, code: str, limit: float
) -> None:
    settings = SMALL | {"behind": "0"}
    measured, bench = compare_stock("poiseuille", code, settings, tmp_path, quiet)
    assert 0 < measured["profile_1"] < limit
    assert bench.particle_updates() > 1e4


def test_units_do_not_matter_to_rheo(tmp_path: Path, quiet: Console) -> None:
    # the same flow, ten times as wide: Reynolds and Mach number, gap and density differ
    wide = SMALL | {"gap": "1e-2", "drive": "1e-7", "rho0": "800"}
    one, _ = compare_stock("poiseuille", "rheo", SMALL, tmp_path / "one", quiet)
    two, _ = compare_stock("poiseuille", "rheo", wide, tmp_path / "two", quiet)
    assert two["profile"] == pytest.approx(one["profile"], rel=1e-6)
    assert two["drag"] == pytest.approx(one["drag"], abs=1e-6)


def test_unknown_script_and_variable_are_refused(tmp_path: Path, quiet: Console) -> None:
    assert set(pairs()["poiseuille"]) == {"sph", "rheo"}
    with pytest.raises(UserError, match="no script for jet by sph"):
        compare_stock("jet", "sph", {}, tmp_path, quiet)
    with pytest.raises(UserError, match="no variable 'nonsense'"):
        compare_stock("poiseuille", "sph", {"nonsense": "1"}, tmp_path, quiet)
