"""Dumps whose number of atoms varies, and dumps that are not as they should be."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import dump_frame
from MDAnalysis.coordinates.LAMMPS import DumpReader

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.trajectory import Trajectory

COLUMNS = "id type x y z vx vy vz rho"
FEW = [[1, 2, 0.5, 0.25, 0.125, 0, 0, 0, 1000], [7, 1, 3.0000001, 1, 2, 4, 5, 6, 999.5]]
MANY = [[9, 1, -0.5, -1.5, -2.5, 1, 1, 1, 1], *FEW, [8, 1, 0, 0, 0, 2, 2, 2, 2]]
WriteDump = Callable[[str], Path]


def test_frames_differ_in_their_number_of_atoms(write_dump: WriteDump) -> None:
    frames = (dump_frame(0, FEW, COLUMNS), dump_frame(5, MANY, COLUMNS), dump_frame(9, [], COLUMNS))
    trajectory = Trajectory(write_dump("".join(frames)))
    assert [len(frame) for frame in trajectory] == [2, 4, 0]
    assert trajectory.steps.tolist() == [0, 5, 9]
    assert trajectory[-2].step == 5
    assert [frame.step for frame in trajectory[1:]] == [5, 9]
    assert [frame.step for frame in trajectory[::-2]] == [9, 0]
    with pytest.raises(IndexError):
        trajectory[3]


def test_atoms_come_sorted_by_id_with_all_their_columns(write_dump: WriteDump) -> None:
    frame = Trajectory(write_dump(dump_frame(5, MANY, COLUMNS)))[0]
    assert frame.ids.tolist() == [1, 7, 8, 9]
    assert frame.types.tolist() == [2, 1, 1, 1]
    assert frame.columns["rho"].tolist() == [1000, 999.5, 2, 1]
    assert frame.velocities[1].tolist() == [4, 5, 6]
    assert frame.select(2).ids.tolist() == [1]


@pytest.mark.parametrize("several", [list, tuple, set, frozenset, np.array])
def test_one_type_or_several_are_selected(write_dump: WriteDump, several: type) -> None:
    frame = Trajectory(write_dump(dump_frame(5, MANY, COLUMNS)))[0]
    for one in (1, np.int64(1), np.int32(1), 1.0, several([1])):
        assert frame.select(one).ids.tolist() == [7, 8, 9]
    assert frame.select(several([1, 2])).ids.tolist() == [1, 7, 8, 9]
    for absent in (77, several([])):
        assert len(frame.select(absent)) == 0


@pytest.mark.parametrize("wrong", ["1", "water", 1.5, 0, -1, np.nan, np.inf, True, None, ["1"]])
def test_what_is_no_type_selects_nothing(write_dump: WriteDump, wrong: object) -> None:
    frame = Trajectory(write_dump(dump_frame(5, MANY, COLUMNS)))[0]
    for types in (wrong, [1, wrong]):
        with pytest.raises(UserError, match=r"select: type .*: types are whole numbers from 1"):
            frame.select(types)


def test_columns_are_those_that_mdanalysis_reads(write_dump: WriteDump) -> None:
    columns = f"{COLUMNS} fx fy fz mass"
    dump = write_dump(dump_frame(5, [[*row, 7, 8, 9, 0.25] for row in MANY], columns))
    theirs = DumpReader(str(dump), "unscaled", additional_columns=True, dt=1.0, format=None).ts
    ours = Trajectory(dump)[0]
    assert list(ours.columns) == columns.split()
    for name in ("type", "rho", "mass"):
        assert ours.columns[name].tolist() == theirs.data[name].tolist()
    np.testing.assert_allclose(ours.velocities, theirs.velocities)
    np.testing.assert_allclose(ours.vectors("fx", "fy", "fz"), theirs.forces)
    np.testing.assert_allclose(ours.positions - ours.box[0], theirs.positions, atol=1e-6)


def test_columns_that_are_not_asked_for_are_left_out(write_dump: WriteDump) -> None:
    dump = write_dump(dump_frame(0, FEW, COLUMNS))
    frame = Trajectory(dump, columns=["rho", "ix"])[0]
    assert list(frame.columns) == ["id", "type", "x", "y", "z", "rho"]
    whole = Trajectory(dump)[0]
    assert all(np.array_equal(frame.columns[name], whole.columns[name]) for name in frame.columns)
    with pytest.raises(UserError, match="line 11: not a row of numbers"):
        Trajectory(write_dump(dump_frame(0, FEW, COLUMNS).replace("7 1 3", "7 1 l")), columns=[])[0]


def test_positions_are_those_of_the_script(write_dump: WriteDump) -> None:
    text = dump_frame(0, FEW, COLUMNS).replace(" 3 1 2 ", " 3.000000123456 1 2 ")
    frame = Trajectory(write_dump(text))[0]
    assert frame.box.tolist() == [[-1, -2, -3], [4, 5, 6]]
    assert frame.positions.tolist() == [[0.5, 0.25, 0.125], [3.000000123456, 1, 2]]


def test_time_comes_from_the_log(write_dump: WriteDump, tmp_path: Path) -> None:
    log = tmp_path / "log.lammps"
    log.write_text("---\nkeywords: ['Step', 'Time', ]\ndata:\n  - [0, 0, ]\n  - [9, 0.3, ]\n...\n")
    dump = write_dump(dump_frame(0, FEW, COLUMNS) + dump_frame(9, MANY, COLUMNS))
    assert [frame.time for frame in Trajectory(dump, log)] == [0, 0.3]
    assert Trajectory(dump, ThermoTable.read(log)).times.tolist() == [0, 0.3]
    assert np.isnan(Trajectory(dump)[1].time)


# characters left of the last frame: within its title, its header, an atom, before the last newline
@pytest.mark.parametrize("kept", [8, 60, 150, -1])
def test_a_last_frame_that_is_cut_off_is_left_out(write_dump: WriteDump, kept: int) -> None:
    dump = write_dump(dump_frame(0, FEW, COLUMNS) + dump_frame(5, MANY, COLUMNS)[:kept])
    with pytest.warns(UserWarning, match="frame at line 12 is cut off"):
        trajectory = Trajectory(dump)
    assert trajectory.steps.tolist() == [0]


def test_frames_that_repeat_a_step_are_left_out(write_dump: WriteDump) -> None:
    """A run that goes on in the same file dumps the step again at which the one before ended."""
    frames = [(0, FEW), (10, FEW), (10, MANY), (20, MANY), (20, FEW), (20, FEW)]
    dump = write_dump("".join(dump_frame(step, rows, COLUMNS) for step, rows in frames))
    with pytest.warns(UserWarning, match="that repeat the step before them are left out: 3 of 6"):
        trajectory = Trajectory(dump)
    assert trajectory.steps.tolist() == [0, 10, 20]
    assert trajectory.counts.tolist() == [2, 2, 4]
    assert [len(frame) for frame in trajectory] == [2, 2, 4]


@pytest.mark.parametrize(("steps", "line"), [((20, 10, 0), 12), ((0, 20, 10), 23)])
def test_steps_that_go_back_name_file_and_frames(
    write_dump: WriteDump, steps: tuple[int, ...], line: int
) -> None:
    dump = write_dump("".join(dump_frame(step, FEW, COLUMNS) for step in steps))
    message = rf"run\.lammpstrj, line {line}: a frame of step 10 follows one of step 20: give each"
    with pytest.raises(UserError, match=message):
        Trajectory(dump)


def test_garbage_between_frames_names_file_and_line(write_dump: WriteDump) -> None:
    dump = write_dump(dump_frame(0, FEW, COLUMNS) + "rubbish\n" + dump_frame(5, MANY, COLUMNS))
    with pytest.raises(UserError, match=r"run\.lammpstrj, line 12: expected 'ITEM: TIMESTEP'"):
        Trajectory(dump)


@pytest.mark.parametrize("row", ["7 1 3 one 2 4 5 6 999.5", "7 1 3"])
def test_garbage_in_a_row_names_file_and_line(write_dump: WriteDump, row: str) -> None:
    dump = write_dump(dump_frame(0, FEW, COLUMNS).replace("7 1 3 1 2 4 5 6 999.5", row))
    with pytest.raises(UserError, match=r"run\.lammpstrj, line 11: not a row of numbers"):
        Trajectory(dump)[0]


@pytest.mark.parametrize(
    ("line", "old", "new", "message"),
    [
        (2, "TIMESTEP\n0", "TIMESTEP\n\u00b2", "is no count"),
        (4, "ATOMS\n2", "ATOMS\n" + 20 * "9", "is no count"),
        (4, "ATOMS\n2", "ATOMS\n" + 5000 * "9", "is no count"),
        (5, "ff ff ff", "", "does not say, as in"),
        (6, "ff ff ff", "xy xz yz ff ff ff", "not the bounds of a box"),
    ],
)
def test_a_header_that_is_not_what_lammps_writes_names_file_and_line(
    write_dump: WriteDump, line: int, old: str, new: str, message: str
) -> None:
    dump = write_dump(dump_frame(0, FEW, COLUMNS).replace(old, new, 1))
    with pytest.raises(UserError, match=rf"run\.lammpstrj, line {line}: .*{message}"):
        Trajectory(dump)


def test_a_file_that_is_no_dump_is_refused(write_dump: WriteDump) -> None:
    with pytest.raises(UserError, match="line 1: expected 'ITEM: TIMESTEP', found 'LAMMPS"):
        Trajectory(write_dump("LAMMPS data file\n\n5 atoms\n"))
    with pytest.raises(UserError, match="no complete frame"):
        Trajectory(write_dump(""))


def test_missing_columns_say_what_to_dump(write_dump: WriteDump) -> None:
    with pytest.raises(UserError, match=r"lacks the column id type: .*dump ID all custom"):
        Trajectory(write_dump(dump_frame(0, [[0, 0, 0]], "x y z")))


def test_missing_velocities_are_an_error_only_when_asked_for(write_dump: WriteDump) -> None:
    frame = Trajectory(write_dump(dump_frame(0, [[1, 1, 0, 0, 0]])))[0]
    with pytest.raises(UserError, match="no column vx vy vz"):
        _ = frame.velocities
