"""Triangles and spheres to pixels, line by line, in whole arrays.

A triangle becomes the rows of pixels between its lowest and highest corner, a row the pixels
between the two edges there. Pixels belong to the triangle that holds their middle; neighbors
compute the common edge from the same two corners, so that no pixel falls between or counts twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

# pixels worked on at a time: their arrays fit into the cache, or nearly
BATCH = 300_000


@dataclass(frozen=True)
class Fragments:
    """Pixels that faces cover; F of them, a pixel as often as there are faces over it.

    Attributes:
        face: which triangle or sphere, shape (F,).
        pixel: numbered by rows, shape (F,).
        nearness: larger is nearer, shape (F,).
    """

    face: NDArray[np.int64]
    pixel: NDArray[np.int64]
    nearness: NDArray[np.float64]


@dataclass(frozen=True)
class Visible:
    """The nearest face in each of P pixels.

    Attributes:
        nearness: of that face, or of what is behind where there is none, shape (P,).
        face: its number, -1 where there is none, shape (P,).
    """

    nearness: NDArray[np.floating]
    face: NDArray[np.int32]

    @cached_property
    def pixel(self) -> NDArray[np.int32]:
        """Where there is a face, shape (F,)."""
        return np.flatnonzero(self.face >= 0).astype(np.int32)


def nearest(fragments: Iterable[Fragments], behind: NDArray[np.floating]) -> Visible:
    """Return the nearest face in each pixel, of those in front of a nearness, shape (P,).

    What is found has the type of that: single precision takes half of the time.
    """
    nearness = behind.copy()
    face = np.full(len(behind), -1, np.int32)
    for part in fragments:
        near = part.nearness.astype(nearness.dtype, copy=False)
        np.maximum.at(nearness, part.pixel, near)
        wins = np.flatnonzero(near == nearness[part.pixel])
        face[part.pixel[wins]] = part.face[wins]
    return Visible(nearness, face)


def triangle_fragments(
    places: NDArray[np.float64], nearness: NDArray[np.float64], shape: tuple[int, int]
) -> Iterator[Fragments]:
    """Yield the fragments of triangles.

    Args:
        places: corners in pixels, shape (T, 3 corners, 2); a triangle with NaN is left out.
        nearness: of the corners, affine in the picture, shape (T, 3).
        shape: rows and columns of the picture.
    """
    heights = places[:, :, 1]
    first, last = _rows(heights.min(axis=1), heights.max(axis=1), shape[0])
    # also as wide as the bounding box: a guess at the number of pixels that errs upwards
    width = np.ptp(places[:, :, 0], axis=1)
    drawn = np.flatnonzero((last > first) & (width < np.inf))
    cost = (last - first)[drawn] * (np.minimum(width[drawn], shape[1]) + 2)
    for part in _batches(drawn, cost):
        yield _fill(part, places[part], nearness[part], first[part], last[part], shape)


@dataclass(frozen=True)
class Discs:
    """Pixels that discs cover; F of them.

    Attributes:
        disc: which one, shape (F,).
        pixel: numbered by rows, shape (F,).
        bulge: how far a sphere stands out there over the disc, of its radius, shape (F,).
    """

    disc: NDArray[np.int64]
    pixel: NDArray[np.int64]
    bulge: NDArray[np.float64]


def disc_fragments(
    places: NDArray[np.float64], reach: NDArray[np.float64], shape: tuple[int, int]
) -> Iterator[Discs]:
    """Yield the fragments of discs that face the camera.

    Args:
        places: of the centers in pixels, shape (N, 2); a disc at NaN is left out.
        reach: radius in pixels, shape (N,).
        shape: rows and columns of the picture.
    """
    first, last = _rows(places[:, 1] - reach, places[:, 1] + reach, shape[0])
    drawn = np.flatnonzero(last > first)
    for part in _batches(drawn, (last - first)[drawn] ** 2.0):
        owner, row = _expand(first[part], last[part])
        disc = part[owner]
        half = np.sqrt(np.maximum(reach[disc] ** 2 - (row + 0.5 - places[disc, 1]) ** 2, 0))
        line, column = _expand(*_rows(places[disc, 0] - half, places[disc, 0] + half, shape[1]))
        face, rows = disc[line], row[line]
        away = (column + 0.5 - places[face, 0]) ** 2 + (rows + 0.5 - places[face, 1]) ** 2
        bulge = np.sqrt(np.maximum(1 - away / reach[face] ** 2, 0))
        yield Discs(face, rows * shape[1] + column, bulge)


def _rows(low: NDArray, high: NDArray, count: int) -> tuple[NDArray, NDArray]:
    """Return the range of rows, or columns, of ``count`` whose middles are between two heights."""
    first = np.clip(np.nan_to_num(np.ceil(low - 0.5)), 0, count).astype(np.int64)
    last = np.clip(np.nan_to_num(np.ceil(high - 0.5)), 0, count).astype(np.int64)
    return first, last


def _expand(first: NDArray, last: NDArray) -> tuple[NDArray, NDArray]:
    """Return for each integer of all ranges the number of its range, and the integer."""
    count = np.maximum(last - first, 0)
    owner = np.repeat(np.arange(len(count)), count)
    start = np.cumsum(count) - count
    return owner, np.arange(len(owner)) + (first - start)[owner]


def _batches(faces: NDArray, cost: NDArray) -> Iterator[NDArray]:
    """Split faces, in order, into parts whose cost is about ``BATCH``."""
    ends = np.searchsorted(np.cumsum(cost), np.arange(BATCH, cost.sum(), BATCH))
    for part in np.split(faces, ends):
        if len(part):
            yield part


def _fill(
    part: NDArray,
    places: NDArray,
    nearness: NDArray,
    first: NDArray,
    last: NDArray,
    shape: tuple[int, int],
) -> Fragments:
    """Return the fragments of some triangles; ``part`` has their numbers."""
    slope, level = _planes(places, nearness)
    upwards = np.argsort(places[:, :, 1], axis=1, kind="stable")
    low, middle, high = np.take_along_axis(places, upwards[..., None], axis=1).transpose(1, 2, 0)
    owner, row = _expand(first, last)
    height = row + 0.5
    beyond = height >= middle[1][owner]
    # the sides from low to middle and from middle to high, one after the other
    bent = _crossing(
        np.concatenate([low, middle], axis=1),
        np.concatenate([middle, high], axis=1),
        owner + len(part) * beyond,
        height,
    )
    straight = _crossing(low, high, owner, height)
    line, column = _expand(*_rows(np.minimum(bent, straight), np.maximum(bent, straight), shape[1]))
    face = owner[line]
    start = level[owner] + slope[1][owner] * height
    near = start[line] + slope[0][face] * (column + 0.5)
    return Fragments(part[face], (row * shape[1])[line] + column, near)


def _crossing(start: NDArray, end: NDArray, side: NDArray, height: NDArray) -> NDArray[np.float64]:
    """Return where sides of triangles cross heights.

    Args:
        start: of all sides, shape (2, S); the end is not at the same height.
        end: shape (2, S).
        side: number of the side that crosses each height, shape (N,).
        height: shape (N,).
    """
    rise, aside = end[1] - start[1], end[0] - start[0]
    share = (height - start[1][side]) / np.where(rise > 0, rise, 1)[side]
    return start[0][side] + share * aside[side]


def _planes(places: NDArray, values: NDArray) -> tuple[NDArray, NDArray]:
    """Return slope, shape (2, T), and level at the origin, (T,), of values at three corners."""
    a, b = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    rise_a, rise_b = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    scale = 1 / np.where(area == 0, np.inf, area)
    across = (rise_a * b[:, 1] - rise_b * a[:, 1]) * scale
    down = (rise_b * a[:, 0] - rise_a * b[:, 0]) * scale
    level = values[:, 0] - across * places[:, 0, 0] - down * places[:, 0, 1]
    return np.stack([across, down]), level
