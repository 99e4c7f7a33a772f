"""Surfaces of triangles: repairs, winding, hinges, seams and pins."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from test_meshing import grid

from sphcloth.errors import UserError
from sphcloth.meshing import Material, Seams, Surface, build_cloth, read_surface
from sphcloth.meshing.command import group_names
from sphcloth.meshing.lammps_files import _id_ranges
from sphcloth.meshing.load import mend_flat, merge_vertices, repair
from sphcloth.meshing.pins import select_vertices
from sphcloth.meshing.surface import check_manifold, join, orient


@pytest.mark.parametrize(
    ("selection", "expected"),
    [
        ("z>0.9", [3, 7, 11, 15]),
        ("z >= 1 and x<=0", [3]),
        ("z>0.9 & x>0.5 & x<0.7", [11]),
        ("box -1 0.1 -1 1 0.3 0.7", [1, 2]),
        ("ids 1,3-4 16", [0, 2, 3, 15]),
        ("border", [0, 1, 2, 3, 4, 7, 8, 11, 12, 13, 14, 15]),
    ],
)
def test_pin_selections(selection: str, expected: list[int]) -> None:
    sheet = grid(3, 3)
    surface = Surface.of(sheet.vertices, sheet.faces)
    assert np.flatnonzero(select_vertices(surface, selection)).tolist() == expected


@pytest.mark.parametrize(
    ("selection", "message"),
    [
        ("z>5", "selects no vertex"),
        ("z=1", "not understood"),
        ("z>one", "'one' is no number"),
        ("__import__('os')", "not understood"),
        ("ids 0", "not within the vertices 1 to 16"),
        ("ids 3-99", "not within the vertices 1 to 16"),
        ("ids a", "no number or range"),
        ("ids", "not understood"),
        ("box 1 2 3", "a box is XLO XHI"),
        ("box 1 0 0 1 0 1", "low before high"),
        ("", "not understood"),
    ],
)
def test_a_wrong_selection_says_what_is_right(selection: str, message: str) -> None:
    sheet = grid(3, 3)
    with pytest.raises(UserError, match=re.escape(message)):
        select_vertices(Surface.of(sheet.vertices, sheet.faces), selection)


def test_ids_become_ranges() -> None:
    assert _id_ranges(np.array([1, 2, 3, 7, 9, 10])) == ["1:3 7 9:10"]
    assert _id_ranges(np.array([], int)) == []


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
HALVES = [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(
    ("vertices", "triangles", "said", "counts"),
    [
        (SQUARE, [*HALVES, [2, 0, 1]], "1 repeated triangles removed", (4, 2)),
        ([*SQUARE, [9, 9, 9]], HALVES, "1 vertices without a triangle removed", (4, 2)),
        ([*SQUARE, [np.nan] * 3], HALVES, "1 vertices without a triangle removed", (4, 2)),
        ([*SQUARE, [1, 0, 0]], [[0, 4, 2], [0, 2, 3], [4, 1, 2]], "1 vertices at the", (4, 2)),
        (SQUARE, [*HALVES, [1, 1, 2]], "1 triangles with an edge of length zero", (4, 2)),
        # a flat triangle on the diagonal and one at the border
        (
            [*SQUARE, [0.5, 0.5, 0]],
            [[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]],
            "1 flat triangles removed",
            (5, 4),
        ),
        ([*SQUARE, [0.5, 0, 0]], [*HALVES, [0, 1, 4]], "1 flat triangles removed", (5, 3)),
        ([*SQUARE, [2, 0, 0]], [*HALVES, [0, 4, 1]], "1 flat triangles removed", (4, 2)),
    ],
)
def test_repairs_are_reported(
    vertices: list, triangles: list, said: str, counts: tuple[int, int]
) -> None:
    area = 1.0
    surface, report = repair(Surface.of(np.array(vertices, float), triangles))
    assert any(line.startswith(said) for line in report), report
    assert (len(surface.vertices), len(surface.triangles)) == counts
    assert surface.areas.sum() == pytest.approx(area)
    assert orient(surface)[1] == 0


def test_close_vertices_merge_as_far_as_asked() -> None:
    vertices = [*SQUARE, [1.001, 0, 0]]
    surface = Surface.of(vertices, [[0, 4, 2], [0, 2, 3]])
    both = join([surface, Surface.of(SQUARE, HALVES)])
    assert merge_vertices(both, 1e-4)[1] == 3 + 1  # vertex 1 of the first is unused
    assert len(merge_vertices(both, 0.01)[0].vertices) == 4


def test_a_chain_of_flat_triangles_is_mended() -> None:
    """Two vertices on one edge, joined by flat triangles."""
    vertices = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, -3, 0], [1, 0, 0], [2, 0, 0]]
    triangles = [[0, 1, 2], [1, 0, 4], [1, 4, 5], [0, 3, 4], [4, 3, 5], [5, 3, 1]]
    surface, removed = mend_flat(Surface.of(np.array(vertices, float), triangles))
    assert removed == 2
    assert surface.quality.min() > 0.1
    assert surface.n_boundary_loops == 1
    assert surface.areas.sum() == pytest.approx(9.0)
    assert orient(surface)[1] == 0


def test_inconsistent_winding_follows_the_majority() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = ball.faces.copy()
    faces[::3] = faces[::3][:, ::-1]
    surface, turned = orient(Surface.of(ball.vertices, faces))
    assert turned == len(faces[::3])
    assert trimesh.Trimesh(surface.vertices, surface.triangles, process=False).volume > 0


def test_a_moebius_strip_is_refused() -> None:
    angle = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    rim = [
        np.stack([(1 + s * np.cos(angle / 2)) * np.cos(angle),
                  (1 + s * np.cos(angle / 2)) * np.sin(angle), s * np.sin(angle / 2)], 1)
        for s in (-0.3, 0.3)
    ]  # fmt: skip
    a = np.arange(20)
    b, c, d = a + 20, (a + 1) % 20, (a + 1) % 20 + 20
    c[-1], d[-1] = d[-1], c[-1]
    triangles = np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    with pytest.raises(UserError, match="one side only"):
        orient(Surface.of(np.concatenate(rim), triangles))


def test_three_triangles_at_an_edge_are_refused() -> None:
    surface = Surface.of([*SQUARE, [0.5, 0.5, 1]], [*HALVES, [0, 2, 4]])
    with pytest.raises(UserError, match=r"1 edges have more than two .* with 3"):
        check_manifold(surface)


def test_hinges_run_wing_edge_edge_wing() -> None:
    """The angle of every hinge of a ball has the same sign: all are ridges."""
    ball = trimesh.creation.icosphere(subdivisions=1)
    a, e1, e2, b = Surface.of(ball.vertices, ball.faces).hinges.T
    x = ball.vertices
    first = np.cross(x[e1] - x[a], x[e2] - x[a])
    second = np.cross(x[e2] - x[b], x[e1] - x[b])
    assert np.all(np.einsum("ij,ij->i", first, x[a]) > 0)
    assert np.all(np.einsum("ij,ij->i", second, x[a]) > 0)
    sines = np.einsum("ij,ij->i", np.cross(first, second), x[e2] - x[e1])
    assert np.all(sines > 0) or np.all(sines < 0)


def test_sewing_too_far_is_refused() -> None:
    """On a line: a vertex of a first piece, of a second, of a third, and of the first again."""
    far = [[0, 1, 0], [0, -1, 0], [0, 0, 1]]
    pieces = [([0, 0.3], far[0]), ([0.1], far[1], [0, -2, 0]), ([0.2], far[2], [0, 0, 2])]
    surface = join(
        [Surface.of([*([x, 0, 0] for x in line), *rest], [[0, 1, 2]]) for line, *rest in pieces]
    )
    with pytest.raises(UserError, match="would join two vertices of one piece"):
        Seams.find(surface, 0.25)
    with pytest.raises(UserError, match="no borders of different pieces are so close"):
        Seams.find(surface, 0.05)


def test_borders_divided_differently_are_reported() -> None:
    left, right = grid(4, 4), grid(4, 8)
    surface = join(
        [
            Surface.of(left.vertices, left.faces),
            Surface.of(right.vertices + np.array([1.01, 0, 0]), right.faces),
        ]
    )
    seams = Seams.find(surface, 0.15)
    assert len(seams.pairs) == 5
    assert seams.widest == pytest.approx(0.01)
    assert seams.unpaired == 4


def test_quads_are_cut_in_two(tmp_path: Path) -> None:
    path = tmp_path / "quad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    surface, said = read_surface(path)
    assert (len(surface.triangles), said) == (2, [])
    assert surface.areas.sum() == pytest.approx(1)


def test_room_per_atom_is_what_lammps_stores() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    cloth = build_cloth(Surface.of(ball.vertices, ball.faces), [Material(1.0)])
    near = [set(np.flatnonzero((cloth.bonds[:, 1:] == v).any(axis=1))) for v in range(162)]
    assert max(map(len, near)) == 6
    room = cloth.room_per_atom()
    assert room["bond"] <= 6
    assert room["special"] == 36 - 1 + 0  # next to a vertex with five edges nothing has all 36


def test_names_of_groups_differ() -> None:
    names = group_names(
        [Path(name) for name in ("g_3.obj", "g.obj", "b/g.obj", "all.obj", "g.ply")]
    )
    assert names == ["g_3", "g", "g_4", "all_4", "g_5"]


def test_masses_that_are_no_numbers_are_refused() -> None:
    ball = trimesh.creation.icosphere(subdivisions=1)
    for areal, size, message in (
        (1e308, 1e3, "mass that is not finite"),
        (5e-324, 1e-3, "no mass"),
    ):
        with pytest.raises(UserError, match=message):
            build_cloth(Surface.of(size * ball.vertices, ball.faces), [Material(areal)])
