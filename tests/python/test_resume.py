"""A run that was stopped goes on, and its log and dump are those of one that was not."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from conftest import dump_frame
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.resume import END_OF_RESTART, join, kept, newest_restart, set_aside
from sphcloth.run import run_example
from sphcloth.trajectory import Trajectory

HEAD = "---\nkeywords: ['Step', 'Time', ]\ndata:\n"


def log_of(*steps: int) -> str:
    return HEAD + "".join(f"  - [{step}, {step / 1000}, ]\n" for step in steps)


def dump_of(*steps: int) -> str:
    return "".join(dump_frame(step, [[1, 1, 0.0, 0, 0], [2, 1, 0.1, 0, 0]]) for step in steps)


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """Return the log and the dump of a run that was killed behind step 30 and went on from 20."""
    log, dump = tmp_path / "log.lammps", tmp_path / "scene.lammpstrj"
    log.write_text(log_of(0, 10, 20, 25, 30) + "  - [35, 0.0")
    dump.write_text(dump_of(0, 20, 30) + dump_of(40)[:-4])
    set_aside(log, dump)
    log.write_text(log_of(20, 25, 30, 40) + "...\nLoop time of 1.0 on 1 procs\n")
    dump.write_text(dump_of(30, 40))
    return log, dump


def test_what_was_written_twice_is_there_once(files: tuple[Path, Path]) -> None:
    log, dump = files
    join(log, dump)
    assert ThermoTable.read(log)["Step"].tolist() == [0, 10, 20, 25, 30, 40]
    assert dump.read_text() == dump_of(0, 20, 30, 40)
    assert not kept(log).exists()
    assert not kept(dump).exists()
    join(log, dump)
    assert dump.read_text() == dump_of(0, 20, 30, 40)


def test_a_run_that_is_stopped_twice_from_the_same_file(files: tuple[Path, Path]) -> None:
    log, dump = files
    join(log, dump)
    set_aside(log, dump)
    log.write_text(log_of(20, 25, 30, 40, 50) + "...\n")
    dump.write_text(dump_of(30, 40, 50))
    join(log, dump)
    assert ThermoTable.read(log)["Step"].tolist() == [0, 10, 20, 25, 30, 40, 50]
    assert dump.read_text() == dump_of(0, 20, 30, 40, 50)


def test_a_run_that_never_began_leaves_what_there_was(files: tuple[Path, Path]) -> None:
    log, dump = files
    before = kept(log).read_text(), kept(dump).read_text()
    log.write_text("LAMMPS\nERROR: no\n")
    dump.unlink()
    join(log, dump)
    assert (log.read_text(), dump.read_text()) == before


def test_a_dump_of_another_form_is_not_thrown_away(files: tuple[Path, Path]) -> None:
    log, dump = files
    kept(dump).write_text("ITEM: UNITS\nsi\n" + dump_of(0))
    with pytest.raises(UserError, match="without 'dump_modify time' or 'units'"):
        join(log, dump)
    assert kept(dump).exists()


def test_the_newest_whole_restart_file_is_taken(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="keep=STEPS"):
        newest_restart(tmp_path, "pour")
    for number, content in enumerate(
        [b"a" + END_OF_RESTART, b"b" + END_OF_RESTART, b"cut off", b""]
    ):
        (tmp_path / f"pour.restart.{number}").write_bytes(content)
    assert newest_restart(tmp_path, "pour").name == "pour.restart.1"


def test_an_example_without_restart_says_so(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="banner cannot go on"):
        run_example("banner", "tiny", 1, tmp_path, {}, None, Console(), resume=True)


def test_pour_goes_on_as_if_it_had_never_stopped(tmp_path: Path) -> None:
    """To round-off: a run that begins takes up its forces in another order.

    Until the water has met the sheet: from then on round-off grows by 1e9 in 50 ms.
    """

    def pour(folder: str, t_end: float, resume: bool = False) -> tuple[ThermoTable, Trajectory]:
        settings = {"t_end": f"{t_end}", "frames": f"{t_end / 0.05:.0f}", "keep": "60"}
        console, out = Console(file=io.StringIO()), tmp_path / folder
        run_example("pour", "tiny", 1, out, settings, None, console, resume=resume)
        return ThermoTable.read(out / "log.lammps"), Trajectory(out / "pour.lammpstrj")

    plain, frames = pour("plain", 0.2)
    pour("stopped", 0.15)
    log, joined = pour("stopped", 0.2, resume=True)
    assert log["v_contacts"][-1] > 0
    shared = np.isin(log["Step"], plain["Step"])
    assert len(plain) - 2 <= shared.sum()
    at = np.searchsorted(plain["Step"], log["Step"][shared])
    np.testing.assert_allclose(log["Time"][shared], plain["Time"][at], rtol=1e-10)
    assert len(joined) == len(frames) == 5
    for one, other in zip(joined, frames, strict=True):
        assert one.step == other.step
        np.testing.assert_allclose(one.positions, other.positions, atol=1e-5)
