"""The triangles of a data file that LAMMPS wrote."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame, square_sheet

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh, read_masses


def test_triangles_are_the_angles_of_the_data_file(cloth_data: Path) -> None:
    mesh = ClothMesh.read(cloth_data)
    assert mesh.ids.tolist() == [2, 3, 4, 5]
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_positions_follow_the_ids() -> None:
    mesh, sheet = square_sheet(2)
    moved = sheet + np.array([0, 0, 3])
    frame = make_frame(0, [[9, 9, 9]], moved)
    np.testing.assert_array_equal(mesh.positions(frame), moved)
    np.testing.assert_array_equal(mesh.corners(frame)[0], moved[mesh.triangles[0]])


def test_a_lost_vertex_is_named() -> None:
    mesh, sheet = square_sheet(2)
    with pytest.raises(UserError, match="cloth vertex 9 is not in the dump at step 4"):
        mesh.positions(make_frame(4, [], sheet[:-1]))


@pytest.mark.parametrize("row", ["1", "x 1.0", "1 heavy"])
def test_masses_that_cannot_be_read_are_named(cloth_data: Path, row: str) -> None:
    text, count = re.subn(r"(?m)^(Masses.*\n\n).*$", rf"\g<1>{row}", cloth_data.read_text())
    assert count == 1
    cloth_data.write_text(text)
    with pytest.raises(UserError, match="the section Masses is not a type and a mass"):
        read_masses(cloth_data)


@pytest.mark.parametrize("text", ["not a data file\n", ""])
def test_a_data_file_of_another_form_says_how_to_write_it(cloth_data: Path, text: str) -> None:
    cloth_data.write_text(text)
    with pytest.raises(UserError, match="write_data FILE nofix"):
        ClothMesh.read(cloth_data)


def test_a_scene_without_triangles_is_refused(cloth_data: Path) -> None:
    text = re.sub(r"\d+ (angles|dihedrals)", r"0 \1", cloth_data.read_text())
    cloth_data.write_text(text[: text.index("Angles\n")])
    with pytest.raises(UserError, match="holds no cloth"):
        ClothMesh.read(cloth_data)


def test_triangles_wound_in_opposite_senses_are_refused() -> None:
    with pytest.raises(UserError, match="wound in opposite senses"):
        ClothMesh(np.arange(4), np.array([[0, 1, 2], [0, 3, 2]]))


@pytest.mark.parametrize("rows", ["1 1 2 3", "1 1 2 3 x", "1 1 2"])
def test_bad_rows_of_triangles_are_refused(cloth_data: Path, rows: str) -> None:
    text = cloth_data.read_text().replace("2 angles", "1 angles")
    before, behind = text.split("Angles\n")
    cloth_data.write_text(f"{before}Angles\n\n{rows}\n\nDihedrals\n{behind.split('Dihedrals')[1]}")
    with pytest.raises(UserError, match="section Angles cannot be read"):
        ClothMesh.read(cloth_data)


def test_noise_is_no_data_file(cloth_data: Path) -> None:
    cloth_data.write_bytes(np.random.default_rng(1).bytes(2000))
    with pytest.raises(UserError, match="is no data file"):
        ClothMesh.read(cloth_data)


def test_the_sense_of_the_triangles_stays(cloth_data: Path) -> None:
    """Whatever the order of the corners' ids."""
    text = re.sub(r"(Angles\n\n)1 1 2 3 4", r"\g<1>1 1 4 2 3", cloth_data.read_text())
    cloth_data.write_text(text)
    assert ClothMesh.read(cloth_data).triangles[0].tolist() == [2, 0, 1]
