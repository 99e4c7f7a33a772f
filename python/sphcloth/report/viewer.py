"""A trajectory as numbers for the viewer in the page: small integers, in base64."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.rendering.cast import Cast, Choice
from sphcloth.rendering.command import evenly_spaced, samples
from sphcloth.roles import Roles
from sphcloth.trajectory import Frame, Trajectory

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


def pack(dump: Path) -> Packed:
    """Read a dump with the data file and the log beside it, as far as they are there.

    Raises:
        UserError: the dump cannot be read, or holds nothing to show.
    """
    log = dump.parent / "log.lammps"
    try:
        trajectory = Trajectory(dump, log if log.is_file() else None)
    except UserError:
        trajectory = Trajectory(dump)
    cast = Cast.of(samples(trajectory), Roles.beside(dump), Choice())
    chosen = evenly_spaced(len(trajectory), FRAMES)
    every = -(-max(_water_count(trajectory[n], cast) for n in _some(chosen)) // PARTICLES) or 1
    frames = [trajectory[n] for n in chosen]
    low, high = _bounds(frames, cast)
    fastest = max(_speeds(_water(frame, cast, 1)).max(initial=0.0) for frame in frames)
    shows_cloth = cast.mesh is not None and len(cast.mesh.ids) <= VERTICES
    still = _still(frames[0], cast)
    data = {
        "low": low.tolist(),
        "size": float(np.max(high - low)),
        "spacing": cast.largest_spacing or float(np.max(high - low)) / 100,
        "fastest": float(fastest),
        "triangles": _text(cast.mesh.triangles, np.uint32) if shows_cloth else "",
        "cloth": _text(cast.cloth, np.uint8) if shows_cloth else "",
        "walls": _text(_scaled(_upright(still, cast), low, high)[0], np.uint16),
        "frames": [_frame(frame, cast, every, low, high, fastest, shows_cloth) for frame in frames],
    }
    shown = f"{len(chosen)} of {len(trajectory)} frames"
    thinned = f", every {_ordinal(every)} particle" if every > 1 else ""
    left_out = "" if shows_cloth or cast.mesh is None else ", without the cloth: too many vertices"
    return Packed(f"{dump.parent.name}/{dump.name}", f"{shown}{thinned}{left_out}", data)


def _frame(
    frame: Frame,
    cast: Cast,
    every: int,
    low: NDArray,
    high: NDArray,
    fastest: float,
    shows_cloth: bool,
) -> dict:
    water = _water(frame, cast, every)
    places, inside = _scaled(_upright(water, cast), low, high)
    speeds = _speeds(water)[inside] / (fastest or 1.0)
    vertices = cast.upright(cast.mesh.positions(frame)) if shows_cloth else np.empty((0, 3))
    return {
        "label": f"step {frame.step}" if np.isnan(frame.time) else f"t = {frame.time:.4g}",
        "water": _text(places, np.uint16),
        "speed": _text(np.round(255 * speeds), np.uint8),
        "vertices": _text((vertices - low) / np.max(high - low), np.float32),
    }


def _some(chosen: list[int]) -> list[int]:
    return [chosen[n] for n in evenly_spaced(len(chosen), 5)]


def _water_count(frame: Frame, cast: Cast) -> int:
    return int(np.count_nonzero(np.isin(frame.types, list(cast.fluid))))


def _water(frame: Frame, cast: Cast, every: int) -> Frame:
    """Return every n-th particle of water, the same ones in all frames."""
    return _chosen(frame, np.isin(frame.types, list(cast.fluid)) & (frame.ids % every == 0))


def _still(frame: Frame, cast: Cast) -> Frame:
    """Return particles of walls, as many as a page shows."""
    walls = np.isin(frame.types, list(cast.walls))
    every = -(-int(np.count_nonzero(walls)) // PARTICLES) or 1
    return _chosen(frame, walls & (frame.ids % every == 0))


def _chosen(frame: Frame, rows: NDArray[np.bool_]) -> Frame:
    columns = {name: values[rows] for name, values in frame.columns.items()}
    return Frame(frame.step, frame.time, frame.box, columns)


def _upright(frame: Frame, cast: Cast) -> NDArray[np.float64]:
    return cast.upright(frame.positions)


def _speeds(frame: Frame) -> NDArray[np.float64]:
    """Return speeds, 0 if the dump has none."""
    known = {"vx", "vy", "vz"} <= frame.columns.keys()
    return np.linalg.norm(frame.velocities, axis=1) if known else np.zeros(len(frame))


def _bounds(frames: list[Frame], cast: Cast) -> tuple[NDArray, NDArray]:
    """Return the corners of what a picture holds: all cloth, and the water but for its spray."""
    parts = []
    for frame in frames:
        if len(water := _upright(_water(frame, cast, 1), cast)):
            parts.append(np.quantile(water, [SPRAY, 1 - SPRAY], axis=0))
        if cast.mesh is not None:
            vertices = cast.upright(cast.mesh.positions(frame))
            parts.append(np.stack([vertices.min(axis=0), vertices.max(axis=0)]))
    if not parts:
        raise UserError("neither water nor cloth in it")
    corners = np.concatenate(parts)
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.05 * np.max(high - low) or 1.0
    return low - margin, high + margin


def _scaled(points: NDArray, low: NDArray, high: NDArray) -> tuple[NDArray, NDArray[np.bool_]]:
    """Return points as whole numbers, and which of them are inside of the picture."""
    inside = np.all((points >= low) & (points <= high), axis=1)
    return np.round(FULL * (points[inside] - low) / np.max(high - low)), inside


def _text(values: NDArray, form: type) -> str:
    """Return numbers as base64, little-endian."""
    plain = np.ascontiguousarray(values, dtype=np.dtype(form).newbyteorder("<"))
    return base64.b64encode(plain.tobytes()).decode()


def _ordinal(number: int) -> str:
    return {2: "2nd", 3: "3rd"}.get(number, f"{number}th")
