"""Pictures: what is in front, which side of the cloth one sees, where the water ends."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import dump_frame, make_frame, square_sheet
from matplotlib import colors
from PIL import Image
from test_render_surface import block

from sphcloth import cli
from sphcloth.errors import UserError
from sphcloth.plots import contact_sheet
from sphcloth.rendering import backdrop, command, light, movie, scene
from sphcloth.rendering.scene import Scene
from sphcloth.rendering.scene_roles import Choice, SceneRoles
from sphcloth.rendering.shading import Geometry
from sphcloth.roles import Roles
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(6)
SIZE = (96, 72)


@pytest.fixture(autouse=True)
def draw_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spend no time on what a small picture does not show."""
    monkeypatch.setattr(scene, "FINE_TRIANGLES", 5000)
    monkeypatch.setattr(backdrop, "SHADOW_TEXELS", 60)
    monkeypatch.setattr(light, "SUN_PIXELS", 200)


# scenes


def frames() -> list[Frame]:
    """Return two frames: a heap of water above a sheet that sags except at its corner."""
    heap = block(4, 0.06, (0.4, 0.4, -0.1))
    sag = SHEET - [0, 0, 0.2] * np.sin(np.pi * SHEET[:, :1])
    return [make_frame(0, [], SHEET), make_frame(1, heap, sag)]


def scene_of(
    shown: list[Frame], choice: Choice | None = None, mesh: object = MESH, **options: object
) -> Scene:
    roles = SceneRoles.of(shown, Roles(mesh=mesh), choice or Choice())
    return Scene.of(shown, roles, SIZE, **options)


def geometry_of(whole: Scene, frame: Frame) -> Geometry:
    renderer = whole.renderer()
    return renderer.geometry_of(frame, renderer.follow(frame))


def picture(whole: Scene, frame: Frame, angle: float = 0.0) -> np.ndarray:
    return whole.renderer().picture(geometry_of(whole, frame), angle)


def share_of(image: np.ndarray, hue: float, least_saturation: float = 0.25) -> float:
    """Return the share of the pixels of about some hue."""
    hues, saturation, _ = np.moveaxis(colors.rgb_to_hsv(image / 255), -1, 0)
    return float(np.mean((abs(hues - hue) < 0.05) & (saturation > least_saturation)))


BLUE, SAND, RUST = 0.53, 0.1, 0.04


@pytest.mark.parametrize("as_spheres", [False, True])
def test_cloth_and_water_are_in_the_picture(as_spheres: bool) -> None:
    whole = scene_of(frames(), as_spheres=as_spheres)
    dry, wet = (picture(whole, frame) for frame in frames())
    assert dry.shape == wet.shape == (*SIZE[::-1], 3)
    assert share_of(dry, SAND, 0.05) > 0.1
    assert share_of(wet, BLUE, 0.35) > share_of(dry, BLUE, 0.35) + 0.01


def test_the_two_sides_of_cloth_differ() -> None:
    whole = scene_of(frames())
    above = picture(whole, frames()[0])
    low = whole.look_from(np.array([0.5, 0.4, -0.09]), np.array([0.5, 0.5, 0.0]))
    assert share_of(picture(low, frames()[0]), RUST, 0.5) > 0.3 > share_of(above, RUST, 0.5)


def test_pins_are_the_vertices_that_never_move() -> None:
    on_the_axis = np.flatnonzero(np.sin(np.pi * SHEET[:, 0]) == 0)
    assert scene_of(frames()).pinned.tolist() == on_the_axis.tolist()


def test_water_ends_at_the_sheet() -> None:
    flat = make_frame(0, block(5, 0.08, (0.3, 0.3, 0.0)), SHEET)
    surface = geometry_of(scene_of([flat]), flat).water
    # nodes of the grid are a quarter of the spacing apart, and the last smoothing moves them
    assert surface.points[:, 2].min() > -0.005
    assert surface.points[:, 2].max() > 0.38


def test_a_piece_that_rests_is_an_obstacle_unless_it_is_said_to_be_cloth() -> None:
    still = [replace(frames()[0], step=step) for step in (0, 1)]
    roles = SceneRoles.of(still, Roles(mesh=MESH), Choice(fluid=frozenset({2})))
    assert not roles.cloth.any()
    assert scene_of(frames()).roles.cloth.all()


def test_particles_that_never_move_are_walls() -> None:
    wall = np.stack([np.linspace(0, 1, 12), np.zeros(12), np.zeros(12)], axis=1)
    first = make_frame(0, block(3, 0.1), wall)
    second = make_frame(1, block(3, 0.1) + 0.01, wall)
    roles = SceneRoles.of([first, second], Roles(), Choice())
    assert (roles.fluid, roles.walls) == (frozenset({1}), frozenset({2}))
    whole = Scene.of([first, second], roles, SIZE)
    assert len(geometry_of(whole, first).walls.triangles)
    assert picture(whole, first).shape


def test_a_scene_of_two_dimensions_stands_upright() -> None:
    x, y = np.meshgrid(np.arange(8) * 0.1, np.arange(4) * 0.1)
    flat = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    whole = scene_of([make_frame(0, flat, np.zeros((0, 3)))], mesh=None)
    assert whole.roles.is_flat
    water = geometry_of(whole, make_frame(0, flat, np.zeros((0, 3)))).water
    low, high = water.points.min(axis=0), water.points.max(axis=0)
    np.testing.assert_allclose(high[2] - low[2], 0.4, atol=0.04)
    np.testing.assert_allclose(high[0] - low[0], 0.8, atol=0.04)


def test_water_goes_on_across_a_periodic_boundary() -> None:
    # a layer over the whole box: flat, without the rim of an island
    layer = block(6)
    layer = layer[layer[:, 2] < 3]
    frame = make_frame(0, layer, np.zeros((0, 3)))
    frame = replace(frame, box=np.array([[0.0] * 3, [6.0] * 3]), periodic=(True, True, False))
    whole = scene_of([frame], mesh=None, choice=Choice(spacing=1.0))
    water = geometry_of(whole, frame).water
    np.testing.assert_allclose(water.points[:, 0].min(), 0, atol=0.1)
    near_the_end = abs(water.points[:, 0] - 0.6) < 0.2
    inner = near_the_end & (abs(water.points[:, 1] - 3) < 2) & (water.points[:, 2] > 1.5)
    np.testing.assert_allclose(water.points[inner, 2], 3, atol=0.1)


def test_colors_show_a_quantity_with_a_scale() -> None:
    frame = frames()[1]
    speed = dict(zip(("vx", "vy", "vz"), np.tile(frame.positions[:, 0], (3, 1)), strict=True))
    fast = replace(frame, columns=frame.columns | speed)
    whole = scene_of([fast], Choice(color_by="speed"))
    assert whole.scale is not None
    assert whole.scale.low == 0 < whole.scale.high
    green = [share_of(picture(one, fast), 0.3, 0.3) for one in (whole, scene_of([fast]))]
    assert green[0] > 0.002 > green[1]
    with pytest.raises(UserError, match="no column vx vy vz"):
        scene_of(frames(), Choice(color_by="speed"))


def test_a_lost_drop_changes_nothing() -> None:
    water = [*block(4, 0.06, (0.4, 0.4, -0.1)), [1e9, 0, 0]]
    lost, kept = (
        replace(make_frame(1, part, SHEET), periodic=(False,) * 3) for part in (water, water[:-1])
    )
    whole = scene_of([frames()[0], lost])
    np.testing.assert_array_equal(picture(whole, lost), picture(whole, kept))


@pytest.mark.parametrize("fluid", [[[np.nan, 0, 0]], [[0, np.inf, 0]]])
def test_positions_must_be_finite(fluid: list[list[float]]) -> None:
    with pytest.raises(UserError, match="not finite at step 3"):
        geometry_of(scene_of(frames()), make_frame(3, fluid, SHEET))


def test_a_coordinate_that_is_too_large_is_named_with_the_limit() -> None:
    with pytest.raises(UserError, match=r"coordinate of 2e\+12 at step 3: .* below 1e\+12"):
        geometry_of(scene_of(frames()), make_frame(3, [[0, -2e12, 0]], SHEET))


# the command


@pytest.fixture
def dump(write_dump: Callable[[str], Path]) -> Path:
    """A dump of three frames in which water comes and goes."""
    drops = [[[0.3, 0.1, 1.0]], [[0.3, 0.1, 0.8], [0.4, 0.1, 0.8]], []]
    texts = [
        dump_frame(
            10 * step,
            [[i + 1, 1, *place] for i, place in enumerate(places)] + [[9, 2, 0, 0, 0.1 * step]],
        )
        for step, places in enumerate(drops)
    ]
    return write_dump("".join(texts))


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    texts = ["sphcloth", "render", *map(str, arguments)]
    monkeypatch.setattr("sys.argv", texts)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return int(ended.value.code or 0)


def test_frames_become_numbered_pictures(
    dump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, report = tmp_path / "out", tmp_path / "report.json"
    out.mkdir()
    (out / "frame_0007.png").touch()
    options = ["--size", "64x48", "--out", out, "--json", report]
    assert call(monkeypatch, dump, *options) == 0
    files = sorted(path.name for path in out.iterdir())
    assert files == ["frame_0000.png", "frame_0001.png", "frame_0002.png"]
    assert Image.open(out / files[0]).size == (64, 48)
    said = json.loads(report.read_text())
    assert (said["steps"], said["particles"]) == ([0, 10, 20], 3)


def test_pictures_of_an_earlier_call_alone_go_and_only_when_there_are_new_ones(
    dump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    own = ["frame_0_mine.png", "frame_1.png", "frame_00001.png", "frame_0000.png.bak"]
    for name in [*own, "frame_0009.png", "frame_10000.png"]:
        (out / name).write_text("earlier")
    options = ["--size", "64x48", "--out", out]
    whole = dump.read_text()
    dump.write_text(whole.replace("9 2 0 0 0\n", "9 2 0 0 here\n"))
    assert call(monkeypatch, dump, *options) == 2
    assert len(list(out.iterdir())) == 6
    dump.write_text(whole)
    assert call(monkeypatch, dump, *options, "--frames", "1") == 0
    assert sorted(path.name for path in out.iterdir()) == sorted([*own, "frame_0000.png"])


def test_particles_that_coincide_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, write_dump: Callable[[str], Path]
) -> None:
    rows = [[number, 1, 0.5, 0.5, 0.5] for number in (1, 2)]
    options = ["--size", "64x48", "--out", tmp_path / "out"]
    for text in (dump_frame(0, rows), dump_frame(0, rows).replace("-1 4", "0 0")):
        assert call(monkeypatch, write_dump(text), *options) == 0
        assert (tmp_path / "out" / "frame_0000.png").is_file()


@pytest.mark.parametrize("form", ["gif", "mp4"])
def test_films(dump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    if form == "mp4":
        pytest.importorskip("imageio_ffmpeg")
    options = ["--size", "64x48", "--out", tmp_path, "--format", form]
    assert call(monkeypatch, dump, *options) == 0
    film = tmp_path / f"run.{form}"
    assert film.stat().st_size > 1000
    if form == "gif":
        assert Image.open(film).n_frames == 3


def test_a_turntable_goes_around_a_single_frame(
    dump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "TURNTABLE_VIEWS", 4)
    options = ["--size", "64x48", "--out", tmp_path, "--frames", "1", "--turntable"]
    assert call(monkeypatch, dump, *options, "--fluid", "1,2") == 0
    views = [np.asarray(Image.open(tmp_path / f"frame_000{n}.png")) for n in range(4)]
    assert not np.array_equal(views[0], views[1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--format", "avi"], "--format avi: use png, gif, mp4"),
        (["--size", "big"], "--size big: expected WIDTHxHEIGHT"),
        (["--size", "9x9"], "--size 9x9: each side from 16"),
        (["--camera", "1,2"], "--camera 1,2: expected three numbers"),
        (["--target", "1,nan,2"], "--target 1,nan,2: expected three numbers"),
        (["--camera", "1,2,3", "--target", "1,2,3"], "the same point"),
        (["--camera", "1,2,3", "--turntable"], "--turntable chooses the view"),
        (["--time", "1"], "--time 1: expected FROM:TO"),
        (["--time", "0:1"], "no times: give its log with --log"),
        (["--every", "2", "--frames", "2"], "--frames and --every exclude each other"),
        (["--spacing", "-1"], "--spacing -1: must be positive"),
        (["--color-by", "mood"], "--color-by mood: use none, speed, pressure, density"),
        (["--color-by", "density"], "the dump has no column rho"),
        (["--colour-by", "density"], "the dump has no column rho"),
        (["--fluid", "x"], "--fluid x: expected atom types"),
        (["--fluid", "7"], "--fluid 7: the dump has the types 1, 2"),
        (["--cloth", "2"], "--cloth 2: triangles come from a data file"),
        (["--data", "none.data"], "no data file none.data"),
        (["--log", "none.log"], "no log file none.log"),
    ],
)
def test_mistakes_are_named(
    dump: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    options: list[str],
    message: str,
) -> None:
    assert call(monkeypatch, dump, "--out", tmp_path / "out", *options) == 2
    assert message in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no complete frame"),
        (dump_frame(0, [[1, 1]], "id type"), "lacks the column x y z"),
        (dump_frame(0, [[1, 1, 0, 0, 0]]).replace("\n1\n", "\n999999999999\n", 1), "no complete"),
        (dump_frame(0, []), "neither water nor cloth"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*cut off")
def test_dumps_that_cannot_be_drawn(
    write_dump: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    text: str,
    message: str,
) -> None:
    assert call(monkeypatch, write_dump(text), "--out", tmp_path / "out") == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_missing_encoder_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(UserError, match="needs an encoder"):
        movie.check_format("mp4", SIZE)


def test_the_data_file_names_the_roles(tmp_path: Path, cloth_data: Path) -> None:
    text = cloth_data.read_text()
    coefficients = "Pair Coeffs # sph/tait\n\n1 fluid 8 k 9\n2 boundary pressure own\n\nAtoms"
    data = tmp_path / "roles.data"
    data.write_text(text.replace("Atoms", coefficients, 1))
    roles = Roles.read(data)
    assert (roles.fluid, roles.walls) == (frozenset({1}), frozenset({2}))
    assert roles.volume == {1: 1 / 8}
    assert roles.mesh is not None
    assert Roles.read(cloth_data).fluid is None
    assert Roles.beside(tmp_path / "other.lammpstrj") == Roles()


# what the command shares with 'sphcloth run'


def test_the_contact_sheet_holds_the_pictures(tmp_path: Path) -> None:
    path = tmp_path / "blue.png"
    Image.new("RGB", (80, 60), "#1257a8").save(path)
    contact_sheet([path] * 6, ["t"] * 6, tmp_path / "sheet.png")
    assert share_of(np.asarray(Image.open(tmp_path / "sheet.png").convert("RGB")), 0.59) > 0.5


def test_spacing_keeps_the_ends() -> None:
    assert command.evenly_spaced(11, 3) == [0, 5, 10]
    assert command.evenly_spaced(2, 6) == [0, 1]
    assert command.evenly_spaced(5, 1) == [4]
