"""From surfaces to a picture: cloth, then water in front of it with refraction.

Colors are linear until the last step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sphcloth.rendering.backdrop import Backdrop, Environment
from sphcloth.rendering.camera import Camera, columns, in_axes
from sphcloth.rendering.canvas import SAMPLES, Canvas, in_parts, sampled
from sphcloth.rendering.light import (
    SKYLIGHT_DOWN,
    SKYLIGHT_UP,
    SUNLIGHT,
    Light,
    Spheres,
    surroundings,
)
from sphcloth.rendering.raster import (
    Fragments,
    Visible,
    disc_fragments,
    nearest,
    triangle_fragments,
)
from sphcloth.rendering.surface import Surface

# light that cloth lets through from its other side
TRANSMISSION = 0.35
# of water: share of light that is mirrored at a right angle, refractive index; color of deep
# water; and how fast red, green and blue are lost, over the length of the scene
MIRRORED, INDEX = 0.02, 1.33
DEEP = np.array([0.012, 0.12, 0.32], np.float32)
ABSORPTION = np.array([14.0, 6.0, 2.6], np.float32)
# light that grazes cloth, and light of the sun that spheres mirror
SHEEN, GLOSS = 0.10, 0.7
# walls: their color, and the share of it seen from in front and added from aside
GLASS_COLOR, GLASS_SHARE = np.array([0.75, 0.85, 0.93], np.float32), (0.10, 0.6)
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


class View:
    """Draws what stands on the floor as one camera sees it."""

    def __init__(self, camera: Camera, environment: Environment) -> None:
        """Look at the floor, which stays as it is."""
        self._camera, self._environment = camera, environment
        self._backdrop = Backdrop.of(camera, environment)
        self._behind = sampled(self._backdrop.nearness.astype(np.float32), camera)

    def draw(self, geometry: Geometry) -> NDArray[np.uint8]:
        """Return a picture, shape (height, width, 3)."""
        camera, light = self._camera.enlarged(SAMPLES), geometry.light
        things = [
            *(_solid(solid, camera, light) for solid in geometry.solids),
            *(_balls(spheres, camera, light) for spheres in geometry.spheres),
        ]
        first = np.cumsum([0, *(thing.faces for thing in things)])
        opaque = nearest(_numbered(things, first), self._behind)
        thickness = np.zeros(len(self._behind))
        water = _seen(
            geometry.water,
            _measured(geometry.water, camera, opaque.nearness, thickness),
            opaque.nearness,
        )
        walls = _seen(geometry.walls, _triangles(geometry.walls, camera), water.nearness)
        canvas = Canvas.of(
            self._camera,
            self._backdrop.color(light),
            [visible.pixel for visible in (opaque, water, walls)],
        )
        owner = np.searchsorted(first, opaque.face[opaque.pixel], side="right") - 1
        for number, thing in enumerate(things):
            pixel = opaque.pixel[owner == number]
            _paint(canvas, camera, opaque, pixel, thing.shade, first[number])
        look = _water(geometry, camera, self._environment, canvas, opaque.nearness, thickness)
        _paint(canvas, camera, water, water.pixel, look)
        _paint(canvas, camera, walls, walls.pixel, _glass(geometry.walls, camera, canvas))
        return canvas.developed()


Shade = Callable[["_Patch"], NDArray[np.float32]]


@dataclass(frozen=True)
class _Thing:
    """Something opaque.

    Attributes:
        fragments: as the camera sees it.
        faces: their number.
        shade: returns the colors of a patch of it, shape (F, 3).
    """

    fragments: Iterator[Fragments]
    faces: int
    shade: Shade


def _numbered(things: Sequence[_Thing], first: NDArray) -> Iterator[Fragments]:
    """Yield the fragments of all things, their faces numbered from ``first`` on."""
    for thing, start in zip(things, first, strict=False):
        for part in thing.fragments:
            yield replace(part, face=part.face + start)


def _seen(surface: Surface, fragments: Iterator[Fragments], behind: NDArray) -> Visible:
    """Return what is to be seen of a surface in front of a nearness, shape (P,)."""
    if len(surface.triangles):
        return nearest(fragments, behind)
    return Visible(behind, np.zeros(0, np.int32))


@dataclass(frozen=True)
class _Patch:
    """Some samples in which something is to be seen.

    Attributes:
        pixel: shape (F,).
        face: of the thing, shape (F,).
        nearness: inverse of the depth, shape (F,).
        rays: unit vectors from the camera, shape (F, 3).
        stretch: length of a ray for a depth of 1, shape (F,).
        points: where the rays meet the thing, from the camera, shape (F, 3).
    """

    pixel: NDArray[np.int32]
    face: NDArray[np.int32]
    nearness: NDArray[np.float32]
    rays: NDArray[np.float32]
    stretch: NDArray[np.float32]
    points: NDArray[np.float32]

    @classmethod
    def of(cls, visible: Visible, pixel: NDArray, camera: Camera) -> _Patch:
        """Find out where the rays through some samples end."""
        nearness = visible.nearness[pixel]
        rays = camera.rays(pixel).astype(np.float32)
        points = rays / nearness[:, None]
        stretch = np.sqrt(_dot(rays, rays))
        return cls(pixel, visible.face[pixel], nearness, rays / stretch[:, None], stretch, points)


@dataclass(frozen=True)
class _Facets:
    """The triangles of a surface, with values of their corners to be found in between.

    Attributes:
        corners: indices, shape (3 corners, T).
        planes: of each triangle a corner, from the camera, and what its product with the way from
            there is the share of the second and of the third corner, shape (9, T).
        values: of the vertices, shape (K, V).
    """

    corners: NDArray[np.int64]
    planes: NDArray[np.float32]
    values: NDArray[np.float32]

    @classmethod
    def of(cls, surface: Surface, camera: Camera, *values: NDArray) -> _Facets:
        """Take values of the vertices of a surface, shape (V, 3) each."""
        corners = np.ascontiguousarray(surface.triangles.T)
        points = columns(surface.points - camera.position, np.float64)
        first, second, third = (points[corner] for corner in corners)
        a, b = second - first, third - first
        aa, ab, bb = _dot(a, a), _dot(a, b), _dot(b, b)
        scale = 1 / np.maximum(aa * bb - ab**2, 1e-300)
        to_second = (bb * scale)[:, None] * a - (ab * scale)[:, None] * b
        to_third = (aa * scale)[:, None] * b - (ab * scale)[:, None] * a
        planes = np.concatenate([first.T, to_second.T, to_third.T])
        table = np.concatenate([value.T for value in values])
        return cls(corners, planes.astype(np.float32), table.astype(np.float32))

    def at(self, patch: _Patch) -> list[NDArray[np.float32]]:
        """Return the values at the points of a patch, shape (F, 3) each."""
        planes = self.planes.take(patch.face, axis=1)
        way = patch.points - planes[:3].T
        # the middle of a sample at a border may be a little outside
        second, third = (np.clip(_dot(way, planes[k : k + 3].T), 0, 1) for k in (3, 6))
        a, b, c = (self.values.take(corner.take(patch.face), axis=1) for corner in self.corners)
        mixed = (1 - second - third) * a + second * b + third * c
        return [mixed[k : k + 3].T for k in range(0, len(mixed), 3)]


def _paint(
    canvas: Canvas,
    camera: Camera,
    visible: Visible,
    pixel: NDArray,
    shade: Shade,
    first: int = 0,
) -> None:
    """Give some samples the colors that ``shade`` returns; ``first`` is the number of its face 0.

    All are shaded before any is painted: what is seen through something is what is behind it.
    """
    color = np.empty((len(pixel), 3), np.float32)

    def fill(part: slice) -> None:
        patch = _Patch.of(visible, pixel[part], camera)
        color[part] = shade(replace(patch, face=patch.face - first))

    in_parts(fill, len(pixel))
    canvas.paint(pixel, color)


def _triangles(surface: Surface, camera: Camera) -> Iterator[Fragments]:
    """Yield the fragments of a surface as a camera sees it."""
    places, near = camera.project(surface.points)
    corners = surface.triangles
    return triangle_fragments(places[corners], near[corners], camera.shape)


def _solid(solid: Solid, camera: Camera, light: Light) -> _Thing:
    """Return a solid, with the light that comes through it from its other side."""
    surface = solid.surface
    sides = [_arriving(surface.points, sign * surface.normals, light) for sign in (1, -1)]
    facets = _Facets.of(surface, camera, surface.normals, *sides)
    colors = solid.front.astype(np.float32), solid.back.astype(np.float32)

    def shade(patch: _Patch) -> NDArray:
        normals, *arriving = facets.at(patch)
        facing = -_dot(_unit(normals), patch.rays)
        front = (facing > 0)[:, None]
        here, beyond = np.where(front, *arriving), np.where(front, *arriving[::-1])
        color = np.where(front, *colors)
        sheen = SHEEN * ((1 - np.abs(facing)) ** 4)[:, None]
        return (color + sheen) * here + TRANSMISSION * color**2 * beyond

    return _Thing(_triangles(surface, camera), len(surface.triangles), shade)


def _arriving(points: NDArray, normals: NDArray, light: Light) -> NDArray[np.float64]:
    """Return the light that arrives at points of a surface, shape (N, 3)."""
    # a little light comes round the edge: cloth scatters
    sun = np.clip((in_axes(normals, light.sun[None])[:, 0] + 0.08) / 1.08, 0, 1)
    lit = np.flatnonzero(sun)
    sun[lit] *= light.sunshine(points[lit], normals[lit])
    return _mixed(sun, light.skylight(points, normals), normals)


def _mixed(sun: NDArray, sky: NDArray, normals: NDArray) -> NDArray:
    """Return shares of sun and sky, shape (N,) each, as light on surfaces, shape (N, 3)."""
    colors = (SUNLIGHT, SKYLIGHT_DOWN, SKYLIGHT_UP - SKYLIGHT_DOWN)
    sunlight, down, rise = (color.astype(normals.dtype) for color in colors)
    up = (0.5 + 0.5 * normals[:, 2])[:, None]
    return sunlight * sun[:, None] + (down + up * rise) * sky[:, None]


def _balls(spheres: Spheres, camera: Camera, light: Light) -> _Thing:
    """Return spheres, each in the light at its top; the shade follows its shape."""
    up = np.broadcast_to([0.0, 0.0, 1.0], spheres.centers.shape)
    top = spheres.centers + spheres.radius[:, None] * up
    sun = light.sunshine(top, up).astype(np.float32)
    sky = light.skylight(top, up).astype(np.float32)
    centers = columns(spheres.centers - camera.position)
    colors = columns(spheres.colors)

    def shade(patch: _Patch) -> NDArray:
        normals = _unit(patch.points - centers[patch.face])
        bright = sun[patch.face]
        toward = bright * np.clip(_along(normals, light.sun), 0, 1)
        gloss = bright * np.clip(_along(_bounced(patch.rays, normals), light.sun), 0, 1) ** 40
        arriving = _mixed(toward, sky[patch.face], normals)
        return colors[patch.face] * arriving + GLOSS * gloss[:, None]

    return _Thing(_discs(spheres, camera), len(spheres.radius), shade)


def _discs(spheres: Spheres, camera: Camera) -> Iterator[Fragments]:
    """Yield the fragments of spheres as a camera sees them."""
    places, near = camera.project(spheres.centers)
    reach = np.nan_to_num(camera.focal * spheres.radius * near)
    for discs in disc_fragments(places, reach, camera.shape):
        depth = 1 / near[discs.disc] - spheres.radius[discs.disc] * discs.bulge
        yield Fragments(discs.disc, discs.pixel, 1 / depth)


def _water(
    geometry: Geometry,
    camera: Camera,
    environment: Environment,
    canvas: Canvas,
    behind: NDArray,
    thickness: NDArray,
) -> Shade:
    """Return how water looks: what is behind, bent and dimmed by it, its own color, a mirror.

    Args:
        geometry: with the water.
        camera: of the samples.
        environment: that water mirrors.
        canvas: what is behind the water.
        behind: nearness of that, shape (P,).
        thickness: of the water, shape (P,).
    """
    water, tints = geometry.water, [] if geometry.tint is None else [geometry.tint]
    facets = _Facets.of(water, camera, water.normals, *tints)

    def shade(patch: _Patch) -> NDArray:
        normals, *tint = facets.at(patch)
        normals = _unit(normals)
        normals *= -np.sign(_dot(normals, patch.rays))[:, None]
        path = np.maximum(thickness[patch.pixel], 0).astype(np.float32) * patch.stretch
        loss, own = np.exp(-path[:, None] * ABSORPTION / (2 * environment.radius)), DEEP
        if tint:
            loss, own = loss.mean(axis=1, keepdims=True) ** TINT_POWER, tint[0]
        there = _refracted(camera, patch, normals, path)
        # what is nearer than the water does not show through it
        there = np.where(behind[there] < patch.nearness, there, patch.pixel)
        inside = canvas.at(there) * loss
        inside += own * (1 - loss) * _glow(normals, environment)
        steep = 1 - np.clip(-_dot(normals, patch.rays), 0, 1)
        mirrored = (MIRRORED + (1 - MIRRORED) * steep**5)[:, None]
        return inside + mirrored * (
            surroundings(_bounced(patch.rays, normals), environment.sun) - inside
        )

    return shade


def _measured(
    water: Surface, camera: Camera, behind: NDArray, thickness: NDArray
) -> Iterator[Fragments]:
    """Yield the fragments of water, and add up its thickness, shape (P,), on the way.

    Rays enter where a triangle faces the camera and leave where one does not; what is farther
    than the things behind, of a nearness of shape (P,), counts as there.
    """
    places, _ = camera.project(water.points)
    a, b, c = np.moveaxis(places[water.triangles], 1, 0)
    # rows count downwards: what is counter-clockwise outside turns the other way in pixels
    sign = np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    least = 1 / (BACKGROUND_DEPTH * camera.distance)
    for part in _triangles(water, camera):
        near = np.maximum(part.nearness, np.maximum(behind[part.pixel], least))
        np.add.at(thickness, part.pixel, sign[part.face] / near)
        yield part


def _refracted(camera: Camera, patch: _Patch, normals: NDArray, path: NDArray) -> NDArray[np.int32]:
    """Return the samples behind water to which refraction leads, shape (F,)."""
    aside = (1 / INDEX - 1) * in_axes(normals, camera.axes[:2]) * path[:, None]
    depth = 1 / patch.nearness
    shift = np.round(aside * (np.float32(camera.focal) / (depth + path))[:, None]).astype(np.int32)
    width, height = camera.size
    row = patch.pixel // width
    column = np.clip(patch.pixel - width * row + shift[:, 0], 0, width - 1)
    return np.clip(row - shift[:, 1], 0, height - 1) * width + column


def _glow(normals: NDArray, environment: Environment) -> NDArray[np.float32]:
    """Return the light that water scatters under its surface, shape (N, 3)."""
    sun = np.clip(0.35 + 0.65 * _along(normals, environment.sun), 0, 1)[:, None]
    return (0.75 * SUNLIGHT).astype(sun.dtype) * sun + (0.8 * SKYLIGHT_UP).astype(sun.dtype)


def _glass(walls: Surface, camera: Camera, canvas: Canvas) -> Shade:
    """Return how walls look through which one sees: bright where they are seen from aside."""
    facets = _Facets.of(walls, camera, walls.normals)

    def shade(patch: _Patch) -> NDArray:
        (normals,) = facets.at(patch)
        aside = 1 - np.abs(_dot(_unit(normals), patch.rays))
        share = (GLASS_SHARE[0] + GLASS_SHARE[1] * aside**3)[:, None]
        color = canvas.at(patch.pixel)
        return color + share * (GLASS_COLOR - color)

    return shade


def _unit(vectors: NDArray) -> NDArray:
    return vectors / np.maximum(np.sqrt(_dot(vectors, vectors)), 1e-30)[:, None]


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)


def _along(vectors: NDArray, direction: NDArray) -> NDArray:
    return in_axes(vectors, direction[None])[:, 0]


def _bounced(rays: NDArray, normals: NDArray) -> NDArray:
    """Return the directions of rays after a mirror, shape (N, 3)."""
    return rays - 2 * _dot(rays, normals)[:, None] * normals
