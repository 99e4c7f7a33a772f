"""Writes the moving cloth of a dump as numbered meshes, one frame in memory at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import trimesh
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.meshing.surface import Surface, lengths
from sphcloth.results import Numbered, make_folder
from sphcloth.trajectory import Frame, Trajectory
from sphcloth.unwrapping import Unwrapper

FORMATS = {"obj": ".obj", "ply": ".ply", "vtk": ".vtp"}
SERIES = "cloth.pvd"
VELOCITY = {"vx", "vy", "vz"}


def write_sequence(
    frames: Trajectory,
    mesh: ClothMesh,
    out: Path,
    form: str,
    *,
    first: int = 0,
    last: int | None = None,
    every: int = 1,
    show: Callable[[range], Iterable[int]] = iter,
) -> list[Path]:
    """Write ``cloth_000000``, ``cloth_000001``, ...: one mesh with normals for each frame.

    VTK files also hold ``strain``, the largest relative change of length of the edges at a vertex
    since the first frame of the dump, further columns of the dump, and a series ``cloth.pvd`` with
    times (steps, if the trajectory was opened without its log). Sheets that reach through a
    periodic boundary come in one piece.

    Args:
        frames: the dump.
        mesh: the cloth.
        out: folder, made if need be; an earlier sequence of the same format goes when the first
            frame has been read.
        form: ``obj``, ``ply`` or ``vtk``.
        first: number of the first frame, from 0.
        last: number of the last frame; None takes the dump's last.
        every: write every so many frames.
        show: wraps the range of frames, for a progress bar.

    Returns:
        The numbered files.

    Raises:
        UserError: an unknown format, no such frame, or a vertex that is not in the dump.
    """
    if form not in FORMATS:
        raise UserError(f"--format {form}: use {', '.join(FORMATS)}")
    chosen = _chosen(len(frames), first, last, every)
    make_folder(out)
    files = Numbered(out, "cloth_", 6, FORMATS[form])
    writer = _writer(form, mesh, frames[0])
    unwrap = Unwrapper(mesh)
    paths, times = [], []
    for index in show(chosen):
        frame = frames[index]
        positions = unwrap(frame)
        if not paths:
            _remove_old(files)
        path = files.path(len(paths))
        writer(frame, positions, path)
        paths.append(path)
        times.append(frame.step if np.isnan(frame.time) else frame.time)
    if form == "vtk":
        _write_series(out / SERIES, paths, times)
    return paths


def _chosen(total: int, first: int, last: int | None, every: int) -> range:
    last = total - 1 if last is None else last
    if not 0 <= first <= last < total:
        raise UserError(f"frames {first} to {last}: the dump has frames 0 to {total - 1}")
    if every < 1:
        raise UserError(f"--every {every}: must be 1 or more")
    return range(first, last + 1, every)


def _remove_old(files: Numbered) -> None:
    files.remove()
    if files.suffix == FORMATS["vtk"]:
        (files.folder / SERIES).unlink(missing_ok=True)


def _writer(form: str, mesh: ClothMesh, start: Frame) -> Callable[[Frame, NDArray, Path], None]:
    """Return what writes the cloth of a frame, at unwrapped positions, to a file."""

    def write(frame: Frame, positions: NDArray, path: Path) -> None:
        body = trimesh.Trimesh(positions, mesh.triangles, process=False)
        if form == "obj":
            body.export(path, include_normals=True, digits=12)
        else:
            body.export(path, vertex_normal=True)

    return write if form != "vtk" else _vtk_writer(mesh, start)


def _vtk_writer(mesh: ClothMesh, start: Frame) -> Callable[[Frame, NDArray, Path], None]:
    import pyvista

    edges = Surface.of(np.zeros((len(mesh.ids), 3)), mesh.triangles).edges
    before = lengths(Unwrapper(mesh)(start), edges)

    def write(frame: Frame, positions: NDArray, path: Path) -> None:
        body = pyvista.PolyData.from_regular_faces(positions, mesh.triangles)
        body.point_data["Normals"] = trimesh.Trimesh(
            positions, mesh.triangles, process=False
        ).vertex_normals
        body.point_data["strain"] = _strain(
            lengths(positions, edges), before, edges, len(positions)
        )
        others = frame.columns.keys() - {"x", "y", "z"}
        if others >= VELOCITY:
            others -= VELOCITY
            body.point_data["velocity"] = mesh.vectors(frame, "vx", "vy", "vz")
        for name in others:
            body.point_data[name] = mesh.vectors(frame, name)[:, 0]
        body.save(path)

    return write


def _strain(now: NDArray, before: NDArray, edges: NDArray, n: int) -> NDArray[np.float64]:
    """Return the largest relative change of length of the edges at each vertex, shape (V,)."""
    largest = np.zeros(n)
    change = np.abs(now / np.where(before > 0, before, np.inf) - (before > 0))
    for ends in edges.T:
        np.maximum.at(largest, ends, change)
    return largest


def _write_series(path: Path, files: list[Path], times: list[float]) -> None:
    """Write the index by which ParaView knows the time of each file."""
    rows = [
        f"    <DataSet timestep='{time:.17g}' file={quoteattr(file.name)}/>\n"
        for file, time in zip(files, times, strict=True)
    ]
    path.write_text(
        "<?xml version='1.0'?>\n<VTKFile type='Collection' version='0.1'>\n  <Collection>\n"
        + "".join(rows)
        + "  </Collection>\n</VTKFile>\n",
        encoding="utf-8",
    )
