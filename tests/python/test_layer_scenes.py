"""Scenes of cloth on cloth: they start apart, and without contact the oracle finds them meeting."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.mesh import ClothMesh
from sphcloth.references.incline import Incline
from sphcloth.references.pressed import Pile
from sphcloth.validation import validate
from sphcloth.validation.case import Case
from sphcloth.validation.cases import collision, drape, incline, knot, pressed, stack, twist
from sphcloth.validation.layers import contact
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.layers.shapes import ball, plate, ribbon, sheet, tube

pytest.importorskip("ipctk", reason="pip install 'sphcloth[oracle]'")

SCENES = {module.CASE.name: module for module in (collision, drape, knot, stack, twist)}
EXACT = {module.CASE.name: module for module in (incline, pressed)}
# what is enough for sheets to meet
SHORT = {
    "collision": {"time": "0.06"},
    "drape": {"time": "0.16", "sheets": "2", "across": "8", "every": "4"},
    "knot": {"time": "0.4", "pull": "0.9", "speed": "3", "every": "20"},
    "stack": {"time": "0.1", "sheets": "2", "across": "6"},
    "twist": {"time": "0.26", "every": "10"},
}


def run(case: Case, settings: dict[str, str], out: Path, ranks: int = 1) -> dict[str, float]:
    console = Console(file=io.StringIO())
    result = validate.validate(case, settings, ranks, True, out, console)
    assert result.particle_updates > 0
    assert (out / f"{case.name}.png").stat().st_size > 10_000
    return {name: metric.value for name, metric in result.metrics.items()}


@pytest.mark.parametrize("quick", [True, False])
@pytest.mark.parametrize("name", [*SCENES, *EXACT])
def test_a_scene_starts_apart_by_its_thickness(name: str, quick: bool) -> None:
    module = (SCENES | EXACT)[name]
    values = module.CASE.values({}, quick)
    scene = module.scene(values)
    positions, thickness = scene.positions, values["thickness"]
    assert scene.oracle.count(positions) == 0
    assert scene.oracle.gap(positions, 1.1 * thickness) >= (1 - 1e-9) * thickness
    jittered = scene.jittered(values["jitter"] * thickness, values["seed"]).positions
    assert scene.oracle.count(jittered) == 0
    assert np.max(np.abs(jittered - positions)) <= values["jitter"] * thickness


@pytest.mark.parametrize("name", SCENES)
def test_without_contact_cloth_meets_cloth(name: str, tmp_path: Path) -> None:
    case = SCENES[name].CASE
    found = run(case, SHORT[name] | {"contact": "no"}, tmp_path)
    assert found["met"] > 0
    assert found["not_free"] > 0
    assert found["missing"] == 1
    assert found["first"] > 0
    # a knot comes undone
    assert found.get("apart") != 0


def test_the_jitter_is_that_of_the_seed_and_spares_what_is_held() -> None:
    scene = drape.scene(drape.CASE.values({}, True))
    one, same, other = (scene.jittered(1e-3, seed).positions for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    moved = np.any(one != scene.positions, axis=1)
    held = np.concatenate([(piece.held > 0) | piece.is_obstacle for piece in scene.pieces])
    np.testing.assert_array_equal(moved, ~held)
    assert np.any(one != other)


def test_a_data_file_holds_the_scene(tmp_path: Path) -> None:
    scene = twist.scene(twist.CASE.values({}, True))
    scene.write(tmp_path / "tube.data")
    mesh = ClothMesh.read(tmp_path / "tube.data")
    np.testing.assert_array_equal(mesh.triangles, scene.mesh.triangles)
    text = (tmp_path / "tube.data").read_text()
    rest = np.array([row.split() for row in text.split("Rest\n\n")[1].splitlines()], float)
    np.testing.assert_array_equal(rest[:, 1:], scene.pieces[0].rest)


def test_obstacles_come_last() -> None:
    with pytest.raises(ValueError, match="obstacles come after all cloth"):
        Scene([plate(1.0, 3, 0.0), sheet(1.0, 3, 0.1, 0.2)])


def test_masses_are_those_of_the_areas() -> None:
    scene = Scene([sheet(0.5, 6, 0.1, 0.2), plate(1.0, 3, 0.0)])
    assert np.sum(scene.masses[: scene.moving]) == pytest.approx(0.2 * 0.25)
    woven = Scene([tube(0.5, 2.0, 48, 0.2)])
    assert np.sum(woven.masses) == pytest.approx(0.2 * 2 * np.pi * 0.5 * 2.0, rel=1e-2)


def test_threads_of_a_woven_tube_are_rigid_and_diagonals_are_not() -> None:
    piece = tube(0.5, 2.0, 16, 0.2)
    scene = Scene([piece])
    edges, lengths = scene.rigid
    rows = len(piece.positions) // 16
    assert len(edges) == 16 * rows + 16 * (rows - 1)
    assert len(scene.mesh.edges) == len(edges) + 16 * (rows - 1)
    assert np.max(lengths) == pytest.approx(np.min(lengths), rel=0.1)


def test_a_ribbon_is_as_wide_as_it_should_be_along_a_screw() -> None:
    def screw(s: np.ndarray) -> np.ndarray:
        return np.stack([np.cos(5 * s), np.sin(5 * s), s], axis=-1)

    piece = ribbon(screw, 0.1, 3, 0.2, 2)
    rows = piece.positions.reshape(-1, 3, 3)
    np.testing.assert_allclose(np.linalg.norm(rows[:, 2] - rows[:, 0], axis=1), 0.1, rtol=1e-12)
    np.testing.assert_allclose(rows[0, 1], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(rows[-1, 1], screw(np.array(1.0)), atol=1e-12)
    tangent = np.gradient(rows[:, 1], axis=0)
    across = rows[:, 2] - rows[:, 0]
    assert np.max(np.abs(np.sum(tangent * across, axis=1))) < 1e-2 * 0.1 * 0.1
    assert set(piece.held[:3]) == set(piece.held[-3:]) == {2}
    assert not np.any(piece.held[3:-3])


def test_a_ball_is_round_and_as_fine_as_wanted() -> None:
    piece = ball(0.5, 0.1, 2.0)
    distances = np.linalg.norm(piece.positions - [0, 0, 2.0], axis=1)
    np.testing.assert_allclose(distances, 0.5, rtol=1e-12)
    assert Scene([sheet(0.1, 3, 0, 1), piece]).longest_edge < 0.11


def test_the_command_of_the_fix() -> None:
    values = {"contact": "yes", "thickness": 0.005, "friction": 0.2}
    assert contact.contact_command(values, obstacle="ball") == (
        "fix touch cloth cloth/contact 0.005 obstacle ball cloth yes cloth/friction 0.2"
    )
    values["contact"] = "no"
    assert contact.contact_command(values) == ""
    assert contact.contact_command(values, obstacle="ball") == (
        "fix touch water cloth/contact 0.005 obstacle ball"
    )


def test_references_of_the_incline_and_the_pile() -> None:
    slide = Incline(30.0, 0.3, 10.0)
    assert slide.slides
    assert slide.acceleration == pytest.approx(10 * (0.5 - 0.3 * 3**0.5 / 2))
    assert Incline(30.0, 0.6, 10.0).acceleration == 0
    assert not Incline(30.0, 0.6, 10.0).slides
    pile = Pile(3, 2.0, 5.0, 0.01)
    np.testing.assert_allclose(pile.forces, [11, 9, 7])
    np.testing.assert_allclose(pile.heights, [0.01, 0.02, 0.03])


def test_numbers_of_a_run_that_is_held_up() -> None:
    """The worst of several runs counts, and one that is no number is the worst."""
    assert contact.worst([1, 2, 3], lambda n: -float(n)) == 3
    assert np.isnan(contact.worst([1, 2], lambda n: np.nan if n == 1 else 0.0))
