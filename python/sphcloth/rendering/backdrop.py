"""What is behind all that stands on the floor: the floor itself, which fades into the background.

Of the pictures of one view only the light on the floor differs: all else is found once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse

from sphcloth.rendering.camera import Camera, columns, in_colors
from sphcloth.rendering.light import SKYLIGHT_UP, SUNLIGHT, Light

FLOOR_COLOR = np.array([0.31, 0.36, 0.40])
BACKDROP_LOW, BACKDROP_HIGH = np.array([0.40, 0.50, 0.57]), np.array([0.10, 0.15, 0.21])
# its light is looked up in maps of a square around the scene, whose half side is in radii of it,
# and it fades into the background from a distance on, until nothing of it is left
SHADOW_TEXELS, SKYLIGHT_TEXELS, FLOOR_REACH = 360, 90, 1.5
FADE_FROM, FADE_WIDTH, FADED = 0.6, 1.6, 100.0
# the floor is a little less bright than its color says: it is the background
FLOOR_SUN = 0.75


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
class Backdrop:
    """Floor and background as a camera sees them, P pixels by rows.

    Attributes:
        nearness: inverse of the depth of the floor, 0 where there is none, shape (P,).
    """

    nearness: NDArray[np.float64]
    _environment: Environment
    _background: NDArray[np.float32]
    _fade: NDArray[np.float32]
    _between: tuple[sparse.csr_array, sparse.csr_array]

    @classmethod
    def of(cls, camera: Camera, environment: Environment) -> Backdrop:
        """Find out where each pixel sees the floor."""
        rays = camera.rays(np.arange(camera.size[0] * camera.size[1], dtype=np.int32))
        height = environment.floor - camera.position[2]
        is_floor = rays[:, 2] * height > 0
        nearness = np.where(is_floor, rays[:, 2] / (height or 1.0), 0)
        depth = np.divide(1, nearness, out=np.zeros_like(nearness), where=is_floor)
        start = (camera.position - environment.center)[:2] / environment.radius
        away = columns(start + (depth / environment.radius)[:, None] * rays[:, :2])
        beyond = np.clip(np.hypot(*away.T) - FADE_FROM, 0, FADED) / FADE_WIDTH
        fade = np.where(is_floor, np.exp(-(beyond**2)), 0)
        up = columns(np.clip(0.45 + rays[:, 2:] / 0.8, 0, 1) ** 2)
        background = in_colors(1 - up[:, 0], BACKDROP_LOW) + in_colors(up[:, 0], BACKDROP_HIGH)
        places = 0.5 + 0.5 / FLOOR_REACH * away
        between = tuple(
            _interpolation(places, texels) for texels in (SHADOW_TEXELS, SKYLIGHT_TEXELS)
        )
        return cls(nearness, environment, (1 - fade)[:, None] * background, fade, between)

    def color(self, light: Light) -> NDArray[np.float32]:
        """Return the linear colors of all pixels in some light, shape (P, 3)."""
        sunny, bright = self._between
        sun = _floor_map(light.sunshine, SHADOW_TEXELS, self._environment)
        sky = _floor_map(light.skylight, SKYLIGHT_TEXELS, self._environment)
        sunlight = FLOOR_COLOR * SUNLIGHT * FLOOR_SUN * self._environment.sun[2]
        color = self._background + in_colors(self._fade * (sunny @ sun.ravel()), sunlight)
        # more than half of the sky is dark where something stands: contact shadows
        shade = (bright @ sky.ravel()) ** 1.4
        color += in_colors(self._fade * shade, FLOOR_COLOR * SKYLIGHT_UP)
        return color


def _interpolation(places: NDArray, texels: int) -> sparse.csr_array:
    """Return the matrix from a square of texels to places on it, shape (N, 2), from 0 to 1.

    Linear between the texels; beyond the border it is as on the border.
    """
    places = np.clip(places * (texels - 1), 0, texels - 1)
    first = np.minimum(places.astype(np.int32), texels - 2)
    part = places - first.astype(places.dtype)
    corner = first[:, 0] * texels + first[:, 1]
    weights = np.einsum("ni,nj->nij", *(np.stack([1 - x, x], axis=1) for x in part.T))
    texel = corner[:, None] + np.array([0, 1, texels, texels + 1], np.int32)
    starts = np.arange(0, 4 * len(places) + 1, 4, dtype=np.int32)
    return sparse.csr_array(
        (weights.ravel(), texel.ravel(), starts), shape=(len(places), texels**2)
    )


def _floor_map(
    share: Callable[[NDArray, NDArray], NDArray], texels: int, environment: Environment
) -> NDArray[np.float32]:
    """Return a share of light on a square of the floor, shape (texels, texels)."""
    line = np.linspace(-FLOOR_REACH, FLOOR_REACH, texels) * environment.radius
    x, y = np.meshgrid(line + environment.center[0], line + environment.center[1], indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), np.full(x.size, environment.floor)]).T
    shares = share(places, np.broadcast_to([0.0, 0.0, 1.0], places.shape)).reshape(x.shape)
    # the light comes from a few directions: without a blur each would have an edge of its own
    return ndimage.gaussian_filter(shares, 1.5).astype(np.float32)
