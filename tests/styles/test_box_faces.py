"""Vertices that leave the box end the run before LAMMPS loses them and misses atoms of a bond."""

import pytest
from harness import fail, instance, write
from scenes import cloth_box, cloth_styles, header, neighbor, sheet, sph_tait

FACES = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"]
SOLVED = "velocity cloth set {} units box\nfix sheet cloth pbd/cloth\n"
CARRIED = (
    "fix carry cloth move linear {} units box\nfix contact rest cloth/contact 0.02 obstacle cloth\n"
)


def flying(velocity, *, moves=SOLVED, boundary="f f f", tilt=""):
    """Return a sheet around the origin and a particle at rest, in a box of length 1."""
    return (
        header(boundary)
        + cloth_box(f"-0.5 0.5 -0.5 0.5 -0.5 0.5{tilt}", shape="prism" if tilt else "block")
        + "create_atoms 1 single 0 0 0.3\n"
        + sheet(2, 1, "0.2 0.2", 0.1)
        + "group rest type 1\nmass 1 0.01\n"
        + sph_tait("1 1 fluid 1000 c0 20", "2 2 none")
        + cloth_styles("1", "0")
        + neighbor(0.05)
        + "timestep 5e-3\nfix step rest sph/integrate constant\n"
        + moves.format(velocity)
    )


def through(face):
    speed = 1 if face[1:] == "hi" else -1
    return " ".join(str(speed * (axis == face[0])) for axis in "xyz")


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize(
    ("moves", "owner"), [(SOLVED, "sheet pbd/cloth"), (CARRIED, "contact cloth/contact")]
)
def test_the_face_is_named(moves, owner, face):
    message = (
        rf"fix {owner}: vertex \d+ leaves the box through its fixed face {face}, at .*"
        rf"larger box, or 'boundary' m"
    )
    with pytest.raises(Exception, match=message):
        instance().commands_string(flying(through(face), moves=moves) + "run 200\n")


def test_the_face_of_a_tilted_box_is_named():
    """At its upper end in y the box reaches from -0.1 to 0.9 in x."""
    inside = flying("1 0.8 0", tilt=" 0.4 0 0") + "run 90\n"
    lmp = instance()
    lmp.commands_string(inside)
    with pytest.raises(Exception, match="fixed face yhi"):
        lmp.command("run 60")


def test_a_vertex_that_starts_outside_is_named():
    with pytest.raises(Exception, match=r"vertex \d+ leaves the box through its fixed face xhi"):
        instance().commands_string(
            flying("0 0 0") + "displace_atoms cloth move 0.45 0 0 units box\nrun 0\n"
        )


def test_a_rank_ends_the_others(tmp_path):
    script = write(tmp_path, flying("0 0 -1") + "run 200\n")
    assert "leaves the box through its fixed face zlo" in fail(script, 4)


@pytest.mark.parametrize("boundary", ["p p p", "m m m", "s s s"])
def test_other_faces_let_cloth_fly(boundary):
    lmp = instance()
    lmp.commands_string(flying("0 0 -1", boundary=boundary) + "run 200\n")
    assert lmp.get_natoms() == 10


@pytest.mark.parametrize(("boundary", "drained"), [("f f f", 1), ("m m m", 0)])
def test_particles_drain_where_they_would_be_lost(boundary, drained):
    lmp = instance()
    lmp.commands_string(
        flying("0 0 0", boundary=boundary)
        + "velocity rest set 0 0 1 units box\nfix out rest sph/drain\nrun 100\n"
    )
    assert lmp.extract_fix("out", 0, 0) == drained
    assert lmp.get_natoms() == 10 - drained
