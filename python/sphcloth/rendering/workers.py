"""Draws pictures in several processes, and hands them over in their order."""

from __future__ import annotations

import itertools
import math
import os
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from loky import ProcessPoolExecutor
from loky.process_executor import TerminatedWorkerError
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.rendering.scene import Renderer, Scene
from sphcloth.trajectory import Frame

# each takes some hundred MB
MAX_JOBS = 8
# those are drawn in the time in which a process starts
MANY_PIXELS = 2_000_000
# tasks of a process, so that all end together, and pictures of one task, so that memory holds few
MANY_TASKS, MAX_SHOTS = 8, 4
# tasks of a process at which no more are handed out
WAITING = 2
# each process has the cores of one
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}


@dataclass(frozen=True)
class Shot:
    """A frame, where its cloth is, and the angle in radians by which the camera went around."""

    frame: Frame
    sheet: NDArray[np.float64] | None
    angle: float


def draw_frames(
    trajectory: Sequence[Frame],
    scene: Scene,
    numbers: Sequence[int],
    angles: Sequence[float],
    jobs: int = 0,
) -> Iterator[NDArray[np.uint8]]:
    """Draw frames of a dump, in order, each of shape (height, width, 3).

    Args:
        trajectory: the frames of a dump.
        scene: what all pictures share.
        numbers: which frames, in the order of the dump; one may come several times.
        angles: of the camera, in radians, one for each.
        jobs: number of processes that draw; 0 for one on each core, up to ``MAX_JOBS``.

    Pictures do not depend on the number of processes.

    Raises:
        UserError: a frame that cannot be read or drawn, or a process that was killed.
    """
    jobs = min(jobs or _number_of_jobs(len(numbers), scene), len(numbers))
    renderer = scene.renderer()
    shots = _shots(trajectory, renderer, numbers, angles)
    pool = _processes(jobs, scene) if jobs > 1 else None
    if pool is None:
        yield from _draw(renderer, shots)
        return
    size = min(max(len(numbers) // (MANY_TASKS * jobs), 1), MAX_SHOTS)
    waiting = deque()
    try:
        while task := list(itertools.islice(shots, size)):
            if len(waiting) == WAITING * jobs:
                yield from waiting.popleft().result()
            waiting.append(pool.submit(_draw_taken, task))
        while waiting:
            yield from waiting.popleft().result()
    except TerminatedWorkerError as error:
        raise UserError(
            "a process that draws pictures was killed, maybe for lack of memory: "
            "'sphcloth render DUMP --jobs 1' draws them one after another"
        ) from error
    finally:
        pool.shutdown(kill_workers=True)


def _number_of_jobs(pictures: int, scene: Scene) -> int:
    """Return how many processes draw by default: one on each core where that saves time."""
    if pictures * math.prod(scene.camera.size) < MANY_PIXELS:
        return 1
    return min(len(os.sched_getaffinity(0)), MAX_JOBS)


def _processes(jobs: int, scene: Scene) -> ProcessPoolExecutor | None:
    """Return processes that draw a scene; None where the system has no semaphores for them."""
    try:
        return ProcessPoolExecutor(jobs, initializer=_take, initargs=(scene,), env=ONE_THREAD)
    except (ImportError, OSError, NotImplementedError):
        return None


def _shots(
    trajectory: Sequence[Frame],
    renderer: Renderer,
    numbers: Sequence[int],
    angles: Sequence[float],
) -> Iterator[Shot]:
    """Yield the pictures one by one; sheets are followed from frame to frame."""
    for number, group in itertools.groupby(zip(numbers, angles, strict=True), lambda pair: pair[0]):
        frame = trajectory[number]
        sheet = renderer.follow(frame)
        for _, angle in group:
            yield Shot(frame, sheet, angle)


# what a process draws with
_taken: list[Renderer] = []


def _take(scene: Scene) -> None:
    """Make ready what draws all pictures of this process."""
    _taken[:] = [scene.renderer()]


def _draw_taken(shots: Sequence[Shot]) -> list[NDArray[np.uint8]]:
    return list(_draw(*_taken, shots))


def _draw(renderer: Renderer, shots: Iterable[Shot]) -> Iterator[NDArray[np.uint8]]:
    """Draw some pictures; surfaces of a frame are made once."""
    last, geometry = None, None
    for shot in shots:
        if shot.frame is not last:
            last, geometry = shot.frame, renderer.geometry_of(shot.frame, shot.sheet)
        yield renderer.picture(geometry, shot.angle)
