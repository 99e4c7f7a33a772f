"""The sheet of springs with a liquid in it: derivative, exact shape of a strip, balance, errors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.references import FilledSheet, HeavyLintearia, Lintearia

G, RHO = 9.81, 1000.0


def grid(
    columns: int, rows: int, length: float, width: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices and triangles of a flat rectangle of cells cut along one diagonal."""
    x, y = np.meshgrid(np.linspace(0, length, columns + 1), np.linspace(0, width, rows + 1))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    number = np.arange(len(flat)).reshape(x.shape)
    a, b = number[:-1, :-1].ravel(), number[:-1, 1:].ravel()
    d, e = number[1:, :-1].ravel(), number[1:, 1:].ravel()
    return flat, np.concatenate([np.column_stack([a, b, e]), np.column_stack([a, e, d])])


def sheet(
    flat: NDArray, triangles: NDArray, held: NDArray, mass: float, volume: float
) -> FilledSheet:
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    lengths = np.linalg.norm(flat[edges[:, 1]] - flat[edges[:, 0]], axis=1)
    return FilledSheet(edges, lengths, 1e-7, triangles, held, mass, volume, RHO, G)


def bowl(side: float = 1.0, cells: int = 8) -> tuple[FilledSheet, NDArray[np.float64]]:
    """Return a square sheet whose rim is held nearer together, and a shape to start from."""
    flat, triangles = grid(cells, cells, side, side)
    held = np.any((flat[:, :2] == 0) | (flat[:, :2] == side), axis=1)
    u, v = (2 * flat[:, k] / side - 1 for k in (0, 1))
    start = np.column_stack([0.45 * u, 0.45 * v, -0.2 * (1 - u**2) * (1 - v**2)])
    return sheet(flat, triangles, held, 0.01, 0.02), start


def test_the_force_is_the_derivative_of_the_energy() -> None:
    filled, x = bowl()
    way = np.random.default_rng(1).normal(size=x.shape)
    slope = (filled._energy(x + 1e-7 * way) - filled._energy(x - 1e-7 * way)) / 2e-7
    assert slope == pytest.approx(-np.sum(filled._force(x) * way), rel=1e-6)


def test_a_strip_between_two_pins_is_the_exact_curve() -> None:
    """The liquid pushes the strip wider, which its rigid edges bear."""
    length, width, span, area = 1.0, 0.02, 0.6, 0.08
    exact = HeavyLintearia(Lintearia(length, span, area, RHO, G), 0.2)
    flat, triangles = grid(50, 1, length, width)
    held = (flat[:, 0] == 0) | (flat[:, 0] == length)
    strip = sheet(flat, triangles, held, 0.2 * length * width / len(flat), area * width)
    arc = flat[:, 0] - length / 2
    start = flat.copy()
    start[:, [0, 2]] = exact.shape(arc) - [0.0, exact.sag]
    start[~held, 2] += 0.02 * np.cos(math.pi * arc[~held])
    rest = strip.at_rest(start)
    assert -rest.bottom == pytest.approx(exact.sag, rel=2e-3)
    assert rest.depth == pytest.approx(exact.depth, rel=4e-3)
    assert rest.lift == pytest.approx(strip.weight, rel=1e-4)


def test_the_held_vertices_carry_liquid_and_sheet() -> None:
    filled, start = bowl()
    rest = filled.at_rest(start)
    assert rest.lift == pytest.approx((RHO * 0.02 + 0.01 * 81) * G, rel=1e-5)
    assert rest.residual <= 1e-6 * filled.weight
    assert 0 < rest.depth < -rest.bottom


def test_a_liquid_that_runs_over_is_refused() -> None:
    filled, start = bowl()
    full = FilledSheet(**{**vars(filled), "volume": 0.5})
    with pytest.raises(UserError, match=r"volume = 0\.5 m\^3: the sheet holds 0\.0"):
        full.at_rest(start)
    with pytest.raises(UserError, match="FilledSheet: mass = 0: it must be above 0"):
        FilledSheet(**{**vars(filled), "mass": 0.0})
