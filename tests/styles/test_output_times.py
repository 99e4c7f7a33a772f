"""Output times of fix sph/integrate: each is met once, by steps that are balanced before it."""

import itertools
import re

import numpy as np
import pytest
from cloth_scenes import cloth
from harness import instance, run, write
from step_scenes import CEILING, DAM, OUTPUT, free_particles, steps_by_limit

# so that steps differ by a factor of three within a few steps
SHAKEN = """
variable push equal 12*sin(200*time)
fix shake fluid addforce v_push 0 0
"""

AFTER_RESTART = """read_restart stop
comm_modify vel yes
"""

EXACT = """
variable next equal f_step[29]
thermo_style custom step time dt f_step[28] press
thermo_modify line yaml format float %.17g
thermo v_next
compute speed all property/atom vx
dump plain all atom 1 plain.{part}
dump_modify plain every/time {every} time yes first {first}
dump computed all custom 1 computed.{part} id c_speed
dump_modify computed every/time $(3*{every}) time yes format float %.17g
"""


def times_of_frames(path):
    lines = path.read_text().splitlines()
    return np.array([float(b) for a, b in itertools.pairwise(lines) if a == "ITEM: TIME"])


def columns_of_frames(path):
    """Columns of a dump, from frame to frame."""
    frames = re.findall(r"ITEM: ATOMS.*\n((?:[^I].*\n)+)", path.read_text())
    return [np.array([line.split() for line in frame.splitlines()], float).T for frame in frames]


def thermo_columns(text):
    """Step, time, dt and the flag of every line of thermodynamic output."""
    rows = [line.strip(" -[],").split(", ") for line in text.splitlines() if line[:5] == "  - ["]
    return np.array(rows, dtype=float)[:, :4].T


def multiples(interval, until):
    return interval * np.arange(0, np.floor(until / interval + 1e-9) + 1)


@pytest.mark.parametrize("every", [0.0173, 0.0031, 0.0004])
@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("style", ["", "run_style sph/adaptive global"])
def test_every_output_time_is_met_once(tmp_path, style, ranks, every):
    """Two runs, then a third after a restart: frames and thermo lines at all multiples."""
    scene = DAM.replace("run 100", SHAKEN)
    first = scene.format(scheme=f"global output {every} acoustic 1.2", style=style)
    text = (
        first
        + EXACT.format(every=every, part=1, first="yes")
        + "run 60\nrun 61\nwrite_restart stop\n"
    )
    after = re.sub(r"(?s)\natom_style.*pair_coeff 2 2 boundary", "\nread_restart stop", first)
    after = after.replace("units si", "").replace("read_restart stop", AFTER_RESTART)
    again = after + EXACT.format(every=every, part=2, first="no") + "run 80\n"
    logs = [
        run(write(tmp_path, script, f"in.{k}"), ranks=ranks)
        for k, script in enumerate((text, again))
    ]
    columns = [thermo_columns(log) for log in logs]
    end = columns[1][1, -1]
    for name, apart in (("plain", every), ("computed", 3 * every)):
        before, after = (times_of_frames(tmp_path / f"{name}.{part}") for part in (1, 2))
        # as always, a run that starts at such a time writes it
        new = after > before[-1] * (1 + 1e-12)
        frames = np.concatenate([before, after[new]])
        np.testing.assert_allclose(frames, multiples(apart, end), rtol=2e-15)
        assert np.sum(~new) == np.isclose(before[-1], columns[0][1, -1], rtol=1e-12)
    dts = np.concatenate(columns, axis=1)[2]
    assert every < 0.01 or (dts.max() > 1.5 * dts.min() and dts.max() < 0.003)
    # thermo: at the start and the end of every run, and at all output times
    _, time, _, flag = np.concatenate(columns, axis=1)
    np.testing.assert_allclose(np.unique(time[flag == 1]), multiples(every, end), rtol=2e-15)
    assert np.sum(flag == 0) <= 5


@pytest.mark.parametrize("place", ["before", "after"])
@pytest.mark.parametrize("style", ["", "run_style sph/adaptive global"])
def test_halt_and_timeout_end_runs_where_they_say(style, place):
    halt = "fix stop all halt 1 v_done >= 1 error continue message no"
    lmp = instance()
    scene = DAM.format(scheme="global output 0.0141", style=style).replace("run 100", "")
    if place == "before":
        scene = scene.replace(
            "fix gravity", f"variable done equal time>=0.0423\n{halt}\nfix gravity"
        )
    else:
        scene += f"variable done equal time>=0.0423\n{halt}\n"
    lmp.commands_string(scene + "thermo_style custom time f_step[28]\nrun 100000000 post no")
    assert lmp.get_thermo("time") == pytest.approx(3 * 0.0141, rel=1e-15)
    assert lmp.extract_fix("step", 0, 1, 27) == 1
    lmp.command("unfix stop")
    lmp.command("timer timeout 1 every 1")
    lmp.command("run 100000000 post no")
    assert lmp.get_thermo("time") > 3 * 0.0141
    lmp.command("timer timeout off")
    ahead = np.ceil(lmp.get_thermo("time") / 0.0141) + 2
    lmp.command("variable done delete")
    lmp.command(f"variable done equal time>={ahead * 0.0141}")
    lmp.command(halt)
    lmp.command("run 100000000 post no")
    assert lmp.get_thermo("time") == pytest.approx(ahead * 0.0141, rel=1e-15)


def test_steps_before_an_output_time_are_equal():
    """As many as are needed, and the one after them grows from what the others allowed."""
    lmp = free_particles(options="output 0.025 growth 1.01", run="run 0")
    dts = []
    for _ in range(7):
        dts.append(lmp.extract_global("dt"))
        lmp.command("run 1 post no")
    np.testing.assert_allclose(dts, 7 * [0.025 / 3], rtol=1e-12)
    assert lmp.get_thermo("time") == pytest.approx(7 * 0.025 / 3, rel=1e-12)
    assert steps_by_limit(lmp) == {OUTPUT: 7}
    # one of 20 is not equal yet, and shorter by less than a tenth is not set by the output time
    lmp = free_particles(options="output 0.197", run="run 1 post no")
    assert lmp.extract_global("dt") == 0.01
    lmp.command("run 10 post no")
    assert lmp.extract_global("dt") == pytest.approx(0.157 / 16, rel=1e-12)
    assert steps_by_limit(lmp) == {CEILING: 11}


def test_the_next_row_is_that_of_an_output_time_or_beyond_the_run():
    values = "fix values all vector 1 f_step[28] f_step[29]\nrun 10"
    lmp = free_particles(options="output 0.035", run=values)
    at_output, row = ([lmp.extract_fix("values", 0, 2, k, n) for k in range(11)] for n in (0, 1))
    assert sum(at_output[1:]) == 2
    for step in range(10):
        assert row[step] == step + 1 if at_output[step + 1] else row[step] > 10


def test_a_ceiling_that_divides_the_interval_is_never_cut():
    lmp = free_particles(options="output 0.1", run="run 1000")
    assert steps_by_limit(lmp) == {CEILING: 1000}
    assert lmp.get_thermo("time") == pytest.approx(10, rel=1e-15)


def test_dumps_by_time_come_with_the_first_step_that_reaches_it(tmp_path):
    """Also where steps grow and shrink much between two frames."""
    scene = DAM.format(scheme="global acoustic 1.2 force 0.05", style="").replace("run 100", SHAKEN)
    log = run(
        write(
            tmp_path,
            scene
            + "thermo_style custom step time dt dt\nthermo_modify line yaml format float %.17g\n"
            + "thermo 1\ndump plain all atom 1 plain\n"
            + "dump_modify plain every/time 0.0173 time yes first yes\n"
            + "run 200\nthermo 50",
        )
    )
    _, time, dt, _ = thermo_columns(log)
    assert dt.max() > 2.5 * dt.min()
    wanted = multiples(0.0173, time[-1])
    np.testing.assert_allclose(
        times_of_frames(tmp_path / "plain"), time[np.searchsorted(time, wanted)], rtol=1e-14
    )


@pytest.mark.parametrize("style", ["", "run_style sph/adaptive global"])
@pytest.mark.parametrize(("every", "until"), [(1, 0.012), (4, 0.012), (1, 1e-4)])
def test_the_end_of_a_run_takes_no_row_from_the_log(tmp_path, style, every, until):
    """A row that is due at the last step but one is written; the second run takes no step."""
    scene = DAM.format(scheme=f"global until {until}", style=style).replace("run 100", "")
    more = "thermo_style custom step time dt f_step[28]\nthermo_modify line yaml\n"
    log = run(write(tmp_path, scene + more + f"thermo {every}\nrun 100\n"))
    steps = thermo_columns(log)[0].astype(int).tolist()
    assert 0 < steps[-1] < 100
    assert steps == sorted({*range(0, steps[-1], every), steps[-1]})


@pytest.mark.parametrize("style", ["", "run_style sph/adaptive global"])
def test_frames_by_time_hold_the_computes_of_their_own_step(tmp_path, style):
    """LAMMPS alone repeats those of the last row of the log, here of the first step."""
    scene = DAM.format(scheme="global", style=style)
    dump = """compute moving all property/atom vz
        variable double atom 2*c_moving
        dump frames all custom 1 frames id vz c_moving v_double
        dump_modify frames every/time 0.01 first no format float %.17g
        thermo 1000
        """
    run(write(tmp_path, scene.replace("run 100", dump + "run 100")))
    frames = columns_of_frames(tmp_path / "frames")
    assert len(frames) > 4
    assert np.ptp(frames[-1][1]) > 0
    for _, speed, computed, doubled in frames:
        np.testing.assert_array_equal(computed, speed)
        np.testing.assert_array_equal(doubled, 2 * speed)


def test_frames_by_time_hold_computes_of_a_sheet_alone(tmp_path):
    lmp = cloth("velocity all set 0.3 0 0.1\n")
    path = tmp_path / "frames"
    lmp.commands_string(
        f"""compute where all property/atom z
        dump frames all custom 1 {path} id z c_where
        dump_modify frames every/time 0.02 first no format float %.17g
        thermo 1000
        run 100
        undump frames"""
    )
    frames = columns_of_frames(path)
    assert len(frames) > 4
    for _, z, computed in frames:
        np.testing.assert_array_equal(computed, z)
