"""A trajectory as numbers for the viewer in the page: small integers, in base64."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.rendering.scene_roles import Choice, SceneRoles, check_positions
from sphcloth.roles import Roles
from sphcloth.trajectory import Frame, Trajectory, evenly_spaced, samples

Array = NDArray[np.float64]

# what a page shows at most: beyond, every n-th frame and particle
FRAMES, PARTICLES, VERTICES = 60, 10_000, 20_000
# share of the particles that may lie outside of the picture on either side
SPRAY = 0.005
# largest number of a coordinate
FULL = 65535


@dataclass(frozen=True)
class Packed:
    """A trajectory for the page.

    Attributes:
        name: of the dump, with its folder.
        caption: what is shown of it.
        data: for the viewer, JSON-ready.
    """

    name: str
    caption: str
    data: dict


@dataclass(frozen=True)
class _View:
    """What is kept of a frame: of a large one little.

    Attributes:
        label: its time or step.
        water: places of particles, z upwards, shape (N, 3).
        speeds: of these, shape (N,); 0 if the dump has none.
        vertices: of the meshes, shape (V, 3).
    """

    label: str
    water: Array
    speeds: Array
    vertices: Array


def pack(dump: Path) -> Packed:
    """Read a dump with the data file and the log beside it, as far as they are there.

    Raises:
        UserError: the dump cannot be read, or holds nothing to show.
    """
    trajectory = _open(dump)
    few = samples(trajectory)
    scene_roles = SceneRoles.of(few, Roles.beside(dump), Choice())
    every = _every(max(np.count_nonzero(_is(frame, scene_roles.fluid)) for frame in few))
    shows_mesh = scene_roles.mesh is not None and len(scene_roles.mesh.ids) <= VERTICES
    chosen = evenly_spaced(len(trajectory), FRAMES)
    views = [_view(trajectory[n], scene_roles, every, shows_mesh) for n in chosen]
    low, size = _bounds(views)
    fastest = max(view.speeds.max(initial=0.0) for view in views) or 1.0
    data = {
        "low": low.tolist(),
        "size": size,
        "spacing": scene_roles.largest_spacing or size / 100,
        "triangles": _base64(scene_roles.mesh.triangles, np.uint32) if shows_mesh else "",
        "cloth": _base64(scene_roles.cloth, np.uint8) if shows_mesh else "",
        "walls": _base64(_scaled(_walls(few[0], scene_roles), low, size)[0], np.uint16),
        "frames": [_numbers(view, low, size, fastest) for view in views],
    }
    caption = f"{len(chosen)} of {len(trajectory)} frames"
    caption += f", every {_ordinal(every)} particle" if every > 1 else ""
    if scene_roles.mesh is not None and not shows_mesh:
        caption += ", without the cloth: too many vertices"
    return Packed(f"{dump.resolve().parent.name}/{dump.name}", caption, data)


def _open(dump: Path) -> Trajectory:
    """Open a dump with the times of the log beside it, if they can be read."""
    log = dump.parent / "log.lammps"
    try:
        return Trajectory(dump, log if log.is_file() else None)
    except UserError:
        return Trajectory(dump)


def _is(frame: Frame, kinds: frozenset[int]) -> NDArray[np.bool_]:
    return np.isin(frame.types, list(kinds))


def _every(count: int) -> int:
    """Return n such that every n-th particle is no more than a page shows."""
    return max(1, -(-int(count) // PARTICLES))


def _view(frame: Frame, scene_roles: SceneRoles, every: int, shows_mesh: bool) -> _View:
    """Take out of a frame what is shown: every n-th particle, the same ones in all frames."""
    check_positions(frame.positions, frame)
    rows = _is(frame, scene_roles.fluid) & (frame.ids % every == 0)
    known = {"vx", "vy", "vz"} <= frame.columns.keys()
    speeds = np.linalg.norm(frame.velocities[rows], axis=1) if known else np.zeros(rows.sum())
    vertices = scene_roles.mesh.positions(frame) if shows_mesh else np.empty((0, 3))
    label = f"step {frame.step}" if np.isnan(frame.time) else f"t = {frame.time:.4g}"
    return _View(
        label, scene_roles.upright(frame.positions[rows]), speeds, scene_roles.upright(vertices)
    )


def _walls(frame: Frame, scene_roles: SceneRoles) -> Array:
    """Return the places of wall particles, as many as a page shows."""
    walls = _is(frame, scene_roles.walls)
    return scene_roles.upright(frame.positions[walls & (frame.ids % _every(walls.sum()) == 0)])


def _bounds(views: list[_View]) -> tuple[Array, float]:
    """Return corner and edge of the cube of the picture: all cloth, the water but for its spray."""
    parts = []
    for view in views:
        if len(view.water):
            parts.append(np.quantile(view.water, [SPRAY, 1 - SPRAY], axis=0))
        if len(view.vertices):
            parts.append(np.stack([view.vertices.min(axis=0), view.vertices.max(axis=0)]))
    if not parts:
        raise UserError("neither water nor cloth in it")
    corners = np.concatenate(parts)
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.05 * np.max(high - low) or 1.0
    return low - margin, float(np.max(high - low) + 2 * margin)


def _numbers(view: _View, low: Array, size: float, fastest: float) -> dict:
    places, inside = _scaled(view.water, low, size)
    return {
        "label": view.label,
        "water": _base64(places, np.uint16),
        "speed": _base64(np.round(255 * view.speeds[inside] / fastest), np.uint8),
        "vertices": _base64((view.vertices - low) / size, np.float32),
    }


def _scaled(points: Array, low: Array, size: float) -> tuple[Array, NDArray[np.bool_]]:
    """Return points as whole numbers, and which of them are inside of the picture."""
    share = (points - low) / size
    inside = np.all((share >= 0) & (share <= 1), axis=1)
    return np.round(FULL * share[inside]), inside


def _base64(values: NDArray, form: type) -> str:
    """Return numbers as base64, little-endian."""
    plain = np.ascontiguousarray(values, dtype=np.dtype(form).newbyteorder("<"))
    return base64.b64encode(plain.tobytes()).decode()


def _ordinal(number: int) -> str:
    return {2: "2nd", 3: "3rd"}.get(number, f"{number}th")
