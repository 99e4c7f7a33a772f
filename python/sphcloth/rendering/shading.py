"""From surfaces to a picture: cloth, then water in front of it with refraction, then a tone curve.

Colors are linear until the last step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from sphcloth.rendering.camera import Camera, in_axes
from sphcloth.rendering.light import Light, Spheres, surroundings
from sphcloth.rendering.raster import (
    Fragments,
    Visible,
    disc_fragments,
    nearest,
    triangle_fragments,
)
from sphcloth.rendering.surface import Surface

# pixels of the drawing along a side of a pixel of the picture
SAMPLES = 2
# pixels that a thread works on at a time, and threads
PART, THREADS = 32_768, 2
SUNLIGHT = np.array([1.0, 0.94, 0.84]) * 1.55
SKYLIGHT_UP, SKYLIGHT_DOWN = np.array([0.50, 0.60, 0.74]), np.array([0.36, 0.33, 0.30])
FLOOR_COLOR = np.array([0.31, 0.36, 0.40])
BACKDROP_LOW, BACKDROP_HIGH = np.array([0.40, 0.50, 0.57]), np.array([0.10, 0.15, 0.21])
# its light is looked up in maps of a square around the scene, whose half side is in radii of it,
# and it fades into the background from a distance on
SHADOW_TEXELS, SKYLIGHT_TEXELS, FLOOR_REACH = 360, 90, 1.5
FADE_FROM, FADE_WIDTH = 0.6, 1.6
# the floor is a little less bright than its color says: it is the background
FLOOR_SUN = 0.75
# light that cloth lets through from its other side
TRANSMISSION = 0.35
# of water: share of light that is mirrored at a right angle, refractive index; color of deep
# water; and how fast red, green and blue are lost, over the length of the scene
MIRRORED, INDEX = 0.02, 1.33
DEEP = np.array([0.012, 0.12, 0.32])
ABSORPTION = np.array([14.0, 6.0, 2.6])
# light that grazes cloth, and light of the sun that spheres mirror
SHEEN, GLOSS = 0.10, 0.7
# walls: their color, and the share of it seen from in front and added from aside
GLASS_COLOR, GLASS_SHARE = np.array([0.75, 0.85, 0.93]), (0.10, 0.6)
EXPOSURE = 0.72
# colors of a quantity cover what is behind more than water does
TINT_POWER = 3
# what is behind all, in distances of the camera
BACKGROUND_DEPTH = 10.0


@dataclass(frozen=True)
class Solid:
    """Something opaque: a surface with a color on each side, linear, shape (3,) each."""

    surface: Surface
    front: NDArray[np.float64]
    back: NDArray[np.float64]


@dataclass(frozen=True)
class Geometry:
    """All that stands on the floor.

    Attributes:
        solids: cloth and obstacles.
        spheres: pins, and the water if it is drawn as spheres.
        water: its surface.
        tint: linear colors of its vertices, shape (V, 3); None for water's own.
        walls: the surface of boundary particles, drawn as clear as glass; they cast no shadow.
        light: what reaches all these.
    """

    solids: Sequence[Solid]
    spheres: Sequence[Spheres]
    water: Surface
    tint: NDArray[np.float64] | None
    walls: Surface
    light: Light


@dataclass(frozen=True)
class Environment:
    """What surrounds the geometry.

    Attributes:
        floor: height of the floor.
        center: the middle of all that is to be seen, shape (3,).
        radius: of a sphere around it that holds all.
        sun: towards the sun, a unit vector, shape (3,).
    """

    floor: float
    center: NDArray[np.float64]
    radius: float
    sun: NDArray[np.float64]


@dataclass(frozen=True)
class _Layer:
    """Colors, shape (P, 3), and depths, shape (P,), of all pixels; what is added overwrites."""

    color: NDArray[np.float32]
    depth: NDArray[np.float64]


def draw(camera: Camera, environment: Environment, geometry: Geometry) -> NDArray[np.uint8]:
    """Return a picture, shape (height, width, 3)."""
    fine = camera.enlarged(SAMPLES)
    light = geometry.light
    layer = _backdrop(camera, environment, light)
    for solid in geometry.solids:
        _add_solid(layer, fine, solid, light)
    for spheres in geometry.spheres:
        _add_spheres(layer, fine, spheres, light)
    if len(geometry.water.triangles):
        _add_water(layer, fine, environment, geometry)
    if len(geometry.walls.triangles):
        _add_glass(layer, fine, geometry.walls)
    return _develop(layer.color, camera)


def _backdrop(camera: Camera, environment: Environment, light: Light) -> _Layer:
    """Return the floor, which fades into the background, and its shadows."""
    maps = [
        _floor_map(share, texels, environment)
        for share, texels in ((light.sunshine, SHADOW_TEXELS), (light.skylight, SKYLIGHT_TEXELS))
    ]
    color = np.empty((camera.size[0] * camera.size[1], 3), np.float32)
    depth = np.full(len(color), np.inf)

    def fill(part: slice) -> None:
        rays = camera.rays(np.arange(len(color))[part])
        up = np.clip(0.45 + rays[:, 2] / 0.8, 0, 1)[:, None] ** 2
        color[part] = BACKDROP_LOW + up * (BACKDROP_HIGH - BACKDROP_LOW)
        height = environment.floor - camera.position[2]
        hits = np.flatnonzero(rays[:, 2] * height > 0)
        depth[part][hits] = height / rays[hits, 2]
        points = camera.position + depth[part][hits, None] * rays[hits]
        away = np.linalg.norm(points[:, :2] - environment.center[:2], axis=1) / environment.radius
        fade = np.exp(-((np.maximum(away - FADE_FROM, 0) / FADE_WIDTH) ** 2))[:, None]
        color[part][hits] += fade * (_floor(points, maps, environment) - color[part][hits])

    _in_parts(fill, len(color))
    return _Layer(_refined(color, camera), _refined(depth, camera))


def _in_parts(work: Callable[[slice], None], total: int) -> None:
    """Do work on parts of a range, small enough for their arrays to stay in the cache."""
    parts = [slice(start, min(start + PART, total)) for start in range(0, total, PART)]
    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(work, parts))


def _refined(values: NDArray, camera: Camera) -> NDArray:
    """Repeat the values of pixels for the finer pixels of the drawing."""
    grid = values.reshape(*camera.shape, -1).repeat(SAMPLES, 0).repeat(SAMPLES, 1)
    return grid.reshape(-1, *values.shape[1:])


def _floor(points: NDArray, maps: list[NDArray], environment: Environment) -> NDArray[np.float64]:
    """Return the color of the floor at points, shape (N, 3), from maps of its light."""
    sun, sky = (_between_texels(texels, points, environment)[:, None] for texels in maps)
    # more than half of the sky is dark where something stands: contact shadows
    return FLOOR_COLOR * (SUNLIGHT * FLOOR_SUN * environment.sun[2] * sun + SKYLIGHT_UP * sky**1.4)


def _floor_map(
    share: Callable[[NDArray, NDArray], NDArray], texels: int, environment: Environment
) -> NDArray[np.float64]:
    """Return a share of light on a square of the floor, shape (texels, texels)."""
    line = np.linspace(-FLOOR_REACH, FLOOR_REACH, texels) * environment.radius
    x, y = np.meshgrid(line + environment.center[0], line + environment.center[1], indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), np.full(x.size, environment.floor)], axis=1)
    shares = share(places, np.broadcast_to([0.0, 0.0, 1.0], places.shape)).reshape(x.shape)
    # the light comes from a few directions: without a blur each would have an edge of its own
    return ndimage.gaussian_filter(shares, 1.5)


def _between_texels(
    texels: NDArray, points: NDArray, environment: Environment
) -> NDArray[np.float64]:
    """Return the values of a map of the floor at points, shape (N,)."""
    places = 0.5 + 0.5 * (points[:, :2] - environment.center[:2]) / (
        FLOOR_REACH * environment.radius
    )
    return ndimage.map_coordinates(texels, places.T * (len(texels) - 1), order=1, mode="nearest")


@dataclass(frozen=True)
class _Patch:
    """Some pixels in which something is to be seen.

    Attributes:
        pixel: shape (F,).
        face: of the thing, shape (F,).
        depth: shape (F,).
        rays: unit vectors from the camera, shape (F, 3).
        stretch: length of a ray for a depth of 1, shape (F,).
        points: where the rays meet the thing, shape (F, 3).
    """

    pixel: NDArray[np.int64]
    face: NDArray[np.int64]
    depth: NDArray[np.float64]
    rays: NDArray[np.float64]
    stretch: NDArray[np.float64]
    points: NDArray[np.float64]

    @classmethod
    def of(cls, visible: Visible, pixel: NDArray, camera: Camera) -> _Patch:
        """Find out where the rays through some pixels end."""
        depth = 1 / visible.nearness[pixel]
        rays = camera.rays(pixel)
        points = camera.position + depth[:, None] * rays
        stretch = np.sqrt(_dot(rays, rays))
        return cls(pixel, visible.face[pixel], depth, rays / stretch[:, None], stretch, points)

    def interpolated(self, surface: Surface, *values: NDArray) -> Iterator[NDArray[np.float64]]:
        """Yield values of the vertices of a surface, shape (V, 3) each, at the points, (F, 3)."""
        corners = surface.triangles[self.face]
        shares = _barycentric(self.points, *np.moveaxis(surface.points[corners], 1, 0))
        for value in values:
            yield sum(
                share[:, None] * value[corner]
                for share, corner in zip(shares, corners.T, strict=True)
            )


def _barycentric(points: NDArray, *corners: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return the shares of three corners, shape (F, 3) each, in points of their plane, (F, 3)."""
    a, b, p = corners[1] - corners[0], corners[2] - corners[0], points - corners[0]
    aa, ab, bb, pa, pb = _dot(a, a), _dot(a, b), _dot(b, b), _dot(p, a), _dot(p, b)
    scale = 1 / np.maximum(aa * bb - ab**2, 1e-300)
    # the middle of a pixel at a border may be a little outside
    second = np.clip((pa * bb - pb * ab) * scale, 0, 1)
    third = np.clip((pb * aa - pa * ab) * scale, 0, 1)
    return 1 - second - third, second, third


def _paint(
    layer: _Layer, camera: Camera, visible: Visible, shade: Callable[[_Patch], NDArray]
) -> None:
    """Give the pixels in which something is nearest the colors that ``shade`` returns."""
    pixel = np.flatnonzero(visible.nearness * layer.depth > 1)
    color = np.empty((len(pixel), 3), np.float32)

    def fill(part: slice) -> None:
        color[part] = shade(_Patch.of(visible, pixel[part], camera))

    _in_parts(fill, len(pixel))
    layer.color[pixel] = color
    layer.depth[pixel] = 1 / visible.nearness[pixel]


def _triangles(surface: Surface, camera: Camera) -> Iterator[Fragments]:
    """Yield the fragments of a surface as a camera sees it."""
    places, near = camera.project(surface.points)
    corners = surface.triangles
    return triangle_fragments(places[corners], near[corners], camera.shape)


def _add_solid(layer: _Layer, camera: Camera, solid: Solid, light: Light) -> None:
    """Draw a solid, with the light that comes through it from its other side."""
    surface = solid.surface
    sides = [_arriving(surface.points, sign * surface.normals, light) for sign in (1, -1)]

    def shade(patch: _Patch) -> NDArray:
        normals, *arriving = patch.interpolated(surface, surface.normals, *sides)
        facing = -_dot(_unit(normals), patch.rays)
        front = (facing > 0)[:, None]
        here, beyond = np.where(front, *arriving), np.where(front, *arriving[::-1])
        color = np.where(front, solid.front, solid.back)
        sheen = SHEEN * ((1 - np.abs(facing)) ** 4)[:, None]
        return (color + sheen) * here + TRANSMISSION * color**2 * beyond

    _paint(layer, camera, nearest(_triangles(surface, camera), len(layer.depth)), shade)


def _arriving(points: NDArray, normals: NDArray, light: Light) -> NDArray[np.float64]:
    """Return the light that arrives at points of a surface, shape (N, 3)."""
    # a little light comes round the edge: cloth scatters
    cosine = np.clip((_along(normals, light.sun) + 0.08) / 1.08, 0, 1)
    sun = light.sunshine(points, normals) * cosine
    return _mixed(sun, light.skylight(points, normals), normals)


def _mixed(sun: NDArray, sky: NDArray, normals: NDArray) -> NDArray[np.float64]:
    """Return shares of sun and sky, shape (N,) each, as light on surfaces, shape (N, 3)."""
    up = (0.5 + 0.5 * normals[:, 2])[:, None]
    half = SKYLIGHT_DOWN + up * (SKYLIGHT_UP - SKYLIGHT_DOWN)
    return SUNLIGHT * sun[:, None] + half * sky[:, None]


def _add_spheres(layer: _Layer, camera: Camera, spheres: Spheres, light: Light) -> None:
    """Draw spheres, each in the light at its top; the shade follows its shape."""
    up = np.broadcast_to([0.0, 0.0, 1.0], spheres.centers.shape)
    top = spheres.centers + spheres.radius[:, None] * up
    sun, sky = light.sunshine(top, up), light.skylight(top, up)

    def shade(patch: _Patch) -> NDArray:
        normals = _unit(patch.points - spheres.centers[patch.face])
        bright = sun[patch.face]
        toward = bright * np.clip(_along(normals, light.sun), 0, 1)
        gloss = bright * np.clip(_along(_bounced(patch.rays, normals), light.sun), 0, 1) ** 40
        arriving = _mixed(toward, sky[patch.face], normals)
        return spheres.colors[patch.face] * arriving + GLOSS * gloss[:, None]

    _paint(layer, camera, nearest(_discs(spheres, camera), len(layer.depth)), shade)


def _discs(spheres: Spheres, camera: Camera) -> Iterator[Fragments]:
    """Yield the fragments of spheres as a camera sees them."""
    places, near = camera.project(spheres.centers)
    reach = np.nan_to_num(camera.focal * spheres.radius * near)
    for discs in disc_fragments(places, reach, camera.shape):
        depth = 1 / near[discs.disc] - spheres.radius[discs.disc] * discs.bulge
        yield Fragments(discs.disc, discs.pixel, 1 / depth)


def _add_water(layer: _Layer, camera: Camera, environment: Environment, geometry: Geometry) -> None:
    """Draw water: what is behind, bent and dimmed by it, its own color, and what it mirrors."""
    water, thickness = geometry.water, np.zeros(len(layer.depth))
    visible = nearest(_measured(water, camera, layer.depth, thickness), len(layer.depth))

    def shade(patch: _Patch) -> NDArray:
        normals, *tint = patch.interpolated(
            water, water.normals, *([] if geometry.tint is None else [geometry.tint])
        )
        normals = _unit(normals)
        normals *= -np.sign(_dot(normals, patch.rays))[:, None]
        path = np.maximum(thickness[patch.pixel], 0) * patch.stretch
        loss, own = np.exp(-path[:, None] * ABSORPTION / (2 * environment.radius)), DEEP
        if tint:
            loss, own = loss.mean(axis=1, keepdims=True) ** TINT_POWER, tint[0]
        inside = _refracted(layer, camera, patch, normals, path) * loss
        inside += own * (1 - loss) * _glow(normals, environment)
        steep = 1 - np.clip(-_dot(normals, patch.rays), 0, 1)
        mirrored = (MIRRORED + (1 - MIRRORED) * steep**5)[:, None]
        return inside + mirrored * (
            surroundings(_bounced(patch.rays, normals), environment.sun) - inside
        )

    _paint(layer, camera, visible, shade)


def _measured(
    water: Surface, camera: Camera, behind: NDArray, thickness: NDArray
) -> Iterator[Fragments]:
    """Yield the fragments of water, and add up its thickness, shape (P,), on the way.

    Rays enter where a triangle faces the camera and leave where one does not; what is farther
    than the things behind counts as there.
    """
    places, _ = camera.project(water.points)
    a, b, c = np.moveaxis(places[water.triangles], 1, 0)
    # rows count downwards: what is counter-clockwise outside turns the other way in pixels
    sign = np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    for part in _triangles(water, camera):
        depth = np.minimum(
            1 / part.nearness, np.minimum(behind[part.pixel], BACKGROUND_DEPTH * camera.distance)
        )
        np.add.at(thickness, part.pixel, sign[part.face] * depth)
        yield part


def _refracted(
    layer: _Layer, camera: Camera, patch: _Patch, normals: NDArray, path: NDArray
) -> NDArray[np.float32]:
    """Return the colors behind water, looked up where refraction leads."""
    aside = (1 / INDEX - 1) * in_axes(normals, camera.axes[:2]) * path[:, None]
    shift = aside * (camera.focal / (patch.depth + path))[:, None]
    row, column = np.divmod(patch.pixel, camera.size[0])
    column = np.clip(column + np.round(shift[:, 0]).astype(np.int64), 0, camera.size[0] - 1)
    row = np.clip(row - np.round(shift[:, 1]).astype(np.int64), 0, camera.size[1] - 1)
    there = row * camera.size[0] + column
    # what is nearer than the water does not show through it
    return layer.color[np.where(layer.depth[there] > patch.depth, there, patch.pixel)]


def _glow(normals: NDArray, environment: Environment) -> NDArray[np.float64]:
    """Return the light that water scatters under its surface, shape (N, 3)."""
    sun = np.clip(0.35 + 0.65 * _along(normals, environment.sun), 0, 1)[:, None]
    return 0.75 * SUNLIGHT * sun + 0.8 * SKYLIGHT_UP


def _add_glass(layer: _Layer, camera: Camera, walls: Surface) -> None:
    """Draw walls so that one sees through them: bright where they are seen from aside."""

    def shade(patch: _Patch) -> NDArray:
        (normals,) = patch.interpolated(walls, walls.normals)
        aside = 1 - np.abs(_dot(_unit(normals), patch.rays))
        share = (GLASS_SHARE[0] + GLASS_SHARE[1] * aside**3)[:, None]
        color = layer.color[patch.pixel]
        return color + share * (GLASS_COLOR - color)

    _paint(layer, camera, nearest(_triangles(walls, camera), len(layer.depth)), shade)


def _develop(color: NDArray, camera: Camera) -> NDArray[np.uint8]:
    """Return a picture from linear colors: a tone curve that keeps highlights, then sRGB."""
    rows = color.reshape(*camera.shape[:1], -1)
    # a grain of less than a step of the 256 hides the steps in the sky
    grain = np.random.default_rng(0).random((*camera.shape, 1), np.float32) - 0.5
    picture = np.empty((*camera.shape, 3), np.uint8)

    def fill(part: slice) -> None:
        for row in range(camera.shape[0])[part]:
            x = np.maximum(rows[row], 0) * EXPOSURE
            # the curve of Narkowicz (2015) for the film response of the Academy
            x = np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)
            x = x.reshape(SAMPLES, camera.shape[1], SAMPLES, 3).mean(axis=(0, 2))
            x = np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
            picture[row] = np.clip(np.round(255 * x + grain[row]), 0, 255)

    _in_parts(fill, camera.shape[0])
    return picture


def _unit(vectors: NDArray) -> NDArray[np.float64]:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)


def _dot(a: NDArray, b: NDArray) -> NDArray[np.float64]:
    return np.einsum("ij,ij->i", a, b)


def _along(vectors: NDArray, direction: NDArray) -> NDArray[np.float64]:
    return in_axes(vectors, direction[None])[:, 0]


def _bounced(rays: NDArray, normals: NDArray) -> NDArray[np.float64]:
    """Return the directions of rays after a mirror, shape (N, 3)."""
    return rays - 2 * _dot(rays, normals)[:, None] * normals
