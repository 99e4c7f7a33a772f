"""The oracle of intersections, on meshes of a few triangles and against its own counts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import make_frame, square_sheet

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.metrics import intersections
from sphcloth.metrics.intersections import Intersections, MostMet, inspect
from sphcloth.trajectory import Frame

pytest.importorskip("ipctk", reason="pip install 'sphcloth[oracle]'")

FLAT = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
TWO = np.array([[0, 1, 2], [3, 4, 5]])


def two(other: np.ndarray) -> np.ndarray:
    """Return a triangle in the plane z = 0 and another one, shape (6, 3)."""
    return np.concatenate([FLAT, other])


def moved(*by: float) -> np.ndarray:
    """Return the triangle in the plane z = 0 elsewhere, shape (3, 3)."""
    return FLAT + np.array(by)


def open_frame(step: int, positions: np.ndarray) -> Frame:
    """Return a frame of vertices in a box that is not periodic."""
    return replace(make_frame(step, [], positions), periodic=(False,) * 3)


# through the inside of FLAT: two of the edges below go through it
UPRIGHT = np.array([[0.3, 0.3, -0.5], [0.2, 0.3, 0.5], [0.3, 0.2, 0.5]])


def test_edges_through_a_triangle_are_found_and_named() -> None:
    oracle = Intersections(TWO, 6)
    pairs = oracle.pairs(two(UPRIGHT))
    assert oracle.intersect(two(UPRIGHT))
    assert set(pairs[:, 1]) == {0}
    assert {tuple(oracle.edges[edge]) for edge in pairs[:, 0]} == {(3, 4), (3, 5)}


def test_two_triangles_that_hook_into_each_other_meet_twice() -> None:
    """One edge of each goes through the other."""
    hooked = np.array([[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [0.9, 0.9, 0.5]])
    oracle = Intersections(TWO, 6)
    pairs = oracle.pairs(two(hooked))
    assert sorted(pairs[:, 1]) == [0, 1]
    assert oracle.count(two(hooked)) == 2


@pytest.mark.parametrize("height", [0.01, -0.01])
def test_triangles_that_are_only_close_do_not_meet(height: float) -> None:
    near = two(moved(0.1, 0.1, height))
    oracle = Intersections(TWO, 6)
    assert oracle.count(near) == 0
    assert oracle.gap(near, 0.02) == pytest.approx(0.01, rel=1e-12)
    assert oracle.gap(near, 0.005) == math.inf


def test_the_gap_of_two_edges_and_of_two_vertices() -> None:
    oracle = Intersections(TWO, 6)
    # edge (1, 2) of the one and edge (3, 4) of the other, above each other in the middle
    crossed = two(np.array([[0.2, 0.2, 0.03], [0.8, 0.8, 0.03], [0.9, 0.9, 0.8]]))
    assert oracle.gap(crossed, 0.1) == pytest.approx(0.03, rel=1e-9)
    beside = two(np.array([[1.03, 0.0, 0.04], [2, 0, 0.04], [2, 1, 0.04]]))
    assert oracle.gap(beside, 0.1) == pytest.approx(0.05, rel=1e-9)


def test_neighbors_that_are_folded_onto_each_other_do_not_count() -> None:
    """They share an edge; no angle between them is an intersection, nor a gap."""
    oracle = Intersections(np.array([[0, 1, 2], [1, 0, 3]]), 4)
    for angle in (0.0, 1.0, math.pi - 1e-3):
        wing = [0.3, -math.cos(angle), math.sin(angle)]
        positions = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 1, 0], wing])
        assert oracle.count(positions) == 0
    # the wings are two vertices that are no neighbors
    assert oracle.gap(positions, 0.1) == pytest.approx(2 * math.sin(0.5e-3), rel=1e-6)


def test_a_step_through_a_triangle_is_not_free_though_both_ends_are() -> None:
    oracle = Intersections(TWO, 6)
    above, below = (two(moved(0.1, 0.1, z)) for z in (0.01, -0.01))
    nearer = two(moved(0.1, 0.1, 0.001))
    assert oracle.count(above) == oracle.count(below) == 0
    assert not oracle.is_free(above, below)
    assert oracle.is_free(above, nearer)


def test_a_step_of_an_edge_through_an_edge_is_not_free() -> None:
    """No vertex goes through a triangle: only the edges tell."""
    blade = np.array([[0.7, 0.7, 0.1], [0.0, 0.0, 0.9], [1.0, 1.0, 0.9]])
    start = np.array([[0.55, 0.55, -0.2], [0.55, 0.55, 0.2], [2.0, 2.0, 0.0]])
    oracle = Intersections(TWO, 6)
    assert oracle.is_free(two(blade), two(blade + 1e-3))
    assert oracle.count(two(start)) == 0
    assert not oracle.is_free(two(start), two(start - [0.1, 0.1, 0]))


def test_obstacles_do_not_meet_one_another_and_are_counted_apart() -> None:
    through, apart = two(UPRIGHT), moved(0, 0, 5)
    assert Intersections(TWO, 6, 0).count(through) == 0
    assert Intersections(TWO, 6, 3).counts(through) == (0, 2)
    assert Intersections(TWO, 6).counts(through) == (2, 0)
    three = np.concatenate([through, apart])
    above, below = (np.concatenate([FLAT, moved(0.1, 0.1, z), apart]) for z in (0.01, -0.01))
    mesh = np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8]])
    assert Intersections(mesh, 9, 6).counts(three) == (2, 0)
    assert Intersections(mesh, 9, 6).crossed(above, below) == (True, False)
    assert Intersections(mesh, 9, 3).crossed(above, below) == (False, True)
    assert Intersections(mesh, 9, 3).crossed(above, above) == (False, False)


def test_a_run_is_asked_frame_by_frame() -> None:
    """A sheet falls through another one: apart, touching, across, apart."""
    below, flat = square_sheet(3)
    sheets = ClothMesh(np.arange(1, 33), np.concatenate([below.triangles, below.triangles + 16]))
    other = flat * [0.9, 0.9, 1] + [0.031, 0.017, 0]
    slant = 0.1 * other[:, :1] * [0, 0, 1]
    frames = [
        open_frame(step, np.concatenate([flat, other + slant + [0, 0, height]]))
        for step, height in ((0, 0.2), (1, 0.004), (2, -0.05), (3, -0.2))
    ]
    found = inspect(Intersections.of(sheets), sheets, frames, 0.01)
    assert (found.frames, found.met, found.not_free, found.first) == (4, 1, 2, 2)
    assert found.most > 0
    assert found.gap == 0
    early = inspect(Intersections.of(sheets), sheets, frames[:2], 0.01)
    assert (early.met, early.not_free, early.first) == (0, 0, -1)
    assert 0.4 < early.gap < 0.8
    through = inspect(Intersections.of(sheets), sheets, [frames[1], frames[3]], 0.01)
    assert (through.met, through.not_free, through.first) == (0, 1, 3)


def test_periodic_positions_are_unwrapped_or_refused() -> None:
    mesh, flat = square_sheet(1)
    frame = make_frame(0, [], flat)
    periodic = replace(frame, periodic=(True, False, False))
    with pytest.raises(UserError, match="no column ix iy iz"):
        intersections.unwrapped(mesh, periodic)
    images = {"ix": np.array([0.0, 1, 0, 0]), "iy": np.zeros(4), "iz": np.zeros(4)}
    wrapped = replace(periodic, columns=frame.columns | images)
    moved = intersections.unwrapped(mesh, wrapped) - flat
    np.testing.assert_allclose(moved[:, 0], [0, 100, 0, 0])


def test_without_the_toolkit_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(intersections, "find_spec", lambda name: None)
    with pytest.raises(UserError, match=r"pip install 'sphcloth\[oracle\]'"):
        Intersections(TWO, 6)


def test_the_frame_with_most_edges_through_triangles_counts() -> None:
    """Obstacles, which may come first, do not meet one another."""
    mesh = ClothMesh(np.arange(1, 10), np.arange(9).reshape(3, 3))
    # two obstacles that meet, and cloth that leaves the first of them
    frames = [
        open_frame(n, np.concatenate([FLAT, UPRIGHT, moved(0.05, 0.05, height)]))
        for n, height in enumerate([0.9, 0.2, -0.9])
    ]
    cloth = np.array([False, False, True])
    oracle = Intersections(np.arange(9).reshape(3, 3), 9)
    counts = [oracle.count(frame.positions) for frame in frames]
    assert counts[0] == counts[2] == 2
    assert counts[1] > 2
    for shown, count in ((frames, counts[1] - 2), (frames[::2], 0)):
        met = MostMet(mesh, cloth)
        for frame in shown:
            met.watch(frame)
        assert met.count == count
