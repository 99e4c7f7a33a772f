"""The surface of the water from its particles.

The surface is where a point is as far from the mean position of the particles around it as the
radius of a particle (Zhu and Bridson, ACM Trans. Graph. 24 (2005) 965, (4) to (6)); the weights
are Gaussian. A Gaussian as wide as ``WIDTH`` spacings puts the surface of a half-space where the
water ends, and gives a single particle the volume that it stands for.

Sums over particles are moments on a grid: deposited on the eight nodes around each particle, then
smoothed one axis after another. That takes time in proportion to particles and nodes, and none
for searching neighbors.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from threadpoolctl import threadpool_limits
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

from sphcloth.rendering.particles import RADIUS, REACH, WIDTH, Particles

# nodes of the grid in a spacing: as many as makes no more than the first number of nodes in all,
# or the fewest; beyond the second number of nodes the grid is coarser than that
MAX_NODES_PER_SPACING, MIN_NODES_PER_SPACING = 4.0, 2.0
FINE_NODES, MAX_NODES = 6_000_000, 30_000_000
# spread of the particles about their mean, in squared standard deviations: 3 inside of water,
# more where a point is between two bodies of water and the mean is in neither
SPREAD_OF_WATER, SPREAD_OF_GAP = 3.3, 4.4
# where weights are less there is no water; a particle alone has 1 at its place
MIN_WEIGHT = 1e-4
# in cells, and how many nodes that looks aside; then rounds of smoothing of the mesh
DISTANCE_BLUR, BLUR_NODES, SMOOTHING_ROUNDS = 0.6, 2, 8
# the grid is worked on in cubes of so many nodes a side, by so many threads
BLOCK_NODES, THREADS = 64, 2
# the own nodes of a block among those on which sums are needed
INNER = (slice(BLUR_NODES, -BLUR_NODES),) * 3


@dataclass(frozen=True)
class Surface:
    """A triangle mesh with normals.

    Attributes:
        points: shape (V, 3).
        triangles: indices, shape (T, 3), counter-clockwise seen from outside.
        normals: unit vectors that point outside, shape (V, 3).
        values: the quantity of the particles, shape (V,), or None.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: NDArray[np.float64]
    values: NDArray[np.float64] | None = None

    @classmethod
    def of(cls, points: NDArray, triangles: NDArray) -> Surface:
        """Make a surface of a mesh, with normals by area."""
        return cls(points, triangles, vertex_normals(points, triangles))

    @classmethod
    def empty(cls) -> Surface:
        """Return a surface without triangles."""
        return cls(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3)))


@dataclass(frozen=True)
class _Grid:
    """Nodes at ``origin + cell * (i, j, k)``."""

    origin: NDArray[np.float64]
    cell: float
    shape: tuple[int, int, int]

    @classmethod
    def around(cls, particles: Particles) -> _Grid:
        """Lay a grid around the particles that their weights do not leave."""
        low, high = particles.positions.min(axis=0), particles.positions.max(axis=0)
        finest = float(particles.spacing.min())
        room = REACH * WIDTH * float(particles.spacing.max())
        extent = high - low + 2 * room
        cell = max(
            finest / MAX_NODES_PER_SPACING,
            min(_cell(extent, FINE_NODES), finest / MIN_NODES_PER_SPACING),
            _cell(extent, MAX_NODES),
        )
        margin = np.ceil(room / cell) + 2
        counts = np.ceil((high - low) / cell) + 2 * margin
        return cls(low - margin * cell, cell, tuple(int(count) for count in counts))

    def nodes(self, axis: int, margin: int = 0) -> NDArray[np.float32]:
        """Return the coordinates of the nodes along an axis, in cells, to be broadcast.

        So many nodes at both ends are left out.
        """
        shape = [-1 if other == axis else 1 for other in range(3)]
        nodes = np.arange(margin, self.shape[axis] - margin, dtype=np.float32)
        return nodes.reshape(shape)


def _cell(extent: NDArray, nodes: int) -> float:
    """Return the cell of a grid of some number of nodes over an extent, shape (3,)."""
    return float(np.prod(extent) / nodes) ** (1 / 3)


def water_surface(particles: Particles) -> Surface:
    """Return the surface of some water; without particles a surface without triangles."""
    if not len(particles.positions):
        return Surface.empty()
    grid = _Grid.around(particles)
    bound = RADIUS * float(particles.spacing.max()) / grid.cell
    distance = np.full(grid.shape, bound, np.float32)
    values = None if particles.values is None else np.zeros(grid.shape, np.float32)

    def fill(block: _Block) -> None:
        moments = _Moments.of(particles.select(block.particles), block.grid, block.margin)
        # empty nodes are not to divide by zero; what they get is never looked at
        share = 1 / np.maximum(moments.weight, MIN_WEIGHT)
        nodes = [block.grid.nodes(axis, block.margin) for axis in range(3)]
        distance[block.place] = _distance(moments, share, nodes, bound)[INNER]
        if values is not None:
            values[block.place] = (moments.values * share)[INNER]

    # matrices as small as these are slower by many threads each than one after another
    with threadpool_limits(1), ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(fill, _blocks(particles, grid)))
    surface = smoothed(_contour(_ended(distance, particles.room, grid), grid))
    return surface if values is None else replace(surface, values=_sample(values, grid, surface))


@dataclass(frozen=True)
class _Block:
    """A part of a grid, small enough for its fields to stay in the cache.

    Attributes:
        grid: its nodes, and as many around them as their sums depend on.
        margin: how many nodes at each side are there for the particles alone: sums are needed on
            its own nodes and on ``BLUR_NODES`` around them.
        place: its own nodes in the whole grid.
        particles: those that its sums depend on, indices.
    """

    grid: _Grid
    margin: int
    place: tuple[slice, ...]
    particles: NDArray[np.int64]


def _blocks(particles: Particles, grid: _Grid) -> Iterator[_Block]:
    """Yield the blocks of a grid that particles reach into."""
    kernel = int(np.ceil(REACH * WIDTH * float(particles.spacing.max()) / grid.cell))
    # one more, as a particle between two nodes is shared out to both
    reach = kernel + BLUR_NODES + 1
    side = max(BLOCK_NODES, 2 * reach)
    places = (particles.positions - grid.origin) / grid.cell
    for number, near in _reached(places, reach, side):
        start, end = number * side, np.minimum((number + 1) * side, grid.shape)
        shape = end - start + 2 * reach
        offset = places[near] - (start - reach)
        held = np.all((offset >= 0) & (offset < shape - 1), axis=1)
        if held.any() and np.all(start >= 0) and np.all(end > start):
            yield _Block(
                _Grid(grid.origin + (start - reach) * grid.cell, grid.cell, tuple(shape.tolist())),
                reach - BLUR_NODES,
                tuple(map(slice, start.tolist(), end.tolist())),
                near[held],
            )


def _reached(places: NDArray, reach: int, side: int) -> Iterator[tuple[NDArray, NDArray]]:
    """Yield each cube of some side that places, shape (N, 3), have within reach, and which ones.

    A cube is at least twice as long as the reach: along an axis a place reaches into two at most.
    """
    low, high = (np.floor((places + shift) / side).astype(np.int64) for shift in (-reach, reach))
    owners, particles = [], []
    for step in np.array(list(np.ndindex(2, 2, 2)), bool):
        chosen = np.flatnonzero(np.all(~step | (high > low), axis=1))
        owners.append(np.where(step, high, low)[chosen])
        particles.append(chosen)
    cubes, owner = np.unique(np.concatenate(owners), axis=0, return_inverse=True)
    order = np.argsort(owner.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(owner.ravel()))
    return zip(cubes, np.split(np.concatenate(particles)[order], ends[:-1]), strict=True)


@dataclass(frozen=True)
class _Moments:
    """Sums over particles on nodes, weighted, and lengths in cells from the origin.

    Attributes:
        weight: the weights alone.
        first: of the positions, three fields.
        second: of their squares.
        radius: of the radii.
        values: of the values, or None.
    """

    weight: NDArray[np.float32]
    first: list[NDArray[np.float32]]
    second: NDArray[np.float32]
    radius: NDArray[np.float32]
    values: NDArray[np.float32] | None

    @classmethod
    def of(cls, particles: Particles, grid: _Grid, margin: int) -> _Moments:
        """Sum over particles, on all nodes but those of a margin.

        Each spacing has weights of its own width.
        """
        total: list[NDArray[np.float32]] = []
        for spacing in np.unique(particles.spacing):
            chosen = particles.spacing == spacing
            places = (particles.positions[chosen] - grid.origin) / grid.cell
            amounts = [np.ones(len(places)), *places.T, (places**2).sum(axis=1)]
            if particles.values is not None:
                amounts.append(particles.values[chosen])
            width = WIDTH * spacing / grid.cell
            fields = [
                _blur(field, width, margin) for field in _deposit(places, amounts, grid.shape)
            ]
            fields.append(fields[0] * np.float32(RADIUS * spacing / grid.cell))
            total = [a + b for a, b in zip(total, fields, strict=True)] if total else fields
        values = total[5] if particles.values is not None else None
        return cls(total[0], total[1:4], total[4], total[-1], values)


def _distance(
    moments: _Moments, share: NDArray, nodes: list[NDArray], bound: float
) -> NDArray[np.float32]:
    """Return the distance of nodes from the water in cells, at most ``bound``."""
    spread = moments.second * share
    away = np.zeros_like(spread)
    for first, places in zip(moments.first, nodes, strict=True):
        mean = first * share
        spread -= mean**2
        away += (mean - places) ** 2
    radius = moments.radius * share
    spread /= np.maximum((WIDTH / RADIUS) * radius, MIN_WEIGHT) ** 2
    inside = (SPREAD_OF_GAP - spread) / (SPREAD_OF_GAP - SPREAD_OF_WATER)
    distance = np.sqrt(away) - radius * np.clip(inside, 0, 1)
    distance[moments.weight < MIN_WEIGHT] = bound
    # beyond a radius the distance says nothing; bounded, it does not blur over the surface
    np.clip(distance, -bound, bound, out=distance)
    return ndimage.gaussian_filter(distance, DISTANCE_BLUR, radius=BLUR_NODES)


def _ended(distance: NDArray[np.float32], room: NDArray, grid: _Grid) -> NDArray[np.float32]:
    """Return distances that are positive outside of a room."""
    for axis, (low, high) in enumerate(((room - grid.origin) / grid.cell).T):
        nodes = grid.nodes(axis)
        np.maximum(distance, np.maximum(low - nodes, nodes - high), out=distance)
    return distance


def _deposit(
    places: NDArray, amounts: list[NDArray], shape: tuple[int, int, int]
) -> list[NDArray[np.float32]]:
    """Share amounts at places, shape (N, 3) in cells, out to the eight nodes around each."""
    corner = np.floor(places).astype(np.int64)
    part = places - corner
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    nodes, shares = [], []
    for step in np.ndindex(2, 2, 2):
        nodes.append((corner + step) @ strides)
        shares.append(np.prod(np.where(step, part, 1 - part), axis=1))
    node, share = np.concatenate(nodes), np.stack(shares)
    fields = []
    for amount in amounts:
        # as float32 throughout: a bincount would make an array of float64 of all nodes first
        field = np.zeros(int(np.prod(shape)), np.float32)
        np.add.at(field, node, (share * amount).ravel().astype(np.float32))
        fields.append(field.reshape(shape))
    return fields


def _blur(field: NDArray[np.float32], width: float, margin: int) -> NDArray[np.float32]:
    """Smooth a field by a Gaussian of a width in cells that is 1 at its middle, less a margin.

    A matrix product along each axis: several times faster than a sum for each node.
    """
    along_x, along_y, along_z = (_kernel(n, width)[margin : n - margin] for n in field.shape)
    field = (along_x @ field.reshape(len(field), -1)).reshape(-1, *field.shape[1:])
    return along_y @ (field @ along_z.T)


@cache
def _kernel(nodes: int, width: float) -> NDArray[np.float32]:
    """Return the symmetric matrix of the weights between nodes on a line, shape (nodes, nodes)."""
    away = np.abs(np.subtract.outer(np.arange(nodes), np.arange(nodes)))
    weights = np.exp(-0.5 * (away / width) ** 2)
    return np.where(away <= np.ceil(REACH * width), weights, 0).astype(np.float32)


def _contour(distance: NDArray[np.float32], grid: _Grid) -> Surface:
    """Return the surface at distance zero."""
    image = vtkImageData()
    # VTK's first index is the fastest
    image.SetDimensions(*distance.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(distance.ravel()))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    mesh = edges.GetOutput()
    if not mesh.GetNumberOfPoints():
        return Surface.empty()
    points = vtk_to_numpy(mesh.GetPoints().GetData())[:, ::-1].astype(np.float64)
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return Surface(grid.origin + grid.cell * points, triangles, np.zeros_like(points))


def smoothed(surface: Surface, rounds: int = SMOOTHING_ROUNDS) -> Surface:
    """Return the surface with its vertices drawn towards their neighbors and back, in turn.

    Every other round goes back by a little more, so that drops do not shrink (Taubin, SIGGRAPH
    1995).
    """
    n = len(surface.points)
    mean = _neighbor_mean(surface.triangles, n)
    points = surface.points
    for number in range(rounds):
        points = points + (0.55, -0.57)[number % 2] * (mean @ points - points)
    return replace(surface, points=points, normals=vertex_normals(points, surface.triangles))


def _neighbor_mean(triangles: NDArray, n: int) -> sparse.csr_array:
    """Return the matrix that takes the mean over the neighbors of each of n vertices."""
    start = triangles.ravel()
    end = np.roll(triangles, -1, axis=1).ravel()
    ones = np.ones(2 * len(start))
    pairs = (np.concatenate([start, end]), np.concatenate([end, start]))
    links = sparse.coo_array((ones, pairs), shape=(n, n)).tocsr()
    return sparse.diags_array(1 / np.maximum(links.sum(axis=1), 1)) @ links


def vertex_normals(points: NDArray, triangles: NDArray) -> NDArray[np.float64]:
    """Return unit normals of the vertices, shape (V, 3): means over triangles by area."""
    a, b, c = points[triangles.T]
    areas = np.cross(b - a, c - a)
    corners = triangles.ravel()
    sums = np.stack(
        [np.bincount(corners, np.repeat(area, 3), len(points)) for area in areas.T], axis=1
    )
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)


def _sample(field: NDArray, grid: _Grid, surface: Surface) -> NDArray[np.float64]:
    """Return a field between the nodes at the vertices of a surface, shape (V,)."""
    places = (surface.points - grid.origin) / grid.cell
    return ndimage.map_coordinates(field, places.T, order=1, mode="nearest")
