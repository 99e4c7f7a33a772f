"""Obstacles of triangles in fix cloth/contact: a ball, a table, a body that is pushed."""

import re

import numpy as np
import pytest
import trimesh
from harness import by_id, instance, last_frame, run, write
from scenes import box, cloth_styles, final_dump, header, neighbor, sph_tait
from scipy.spatial import cKDTree

RADIUS = 0.3


def scene(tmp_path, mesh, fixes, cloth="", drops="", run_commands="run 0", mass=1.0):
    """Return an input script with an obstacle of type 1 from a mesh, water of type 2, cloth 3."""
    text = ["LAMMPS data file of an obstacle\n"]
    text.append(f"{len(mesh.vertices)} atoms\n{len(mesh.faces)} angles\n3 atom types\n")
    text.append("1 angle types\n1 bond types\n1 dihedral types\n")
    text.append("-1 1 xlo xhi\n-1 1 ylo yhi\n-1 1 zlo zhi\n")
    text.append(f"\nMasses\n\n1 {mass}\n2 0.125\n3 1\n\nAtoms # hybrid\n")
    for n, (x, y, z) in enumerate(mesh.vertices, 1):
        text.append(f"{n} 1 {x:.17g} {y:.17g} {z:.17g} 1 0 1 1")
    text.append("\nAngles\n")
    text += [f"{n} 1 {a + 1} {b + 1} {c + 1}" for n, (a, b, c) in enumerate(mesh.faces, 1)]
    (tmp_path / "obstacle.data").write_text("\n".join(text) + "\n")
    return (
        header()
        + f"read_data {tmp_path / 'obstacle.data'} extra/bond/per/atom 8 extra/angle/per/atom 12 "
        + "extra/dihedral/per/atom 12\ngroup obstacle type 1\n"
        + f"{cloth}\n{drops}\ngroup water type 2\n"
        + sph_tait("1 1 none", "3 3 none", "2 2 fluid 1000 c0 1e-3")
        + cloth_styles("1", "0")
        + neighbor(0.1, cutoff=0.7)
        + "timestep 1e-3\nfix step water sph/integrate constant\n"
        + f"{fixes}\n{run_commands}\n"
    )


def ball():
    return trimesh.creation.icosphere(subdivisions=2, radius=RADIUS)


RAIN = (
    "region rain block -0.51 0.5 -0.51 0.5 0.4 0.8 units box\n"
    "lattice sc 0.1 origin 0.31 0.17 0.43\n"
    "create_atoms 2 region rain\nvelocity all set 0 0 0\n"
    "group rain type 2\nvelocity rain set 0 0 {speed} units box"
)
WEIGHT = "fix g all gravity 9.81 vector 0 0 -1\n"


def depth_in_ball(mesh, points):
    """How far points are inside a convex mesh; negative outside."""
    corners = mesh.vertices[mesh.faces[:, 0]]
    heights = points @ mesh.face_normals.T - (corners * mesh.face_normals).sum(axis=1)
    return -heights.max(axis=1)


@pytest.mark.parametrize("speed", [-3, -300])
def test_rain_does_not_get_into_a_ball(tmp_path, speed):
    mesh = ball()
    lmp = instance()
    contact = "fix c water cloth/contact 0.01 obstacle obstacle"
    lmp.commands_string(scene(tmp_path, mesh, WEIGHT + contact, drops=RAIN.format(speed=speed)))
    lmp.command(f"timestep {0.003 / abs(speed) * 3}")
    deepest = []
    for _ in range(30):
        lmp.command("run 4 post no")
        water = by_id(lmp, "type") == 2
        deepest.append(depth_in_ball(mesh, by_id(lmp, "x")[water]).max())
    assert max(deepest) < 0
    assert lmp.extract_fix("c", 0, 1, 1) > 50  # stops


CLOTH = (
    "create_cloth 3 0.5 size 0.9 0.9 center 0 0 0.35 spacing 0.05 group cloth bond 1 triangle 1 "
    "hinge 1"
)


@pytest.mark.parametrize("below", [1, -1])
def test_what_would_pass_a_plate_in_a_step_ends_on_it(tmp_path, below):
    """It covers three thicknesses a step, and has its gap behind the step of the hit."""
    corners = [[-0.4, -0.4, 0], [0.4, -0.4, 0], [0.4, 0.4, 0], [-0.4, 0.4, 0]]
    plate = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]])
    lmp = instance()
    drop = f"create_atoms 2 single 0.3 -0.2 {0.1 * below} units box"
    contact = "fix c water cloth/contact 0.01 obstacle obstacle"
    lmp.commands_string(scene(tmp_path, plate, contact, drops=drop))
    lmp.commands_string(f"velocity water set 0 0 {-35 * below} units box\nrun 3 post no")
    drop = by_id(lmp, "type") == 2
    np.testing.assert_allclose(by_id(lmp, "x")[drop], [[0.3, -0.2, 0.01 * below]], rtol=1e-5)
    np.testing.assert_allclose(by_id(lmp, "v")[drop], 0.0, atol=1e-10)


def test_cloth_drapes_over_a_ball(tmp_path):
    """No vertex gets in; with friction it stays, the ball carries its weight."""
    mesh = ball()
    lmp = instance()
    fixes = (
        WEIGHT
        + "fix s cloth pbd/cloth damping 20\n"
        + "fix c water cloth/contact 0.01 obstacle obstacle friction 0.6\n"
        + "fix drag cloth viscous 0.005"
    )
    lmp.commands_string(scene(tmp_path, mesh, fixes, cloth=CLOTH))
    carried = []
    for n in range(220):  # 1000 steps to settle, then 1000 that are averaged
        lmp.command(f"run {50 if n < 20 else 5} post no")
        x = by_id(lmp, "x")[by_id(lmp, "type") == 3]
        assert depth_in_ball(mesh, x).max() < 0
        if n >= 20:
            carried.append([lmp.extract_fix("c", 0, 1, m) for m in (7, 8, 9)])
    assert x[:, 2].min() < 0.0 < x[:, 2].max()
    assert lmp.extract_fix("s", 0, 1, 3) < 0.1
    assert np.mean(carried, axis=0)[2] == pytest.approx(-0.5 * 0.81 * 9.81, rel=0.05)


def test_a_moving_table_throws_cloth_and_water(tmp_path):
    """It comes up from below at a constant speed: all leave with it, none goes through.

    The cloth as a whole does; its corners still flap.
    """
    table = trimesh.creation.box(extents=(1.6, 1.6, 0.1)).subdivide_to_size(0.3)
    table.apply_translation([0, 0, -0.3])
    lmp = instance()
    fixes = (
        "fix m obstacle move linear 0 0 2 units box\nfix s cloth pbd/cloth\n"
        "fix c water cloth/contact 0.01 obstacle obstacle"
    )
    cloth = CLOTH.replace("0 0 0.35", "0 0 -0.1")
    drops = (
        "region rain block -0.5 0.5 -0.5 0.5 0.0 0.1 units box\nlattice sc 0.1\n"
        "create_atoms 2 region rain"
    )
    lmp.commands_string(scene(tmp_path, table, fixes, cloth=cloth, drops=drops))
    lmp.command("run 250")
    kind, x, v = (by_id(lmp, name) for name in ("type", "x", "v"))
    assert x[kind == 3, 2].min() > 0.15 + 0.0099
    upward = v[kind == 3, 2]
    assert upward.mean() == pytest.approx(2.0, abs=0.02)
    assert upward.std() < 0.1
    assert x[kind == 2, 2].min() > 0.15


def test_a_body_takes_what_the_drops_give(tmp_path):
    """A rigid ball that floats freely: momentum of ball and drops together is kept."""
    lmp = instance()
    fixes = "fix r obstacle rigid single\nfix c water cloth/contact 0.01 obstacle obstacle"
    lmp.commands_string(
        scene(tmp_path, ball(), fixes, drops=RAIN.format(speed=-3), mass=0.2) + "timestep 5e-4\n"
    )

    def momentum():
        mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
        return (mass[:, None] * by_id(lmp, "v")).sum(axis=0)

    lmp.command("run 0")
    before = momentum()
    lmp.command("run 300")
    under_way = [0.5 * 5e-4 * lmp.extract_fix("c", 0, 1, n) for n in (7, 8, 9)]
    ball_speed = by_id(lmp, "v")[by_id(lmp, "type") == 1][:, 2].mean()
    assert ball_speed < -0.05
    assert np.abs(momentum() + under_way - before).max() < 1e-11 * np.abs(before).max()


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_a_body_takes_what_the_drops_give_when_steps_change(tmp_path, scheme):
    """A force of LAMMPS's Verlet acts for half of its step and half of the next, an impulse once.

    A particle that is braked elsewhere lets steps grow.
    """
    drops = (
        RAIN.format(speed=-3)
        + "\ncreate_atoms 2 single 0.9 0.9 0.9 units box\n"
        + "region corner sphere 0.9 0.9 0.9 0.01 units box\ngroup braked region corner\n"
        + "velocity braked set 6 0 0 units box"
    )
    fixes = (
        "fix r obstacle rigid single\nfix c water cloth/contact 0.01 obstacle obstacle\n"
        "fix brake braked addforce -3.75 0 0"
    )
    lmp = instance()
    lmp.commands_string(
        scene(tmp_path, ball(), fixes, drops=drops, mass=0.2)
        + "unfix step\nfix step water sph/integrate global max 1e-3 velocity 0.01\n"
        + f"run_style sph/adaptive {scheme}\nrun 0"
    )
    mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]

    def momentum():
        return (mass[:, None] * by_id(lmp, "v"))[by_id(lmp, "x")[:, 2] < 0.89].sum(axis=0)

    def is_free():
        return max(abs(lmp.extract_fix("c", 0, 1, n)) for n in (7, 8, 9)) < 1e-30

    before = momentum()
    lmp.command("run 400")
    assert by_id(lmp, "v")[by_id(lmp, "type") == 1][:, 2].mean() < -0.05
    for _ in range(100):
        lmp.command("run 1")
        if is_free():
            break
    assert is_free()
    assert np.abs(momentum() - before).max() < 1e-11 * np.abs(before).max()


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks(tmp_path, ranks):
    fixes = (
        WEIGHT
        + "fix m obstacle move linear 0.1 0 0.5 units box\n"
        + "fix s cloth pbd/cloth damping 5\n"
        + "fix c water cloth/contact 0.01 obstacle obstacle friction 0.3"
    )
    drops = RAIN.format(speed=-3)
    for n in (1, ranks):
        commands = "run 45\n" + final_dump(file=f"{n}.txt")
        text = scene(tmp_path, ball(), fixes, CLOTH, drops, commands)
        run(write(tmp_path, text, f"in.{n}"), ranks=n)
    one, many = (last_frame(tmp_path / f"{n}.txt") for n in (1, ranks))
    # create_atoms numbers them by rank
    distance, partner = cKDTree(one[:, 1:]).query(many[:, 1:])
    assert distance.max() < 1e-9
    assert len(set(partner)) == len(one)


@pytest.mark.parametrize("carrier", ["nve", "rigid single"])
def test_restart_continues_to_the_last_bit(tmp_path, carrier):
    """In the midst of contacts, whose pushes act on the obstacle in the next step."""
    fixes = (
        f"{WEIGHT}fix carrier obstacle {carrier}\nfix s cloth pbd/cloth damping 5\n"
        "fix c water cloth/contact 0.01 obstacle obstacle friction 0.3\n"
        "thermo_style custom step f_c[8] f_c[9] f_c[10]\nthermo_modify format float %.17g"
    )
    end, again = ("run 40\n" + final_dump(file=f"{name}.txt") for name in ("whole", "again"))
    first = f"run 80\nwrite_restart half.bin\n{end}"
    whole = scene(tmp_path, ball(), fixes, CLOTH, RAIN.format(speed=-3), first, mass=0.05)
    start = "comm_modify vel yes\nread_restart half.bin\n"
    behind = start + whole[whole.index("pair_style") :].replace(first, again)
    out = [run(write(tmp_path, text)) for text in (whole, behind)]
    tables = [text.split("Step")[-1].splitlines()[1:3] for text in out]
    assert tables[0] == tables[1]
    assert all(float(word) for word in tables[0][0].split()[1:])
    whole, again = (last_frame(tmp_path / f"{name}.txt") for name in ("whole", "again"))
    assert np.array_equal(whole, again)


@pytest.mark.parametrize(
    ("fixes", "words"),
    [
        ("fix c water cloth/contact 0.01 obstacle gone", "obstacle group is 'gone'"),
        (
            "fix s cloth pbd/cloth\nfix c water cloth/contact 0.01 obstacle cloth\nrun 0",
            "obstacle group cloth holds vertices of fix s",
        ),
        ("fix c all cloth/contact 0.01 obstacle obstacle\nrun 0", "holds atoms of group all"),
        ("fix c obstacle cloth/contact 0.01 obstacle water\nrun 0", "has no atoms|no triangles"),
    ],
)
def test_errors(tmp_path, fixes, words):
    text = scene(tmp_path, ball(), fixes, cloth=CLOTH, drops="create_atoms 2 single 0 0 0.9")
    with pytest.raises(Exception, match=words):
        instance().commands_string(text)


@pytest.mark.parametrize("atoms", ["sph", "hybrid sph bond", "hybrid sph angle"])
@pytest.mark.parametrize(
    ("fixes", "message"),
    [
        ("fix c water cloth/contact 0.01 obstacle mesh", "obstacle group mesh has no triangles"),
        ("fix s mesh pbd/cloth\nfix c water cloth/contact 0.01", "the cloth has no triangles"),
    ],
)
def test_meshes_without_triangles_end_with_an_error_in_any_atom_style(atoms, fixes, message):
    if "pbd/cloth" in fixes and atoms == "sph":
        message = "atom_style sph has no bonds: use atom_style molecular"
    bonds = "bond/types 1 extra/bond/per/atom 2" if atoms != "sph" else ""
    with instance() as lmp, pytest.raises(Exception, match=message):
        lmp.commands_string(
            header(atoms=atoms)
            + box("-1 1 -1 1 -1 1", 2, room=bonds)
            + "mass * 0.1\n"
            + "".join(
                f"create_atoms {kind} single {x} 0 {z}\n"
                for kind, x, z in ((1, 0, 0.3), (2, 0, 0), (2, 0.1, 0))
            )
            + "group water type 1\ngroup mesh type 2\n"
            + sph_tait("1 1 fluid 1000 c0 20", "2 2 none")
            + ("bond_style pbd\nbond_coeff 1 1\ncreate_bonds single/bond 1 2 3\n" if bonds else "")
            + neighbor(0.1)
            + f"timestep 1e-3\nfix step water sph/integrate constant\n{fixes}\nrun 1\n"
        )


def test_triangles_larger_than_the_ghost_cutoff(tmp_path):
    """A box of twelve triangles, cut in the middle by two ranks."""
    text = scene(
        tmp_path,
        trimesh.creation.box(extents=(1.0, 1.0, 0.2)),
        "fix c water cloth/contact 0.01 obstacle obstacle",
        drops="create_atoms 2 single 0 0 0.9",
    ).replace("comm_modify cutoff 0.7", "comm_modify cutoff 0.25")
    text = text.replace("angle_style zero\nangle_coeff *\n", "angle_style none\n")
    text = text.replace("read_data", "processors 2 1 1\nread_data", 1)
    said = run(write(tmp_path, text), ranks=2)
    assert re.search("fix c cloth/contact: ghost cutoff raised from 0.25 to 1.6", said)
