"""The same answer however space is cut and lists are made; see test_styles.py for the rest."""

import numpy as np
import pytest
from harness import instance, last_frame, run, write
from scenes import AGAIN_DROP as USUAL_AGAIN
from scenes import DROP as USUAL_DROP
from scenes import END, MAKE_DROP

from sphcloth.stress.case import SCENES

# for the short time in which water does not go around the box
DROP, AGAIN_DROP = (
    script.replace("global gain 1", "global gain 1 acoustic 0.5 force 0.05")
    for script in (USUAL_DROP, USUAL_AGAIN)
)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A folder with the data file, and the result of one rank after 100 steps."""
    folder = tmp_path_factory.mktemp("drop")
    run(write(folder, MAKE_DROP, "in.make"))
    write(folder, DROP + END, "in.drop")
    run(folder / "in.drop", dump="serial.txt")
    return folder


def largest_difference(folder, a, b):
    return np.abs(last_frame(folder / a) - last_frame(folder / b)).max()


def test_the_scene_has_contact_pressure_and_tension(scene):
    end = last_frame(scene / "serial.txt")
    fluid = end[:, 0] <= 384
    assert -2.9 < end[fluid, 6].mean() < -1.0  # the sheet slows the water down
    assert np.abs(end[~fluid, 3]).max() > 1e-3  # and gives way


def test_contact_alone_stops_water(scene):
    """Water without pressure; the same on ranks is the scene rain of registry.py."""
    script = DROP.replace("c0 30 alpha 0.1 nu 1e-3", "c0 1e-3") + END
    script = script.replace("sph/integrate global", "sph/integrate constant")
    script = script.replace("timestep 0.002", "timestep 5e-4").replace("0.015", "0.02")
    script = script.replace("2 2 boundary", "2 2 boundary pressure own")
    out = run(write(scene, script, "in.rain"), dump="rain1.txt")
    contacts, crossed = out.split("Loop time")[0].split("\n")[-2].split()[-2:]
    assert float(contacts) > 100 and float(crossed) == 0


def test_another_cut_through_the_cloth(scene):
    script = DROP.replace("read_data", "processors 1 2 1\nread_data") + END
    run(write(scene, script, "in.cut"), ranks=2, dump="cut.txt")
    assert largest_difference(scene, "serial.txt", "cut.txt") < 1e-10


def test_all_atoms_on_one_rank(scene):
    script = DROP.replace("pair_style", "balance 1.0 x 0.98\npair_style", 1) + END
    script = script.replace("read_data", "processors 2 1 1\nread_data")
    run(write(scene, script, "in.empty"), ranks=2, dump="empty.txt")
    assert largest_difference(scene, "serial.txt", "empty.txt") < 1e-10


def test_tilted_box(scene):
    """The sheet crosses both periodic borders of a tilted box."""
    tilt = "change_box all triclinic\nchange_box all xy final 0.1 xz final -0.05 yz final 0.08\n"
    move = tilt + "displace_atoms all move 0.3 0.4 0 units box\ngroup fluid type 1\n"
    script = DROP.replace("group fluid type 1\n", move) + END
    # the pins are chosen before the move
    script = script.replace("region held block -0.44 0.44 INF", "region held block -0.14 0.74 INF")
    write(scene, script, "in.tilt")
    run(scene / "in.tilt", dump="tilt1.txt")
    for ranks, grid in ((2, "2 1 1"), (2, "1 2 1"), (4, "* * *")):
        cut = script.replace("read_data", f"processors {grid}\nread_data")
        run(write(scene, cut, "in.tilted"), ranks=ranks, dump="tilt.txt")
        assert largest_difference(scene, "tilt1.txt", "tilt.txt") < 1e-10


def test_deforming_box(tmp_path):
    """Water hits a free sheet while both go through faces that move."""
    script = write(tmp_path, (SCENES / "in.equal").read_text(), "in.equal")
    run(script)
    for ranks in (1, 2):
        settings = {"from": "data", "box": "deforming", "scheme": "block", "steps": 40}
        run(script, ranks, **settings, dt=5e-4, end=f"{ranks}.txt")
    assert largest_difference(tmp_path, "1.txt", "2.txt") < 1e-9


def test_balancing_while_it_runs(scene):
    script = DROP + "fix balance all balance 20 1.0 shift xy 5 1.05\n" + END
    run(write(scene, script, "in.balance"), ranks=2, dump="balance.txt")
    assert largest_difference(scene, "serial.txt", "balance.txt") < 1e-10


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_a_wide_skin_changes_nothing(scene, ranks):
    """Lists of the pair style are narrower and renewed on their own, also beside other ranks."""
    wide = write(scene, DROP.replace("neighbor 0.03", "neighbor 0.3") + END, "in.wide")
    said = run(wide, ranks=ranks, dump=f"wide{ranks}.txt")
    assert largest_difference(scene, "serial.txt", f"wide{ranks}.txt") < 1e-10
    assert "Neighbor list builds = 0" in said


@pytest.mark.parametrize("ranks", [1, 2])
def test_restart_with_a_wide_skin_continues_to_the_last_bit(scene, ranks):
    first = "run 60\nwrite_restart mid.restart\n"
    script = (DROP + first + END.replace("${steps}", "60")).replace("0.03 bin", "0.3 bin")
    run(write(scene, script, "in.whole"), ranks=ranks, dump="whole.txt")
    script = (AGAIN_DROP + END).replace("0.03 bin", "0.3 bin")
    run(write(scene, script, "in.again"), ranks=ranks, dump="again.txt")
    np.testing.assert_array_equal(last_frame(scene / "again.txt"), last_frame(scene / "whole.txt"))


def test_split_runs_are_one_run(scene):
    split = DROP + "run 30\nrun 30\n" + END.replace("${steps}", "40")
    run(write(scene, split, "in.split"), dump="split.txt")
    assert largest_difference(scene, "serial.txt", "split.txt") < 1e-10


def test_data_file_keeps_cloth_and_coefficients(scene):
    script = DROP + "run 0\nwrite_data copy.data nofix\n" + END
    run(write(scene, script, "in.copy"), dump="first.txt", steps=20)
    # coefficients in a data file want their styles first
    styles = "bond_style pbd\ndihedral_style pbd\nangle_style zero\npair_style sph/tait 0.1\n"
    again = DROP.replace("read_data drop.data", styles + "read_data copy.data") + END
    run(write(scene, again, "in.read"), dump="second.txt", steps=20)
    assert largest_difference(scene, "first.txt", "second.txt") < 1e-10


# every kind of constraint at once, with substeps and edges projected along their start
RICH = {
    "bond_coeff 1 1.0": "bond_coeff 1 compliance 1e-5 compress 0.5 limit 0.02",
    "dihedral_coeff 1 0.1": "dihedral_coeff 1 compliance 1 rest flat",
    "iterations 5": "iterations 5 direction start solver {}",
}


def rich(script, solver):
    for plain, other in RICH.items():
        script = script.replace(plain, other.format(solver))
    return script


@pytest.mark.parametrize("solver", ["gs", "jacobi", "substeps"])
def test_compliant_cloth_on_ranks_after_restart_and_from_data(scene, solver):
    first = "run 30\nwrite_restart mid.restart\nwrite_data mid.data nofix\n"
    whole = write(scene, rich(DROP, solver) + first + END.replace("${steps}", "30"), "in.rich")
    run(whole, dump="rich1.txt")
    run(whole, ranks=2, newton="off", dump="rich2.txt")
    assert largest_difference(scene, "rich1.txt", "rich2.txt") < 1e-10
    assert largest_difference(scene, "rich1.txt", "serial.txt") > 1e-4

    run(write(scene, rich(DROP, solver) + first + END.replace("${steps}", "30"), "in.rich"))
    again = write(scene, rich(AGAIN_DROP, solver).replace("index 60", "index 30") + END, "in.more")
    run(again, dump="again.txt")
    run(whole, dump="rich1.txt")
    np.testing.assert_array_equal(last_frame(scene / "again.txt"), last_frame(scene / "rich1.txt"))
    coefficients = (scene / "mid.data").read_text()
    assert "1 compliance 1e-05 compress 0.5 limit 0.02" in coefficients
    assert "1 compliance 1 rest flat" in coefficients


def test_two_instances_and_clear(scene, monkeypatch):
    monkeypatch.chdir(scene)
    script = (DROP + END).replace("${steps}", "20")
    alone = instance()
    alone.commands_string(script.replace("${dump}", "alone.txt"))

    one, two = instance(), instance()
    for lmp, name in ((one, "one.txt"), (two, "two.txt")):
        lmp.commands_string(script.replace("${dump}", name))
    one.command("run 5")
    two.command("clear")
    two.commands_string(script.replace("${dump}", "cleared.txt"))
    one.command("run 5")
    one.close()
    two.command("run 5")
    for name in ("one.txt", "two.txt", "cleared.txt"):
        assert largest_difference(scene, "alone.txt", name) == 0
