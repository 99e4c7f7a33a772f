"""Sheets of springs as membranes: nets without end by hand, and small sheets in LAMMPS."""

from __future__ import annotations

import io
import math
from pathlib import Path

import pytest
from rich.console import Console

from sphcloth.validation import membrane
from sphcloth.validation.membrane import Net
from sphcloth.validation.runner import Runner


def runner(tmp_path: Path) -> Runner:
    return Runner(membrane.SCRIPT, tmp_path, 1, Console(file=io.StringIO()))


@pytest.mark.parametrize(
    ("net", "modulus"),
    [
        (Net("diagonal"), 4 / 3),
        (Net("cross", 0.5), 4 / 3),
        (Net("equilateral"), 2 / math.sqrt(3)),
    ],
)
def test_three_nets_are_isotropic(net: Net, modulus: float) -> None:
    for degrees in (0, 10, 45, 77, 90):
        found = membrane.moduli(membrane.stiffness(net), degrees)
        assert found == pytest.approx((modulus, 1 / 3), rel=1e-12)


def test_one_diagonal_resists_along_itself() -> None:
    voigt = membrane.stiffness(Net("square"))
    along_an_edge, along_the_diagonal, across = (
        membrane.moduli(voigt, degrees)[0] for degrees in (0, 45, 135)
    )
    assert (along_an_edge, along_the_diagonal, across) == pytest.approx((1, 2, 0.4))


@pytest.mark.parametrize("net", [Net("square"), Net("cross")])
@pytest.mark.parametrize("degrees", [22.5, 135.0])
def test_a_sheet_pulled_has_the_moduli_of_its_net(tmp_path: Path, net: Net, degrees: float) -> None:
    found = membrane.pull(runner(tmp_path), net, degrees, cells=6)
    exact = membrane.moduli(membrane.stiffness(net), degrees)
    assert found == pytest.approx(exact, abs=1e-4)


def test_alternating_diagonals_resist_shear_both_ways_alike(tmp_path: Path) -> None:
    at = runner(tmp_path)
    assert membrane.shear(at, Net("diagonal"), 0.3, 6) == pytest.approx(
        membrane.shear(at, Net("diagonal"), -0.3, 6), rel=1e-3
    )
    up, down = (membrane.shear(at, Net("square"), gamma, 6) for gamma in (0.3, -0.3))
    # a diagonal of the unit square that follows the shear, its stretch squared over gamma squared
    affine = [(math.sqrt((1 + g) ** 2 + 1) - math.sqrt(2)) ** 2 / g**2 for g in (0.3, -0.3)]
    sides = (math.sqrt(1 + 0.3**2) - 1) ** 2 / 0.3**2
    assert (up, down) == pytest.approx([each + sides for each in affine], rel=1e-6)


def test_sheets_hang_and_are_drawn(tmp_path: Path) -> None:
    at = runner(tmp_path)
    for pattern in ("equilateral", "cross"):
        shape, run = membrane.hang(at, pattern, "corners", 6, 20, 1)
        assert 0.7 < shape.depth < 1.2
        assert shape.speed < 1e-2
    membrane.draw_shapes({pattern: run, "diagonal": run}, tmp_path / "shapes.png")
    top, _ = membrane.hang(at, "diagonal", "top", 6, 20, 1)
    assert top.depth == pytest.approx(1, abs=5e-3)
    points = [
        {"sheet": net.name, "angle": 0.0, "modulus": 1.0, "poisson": 0.3} for net in membrane.NETS
    ]
    membrane.plot_pull(points, tmp_path / "pull.png")
    for picture in ("shapes.png", "pull.png"):
        assert (tmp_path / picture).stat().st_size > 10_000
