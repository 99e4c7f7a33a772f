"""Which particles went through a moving sheet, and which lie on it, from the dump alone."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize.elementwise import find_root
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.trajectory import Frame, successive

# particles whose paths are compared with the sheet at a time: bounds the memory
_BLOCK = 20_000
# relative slack of the inside tests: a particle that meets an edge belongs to both triangles
_EDGE_SLACK = 1e-12
# edges by which a particle may move between two frames for its straight path to tell what it did
_FAR = 2.0


@dataclass(frozen=True)
class Crossings:
    """Particles that went through the sheet between two dumped frames.

    Attributes:
        ids: atom ids, shape (K,); a particle that crosses in several intervals is listed for each.
        steps: step of the frame after the crossing, shape (K,).
        points: where the particle met the sheet, shape (K, 3).
        moved: how far the particle went between the frames, over the mean length of an edge,
            shape (K,).
    """

    ids: NDArray[np.int64]
    steps: NDArray[np.int64]
    points: NDArray[np.float64]
    moved: NDArray[np.float64]

    @property
    def is_unclear(self) -> NDArray[np.bool_]:
        """Whether the frames are too far apart to tell, by more than two edges, shape (K,)."""
        return self.moved > _FAR

    @property
    def count(self) -> int:
        """Number of distinct particles that crossed."""
        return len(np.unique(self.ids))


def crossings(
    mesh: ClothMesh, trajectory: Iterable[Frame], fluid_type: int | Sequence[int] = 1
) -> Crossings:
    """Find the fluid particles that end up on the other side of the moving sheet.

    Particles and vertices are taken to move along straight lines from frame to frame. In each
    interval a particle's passes in the two directions are weighed against each other, so a line
    that cuts through a fold and comes out again is no crossing. A particle that rounds the border
    is seen to do so only if the frames are close enough to show it: see
    :attr:`Crossings.is_unclear`.

    Through periodic faces, edges and paths are taken to be the shortest ones: both must be shorter
    than half the distance of opposite faces of the box.

    Args:
        mesh: of the sheet.
        trajectory: frames in the order of their steps; each is taken once, so they may be read on
            the way.
        fluid_type: atom type of the fluid, or several.

    Raises:
        UserError: there is one frame, steps go back, or a position is not finite.
    """
    found = [
        _crossings_between(mesh, before, after, fluid_type)
        for before, after in successive(trajectory, "crossings")
    ]
    if not found:
        raise UserError("crossings are counted between frames: the dump has only one")
    return Crossings(
        np.concatenate([part.ids for part in found]),
        np.concatenate([part.steps for part in found]),
        np.concatenate([part.points for part in found]),
        np.concatenate([part.moved for part in found]),
    )


def above_sheet(
    mesh: ClothMesh, frame: Frame, fluid_type: int | Sequence[int] = 1
) -> NDArray[np.bool_]:
    """Tell which fluid particles have the sheet vertically below them, shape (fluid particles,).

    They rest on the sheet or are on their way down to it; the others missed it or ran off.

    The sheet may lie across periodic faces. Where z is periodic it is below those within half the
    height of the box.

    Raises:
        UserError: a position that is not finite.
    """
    water = frame.select(fluid_type)
    positions, corners = water.positions, mesh.corners(frame)
    _check_finite(water.ids, positions[None], corners, frame)
    half_height = frame.cell[2, 2] / 2
    owner, shifts = _images(np.stack([positions, positions - [0, 0, half_height]]), corners, frame)
    images = positions[owner] + shifts
    plan = np.broadcast_to(images[:, :2], (2, len(images), 2))
    footprint = _boxes(corners[:, :, :2].swapaxes(0, 1))
    image, triangle = _overlapping_boxes(plan, footprint)
    height = _height_over(images[image], corners[triangle])
    reach = half_height if frame.periodic[2] else np.inf
    above = np.zeros(len(positions), dtype=bool)
    above[owner[image[(height > 0) & (height < reach)]]] = True
    return above


def _crossings_between(
    mesh: ClothMesh, before: Frame, after: Frame, fluid_type: int | Sequence[int]
) -> Crossings:
    """Compare the paths of the particles present in both frames with that of the sheet."""
    start, end = before.select(fluid_type), after.select(fluid_type)
    ids, first, second = np.intersect1d(start.ids, end.ids, True, return_indices=True)
    paths = np.stack([start.positions[first], end.positions[second]])
    corners = np.stack([mesh.corners(before), mesh.corners(after)])
    _check_finite(ids, paths, corners, after)
    for each in (paths, corners):
        each[1] = each[0] + before.shortest(each[1] - each[0])
    crossed, points, moved = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))], [np.empty(0)]
    edge = mesh.edge_lengths(before).mean() if len(mesh.edges) else np.inf
    for block in np.array_split(np.arange(len(ids)), len(ids) // _BLOCK + 1):
        through, where = _net_passes(paths[:, block], corners, before)
        crossed.append(ids[block[through]])
        points.append(where)
        displacements = np.subtract(*paths[:, block[through]])
        moved.append(np.linalg.norm(displacements, axis=1) / edge)
    found = np.concatenate(crossed)
    steps = np.full(len(found), after.step)
    return Crossings(found, steps, np.concatenate(points), np.concatenate(moved))


def _check_finite(ids: NDArray, paths: NDArray, corners: NDArray, frame: Frame) -> None:
    """Raise UserError for positions, shape (K, P, 3), and corners that are not finite."""
    if not np.isfinite(paths).all():
        bad = ids[~np.isfinite(paths).all(axis=(0, 2))][0]
        raise UserError(f"particle {bad} has a position that is not finite at step {frame.step}")
    if not np.isfinite(corners).all():
        raise UserError(f"a vertex has a position that is not finite at step {frame.step}")


def _net_passes(paths: NDArray, corners: NDArray, frame: Frame) -> tuple[NDArray, NDArray]:
    """Return the particles whose passes through the triangles do not cancel, and one point each.

    Args:
        paths: positions before and after, shape (2, P, 3).
        corners: triangle corners before and after, shape (2, T, 3 corners, 3).
        frame: before, with the box.

    Returns:
        Indices of the particles, shape (K,), and where they passed, shape (K, 3).
    """
    owner, shifts = _images(paths, corners, frame)
    images = paths[:, owner] + shifts
    sweeps = _boxes([*corners[0].swapaxes(0, 1), *corners[1].swapaxes(0, 1)])
    image, triangle = _overlapping_boxes(_boxes(images), sweeps)
    pair, moment, direction = _passes(images[:, image], corners[:, triangle])
    passing = owner[image[pair]]
    net = np.bincount(passing, weights=direction, minlength=paths.shape[1])
    through = np.flatnonzero(net)
    # passes come in no order: the first one listed of each particle stands for it
    listed, first = np.unique(passing, return_index=True)
    first = first[np.isin(listed, through)]
    start, end = paths[:, passing[first]]
    return through, start + moment[first, None] * (end - start)


def _images(paths: NDArray, corners: NDArray, frame: Frame) -> tuple[NDArray, NDArray]:
    """Return the periodic images of paths that may meet the triangles: path and shift of each.

    A path has those images whose box, along the edges of the cell, meets the one of the sheet.
    """
    if not any(frame.periodic) or not corners.size:
        return np.arange(paths.shape[1]), np.zeros(3)
    inverse = np.linalg.inv(frame.cell)
    low, high = _boxes(paths @ inverse)
    sheet = corners.reshape(-1, 3) @ inverse
    least = np.ceil(sheet.min(axis=0) - high - _EDGE_SLACK) * frame.periodic
    most = np.floor(sheet.max(axis=0) - low + _EDGE_SLACK) * frame.periodic
    ranges = zip(least.min(axis=0, initial=0), most.max(axis=0, initial=0), strict=True)
    owners, shifts = [], []
    for wraps in itertools.product(*(np.arange(a, b + 1) for a, b in ranges)):
        near = np.flatnonzero(np.all((least <= wraps) & (wraps <= most), axis=1))
        owners.append(near)
        shifts.append(np.broadcast_to(wraps @ frame.cell, (len(near), 3)))
    return np.concatenate(owners), np.concatenate(shifts)


def _passes(paths: NDArray, corners: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Find when particles pass through triangles, pair by pair; both move linearly.

    A particle meets a triangle where the volume that it spans with the corners, a cubic in time,
    changes its sign while the particle lies inside.

    Args:
        paths: positions before and after, shape (2, M, 3).
        corners: corners before and after, shape (2, M, 3 corners, 3).

    Returns:
        For each pass the pair's index, the moment in [0, 1], and the direction, 1 or -1.
    """
    start, end = corners - paths[:, :, None]
    cubic = _volume_cubic(start, end)
    knots = _monotone_knots(cubic)
    side = _evaluate(cubic[:, :, None], knots) >= 0
    pair, piece = np.nonzero(side[:, :-1] != side[:, 1:])
    bracket = (knots[pair, piece], knots[pair, piece + 1])
    moment = find_root(lambda s, *c: _evaluate(c, s), bracket, args=tuple(cubic[:, pair])).x
    direction = np.where(side[pair, piece + 1], 1, -1)
    met = _contains_origin(start[pair] + moment[:, None, None] * (end - start)[pair])
    return pair[met], moment[met], direction[met]


def _volume_cubic(start: NDArray, end: NDArray) -> NDArray:
    """Return the coefficients, constant first, of det(start + s (end - start)), shape (4, M)."""
    samples = np.array([0.0, 1 / 3, 2 / 3, 1.0])
    volumes = np.stack([np.linalg.det(start + s * (end - start)) for s in samples])
    return np.linalg.solve(np.vander(samples, increasing=True), volumes)


def _evaluate(cubic: Sequence[NDArray] | NDArray, s: NDArray) -> NDArray:
    """Evaluate a cubic by Horner's rule; coefficients come constant first."""
    return cubic[0] + s * (cubic[1] + s * (cubic[2] + s * cubic[3]))


def _monotone_knots(cubic: NDArray) -> NDArray:
    """Split [0, 1] where the cubic turns, shape (M, 4): it is monotone between neighbors."""
    a, b, c = 3 * cubic[3], 2 * cubic[2], cubic[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        turns = np.stack([q / a, c / q])
    turns = np.sort(np.clip(np.nan_to_num(turns, nan=0.0), 0, 1), axis=0)
    ends = np.zeros_like(a), np.ones_like(a)
    return np.stack([ends[0], *turns, ends[1]], axis=1)


def _contains_origin(corners: NDArray) -> NDArray[np.bool_]:
    """Tell which triangles, shape (M, 3, 3), hold the origin, which lies in their planes."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    slack = -_EDGE_SLACK * np.sum(normal * normal, axis=1)
    areas = [np.cross(u, v) for u, v in ((a, b), (b, c), (c, a))]
    return np.all([np.sum(area * normal, axis=1) >= slack for area in areas], axis=0)


def _height_over(positions: NDArray, corners: NDArray) -> NDArray[np.float64]:
    """Return the height of each point over its triangle, shape (M,); NaN beside it in plan."""
    a, b, c = np.moveaxis(corners, 1, 0)
    total = _plan_area(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        weight_b = _plan_area(positions - a, c - a) / total
        weight_c = _plan_area(b - a, positions - a) / total
    weight_a = 1 - weight_b - weight_c
    inside = np.minimum(np.minimum(weight_a, weight_b), weight_c) >= -_EDGE_SLACK
    sheet = weight_a * a[:, 2] + weight_b * b[:, 2] + weight_c * c[:, 2]
    return np.where(inside, positions[:, 2] - sheet, np.nan)


def _plan_area(u: NDArray, v: NDArray) -> NDArray:
    """Return twice the signed area that two vectors span in the x-y plane."""
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def _boxes(points: Sequence[NDArray] | NDArray) -> NDArray[np.float64]:
    """Return the lower and upper corners of the boxes around K points each, shape (2, N, D).

    Args:
        points: K arrays of shape (N, D).
    """
    return np.stack([functools.reduce(bound, points) for bound in (np.minimum, np.maximum)])


def _overlapping_boxes(left: NDArray, right: NDArray) -> tuple[NDArray, NDArray]:
    """Return all pairs of boxes that overlap; boxes are lower and upper corners, (2, N, D)."""
    if not right.size:
        return np.empty(0, dtype=np.intp), np.empty(0, dtype=np.intp)
    reach_left = (left[1] - left[0]).max(axis=1) / 2
    reach_right = (right[1] - right[0]).max() / 2
    # slack: neighbors at exactly the reach must not be lost to round-off
    radii = (reach_left + reach_right) * (1 + _EDGE_SLACK)
    tree = cKDTree(right.mean(axis=0))
    near = tree.query_ball_point(left.mean(axis=0), radii, p=np.inf)
    first = np.repeat(np.arange(len(near)), [len(found) for found in near])
    second = np.fromiter(itertools.chain.from_iterable(near), dtype=np.intp, count=len(first))
    overlap = np.all(
        (left[0, first] <= right[1, second]) & (right[0, second] <= left[1, first]), axis=1
    )
    return first[overlap], second[overlap]
