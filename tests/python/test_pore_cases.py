"""Pores in the harness: references, cases in full as small as they can be, and which triangles."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame
from rich.console import Console

from sphcloth.advice.commands import Commands
from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.references import DrainingColumn, measured_drag
from sphcloth.validation import validate


def test_a_slow_column_drains_as_the_formulas_say() -> None:
    """Where the sheet takes nearly all of the weight."""
    height, rho, g = 0.2, 1000.0, 9.81
    times = np.linspace(0.0, 300.0, 20)
    a = rho * g / 0.005
    darcy = DrainingColumn(height, a, 0.0, rho, g).levels(times)
    np.testing.assert_allclose(darcy, height * np.exp(-0.005 * times), rtol=2e-5)
    b = rho * g / (0.002 * np.sqrt(height)) ** 2
    root = np.sqrt(height) - 0.5 * np.sqrt(rho * g / b) * times
    forchheimer = DrainingColumn(height, 0.0, b, rho, g).levels(times)
    np.testing.assert_allclose(forchheimer, root**2, rtol=2e-5)


def test_a_column_without_resistance_falls_freely() -> None:
    column = DrainingColumn(1.0, 1e-9, 0.0, 1000.0, 9.81)
    times = np.linspace(0.0, 0.3, 5)
    np.testing.assert_allclose(column.levels(times), 1.0 - 0.5 * 9.81 * times**2, rtol=1e-6)
    assert column.levels(np.array([0.0, 10.0]))[-1] == 0.0


def test_the_flux_bears_the_column() -> None:
    for a, b in ((500.0, 0.0), (0.0, 3e4), (200.0, 1e4)):
        column = DrainingColumn(0.3, a, b, 1000.0, 9.81)
        u = column.flux(0.3)
        assert a * u + b * u * u == pytest.approx(1000 * 9.81 * 0.3)
    with pytest.raises(UserError, match="darcy = -1"):
        DrainingColumn(0.3, -1.0, 0.0, 1000.0, 9.81)


def test_a_net_that_was_not_measured_is_refused() -> None:
    assert measured_drag(0.2) == pytest.approx(0.288, abs=1e-3)
    with pytest.raises(UserError, match=r"solidity = 0.5.*0.13 to 0.32"):
        measured_drag(0.5)


SMALL = {
    "drain": {"layers": "14", "most_ranks": "1"},
    "net-drag": {"across": "5", "wide": "2", "long": "2.5", "time": "1.5"},
}
# what so coarse a scene must do worse
LOOSE = {
    "drain": {"darcy": 0.02, "forchheimer": 0.03, "both": 0.02, "through": 0.05},
    "net-drag": {"drag_0.2": 0.2, "drag_0.3": 0.2, "coarse": 0.3, "middle": 0.3},
}


@pytest.mark.parametrize("name", SMALL)
def test_a_small_case_with_pores_is_within_its_limits(
    tmp_path: Path, name: str, request: pytest.FixtureRequest
) -> None:
    if name == "drain":
        request.getfixturevalue("finest_only")
    console = Console(file=io.StringIO())
    result = validate.validate(validate.find_case(name), SMALL[name], 1, True, tmp_path, console)
    for metric, found in result.metrics.items():
        limit = LOOSE[name].get(metric, found.limit)
        assert limit is None or abs(found.value) <= limit, (metric, found.value)
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000


def mesh() -> ClothMesh:
    return ClothMesh(np.arange(1, 5), np.array([[0, 1, 2], [0, 2, 3]]), kinds=np.array([2, 1]))


def test_triangles_are_chosen_by_their_type() -> None:
    assert mesh().of_kinds([2]).triangles.tolist() == [[0, 1, 2]]
    for wrong in ("2", ["2"], [2.5], [0]):
        with pytest.raises(UserError, match=r"angle type .*: types are whole numbers from 1"):
            mesh().of_kinds(wrong)
    assert mesh().without_kinds([2]).triangles.tolist() == [[0, 2, 3]]
    assert mesh().without_kinds([]).triangles.tolist() == mesh().triangles.tolist()
    with pytest.raises(UserError, match="types of the triangles are not known"):
        ClothMesh(np.arange(3), np.array([[0, 1, 2]])).of_kinds([1])


@pytest.mark.parametrize(
    ("words", "expected"),
    [("2", {2}), ("1*2", {1, 2}), ("*", {1, 2}), ("2*", {2}), ("*1", {1}), ("3", set())],
)
def test_the_log_says_which_types_have_pores(tmp_path: Path, words: str, expected: set) -> None:
    log = tmp_path / "log.lammps"
    log.write_text(f"fix pores water cloth/pores {words} darcy 1\n")
    assert Commands.read(log).porous(mesh()) == expected
    assert Commands.read(log).porous(None) == set()


def test_nothing_crosses_a_mesh_without_triangles() -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    frames = [make_frame(step, [[0.6, 0.3, z]], square) for step, z in enumerate((0.1, -0.1))]
    assert crossings(mesh().of_kinds([7]), frames, 1).count == 0
    assert crossings(mesh().of_kinds([2]), frames, 1).count == 1
    assert crossings(mesh().without_kinds([2]), frames, 1).count == 0
