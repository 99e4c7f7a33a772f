"""Pictures drawn by several processes are those of one, in order, and their ends are told."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame, square_sheet

from sphcloth.errors import UserError
from sphcloth.rendering import workers
from sphcloth.rendering.scene import Scene
from sphcloth.rendering.scene_roles import Choice, SceneRoles
from sphcloth.rendering.workers import draw_frames
from sphcloth.roles import Roles
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(3)
SIZE = (64, 48)
WIDTH = 3.0


def wandering(count: int) -> list[Frame]:
    """Return frames of a sheet that goes through the box's periodic faces, always the same way."""
    box = np.array([[0.0, -9.0, -9.0], [WIDTH, 9.0, 9.0]])
    frames = []
    for step in range(count):
        places = SHEET.copy()
        places[:, 0] = (places[:, 0] + 1.1 * step) % WIDTH
        frames.append(replace(make_frame(step, [], places), box=box))
    return frames


def scene_of(frames: list[Frame]) -> Scene:
    return Scene.of(frames, SceneRoles.of(frames, Roles(mesh=MESH), Choice()), SIZE)


def drawn(frames: list[Frame], jobs: int) -> list[np.ndarray]:
    numbers = range(len(frames))
    return list(draw_frames(frames, scene_of(frames), numbers, [0.0] * len(frames), jobs))


def test_pictures_do_not_depend_on_the_number_of_processes() -> None:
    frames = wandering(5)
    one, two = (drawn(frames, jobs) for jobs in (1, 2))
    np.testing.assert_array_equal(one, two)
    # followed from the first frame on, the sheet leaves; alone it is where the dump has it
    assert not np.array_equal(two[-1], drawn(frames[-1:], 1)[0])


def test_a_turntable_makes_the_surfaces_of_a_frame_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    renderer = workers.Renderer
    monkeypatch.setattr(
        renderer,
        "geometry_of",
        lambda *given, made_so=renderer.geometry_of: made.append(given) or made_so(*given),
    )
    frames = wandering(1)
    angles = [0.0, 0.5, 1.0, 1.5]
    pictures = list(draw_frames(frames, scene_of(frames), [0] * 4, angles, 1))
    assert len({picture.tobytes() for picture in pictures}) == 4
    assert len(made) == 1


def test_a_frame_that_cannot_be_drawn_is_named_by_other_processes_too() -> None:
    frames = wandering(4)
    frames[2].columns["x"][3] = np.nan
    scene = scene_of(wandering(4))
    with pytest.raises(UserError, match="not finite at step 2"):
        list(draw_frames(frames, scene, range(4), [0.0] * 4, 2))


def test_a_process_that_is_killed_ends_the_drawing_with_a_remedy() -> None:
    # more than are handed out at a time
    frames = wandering(200)
    pictures = draw_frames(frames, scene_of(frames), range(200), [0.0] * 200, 2)
    next(pictures)
    for process in _processes_that_draw():
        os.kill(process, signal.SIGKILL)
    with pytest.raises(UserError, match=r"was killed, .*--jobs 1"):
        list(pictures)


def test_a_caller_that_stops_leaves_no_process_behind() -> None:
    frames = wandering(12)
    pictures = draw_frames(frames, scene_of(frames), range(12), [0.0] * 12, 2)
    next(pictures)
    assert _processes_that_draw()
    pictures.close()
    assert not _processes_that_draw()


def test_small_pictures_start_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "ProcessPoolExecutor", None)
    assert len(drawn(wandering(2), 0)) == 2
    monkeypatch.setattr(workers, "MANY_PIXELS", 1)
    monkeypatch.setattr(workers.os, "sched_getaffinity", lambda _: {0, 1})
    with pytest.raises(TypeError):
        drawn(wandering(2), 0)


def test_without_semaphores_one_process_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise OSError(38, "Function not implemented")

    frames = wandering(3)
    expected = drawn(frames, 1)
    monkeypatch.setattr(workers, "ProcessPoolExecutor", none)
    np.testing.assert_array_equal(drawn(frames, 2), expected)


def _processes_that_draw() -> list[int]:
    """Return the children of this process that wait for pictures to draw."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = stat.read_text().rpartition(")")[2].split()
            command = (stat.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if words[1] == str(os.getpid()) and words[0] != "Z" and b"popen_loky" in command:
            found.append(int(stat.parent.name))
    return found
