"""Which atoms of a dump are water, walls and cloth, and where they are in a picture."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.rendering.particles import REACH, WIDTH, Particles
from sphcloth.roles import Roles
from sphcloth.strings import Strings
from sphcloth.trajectory import Frame

QUANTITIES = {"speed": ("vx", "vy", "vz"), "pressure": ("pressure",), "density": ("rho",)}
# beyond this a coordinate is a mistake: its square loses what a scene is made of
LARGEST = 1e12
# layers of copies that give a two-dimensional scene a depth
LAYERS = np.arange(-2, 3)


@dataclass(frozen=True)
class Choice:
    """What a user says of the atoms; None leaves it to the data file and the dump.

    Attributes:
        fluid: types of water.
        cloth: types of the vertices of cloth; other triangles are obstacles.
        spacing: of the particles of water.
        color_by: a key of ``QUANTITIES``.
    """

    fluid: frozenset[int] | None = None
    cloth: frozenset[int] | None = None
    spacing: float | None = None
    color_by: str | None = None


@dataclass(frozen=True)
class SceneRoles:
    """What each atom of a dump is drawn as.

    Attributes:
        fluid: types of water.
        walls: types of boundary particles.
        mesh: triangles of cloth and obstacles, or None.
        cloth: which of the mesh's triangles are cloth, shape (T,); empty without a mesh.
        spacing: of each type of water and wall.
        is_flat: whether the scene is two-dimensional, in the plane of x and y.
        color_by: a key of ``QUANTITIES``, or None.
        strings: edges beside the triangles, or None.
    """

    fluid: frozenset[int]
    walls: frozenset[int]
    mesh: ClothMesh | None
    cloth: NDArray[np.bool_]
    spacing: dict[int, float]
    is_flat: bool
    color_by: str | None
    strings: Strings | None = None

    @classmethod
    def of(cls, frames: Sequence[Frame], roles: Roles, choice: Choice) -> SceneRoles:
        """Find out from some frames of a dump what its atoms are.

        Raises:
            UserError: a type that is not in the dump, or cloth that is not in the data file.
        """
        for frame in frames:
            check_positions(frame.positions, frame)
        present = frozenset(np.unique(np.concatenate([frame.types for frame in frames])).tolist())
        corners = _corner_types(frames[0], roles.mesh)
        vertices = frozenset(np.unique(corners).tolist())
        _check_types(choice, present, vertices)
        if roles.strings is not None:
            vertices |= roles.strings.types(frames[0])
        walls = (roles.walls | _still_types(frames)) - vertices - (choice.fluid or frozenset())
        fluid = choice.fluid or roles.fluid or present - vertices - walls
        cloth = np.isin(corners, list(choice.cloth or vertices)).all(axis=1)
        is_flat = all(np.ptp(frame.positions[:, 2]) == 0 for frame in frames if len(frame))
        spacing = {
            kind: _spacing(kind, frames, roles, choice, is_flat)
            for kind in (fluid | walls) & present
        }
        return cls(
            fluid & present,
            (walls - fluid) & present,
            roles.mesh,
            cloth & ~_resting(frames, roles.mesh),
            spacing,
            is_flat,
            choice.color_by,
            roles.strings,
        )

    @property
    def largest_spacing(self) -> float:
        """The spacing of the coarsest water; 0 without water."""
        return max((self.spacing[kind] for kind in self.fluid), default=0.0)

    def upright(self, points: NDArray) -> NDArray[np.float64]:
        """Turn points, shape (..., 3), so that z points up: the y of a two-dimensional scene."""
        return points[..., [0, 2, 1]] * [1.0, -1.0, 1.0] if self.is_flat else points

    def water(self, frame: Frame) -> Particles:
        """Return the water of a frame, with what looks over from across a periodic boundary.

        Raises:
            UserError: a position that is not finite, or no column for the colors.
        """
        return self._particles(frame, self.fluid, self.values(frame))

    def wall_particles(self, frame: Frame) -> Particles:
        """Return the boundary particles of a frame, likewise."""
        return self._particles(frame, self.walls, None)

    def values(self, frame: Frame) -> NDArray[np.float64] | None:
        """Return the quantity of all atoms that gives water its color, shape (N,), or None."""
        if self.color_by is None:
            return None
        values = frame.vectors(*QUANTITIES[self.color_by])
        return np.linalg.norm(values, axis=1) if values.shape[1] > 1 else values[:, 0]

    def _particles(self, frame: Frame, kinds: frozenset[int], values: NDArray | None) -> Particles:
        chosen = np.flatnonzero(np.isin(frame.types, list(kinds)))
        spacing = np.array([self.spacing[kind] for kind in frame.types[chosen]], dtype=float)
        particles = Particles(
            frame.positions[chosen], spacing, None if values is None else values[chosen]
        )
        check_positions(particles.positions, frame)
        particles = _with_images(particles, frame, axes=2 if self.is_flat else 3)
        if self.is_flat:
            particles = _with_depth(particles)
        return replace(
            particles,
            positions=self.upright(particles.positions),
            room=np.sort(self.upright(particles.room), axis=0),
        )


def check_positions(positions: NDArray, frame: Frame) -> None:
    """Raise UserError for a position, shape (N, 3), that is no number, or too large for one."""
    if not np.isfinite(positions).all():
        raise UserError(f"the dump has positions that are not finite at step {frame.step}")
    if not np.all(np.abs(positions) < LARGEST):
        raise UserError(
            f"the dump has a coordinate of {np.abs(positions).max():g} at step {frame.step}: "
            f"what is drawn must be below {LARGEST:g}"
        )


def _corner_types(frame: Frame, mesh: ClothMesh | None) -> NDArray[np.int64]:
    """Return the types of the corners of all triangles, shape (T, 3)."""
    if mesh is None:
        return np.zeros((0, 3), np.int64)
    return mesh.vectors(frame, "type")[:, 0].astype(np.int64)[mesh.triangles]


def _check_types(choice: Choice, present: frozenset[int], vertices: frozenset[int]) -> None:
    listed = ", ".join(map(str, sorted(present))) or "none"
    for kind in sorted((choice.fluid or frozenset()) - present):
        raise UserError(f"--fluid {kind}: the dump has the types {listed}")
    for kind in sorted((choice.cloth or frozenset()) - vertices):
        held = ", ".join(map(str, sorted(vertices)))
        raise UserError(
            f"--cloth {kind}: the triangles of the data file have the types {held}"
            if vertices
            else f"--cloth {kind}: triangles come from a data file, and there is none: give --data"
        )


def _still_types(frames: Sequence[Frame]) -> frozenset[int]:
    """Return the types of which no atom comes, goes or moves."""
    still: set[int] = set()
    if len(frames) > 1:
        for kind in np.unique(frames[0].types).tolist():
            first, *rest = (frame.select(kind).positions for frame in frames)
            if all(np.array_equal(first, later) for later in rest):
                still.add(kind)
    return frozenset(still)


def _resting(frames: Sequence[Frame], mesh: ClothMesh | None) -> NDArray[np.bool_]:
    """Return which triangles belong to pieces that rest in all frames, shape (T,): obstacles."""
    if mesh is None:
        return np.zeros(0, bool)
    if len(frames) < 2:
        return np.zeros(len(mesh.triangles), bool)
    first, *rest = (mesh.positions(frame) for frame in frames)
    moves = np.any([later != first for later in rest], axis=(0, 2))
    pieces = mesh.pieces
    moving = np.bincount(pieces, moves) > 0
    return ~moving[pieces[mesh.triangles[:, 0]]]


def _spacing(
    kind: int, frames: Sequence[Frame], roles: Roles, choice: Choice, is_flat: bool
) -> float:
    """Return the spacing of a type: the user's, the data file's, or that of its neighbors."""
    if choice.spacing is not None:
        return choice.spacing
    if kind in roles.volume:
        return roles.volume[kind] ** (1 / 2 if is_flat else 1 / 3)
    positions = max((frame.select(kind).positions for frame in frames), key=len)
    positions = positions[np.isfinite(positions).all(axis=1)]
    of_box = 0.01 * float(np.ptp(frames[0].box, axis=0).max()) or 1.0
    if len(positions) < 2:
        return of_box
    distance, _ = cKDTree(positions).query(positions, k=2)
    # 0 where particles coincide
    between = float(np.median(distance[:, 1]))
    return between or 0.01 * float(np.ptp(positions, axis=0).max()) or of_box


def _with_images(particles: Particles, frame: Frame, axes: int) -> Particles:
    """Add the periodic images of particles that the surface in the box depends on."""
    if any(frame.tilt) or not len(particles.positions):
        return particles
    reach = REACH * WIDTH * float(particles.spacing.max())
    room = particles.room.copy()
    for axis in itertools.compress(range(axes), frame.periodic):
        low, high = room[:, axis] = frame.box[:, axis]
        place = low + (particles.positions[:, axis] - low) % (high - low)
        positions = particles.positions.copy()
        positions[:, axis] = place
        particles = replace(particles, positions=positions)
        parts = [particles, *_images(particles, axis, low, high, reach)]
        particles = _joined(parts)
    return replace(particles, room=room)


def _images(
    particles: Particles, axis: int, low: float, high: float, reach: float
) -> Iterator[Particles]:
    place = particles.positions[:, axis]
    for chosen, shift in ((place < low + reach, high - low), (place > high - reach, low - high)):
        part = particles.select(chosen)
        part.positions[:, axis] += shift
        yield part


def _with_depth(particles: Particles) -> Particles:
    """Put copies of the particles of a plane side by side along z."""
    parts = []
    for layer in LAYERS:
        part = particles.select(np.ones(len(particles.positions), bool))
        part.positions[:, 2] += layer * part.spacing
        parts.append(part)
    return _joined(parts)


def _joined(parts: Sequence[Particles]) -> Particles:
    values = None
    if parts[0].values is not None:
        values = np.concatenate([part.values for part in parts])
    return replace(
        parts[0],
        positions=np.concatenate([part.positions for part in parts]),
        spacing=np.concatenate([part.spacing for part in parts]),
        values=values,
    )
