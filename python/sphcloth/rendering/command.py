"""What ``sphcloth render`` does: chooses frames of a dump and draws them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

from sphcloth.errors import UserError
from sphcloth.rendering.movie import check_format, write_pictures
from sphcloth.rendering.scene import Scene
from sphcloth.rendering.scene_roles import QUANTITIES, Choice, SceneRoles
from sphcloth.rendering.workers import draw_frames
from sphcloth.results import write_json
from sphcloth.roles import Roles, parse_types
from sphcloth.trajectory import Frame, Trajectory, evenly_spaced, samples

# views of a turntable around a single frame
TURNTABLE_VIEWS = 72
MIN_SIZE, MAX_SIZE = 16, 4096
LOG = "log.lammps"


@dataclass(frozen=True)
class Frames:
    """Which frames to draw: at most one of these, or all frames.

    Attributes:
        count: so many, evenly spaced, with the first and the last.
        every: each so many, from the first.
        time: ``a:b``, those between two times; an empty end is the dump's.
    """

    count: int | None = None
    every: int | None = None
    time: str | None = None

    def choose(self, trajectory: Trajectory) -> list[int]:
        """Return the numbers of the frames.

        Raises:
            UserError: several ways to choose, no time known, or no frame in the range.
        """
        given = [f"--{name}" for name, value in self._options().items() if value is not None]
        if len(given) > 1:
            raise UserError(f"{' and '.join(given)} exclude each other")
        total = len(trajectory)
        if self.count is not None:
            return evenly_spaced(total, self.count)
        if self.time is not None:
            return self._between(trajectory.times)
        return list(range(0, total, self.every or 1))

    def _options(self) -> dict[str, object]:
        return {"frames": self.count, "every": self.every, "time": self.time}

    def _between(self, times: NDArray[np.float64]) -> list[int]:
        low, high = _parse_range(self.time or "")
        if np.isnan(times).all():
            raise UserError(f"--time {self.time}: the dump has no times: give its log with --log")
        chosen = np.flatnonzero((times >= low) & (times <= high)).tolist()
        if not chosen:
            span = f"{np.nanmin(times):g} to {np.nanmax(times):g}"
            raise UserError(f"--time {self.time}: no frame there, the dump has times {span}")
        return chosen


@dataclass(frozen=True)
class View:
    """How pictures look: texts as the user gave them, None for what is found out.

    Attributes:
        camera: ``x,y,z`` of the camera.
        target: ``x,y,z`` of the middle of the picture.
        turntable: whether the camera walks around the scene once.
        size: ``WIDTHxHEIGHT`` in pixels.
        spheres: whether water is drawn as spheres.
    """

    camera: str | None = None
    target: str | None = None
    turntable: bool = False
    size: str = "1280x960"
    spheres: bool = False


@dataclass(frozen=True)
class Report:
    """What was drawn, for ``--json``."""

    dump: str
    pictures: list[str]
    frames: list[int]
    steps: list[int]
    particles: int
    seconds_per_picture: float


def make_choice(
    fluid: str | None, cloth: str | None, spacing: float | None, color_by: str
) -> Choice:
    """Turn options into a choice of atoms and colors.

    Raises:
        UserError: a value that is none.
    """
    if spacing is not None and not 0 < spacing < np.inf:
        raise UserError(f"--spacing {spacing:g}: must be positive")
    if color_by not in ("none", *QUANTITIES):
        raise UserError(f"--color-by {color_by}: use {', '.join(('none', *QUANTITIES))}")
    return Choice(
        None if fluid is None else parse_types(fluid, "--fluid"),
        None if cloth is None else parse_types(cloth, "--cloth"),
        spacing,
        None if color_by == "none" else color_by,
    )


def make_scene(frames: Sequence[Frame], roles: SceneRoles, view: View | None = None) -> Scene:
    """Choose what all pictures of a dump share, from some of its frames.

    Raises:
        UserError: nothing to draw, or a view that is none.
    """
    view = view or View()
    camera, target = _parse_place(view.camera, "--camera"), _parse_place(view.target, "--target")
    scene = Scene.of(frames, roles, parse_size(view.size), view.spheres)
    if camera is None and target is None:
        return scene.seen_all_around() if view.turntable else scene
    if view.turntable:
        raise UserError("--turntable chooses the view: leave out --camera and --target")
    return scene.look_from(camera, target)


def draw(
    trajectory: Trajectory,
    scene: Scene,
    numbers: Sequence[int],
    turntable: bool = False,
    jobs: int = 0,
) -> Iterator[NDArray[np.uint8]]:
    """Draw frames, by so many processes, 0 for one on each core.

    On a turntable the camera goes once around; a single frame gives ``TURNTABLE_VIEWS`` pictures.
    """
    if not turntable:
        return draw_frames(trajectory, scene, numbers, [0.0] * len(numbers), jobs)
    shown = [*numbers] * TURNTABLE_VIEWS if len(numbers) == 1 else numbers
    around = np.linspace(0, 2 * np.pi, len(shown), endpoint=False).tolist()
    return draw_frames(trajectory, scene, shown, around, jobs)


def render(
    dump: Path,
    out: Path,
    *,
    data: Path | None,
    log: Path | None,
    frames: Frames,
    choice: Choice,
    view: View,
    form: str,
    jobs: int,
    console: Console,
) -> Report:
    """Draw frames of a dump and say what was written.

    Args:
        dump: text dump.
        out: folder for the pictures.
        data: data file of the scene; None takes that of the dump's name, if there is one.
        log: log of the run; None takes ``log.lammps`` beside the dump, if there is one.
        frames: which frames.
        choice: which atoms are what, and the colors.
        view: camera and size.
        form: ``png``, ``gif`` or ``mp4``.
        jobs: number of processes that draw; 0 for one on each core.
        console: where progress and the result appear.

    Raises:
        UserError: a file that is missing or of another form, or an option that does not fit.
    """
    check_format(form, parse_size(view.size))
    trajectory = Trajectory(dump, log or _log_beside(dump, frames))
    numbers = frames.choose(trajectory)
    roles = Roles.read(data) if data else Roles.beside(dump)
    some = samples(trajectory)
    scene = make_scene(some, SceneRoles.of(some, roles, choice), view)
    total = TURNTABLE_VIEWS if view.turntable and len(numbers) == 1 else len(numbers)
    start = time.perf_counter()
    pictures = track(
        draw(trajectory, scene, numbers, view.turntable, jobs), "drawing", total, console=console
    )
    paths = list(write_pictures(pictures, form, out, dump.stem))
    seconds = (time.perf_counter() - start) / total
    particles = max(trajectory.counts[numbers])
    written = f"{paths[0]}" + (f" ... {paths[-1].name}" if len(paths) > 1 else "")
    console.print(written, markup=False)
    console.print(
        f"{total} pictures of up to {particles:,} atoms, {seconds:.2g} s each", highlight=False
    )
    return Report(
        str(dump),
        [str(path) for path in paths],
        numbers,
        [int(trajectory.steps[number]) for number in numbers],
        int(particles),
        seconds,
    )


def write_report(report: Report, path: Path) -> None:
    """Write a report as JSON."""
    write_json(path, asdict(report))


def parse_size(text: str) -> tuple[int, int]:
    """Turn ``1280x960`` into numbers.

    Raises:
        UserError: another form, or a picture too small or too large.
    """
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise UserError(f"--size {text}: expected WIDTHxHEIGHT such as 1280x960")
    size = int(width), int(height)
    if not all(MIN_SIZE <= side <= MAX_SIZE for side in size):
        raise UserError(f"--size {text}: each side from {MIN_SIZE} to {MAX_SIZE} pixels")
    return size


def _parse_place(text: str | None, option: str) -> NDArray[np.float64] | None:
    if text is None:
        return None
    try:
        place = np.array(text.split(","), dtype=float)
    except ValueError:
        place = np.array([])
    if place.shape != (3,) or not np.isfinite(place).all():
        raise UserError(f"{option} {text}: expected three numbers x,y,z")
    return place


def _parse_range(text: str) -> tuple[float, float]:
    start, colon, end = text.partition(":")
    try:
        low, high = float(start or -np.inf), float(end or np.inf)
    except ValueError:
        colon = ""
    if not colon or not low <= high:
        raise UserError(f"--time {text}: expected FROM:TO such as 0.5:2 or 1:")
    return low, high


def _log_beside(dump: Path, frames: Frames) -> Path | None:
    """Return the log of a run in the dump's folder, where its times are asked for."""
    log = dump.parent / LOG
    return log if frames.time is not None and log.is_file() else None
