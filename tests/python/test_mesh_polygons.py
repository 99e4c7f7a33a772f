"""Polygons of mesh files become triangles that cover them once."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh
from test_cli import call

from sphcloth.errors import UserError
from sphcloth.meshing import Surface, read_surface

RNG = np.random.default_rng(5)
# in the positive sense; a fan from the second corner of each folds
ELL = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]], float)
DART = np.array([[0, 0, 0], [1, 2, 0], [0, 0.5, 0], [-1, 2, 0]])
TENTHS = np.arange(10) * np.pi / 5
RADII = np.where(np.arange(10) % 2, 0.3, 1.0)
STAR = np.column_stack([RADII * np.cos(TENTHS), RADII * np.sin(TENTHS), np.zeros(10)])
Faces = Sequence[Sequence[int]]


def _rows(vertices: np.ndarray, before: str = "") -> str:
    return "".join(f"{before}{x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())


def _counted(faces: Faces) -> str:
    return "".join(f"{len(face)} {' '.join(map(str, face))}\n" for face in faces)


def _ply_head(vertices: np.ndarray, faces: Faces, kind: str) -> str:
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    return (
        f"ply\nformat {kind} 1.0\nelement vertex {len(vertices)}\n{axes}element face {len(faces)}\n"
        "property list uchar int vertex_index\nend_header\n"
    )


def write_obj(path: Path, vertices: np.ndarray, faces: Faces) -> None:
    lines = "".join(f"f {' '.join(str(n + 1) for n in face)}\n" for face in faces)
    path.write_text(_rows(vertices, "v ") + lines)


def write_off(path: Path, vertices: np.ndarray, faces: Faces) -> None:
    counts = f"OFF # polygons\n{len(vertices)} {len(faces)} 0\n"
    path.write_text(counts + _rows(vertices) + _counted(faces))


def write_ply(path: Path, vertices: np.ndarray, faces: Faces) -> None:
    path.write_text(_ply_head(vertices, faces, "ascii") + _rows(vertices) + _counted(faces))


def write_binary(path: Path, vertices: np.ndarray, faces: Faces) -> None:
    lists = b"".join(struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces)
    head = _ply_head(vertices, faces, "binary_little_endian").encode()
    path.write_bytes(head + vertices.astype("<f8").tobytes() + lists)


WRITERS = {"a.obj": write_obj, "a.off": write_off, "a.ply": write_ply, "binary.ply": write_binary}


def normals_of(surface: Surface) -> np.ndarray:
    """Twice the areas along z."""
    a, b, c = surface.vertices[surface.triangles.T]
    return np.cross(b - a, c - a)[:, 2]


def area_of(polygon: np.ndarray) -> float:
    """Signed area in the x-y plane, by the shoelace formula."""
    (x, y), (u, v) = polygon[:, :2].T, np.roll(polygon[:, :2], -1, axis=0).T
    return float(np.sum(x * v - u * y) / 2)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("polygon", [ELL, DART, STAR], ids=["ell", "dart", "star"])
def test_concave_polygons_are_covered_once(tmp_path: Path, name: str, polygon: np.ndarray) -> None:
    """Two of them, one in each sense, from every corner."""
    n = len(polygon)
    vertices = np.concatenate([polygon, polygon + np.array([5, 0, 0])])
    for first in range(n):
        face = np.roll(np.arange(n), first)
        WRITERS[name](tmp_path / name, vertices, [face, n + face[::-1]])
        surface, repairs = read_surface(tmp_path / name)
        doubled = normals_of(surface)
        assert not repairs and len(doubled) == 2 * (n - 2)
        of_second = surface.vertices[surface.triangles[:, 0], 0] > 3.5
        for turn, mine in ((1, doubled[~of_second]), (-1, doubled[of_second])):
            assert np.all(turn * mine > 0)
            assert np.sum(turn * mine) / 2 == pytest.approx(area_of(polygon), rel=1e-12)


def test_random_polygons_in_space_keep_their_area(tmp_path: Path) -> None:
    for _ in range(40):
        n = RNG.integers(5, 20)
        angles = (np.arange(n) + RNG.random(n)) * 2 * np.pi / n
        radii = RNG.uniform(0.1, 1, n)
        polygon = np.column_stack([radii * np.cos(angles), radii * np.sin(angles), 0 * radii])
        turned = polygon @ np.linalg.qr(RNG.normal(size=(3, 3)))[0] + RNG.normal(size=3)
        write_obj(tmp_path / "a.obj", turned, [range(n)])
        surface, _ = read_surface(tmp_path / "a.obj")
        assert surface.areas.sum() == pytest.approx(area_of(polygon), rel=1e-9)


@pytest.mark.parametrize("writer", [write_obj, write_ply])
def test_a_concave_polygon_among_others(tmp_path: Path, writer: Callable) -> None:
    """Its neighbors, a triangle and a square, keep their order and their corners."""
    vertices = np.concatenate([ELL, [[2, -1, 0], [0, -1, 0], [4, -1, 0], [4, 0, 0]]])
    path = tmp_path / ("a.obj" if writer is write_obj else "a.ply")
    writer(path, vertices, [[1, 6, 8, 9], [1, 2, 3, 4, 5, 0], [0, 7, 1], [1, 7, 6]])
    surface, _ = read_surface(path)
    assert surface.triangles[:2].tolist() == [[1, 6, 8], [1, 8, 9]]
    assert surface.triangles[-2:].tolist() == [[0, 7, 1], [1, 7, 6]]
    assert np.all(normals_of(surface) > 0)
    assert surface.areas.sum() == pytest.approx(3 + 2 + 2)
    assert len(surface.boundary_edges) == 10


def test_corners_with_textures_and_counted_back(tmp_path: Path) -> None:
    corners = " ".join(f"{n - 6}/{n + 1}" for n in [1, 2, 3, 4, 5, 0])
    lines = f"vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 1 2\nvt 2 2\nf {corners}\nv 9 9 9\n"
    (tmp_path / "a.obj").write_text(_rows(ELL, "v ") + lines)
    surface, repairs = read_surface(tmp_path / "a.obj")
    assert surface.areas.sum() == pytest.approx(3)
    assert repairs == ["1 vertices without a triangle removed"]


@pytest.mark.parametrize("name", WRITERS)
def test_convex_polygons_are_fans(tmp_path: Path, name: str) -> None:
    """The triangles of trimesh, which a wavy sheet of squares keeps, too."""
    x, y = np.meshgrid(np.arange(9.0), np.arange(8.0), indexing="ij")
    vertices = np.stack([x, y, 2 * np.sin(x) * np.cos(2 * y)], axis=-1).reshape(-1, 3)
    number = np.arange(72).reshape(9, 8)
    squares = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1)
    WRITERS[name](tmp_path / name, vertices, squares.reshape(-1, 4).tolist())
    surface, _ = read_surface(tmp_path / name)
    expected = trimesh.load_mesh(tmp_path / name, process=False)
    assert surface.triangles.tolist() == expected.faces.tolist()
    assert surface.vertices.tolist() == expected.vertices.tolist()


@pytest.mark.parametrize("corners", [[0, 4, 2, 6], [0, 4, 8, 2, 6]])
@pytest.mark.parametrize("others", [[], [[0, 1, 2]], [[1, 2, 3, 4, 5, 6, 7, 8, 9, 0]]])
def test_a_polygon_that_crosses_itself_is_named(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    corners: list[int],
    others: list[list[int]],
) -> None:
    mesh, data = tmp_path / "a.obj", tmp_path / "x.data"
    write_obj(mesh, STAR, [*others, corners])
    assert call(monkeypatch, "mesh", str(mesh), "--areal-mass", "1", "--data", str(data)) == 2
    shown = " ".join(capsys.readouterr().err.split())
    assert f"the polygon of {len(corners)} corners around (" in shown
    assert "crosses or touches itself" in shown
    assert not data.exists()


@pytest.mark.parametrize("corner", [0, 12])
def test_a_corner_that_is_not_in_the_file_is_an_error(tmp_path: Path, corner: int) -> None:
    path = tmp_path / "a.ply"
    write_ply(path, ELL, [[0, 1, 2, 3], [0, 1, corner or -1, 5]])
    with pytest.raises(UserError, match=r"a.ply"):
        read_surface(path)
