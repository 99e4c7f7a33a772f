"""What commands between two runs do to steps: nothing, an error that says why, or, where they
change what moves, other steps and water that wakes."""

import numpy as np
import pytest
from harness import by_id, instance, state
from scenes import (
    FLUID,
    MAKE_FALL,
    box,
    fall,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    periodic_water,
    sph_tait,
)

SCHEMES = ("constant", "global", "individual", "block")
DUMP = "id type x y z vx vy vz"
EXACT = f"modify sort id format float %.17g\nrerun now.dump dump {' '.join(DUMP.split()[2:])}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("between")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        with instance() as lmp:
            lmp.commands_string(MAKE_FALL)
    return path


@pytest.fixture
def here(folder, monkeypatch):
    monkeypatch.chdir(folder)
    return folder


def falling(scheme, limits="", extra="", walls="zlo 0"):
    """Half-way through the impact, in the middle of a base step."""
    lmp = instance()
    script = fall(scheme, ceiling=5e-4 if scheme == "constant" else 2e-3, limits=limits)
    script = script.replace("fix walls all wall/sph zlo 0", f"fix walls all wall/sph {walls}")
    lmp.commands_string(f"{extra}{script}thermo_style custom step time\nrun 30")
    return lmp


def end(scheme, between, limits="", run="run 30"):
    """Positions, velocities, and the time since the command between the runs."""
    with falling(scheme, limits) as lmp:
        lmp.commands_string(between)
        begin = lmp.get_thermo("time")
        lmp.command(run)
        return state(lmp), lmp.get_thermo("time") - begin


def error_between(scheme, between, limits="", run="run 30"):
    with falling(scheme, limits) as lmp:
        try:
            lmp.commands_string(f"{between}\n{run}")
        except Exception as error:
            return str(error)
    return ""


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(
    "between", ["reset_timestep 0", "reset_timestep 7 time 0.5", "reset_timestep 1000"]
)
def test_a_reset_of_the_time_changes_no_motion(here, scheme, between):
    (expected, took), (found, takes) = end(scheme, "run 0"), end(scheme, between)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)
    assert takes == pytest.approx(took, rel=1e-9)


@pytest.mark.parametrize("scheme", ["global", "individual"])
def test_output_times_are_those_of_the_new_time(here, scheme):
    with falling(scheme, "output 0.01") as lmp:
        lmp.commands_string("reset_timestep 0")
        met = []
        for _ in range(40):
            lmp.command("run 1 post no")
            if lmp.extract_fix("step", 0, 1, 27):
                met.append(lmp.get_thermo("time"))
    assert met
    np.testing.assert_allclose(met, 0.01 * np.arange(1, len(met) + 1), rtol=1e-12)


def test_a_reset_that_would_miss_an_output_time_is_an_error(here):
    """Particles of unequal steps are synchronized at the end of a base step alone."""
    limits = "output 0.1 gain 1"
    between = "reset_timestep 0 time 0.09999"
    message = error_between("block", between, limits)
    assert "fix step sph/integrate: the time has been reset to 0.09999" in message
    assert "reset the time where a run has ended at an output time" in message


def test_output_times_of_block_steps_after_a_reset(here):
    with falling("block", "output 0.01 gain 1 until 0.02") as lmp:
        lmp.commands_string("run 1000\nreset_timestep 0\nrun 1000")
        assert lmp.get_thermo("time") == pytest.approx(0.02, rel=1e-12)


def test_a_reset_and_a_run_without_setup_are_an_error(here):
    message = error_between("individual", "reset_timestep 0", run="run 30 pre no")
    assert "the time has been reset since the last step: leave 'pre no' out of run" in message


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("between", ["timestep {dt}", "write_restart half.restart"])
def test_other_commands_change_nothing(here, scheme, between):
    dt = 5e-4 if scheme == "constant" else 1e-4
    expected, found = end(scheme, "run 0"), end(scheme, between.format(dt=dt))
    np.testing.assert_array_equal(found[0], expected[0])


@pytest.mark.parametrize("scheme", ["global", "block"])
@pytest.mark.parametrize(
    "between",
    [
        "fix evenly all balance 1000 1.0 shift x 5 1.0",
        "fix forces all store/force",
        "region low block INF INF INF INF INF 0.2\ngroup low dynamic all region low every 5",
        "unfix gravity\nfix weight all gravity 9.81 vector 0 0 -1",
    ],
)
def test_fixes_that_change_no_motion_change_no_step(here, scheme, between):
    expected, found = end(scheme, "run 0"), end(scheme, between)
    np.testing.assert_allclose(found[0], expected[0], rtol=0, atol=1e-11)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_run_upto(here, scheme):
    expected, found = end(scheme, "run 0"), end(scheme, "run 0", run="run 60 upto")
    np.testing.assert_array_equal(found[0], expected[0])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_clear_forgets_the_run_before(here, scheme):
    with falling(scheme) as lmp:
        expected = state(lmp)
        lmp.command("clear")
        ceiling = 5e-4 if scheme == "constant" else 2e-3
        lmp.commands_string(fall(scheme, ceiling=ceiling) + "\nrun 30")
        np.testing.assert_array_equal(state(lmp), expected)


@pytest.mark.parametrize("scheme", ["constant", "global"])
def test_rerun_of_the_last_state_changes_nothing(here, scheme):
    rerun = f"write_dump all custom now.dump {DUMP} {EXACT}"
    expected, found = end(scheme, "run 0"), end(scheme, rerun)
    np.testing.assert_allclose(found[0], expected[0], rtol=0, atol=1e-11)


@pytest.mark.parametrize("scheme", ["individual", "block"])
def test_rerun_and_minimize_need_forces_on_all_particles(here, scheme):
    rerun = f"write_dump all custom now.dump {DUMP} {EXACT}"
    for command, between in {"minimize": "minimize 0 0 1 1", "rerun": rerun}.items():
        message = error_between(scheme, between)
        assert f"fix step sph/integrate: with run_style sph/adaptive {scheme} {command}" in message
        assert "use 'run_style verlet' before" in message


def test_a_reset_behind_a_restart_file(here):
    """The state of unequal steps in the file is that of the time in the file."""
    settings = "neighbor 0.03 bin\nneigh_modify every 1 delay 0 check yes\n"
    fixes = fall("individual").split("check yes\n")[1].split("\n", 1)[1]
    with falling("individual") as lmp:
        lmp.commands_string("write_restart half.restart\nrun 30")
        expected = state(lmp)
    for reset in ("", "reset_timestep 0"):
        with instance() as lmp:
            lmp.commands_string(
                f"comm_modify vel yes\nread_restart half.restart\n{reset}\n{settings}{fixes}run 30"
            )
            np.testing.assert_allclose(state(lmp), expected, rtol=0, atol=1e-11, err_msg=reset)


# Water that falls fast, and two stones that move by fixes before and behind its own.
STONES = (
    sph_tait("1 1 fluid 1000 c0 30 alpha 0.1", "2 2 none")
    + "group water type 1\ngroup first id 1\ngroup last id 2\n"
    + neighbor(0.03)
    + "timestep 0.01\n"
    + gravity()
    + """fix before first nve
fix step water sph/integrate global
fix behind last nve
{style}
run 5
"""
)
MAKE_STONES = (
    header("f f f", FLUID)
    + box("-1 1 -1 1 -3 1", 2)
    + "create_atoms 2 single 0.7 0 0.5 units box\ncreate_atoms 2 single -0.7 0 0.5 units box\n"
    + lattice()
    + filled("block", "-0.1 0.1 -0.1 0.1 -0.1 0.1")
    + "mass * 0.125\nvelocity all set 0.1 0 -5 units box\n"
    + "velocity all ramp vz -1 -5 x -0.1 0.1 units box\n"
)


@pytest.mark.parametrize("style", ["", *(f"run_style sph/adaptive {s}" for s in SCHEMES[1:])])
def test_other_fixes_go_on_from_a_restart_file_to_the_last_bit(style, tmp_path):
    """They take the step of the run at once, not that of the script, which is its ceiling."""
    file, script = tmp_path / "half.restart", STONES.format(style=style)
    with instance() as whole, instance() as again:
        whole.commands_string(MAKE_STONES + script)
        assert whole.get_thermo("dt") < 0.005
        whole.commands_string(f"write_restart {file}\nrun 5")
        again.commands_string(f"comm_modify vel yes\nread_restart {file}\n{script}")
        assert again.get_thermo("time") == whole.get_thermo("time")
        np.testing.assert_array_equal(state(again), state(whole))


def test_a_source_goes_on_behind_a_restart_file_and_a_reset(here):
    source = "fix pour all sph/emit 300 1 0.05 rectangle 0 0 0.9 0.2 0.2 velocity 0 0 -2 start 0\n"
    with falling("global") as lmp:
        lmp.commands_string(f"{source}run 30\nwrite_restart pour.restart\nrun 60")
        expected = lmp.extract_fix("pour", 0, 0)
    fixes = fall("global").split("check yes\n")[1].split("\n", 1)[1]
    with instance() as lmp:
        lmp.commands_string(
            "comm_modify vel yes\nread_restart pour.restart\nreset_timestep 0\n"
            f"neighbor 0.03 bin\nneigh_modify every 1 delay 0 check yes\n{fixes}{source}run 60"
        )
        assert lmp.extract_fix("pour", 0, 0) == expected


def test_the_velocity_of_a_wall_does_not_feel_a_reset(here):
    """That of a lid which goes down by the time since a moment that is reset as well."""
    lid = "variable begin equal 0\nvariable lid equal 0.46-0.2*(time-v_begin)\n"

    def behind(reset):
        with falling("global", extra=lid, walls="zlo 0 zhi v_lid") as lmp:
            now = lmp.get_thermo("time")
            if reset:
                lmp.command("reset_timestep 1000")
                lmp.command(f"variable begin equal {lmp.get_thermo('time') - now!r}")
            lmp.command("run 1")
            return state(lmp)

    np.testing.assert_allclose(behind(True), behind(False), rtol=0, atol=1e-11)


# A cube of water in a corner, over a floor.
CORNER = (
    header("f f f", FLUID)
    + box("-0.2 1 -0.2 0.6 -0.4 0.8")
    + lattice()
    + filled("water", "0 0.3 0 0.3 0 0.3")
    + "mass 1 0.125\n"
    + sph_tait("1 1 fluid 1000 c0 {sound} alpha 0.5 spacing 0.05", options="density calibrated")
    + neighbor(0.03)
    + gravity()
    + """timestep 4e-3
fix walls all wall/sph xlo 0 xhi 0.3 ylo 0 yhi 0.3 zlo 0
fix step all sph/integrate global {limits}
run_style sph/adaptive {scheme}
compute energy all pe
variable moving equal ke+c_energy
thermo_style custom step v_moving ke
"""
)


@pytest.mark.parametrize("scheme", ["global", "block"])
@pytest.mark.parametrize(
    ("sound", "change", "bearable"),
    [
        (60, "velocity all set 0 0 -20 units box", 5e-4),
        (10, "pair_coeff 1 1 fluid 1000 c0 200 alpha 0.5 spacing 0.05", 4e-4),
    ],
)
def test_a_step_that_is_too_long_after_a_change_is_not_taken(scheme, sound, change, bearable):
    with instance() as lmp:
        lmp.commands_string(CORNER.format(scheme=scheme, sound=sound, limits="") + "run 5")
        assert lmp.get_thermo("dt") > 1.1 * bearable
        lmp.commands_string(f"{change}\nrun 0")
        energy, dt = lmp.get_thermo("v_moving"), lmp.get_thermo("dt")
        lmp.command("run 30")
        assert dt < bearable
        assert lmp.get_thermo("v_moving") < 1.05 * energy + 1.0


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_water_that_is_compressed_takes_shorter_steps(scheme):
    with instance() as lmp:
        lmp.commands_string(
            periodic_water(0.05, "1000 c0 20 alpha 0.02 spacing 0.05", "density calibrated")
            + "timestep 0.01\nfix step all sph/integrate global gain 1\n"
            + f"run_style sph/adaptive {scheme}\n"
            + "displace_atoms all random 5e-4 5e-4 5e-4 4 units box\nrun 100"
        )
        longest = lmp.get_thermo("dt")
        smaller = " ".join(f"{axis} scale 0.93" for axis in "xyz")
        lmp.commands_string(f"change_box all {smaller} remap\nrun 0")
        assert lmp.get_thermo("dt") < 0.7 * longest


@pytest.mark.parametrize("scheme", ["global", "block"])
def test_two_runs_are_one_while_particles_are_emitted(scheme):
    """Their number follows from the motion."""
    emit = "fix rain all sph/emit 1000 1 0.05 disc 0.15 0.15 0.6 0.1 velocity 0 0 -2\n"
    found = []
    for runs in ("run 60", "run 25\nrun 35"):
        with instance() as lmp:
            lmp.commands_string(CORNER.format(scheme=scheme, sound=20, limits="") + emit + runs)
            assert lmp.get_natoms() > 230
            found.append(by_id(lmp, "x"))
    np.testing.assert_array_equal(*found)


SLEEP = CORNER.format(scheme="block", sound=20, limits="sleep 0.3")
WALLS = "unfix walls\nfix walls all wall/sph xlo 0 xhi {} ylo 0 yhi 0.3 zlo 0\n"
LOWER = "region lower block INF INF INF INF INF 0.15 units box\ndelete_atoms region lower\n"


@pytest.mark.parametrize(
    ("change", "falls"),
    [(WALLS.format(0.8), 0.02), ("unfix walls\n", 0.02), (LOWER, 0.02)],
    ids=["another wall", "no wall", "half of the water"],
)
def test_water_that_sleeps_wakes_in_another_scene(change, falls):
    with instance() as lmp:
        lmp.commands_string(SLEEP + "run 600")
        assert lmp.extract_fix("step", 0, 1, 29) == 216
        lmp.commands_string(change)
        kept = lmp.get_natoms()
        height = by_id(lmp, "x")[:, 2].mean()
        lmp.command("run 60")
        assert lmp.get_natoms() == kept
        assert by_id(lmp, "x")[:, 2].mean() < height - falls


@pytest.mark.parametrize("change", ["run 0", WALLS.format(0.3), "pair_coeff {}"])
def test_water_that_sleeps_sleeps_on_in_the_same_scene(change):
    change = change.format("1 1 fluid 1000 c0 20 alpha 0.5 spacing 0.05")
    with instance() as lmp:
        lmp.commands_string(f"{SLEEP}run 600\n{change}\nrun 20")
        assert lmp.extract_fix("step", 0, 1, 29) == 216
