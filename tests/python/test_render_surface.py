"""What a picture is made of: the water's surface, pixels, camera, light, smooth cloth."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import square_sheet
from trimesh.geometry import faces_to_edges
from trimesh.graph import connected_component_labels

from sphcloth.rendering import light
from sphcloth.rendering.camera import Camera, ParallelView
from sphcloth.rendering.light import Light, Spheres
from sphcloth.rendering.particles import Particles
from sphcloth.rendering.raster import disc_fragments, nearest, triangle_fragments
from sphcloth.rendering.subdivision import Refinement
from sphcloth.rendering.surface import Surface, water_surface

MESH, SHEET = square_sheet(6)
SIZE = (96, 72)


@pytest.fixture(autouse=True)
def small_maps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spend no time on fine shadows."""
    monkeypatch.setattr(light, "SUN_PIXELS", 200)


def block(
    n: int, spacing: float = 1.0, corner: tuple[float, float, float] = (0, 0, 0)
) -> np.ndarray:
    """Return a cube of particles, shape (n**3, 3); its water is ``n * spacing`` long."""
    line = (np.arange(n) + 0.5) * spacing
    return np.stack(np.meshgrid(line, line, line, indexing="ij"), -1).reshape(-1, 3) + corner


def surface_of(positions: np.ndarray, spacing: float = 1.0) -> Surface:
    positions = np.asarray(positions, float)
    return water_surface(Particles(positions, np.full(len(positions), spacing)))


def volume(surface: Surface) -> float:
    a, b, c = surface.points[surface.triangles.T]
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def bodies(surface: Surface) -> int:
    """Return the number of connected parts of a surface."""
    edges = faces_to_edges(surface.triangles)
    return int(connected_component_labels(edges, len(surface.points)).max()) + 1


# the surface


def test_water_has_the_volume_of_its_particles() -> None:
    # less what the round edges lack
    assert 920 < volume(surface_of(block(10))) < 1000


def test_a_drop_has_about_its_volume() -> None:
    # on a grid of four nodes a spacing the ball loses a little by smoothing
    assert 0.7 < volume(surface_of([[0.3, 0.1, 0.2]])) < 1.1


def test_still_water_is_flat_and_ends_half_a_spacing_over_the_last_particles() -> None:
    surface = surface_of(block(12))
    middle = np.all(abs(surface.points[:, :2] - 6) < 3, axis=1)
    top = surface.points[middle & (surface.points[:, 2] > 6)]
    np.testing.assert_allclose(top[:, 2], 12, atol=0.1)
    assert np.std(top[:, 2]) < 0.02


def test_normals_point_out_of_the_water() -> None:
    surface = surface_of([[0.0, 0, 0]])
    assert np.all(np.einsum("ij,ij->i", surface.points, surface.normals) > 0)


@pytest.mark.parametrize(("gap", "parts"), [(0.0, 1), (2.0, 2)])
def test_bodies_of_water_that_are_apart_stay_so(gap: float, parts: int) -> None:
    positions = np.concatenate([block(6), block(6, corner=(6 + gap, 0, 0))])
    assert bodies(surface_of(positions)) == parts


def test_water_of_two_resolutions_is_one_body() -> None:
    coarse, fine = block(6), block(12, 0.5, (6, 0, 0))
    spacing = np.repeat([1.0, 0.5], [len(coarse), len(fine)])
    surface = water_surface(Particles(np.concatenate([coarse, fine]), spacing))
    assert bodies(surface) == 1
    assert volume(surface) == pytest.approx(432, rel=0.08)


def test_values_are_carried_to_the_surface() -> None:
    positions = block(8)
    surface = water_surface(Particles(positions, np.ones(512), positions[:, 0]))
    x = surface.points[:, 0]
    inner = abs(x - 4) < 2
    np.testing.assert_allclose(surface.values[inner], x[inner], atol=0.3)


def test_no_particles_no_surface() -> None:
    assert len(surface_of(np.zeros((0, 3))).triangles) == 0


# triangles and spheres to pixels


def test_pixels_belong_to_the_triangle_that_holds_their_middle() -> None:
    shape, rng = (20, 30), np.random.default_rng(1)
    places = rng.uniform(-8, 36, (40, 3, 2))
    near = rng.uniform(1, 2, (40, 3))
    visible = nearest(triangle_fragments(places, near, shape), np.full(600, -np.inf))
    rows, columns = np.divmod(np.arange(600), 30)
    middles = np.stack([columns + 0.5, rows + 0.5], 1)
    best = np.full(600, -np.inf)
    for corners, values in zip(places, near, strict=True):
        shares = np.linalg.solve(np.vstack([corners.T, np.ones(3)]), np.c_[middles, np.ones(600)].T)
        best = np.where((shares >= 0).all(0), np.maximum(best, values @ shares), best)
    np.testing.assert_allclose(visible.nearness, best)


def test_neighbors_leave_no_gap_and_no_overlap() -> None:
    sheet = SHEET[:, :2] @ [[17.0, 4.0], [-5.0, 13.0]] + [9.0, 2.0]
    places = sheet[MESH.triangles]
    parts = triangle_fragments(places, np.ones(places.shape[:2]), (24, 32))
    counts = np.bincount(np.concatenate([part.pixel for part in parts]))
    assert set(counts.tolist()) == {0, 1}
    assert counts.sum() == pytest.approx(17 * 13 + 4 * 5, abs=4)


def test_triangles_behind_the_camera_are_left_out() -> None:
    places = np.array([[[0, 0], [np.nan, np.nan], [9, 9]]], float)
    assert not list(triangle_fragments(places, np.ones((1, 3)), (9, 9)))


def test_balls_are_round_and_bulge() -> None:
    (disc,) = disc_fragments(np.array([[10.0, 12.0]]), np.array([6.0]), (24, 20))
    assert len(disc.pixel) == pytest.approx(np.pi * 36, abs=4)
    assert disc.bulge.max() == pytest.approx(1, abs=0.01)


# camera and light


def test_rays_lead_back_to_the_points() -> None:
    camera = Camera(np.array([3.0, -4, 2]), np.array([0.0, 1, 0]), (400, 300))
    points = np.random.default_rng(2).uniform(-0.5, 0.5, (50, 3))
    places, near = camera.project(points)
    column, row = np.floor(places).astype(int).T
    found = camera.position + camera.rays(row * 400 + column) / near[:, None]
    np.testing.assert_allclose(found, points, atol=2 / camera.focal / near.min())


def test_what_is_behind_the_camera_has_no_place() -> None:
    camera = Camera(np.array([0.0, -4, 0]), np.zeros(3), SIZE)
    assert np.isnan(camera.project(np.array([[0.0, -5, 0]]))[1]).all()


@pytest.mark.parametrize("direction", [[1.0, -1.8, 0.9], [0.0, 0.0, 1.0]])
def test_a_camera_takes_in_all_points(direction: list[float]) -> None:
    points = np.random.default_rng(3).normal(size=(40, 3))
    places, _ = Camera.framing(points, np.array(direction), SIZE).project(points)
    assert np.all((places > 0) & (places < SIZE))


def test_a_turned_camera_keeps_its_distance_and_height() -> None:
    camera = Camera(np.array([3.0, -4, 2]), np.array([0.0, 1, 0]), SIZE)
    turned = camera.turned(np.pi)
    assert turned.distance == pytest.approx(camera.distance)
    np.testing.assert_allclose(turned.position, [-3, 6, 2])


def lit(solids: list[Surface], spheres: list[Spheres]) -> Light:
    sun = np.array([0.0, 0.0, 1.0])
    return Light.on(solids, Surface.empty(), spheres, sun, (np.array([0.5, 0.5, 0]), 3.0))


@pytest.mark.parametrize("as_sphere", [False, True])
def test_things_cast_shadows(as_sphere: bool) -> None:
    fine = Refinement.of(MESH.triangles, len(SHEET), 100_000)
    sheet = Surface.of(fine.weights @ SHEET + [0, 0, 1], fine.triangles)
    ball = Spheres(np.array([[0.5, 0.5, 1.0]]), np.array([0.5]), np.ones((1, 3)))
    lamp = lit([], [ball]) if as_sphere else lit([sheet], [])
    points = np.array([[0.5, 0.5, 0], [2.0, 0.5, 0]])
    up = np.tile([0.0, 0.0, 1.0], (2, 1))
    np.testing.assert_allclose(lamp.sunshine(points, up), [0, 1])
    if not as_sphere:
        dark, bright = lamp.skylight(points, up)
        assert dark < 0.8 < bright
    # beyond the map there is nothing in the way
    assert lamp.sunshine(np.array([[90.0, 0, 0]]), up[:1]) == 1


def test_a_parallel_view_keeps_distances() -> None:
    view = ParallelView(np.array([0.6, 0.0, 0.8]), np.zeros(3), 2.0, 100)
    places, near = view.project(np.array([[0.6, 0, 0.8], [0.0, 1, 0]]))
    np.testing.assert_allclose(near, [1, 0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(places - 50, axis=1), [0, 25], atol=1e-9)


# subdivision


def test_subdivision_keeps_planes_borders_and_winding() -> None:
    fine = Refinement.of(MESH.triangles, len(SHEET), 5000)
    points = fine.weights @ SHEET
    a, b, c = points[fine.triangles.T]
    assert len(fine.triangles) == 64 * len(MESH.triangles)
    assert np.all(np.cross(b - a, c - a)[:, 2] > 0)
    np.testing.assert_allclose(np.cross(b - a, c - a)[:, 2].sum() / 2, 1)


def test_subdivision_rounds_a_ridge_off() -> None:
    ridge = SHEET * [1, 1, 0] + np.array([0, 0, 1]) * np.minimum(SHEET[:, :1], 1 - SHEET[:, :1])
    fine = Refinement.of(MESH.triangles, len(SHEET), 5000)
    inner = fine.weights @ ridge
    assert 0.4 < inner[abs(inner[:, 1] - 0.5) < 0.2, 2].max() < 0.49


def test_three_triangles_at_an_edge_are_no_obstacle_to_subdivision() -> None:
    triangles = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert len(Refinement.of(triangles, 5, 12).triangles) == 12
