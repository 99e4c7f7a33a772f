"""How pictures come about: samples, the backdrop, what hides what, and threads."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import make_frame, square_sheet
from scipy import ndimage
from test_render_surface import block

from sphcloth.rendering import backdrop, canvas, light, scene
from sphcloth.rendering.camera import Camera
from sphcloth.rendering.canvas import SAMPLES, Canvas
from sphcloth.rendering.light import Light
from sphcloth.rendering.scene import Scene
from sphcloth.rendering.scene_roles import Choice, SceneRoles
from sphcloth.rendering.shading import Geometry, Solid, View
from sphcloth.rendering.surface import Surface
from sphcloth.roles import Roles

MESH, SHEET = square_sheet(6)
SIZE = (96, 72)
CAMERA = Camera(np.array([3.0, -4, 2]), np.array([0.0, 0, 0]), SIZE)


@pytest.fixture(autouse=True)
def draw_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spend no time on what a small picture does not show."""
    monkeypatch.setattr(scene, "FINE_TRIANGLES", 5000)
    monkeypatch.setattr(backdrop, "SHADOW_TEXELS", 60)
    monkeypatch.setattr(light, "SUN_PIXELS", 200)


# samples


def test_a_sample_is_a_part_of_its_pixel() -> None:
    ground = np.zeros((SIZE[0] * SIZE[1], 3), np.float32)
    row, column = 2 * SAMPLES + 1, 5 * SAMPLES
    sample = np.array([row * SAMPLES * SIZE[0] + column], np.int32)
    drawn = Canvas.of(CAMERA, ground, [sample])
    drawn.paint(sample, np.ones((1, 3)))
    np.testing.assert_array_equal(drawn.at(sample), 1)
    neighbors = sample + np.array([1, -1, -SAMPLES * SIZE[0]], np.int32)
    np.testing.assert_array_equal(drawn.at(neighbors), 0)
    bright = np.argwhere(drawn.developed().max(axis=2) > 50)
    assert bright.tolist() == [[2, 5]]


def test_a_pixel_whose_samples_are_all_alike_is_like_one_without_samples() -> None:
    ground = np.random.default_rng(0).random((SIZE[0] * SIZE[1], 3), np.float32)
    everywhere = np.arange(len(ground) * SAMPLES**2, dtype=np.int32)
    plain, sampled = (Canvas.of(CAMERA, ground, part) for part in ([], [everywhere]))
    np.testing.assert_array_equal(plain.developed(), sampled.developed())


# the backdrop


def test_between_texels_the_light_of_the_floor_is_linear() -> None:
    rng = np.random.default_rng(4)
    texels, places = rng.random((9, 9)), rng.uniform(-0.2, 1.2, (200, 2))
    found = backdrop._interpolation(places, 9) @ texels.ravel()
    clipped = np.clip(places, 0, 1).T * 8
    np.testing.assert_allclose(found, ndimage.map_coordinates(texels, clipped, order=1), atol=1e-6)


def test_rays_that_lean_aside_meet_nothing_that_is_farther_away_than_was_looked() -> None:
    view = light.ParallelView(np.array([0.0, 0, 1]), np.zeros(3), 1.0, 120)
    nearness = np.full((120, 120), -np.inf)
    nearness[50:70, 50:70] = 0.5
    nearness[90, 20] = 0.2
    shadows = light._ShadowMap(view, light._bordered(nearness))
    places = np.random.default_rng(5).uniform(-10, 130, (4000, 2))
    near = np.zeros(len(places))
    straight = shadows._look(places)
    rise = np.maximum(np.where(np.isfinite(straight), straight, 0), light.MIN_RISE)
    reach = rise * light.SUN_SLOPE / view.pixel
    blocked = [shadows._look(places + reach[:, None] * slope) > near for slope in light._spiral(24)]
    softly = shadows.blocked_softly(places, near, 24)
    np.testing.assert_allclose(softly, np.mean(blocked, axis=0), atol=1e-6)
    assert 0 < np.mean(softly > 0) < 0.2


# what hides what


def sheet_at(height: float, color: float) -> Solid:
    surface = Surface.of((SHEET - [0.5, 0.5, 0]) * [2, 2, 1] + [0, 0, height], MESH.triangles)
    return Solid(surface, np.full(3, color), np.full(3, color))


def drawn(solids: list[Solid]) -> np.ndarray:
    environment = backdrop.Environment(-0.5, np.zeros(3), 2.0, np.array([0.0, 0, 1]))
    surfaces = [solid.surface for solid in solids]
    room = (environment.center, environment.radius)
    lamp = Light.on(surfaces, Surface.empty(), [], environment.sun, room)
    geometry = Geometry(solids, [], Surface.empty(), None, Surface.empty(), lamp)
    return View(CAMERA, environment).draw(geometry)


def test_the_nearer_of_two_solids_is_seen_in_whatever_order_they_come() -> None:
    upper, lower = sheet_at(0.3, 0.8), sheet_at(0.0, 0.0)
    picture = drawn([upper, lower])
    np.testing.assert_array_equal(picture, drawn([lower, upper]))
    (column, row) = CAMERA.project(np.array([[0.0, 0, 0.3]]))[0][0].astype(int)
    assert picture[row, column].min() > 100
    assert drawn([lower])[row, column].max() < 60


# threads


def test_pictures_do_not_depend_on_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    sag = SHEET - [0, 0, 0.2] * np.sin(np.pi * SHEET[:, :1])
    frames = [make_frame(0, [], SHEET), make_frame(1, block(4, 0.06, (0.4, 0.4, -0.1)), sag)]
    roles = SceneRoles.of(frames, Roles(mesh=MESH), Choice())
    pictures = []
    for threads in (1, 5):
        monkeypatch.setattr(canvas, "THREADS", threads)
        monkeypatch.setattr(canvas, "PART", 500)
        renderer = Scene.of(frames, roles, SIZE).renderer()
        made = [renderer.geometry_of(frame, renderer.follow(frame)) for frame in frames]
        pictures.append([renderer.picture(geometry) for geometry in made])
    np.testing.assert_array_equal(*pictures)
