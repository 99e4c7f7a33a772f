"""The pictures of a finished example: frames, some of them side by side, and a plot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sphcloth import plots
from sphcloth.log import ThermoTable
from sphcloth.rendering.command import make_scene
from sphcloth.rendering.movie import write_pictures
from sphcloth.rendering.scene_roles import SceneRoles
from sphcloth.rendering.workers import draw_frames
from sphcloth.results import SUMMARY_PICTURES
from sphcloth.trajectory import Frame, Trajectory, evenly_spaced

SHEET_PICTURES = 6


def draw(
    trajectory: Trajectory,
    some: Sequence[Frame],
    scene_roles: SceneRoles,
    table: ThermoTable,
    folder: Path,
    frames: int,
) -> list[str]:
    """Draw the contact sheet, the plot and evenly spaced frames; return the paths as text.

    Args:
        trajectory: the dump.
        some: a few frames of it, for one view of all.
        scene_roles: of its atoms.
        table: of the log.
        folder: for the pictures.
        frames: how many of them are drawn.
    """
    chosen = evenly_spaced(len(trajectory), frames)
    scene = make_scene(some, scene_roles)
    images = draw_frames(trajectory, scene, chosen, [0.0] * len(chosen))
    pictures = list(write_pictures(images, "png", folder / "pictures", ""))
    sheet, history = (folder / name for name in SUMMARY_PICTURES)
    shown = evenly_spaced(len(pictures), SHEET_PICTURES)
    captions = [f"t = {trajectory.times[chosen[place]]:.3g}" for place in shown]
    plots.contact_sheet([pictures[place] for place in shown], captions, sheet)
    plots.plot_history(table, history)
    return [str(path) for path in (sheet, history, *pictures)]
