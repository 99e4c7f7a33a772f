"""Pictures show cloth and water, whichever program draws them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame, square_sheet
from matplotlib import colors, image

from sphcloth import render
from sphcloth.errors import UserError
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(6)


def frames() -> list[Frame]:
    """Return two frames: a heap of water above a sheet that sags except at its corner."""
    heap = np.stack(np.meshgrid(*[np.linspace(0.4, 0.6, 4)] * 3), -1).reshape(-1, 3)
    sag = SHEET - [0, 0, 0.2] * np.sin(np.pi * SHEET[:, :1])
    return [make_frame(0, [], SHEET), make_frame(1, heap - [0, 0, 0.3], sag)]


def share_of_blue(picture: np.ndarray) -> float:
    hue, saturation, _ = np.moveaxis(colors.rgb_to_hsv(picture[..., :3]), -1, 0)
    return float(np.mean((abs(hue - 0.58) < 0.06) & (saturation > 0.5)))


def share_of_orange(picture: np.ndarray) -> float:
    hue, saturation, _ = np.moveaxis(colors.rgb_to_hsv(picture[..., :3]), -1, 0)
    return float(np.mean((abs(hue - 0.1) < 0.06) & (saturation > 0.4)))


@pytest.mark.parametrize("with_vtk", [True, False])
def test_cloth_and_water_are_in_the_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, with_vtk: bool
) -> None:
    if with_vtk and not render.can_use_pyvista():
        pytest.skip("VTK cannot draw on this machine")
    monkeypatch.setattr(render, "can_use_pyvista", lambda: with_vtk)
    dry, wet = (image.imread(path) for path in render.render_frames(frames(), MESH, tmp_path))
    assert dry.shape[:2] == wet.shape[:2] == render.PICTURE_SIZE[::-1]
    assert share_of_orange(dry) > 0.1
    assert share_of_blue(dry) < 1e-3
    assert share_of_blue(wet) > 0.01


def test_one_camera_takes_in_all_of_the_cloth() -> None:
    scene = render.Scene.of(frames(), MESH, 1)
    for frame in frames():
        places, depth = scene.camera.project(MESH.positions(frame))
        assert np.all(depth > 0)
        assert np.all(np.abs(places) < render.HALF_EXTENT)


def test_pins_are_the_vertices_that_never_move() -> None:
    on_the_axis = np.flatnonzero(np.sin(np.pi * SHEET[:, 0]) == 0)
    assert render.Scene.of(frames(), MESH, 1).pinned.tolist() == on_the_axis.tolist()


def test_the_contact_sheet_holds_the_pictures(tmp_path: Path) -> None:
    picture = tmp_path / "blue.png"
    image.imsave(picture, np.full((60, 80, 3), colors.to_rgb("#1257a8")))
    sheet = tmp_path / "sheet.png"
    render.contact_sheet([picture] * 8, ["t"] * 8, sheet)
    assert share_of_blue(image.imread(sheet)) > 0.5


def test_spacing_keeps_the_ends() -> None:
    assert render.evenly_spaced(11, 3) == [0, 5, 10]
    assert render.evenly_spaced(2, 6) == [0, 1]
    assert render.evenly_spaced(5, 1) == [4]


def test_nothing_to_draw_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no frame"):
        render.render_frames([], MESH, tmp_path)
