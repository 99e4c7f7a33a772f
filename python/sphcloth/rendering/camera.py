"""Where pictures are taken from: perspective cameras, and parallel light that sees a scene too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

# the lens's full angle from bottom to top, and what is too close to be drawn, of the distance
LENS_ANGLE = np.radians(28.0)
NEAREST = 1e-3
MARGIN = 1.08


def axes_towards(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return right, up and back, the rows of a (3, 3) matrix, for a look against ``direction``.

    Up is z as far as that can be; for a look along z it is y.
    """
    back = direction / np.linalg.norm(direction)
    pole = np.array([0.0, 1.0, 0.0]) if abs(back[2]) > 0.999 else np.array([0.0, 0.0, 1.0])
    right = np.cross(pole, back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back])


def in_axes(vectors: NDArray, axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the components of vectors, shape (N, 3), along axes, the rows of a (K, 3) matrix.

    For so small a matrix the threads of a matrix product cost more than they bring. What is
    returned has the type of the vectors, and its columns are contiguous.
    """
    return np.einsum("kj,nj->kn", axes.astype(vectors.dtype, copy=False), vectors).T


def columns(vectors: NDArray, kind: type = np.float32) -> NDArray:
    """Return vectors, shape (N, 3), with contiguous columns.

    Arithmetic keeps that order, and is several times as fast as on rows of three.
    """
    return np.asarray(vectors, kind, order="F")


def in_colors(shares: NDArray, color: NDArray[np.float64]) -> NDArray:
    """Return shares of a color, shape (N,), as colors, shape (N, 3), with contiguous columns."""
    return np.multiply.outer(color.astype(shares.dtype), shares).T


@dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    Attributes:
        position: where it stands, shape (3,).
        target: the point in the middle of the picture, shape (3,).
        size: width and height of the picture in pixels.
    """

    position: NDArray[np.float64]
    target: NDArray[np.float64]
    size: tuple[int, int]

    @classmethod
    def framing(
        cls, points: NDArray[np.float64], direction: NDArray[np.float64], size: tuple[int, int]
    ) -> Camera:
        """Stand in a direction from the points, shape (N, 3), as close as lets all be seen."""
        axes = axes_towards(direction)
        seen = points @ axes.T
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
        half_height = np.tan(LENS_ANGLE / 2)
        half_extent = half_height * np.array([size[0] / size[1], 1.0])
        aside = np.abs(seen - middle)[:, :2] / half_extent
        needed = MARGIN * float(((seen - middle)[:, 2] + aside.max(axis=1)).max())
        target = middle @ axes
        # a single point has no extent to stand back from
        return cls(target + (needed or 1.0) * axes[2], target, size)

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """Right, up and back, the rows of a (3, 3) matrix."""
        return axes_towards(self.position - self.target)

    @cached_property
    def distance(self) -> float:
        """From the camera to its target."""
        return float(np.linalg.norm(self.position - self.target))

    @cached_property
    def focal(self) -> float:
        """Pixels for a slope of 1."""
        return self.size[1] / (2 * np.tan(LENS_ANGLE / 2))

    @cached_property
    def half_angle(self) -> float:
        """Half of the angle of view across the shorter side of the picture, in radians."""
        return float(np.arctan(np.tan(LENS_ANGLE / 2) * min(1.0, self.size[0] / self.size[1])))

    @cached_property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the picture."""
        return self.size[1], self.size[0]

    def enlarged(self, factor: int) -> Camera:
        """Return the camera of the same view with ``factor`` times as many pixels a side."""
        return replace(self, size=(factor * self.size[0], factor * self.size[1]))

    def turned(self, angle: float) -> Camera:
        """Return the camera after a walk around the target, by an angle in radians about z."""
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        return replace(self, position=self.target + turn @ (self.position - self.target))

    def project(self, points: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return where points, shape (N, 3), appear and how near they are.

        Returns:
            Places in pixels from the upper left corner, shape (N, 2), and the inverse of the
            depth, shape (N,): affine in the picture, and larger for what is nearer. Points
            behind the camera get NaN.
        """
        offset = in_axes(points - self.position, self.axes)
        depth = np.where(-offset[:, 2] > NEAREST * self.distance, -offset[:, 2], np.nan)
        slopes = offset[:, :2] / depth[:, None]
        middle = np.array(self.size) / 2
        return middle + slopes * self.focal * [1, -1], 1 / depth

    def rays(self, pixels: NDArray[np.integer]) -> NDArray[np.float64]:
        """Return the direction of the rays through pixels, numbered by rows, shape (N, 3).

        Their length is such that a depth times a ray leads from the camera to the point.
        """
        row = pixels // self.size[0]
        column = pixels - row * self.size[0]
        across = (column + 0.5 - self.size[0] / 2) / self.focal
        upwards = (self.size[1] / 2 - row - 0.5) / self.focal
        right, up, back = self.axes[:, :, None]
        return (across * right + upwards * up - back).T


@dataclass(frozen=True)
class ParallelView:
    """A scene as parallel light sees it, on a square of pixels.

    Attributes:
        direction: towards the light, a unit vector, shape (3,).
        center: the point in the middle, shape (3,).
        radius: half of the side of the square.
        pixels: number of pixels along a side.
    """

    direction: NDArray[np.float64]
    center: NDArray[np.float64]
    radius: float
    pixels: int

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """Right, up and back, the rows of a (3, 3) matrix."""
        return axes_towards(self.direction)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.pixels, self.pixels

    @property
    def pixel(self) -> float:
        """Side of a pixel."""
        return 2 * self.radius / self.pixels

    def project(self, points: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return places in pixels, shape (N, 2), and how near the light points are, (N,)."""
        offset = in_axes(points - self.center, self.axes)
        return offset[:, :2] / self.pixel + self.pixels / 2, offset[:, 2]
