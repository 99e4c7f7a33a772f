"""Where light comes from, and how much of it reaches a point.

A sun with a soft edge, and a sky: how much of them points see comes from shadow maps, one from
near the sun and one from each of some directions all over the sky. Water lets most of it through.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from sphcloth.rendering.camera import ParallelView, columns, in_axes
from sphcloth.rendering.raster import disc_fragments, triangle_fragments
from sphcloth.rendering.surface import Surface

SUN_PIXELS, SUN_RAYS = 900, 24
SKY_PIXELS, SKY_DIRECTIONS = 150, 28
# half of the angle under which the sun appears, as a slope: the softness of shadows
SUN_SLOPE = 0.05
# what a sun's ray that meets nothing is taken to have risen, of the radius of the scene
MIN_RISE = 0.12
# what water takes from light that is on its way through
WATER_SHADE, WATER_SKY_SHADE = 0.45, 0.35
# cosines of the angles from the sun in which the lamp that water mirrors fades
SOFTBOX_EDGE = (0.93, 0.965)
SUNLIGHT = np.array([1.0, 0.94, 0.84]) * 1.55
SKYLIGHT_UP, SKYLIGHT_DOWN = np.array([0.50, 0.60, 0.74]), np.array([0.36, 0.33, 0.30])
GROUND, HORIZON, ZENITH = (
    np.array(color, np.float32)
    for color in ((0.42, 0.43, 0.46), (0.86, 0.90, 0.95), (0.34, 0.52, 0.78))
)


@dataclass(frozen=True)
class Spheres:
    """Spheres of one or many colors.

    Attributes:
        centers: shape (N, 3).
        radius: shape (N,).
        colors: linear, shape (N, 3).
    """

    centers: NDArray[np.float64]
    radius: NDArray[np.float64]
    colors: NDArray[np.float64]


@dataclass(frozen=True)
class Light:
    """Sun and sky over a scene.

    Attributes:
        sun: towards the sun, a unit vector, shape (3,).
        maps: how far from the sun is what it sees: solids and water.
        sky: the same for directions of the sky.
    """

    sun: NDArray[np.float64]
    maps: tuple[_ShadowMap, _ShadowMap]
    sky: list[tuple[_ShadowMap, _ShadowMap]]

    @classmethod
    def on(
        cls,
        solids: Sequence[Surface],
        water: Surface,
        spheres: Sequence[Spheres],
        sun: NDArray[np.float64],
        room: tuple[NDArray[np.float64], float],
    ) -> Light:
        """Cast light on surfaces and spheres in a room: a sphere, its center and radius."""
        view = ParallelView(sun, *room, SUN_PIXELS)
        maps = (_ShadowMap.of(view, solids, spheres), _ShadowMap.of(view, [water], []))
        parts = [*(solid.points for solid in solids), *(part.centers for part in spheres)]
        grains = np.concatenate([np.zeros((0, 3)), *parts])
        dusts = [columns(dust, np.float64) for dust in (grains, water.points)]
        sky = []
        for direction in sky_directions(SKY_DIRECTIONS):
            view = ParallelView(direction, *room, SKY_PIXELS)
            sky.append(tuple(_ShadowMap.of_points(view, dust) for dust in dusts))
        return cls(sun, maps, sky)

    def sunshine(self, points: NDArray, normals: NDArray) -> NDArray[np.float64]:
        """Return the share of the sun that points see, shape (N,)."""
        solid, water = self.maps
        start = columns(points + 2.5 * solid.view.pixel * normals, np.float64)
        places, near = solid.view.project(start)
        blocked = solid.blocked_softly(places, near, SUN_RAYS)
        wet = water.blocked_softly(places, near, SUN_RAYS // 2)
        return (1 - blocked) * (1 - WATER_SHADE * wet)

    def skylight(self, points: NDArray, normals: NDArray) -> NDArray[np.float64]:
        """Return the share of the sky over their tangent planes that points see, shape (N,)."""
        total, seen = np.full(len(points), 1e-9), np.full(len(points), 1e-9)
        points, normals = columns(points, np.float64), columns(normals, np.float64)
        starts = points + 2.0 * self.sky[0][0].view.pixel * normals
        for solid, water in self.sky:
            cosine = _along(normals, solid.view.direction)
            # the others do not see this part of the sky
            turned = np.flatnonzero(cosine > 0)
            places, near = solid.view.project(starts[turned])
            clear = ~solid.blocked(places, near) * (
                1 - WATER_SKY_SHADE * water.blocked(places, near)
            )
            total[turned] += cosine[turned]
            seen[turned] += cosine[turned] * clear
        return seen / total


@dataclass(frozen=True)
class _ShadowMap:
    """The distance towards the light of what is nearest to it, -inf where nothing is."""

    view: ParallelView
    nearness: NDArray[np.float64]

    @classmethod
    def of(
        cls, view: ParallelView, surfaces: Sequence[Surface], spheres: Sequence[Spheres]
    ) -> _ShadowMap:
        nearness = np.full(view.pixels**2, -np.inf)
        for surface in surfaces:
            places, near = view.project(surface.points)
            corners = surface.triangles
            for part in triangle_fragments(places[corners], near[corners], view.shape):
                np.maximum.at(nearness, part.pixel, part.nearness)
        for part in spheres:
            places, near = view.project(part.centers)
            for discs in disc_fragments(places, part.radius / view.pixel, view.shape):
                top = near[discs.disc] + part.radius[discs.disc] * discs.bulge
                np.maximum.at(nearness, discs.pixel, top)
        return cls(view, _bordered(nearness.reshape(view.shape)))

    @classmethod
    def of_points(cls, view: ParallelView, points: NDArray) -> _ShadowMap:
        """Take points for all of a surface; they are denser than pixels, or nearly."""
        places, near = view.project(points)
        nearness = np.full(view.pixels**2, -np.inf)
        np.maximum.at(nearness, _texels(places, view), near)
        return cls(view, _bordered(ndimage.maximum_filter(nearness.reshape(view.shape), 2)))

    def blocked(self, places: NDArray, near: NDArray) -> NDArray[np.bool_]:
        """Return whether something is between the light and points of its view, shape (N,)."""
        return self._look(places) > near

    def blocked_softly(self, places: NDArray, near: NDArray, rays: int) -> NDArray[np.float64]:
        """Return which share of rays to all parts of the sun is blocked, shape (N,).

        What a ray that leans aside meets is looked up where it is as high as what the straight
        ray meets: exact for a flat blocker.
        """
        straight = self._look(places)
        rise = np.where(np.isfinite(straight), straight - near, 0)
        reach = np.maximum(rise, self._least_rise) * (SUN_SLOPE / self.view.pixel)
        dim = np.isfinite(straight) | (self._around[_texels(places, self.view)] > near)
        some = np.flatnonzero(dim)
        blocked = np.zeros(len(near), np.float32)
        places, near, reach = places[some], near[some], reach[some]
        for slope in _spiral(rays):
            blocked[some] += self._look(places + reach[:, None] * slope) > near
        return blocked / rays

    @property
    def _least_rise(self) -> float:
        return MIN_RISE * self.view.radius

    @cached_property
    def _around(self) -> NDArray[np.float64]:
        """What is nearest to the light of all that other rays meet where the straight one does not.

        They lean aside by what belongs to the least rise.
        """
        aside = int(np.ceil(self._least_rise * SUN_SLOPE / self.view.pixel))
        nearness = self.nearness.reshape(self.view.shape)
        return ndimage.maximum_filter(nearness, 2 * aside + 1).ravel()

    def _look(self, places: NDArray) -> NDArray[np.float64]:
        """Return what is nearest to the light at places, shape (N, 2)."""
        return self.nearness[_texels(places, self.view)]


def _texels(places: NDArray, view: ParallelView) -> NDArray[np.int32]:
    """Return the numbers of the pixels of a view at places, shape (N, 2); the nearest ones."""
    column, row = np.clip(places, 0, view.pixels - 1).astype(np.int32).T
    return row * view.pixels + column


def _bordered(nearness: NDArray) -> NDArray[np.float64]:
    """Return a map, flat, with nothing on its border: what is off the map is in the light."""
    nearness[[0, -1], :] = nearness[:, [0, -1]] = -np.inf
    return nearness.ravel()


def sky_directions(count: int) -> NDArray[np.float64]:
    """Return unit vectors spread evenly over the upper half of the sphere, shape (count, 3)."""
    height = (np.arange(count) + 0.5) / count
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - height**2)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)


def _spiral(count: int) -> NDArray[np.float64]:
    """Return points spread evenly over the unit disc, shape (count, 2)."""
    radius = np.sqrt((np.arange(count) + 0.5) / count)
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)


def surroundings(directions: NDArray, sun: NDArray) -> NDArray[np.float64]:
    """Return the light that comes from unit directions, shape (N, 3), in linear color (N, 3).

    A studio: ground, horizon and sky, a large bright lamp around the sun and a long faint one
    opposite, for water to mirror.
    """
    height = directions[:, 2:3]
    up = np.clip(height, 0, 1) ** 0.6
    light = np.where(
        height > 0,
        HORIZON + up * (ZENITH - HORIZON),
        HORIZON + np.clip(-4 * height, 0, 1) * (GROUND - HORIZON),
    )
    key = _smooth_step(_along(directions, sun), *SOFTBOX_EDGE)
    behind = _along(directions, -sun * [1, 1, 0] / np.linalg.norm(sun[:2]))
    height_of_strip = _smooth_step(0.16 - np.abs(height[:, 0] - 0.38), 0, 0.08)
    strip = _smooth_step(behind, 0.3, 0.6) * height_of_strip
    return light + (7 * key + 1.4 * strip)[:, None]


def _smooth_step(values: NDArray, low: float, high: float) -> NDArray[np.float64]:
    share = np.clip((values - low) / (high - low), 0, 1)
    return share**2 * (3 - 2 * share)


def _along(vectors: NDArray, direction: NDArray) -> NDArray[np.float64]:
    """Return the components of vectors, shape (N, 3), along a direction, shape (N,)."""
    return in_axes(vectors, direction[None])[:, 0]
