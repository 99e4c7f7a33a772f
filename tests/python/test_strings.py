"""Strings: edges beside the triangles are found, followed and drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame, square_sheet
from numpy.typing import ArrayLike
from test_render import SIZE, picture

from sphcloth.errors import UserError
from sphcloth.rendering.scene import Scene
from sphcloth.rendering.scene_roles import Choice, SceneRoles
from sphcloth.rendering.tubes import tubes
from sphcloth.roles import Roles
from sphcloth.strings import Strings
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(4)
FIRST, LAST = int(MESH.ids[0]), int(MESH.ids[-1])
MIDDLE, LOAD, RING = LAST + 1, LAST + 2, LAST + 3
# from two corners to a knot and on to a load; a ring that is tied to nothing; a seam and an edge
BONDS = [
    f"1 2 {FIRST} {MIDDLE}",
    f"2 2 {MIDDLE} {LAST}",
    f"3 2 {MIDDLE} {LOAD}",
    f"4 2 {RING} {RING + 1}",
    f"5 2 {RING + 1} {RING + 2}",
    f"6 2 {RING + 2} {RING}",
    f"7 3 {FIRST} {LAST}",
    f"8 1 {FIRST} {FIRST + 1}",
]
DATA = Path("scene.data")


def strings() -> Strings:
    found = Strings.of_bonds(BONDS, MESH, DATA)
    assert found is not None
    return found


def frame_of(free: ArrayLike, periodic: bool = True) -> Frame:
    """Return a frame of the sheet (type 1) and five free ends (type 2), in a box from -1 to 1."""
    positions = np.concatenate([SHEET, free])
    ids = np.arange(len(positions)) + 1
    values = [ids, np.where(ids <= LAST, 1, 2), *positions.T]
    columns = dict(zip(("id", "type", "x", "y", "z"), np.array(values, float), strict=True))
    return Frame(0, 0.0, np.array([[-1.0] * 3, [1.0] * 3]), columns, (periodic,) * 3)


def test_edges_between_vertices_of_triangles_are_no_strings() -> None:
    found = strings()
    assert len(found.links) == 6
    assert found.ids[found.is_free].tolist() == list(range(MIDDLE, RING + 3))
    # where three edges meet, and where a string ends; not in the ring
    assert found.ids[found.knots].tolist() == [MIDDLE, LOAD]
    assert Strings.of_bonds(BONDS[-2:], MESH, DATA) is None


def test_a_string_hangs_on_across_a_periodic_boundary() -> None:
    below = np.array([[0.5, 0.5, -0.6], [0.5, 0.5, 0.9], *3 * [[0.1, 0.2, 0.3]]])
    found = strings()
    places = found.positions(frame_of(below), SHEET)
    by_id = dict(zip(found.ids.tolist(), places, strict=True))
    assert by_id[LOAD] == pytest.approx([0.5, 0.5, -1.1])
    assert by_id[MIDDLE] == pytest.approx([0.5, 0.5, -0.6])
    wrapped = found.positions(frame_of(below, periodic=False), SHEET)
    assert dict(zip(found.ids.tolist(), wrapped, strict=True))[LOAD] == pytest.approx(below[1])


def test_the_ends_of_strings_are_no_water() -> None:
    frame = frame_of(np.full((5, 3), 0.5))
    assert SceneRoles.of([frame], Roles(mesh=MESH), Choice()).fluid == {2}
    assert not SceneRoles.of([frame], Roles(mesh=MESH, strings=strings()), Choice()).fluid


def test_strings_and_their_knots_are_in_the_picture() -> None:
    free = np.array([[0.5, 0.5, -0.4], [0.5, 0.5, -0.7], *3 * [[0.5, 0.5, -0.7]]])
    frame = frame_of(free)
    roles = SceneRoles.of([frame], Roles(mesh=MESH, strings=strings()), Choice())
    scene = Scene.of([frame], roles, SIZE)
    renderer = scene.renderer()
    geometry = renderer.geometry_of(frame, renderer.follow(frame))
    tube = geometry.solids[-1].surface
    assert tube.points[:, 2].min() == pytest.approx(-0.7, abs=1e-2)
    assert np.concatenate([balls.centers for balls in geometry.spheres]).tolist() == [
        pytest.approx(free[0]),
        pytest.approx(free[1]),
    ]
    bare = Scene.of([frame], SceneRoles.of([frame], Roles(mesh=MESH), Choice()), SIZE)
    assert not np.array_equal(picture(scene, frame), picture(bare, frame))


def test_a_tube_lies_around_its_edge() -> None:
    points = np.array([[0.0, 0, 0], [0, 0, 2], [1, 1, 1], [1, 1, 1]])
    surface = tubes(points, np.array([[0, 1], [2, 3]]), 0.1)
    straight = surface.points[:12]
    assert np.linalg.norm(straight[:, :2], axis=1) == pytest.approx(0.1)
    assert sorted(set(straight[:, 2])) == [0, 2]
    outward = np.einsum("ij,ij->i", surface.normals[:12, :2], straight[:, :2])
    assert (outward > 0).all()
    # an edge without length has no direction
    assert np.isfinite(surface.points).all()


@pytest.mark.parametrize("line", ["1 2 3 x", "1 2 3"])
def test_a_damaged_bond_is_named(line: str) -> None:
    with pytest.raises(UserError, match="section Bonds cannot be read"):
        Strings.of_bonds([line], MESH, DATA)


def test_a_lost_end_is_named() -> None:
    with pytest.raises(UserError, match=f"vertex {MIDDLE} is not in the dump"):
        strings().positions(make_frame(0, [], SHEET), SHEET)


def test_a_sheet_alone_has_none(cloth_data: Path) -> None:
    assert Roles.read(cloth_data).strings is None
