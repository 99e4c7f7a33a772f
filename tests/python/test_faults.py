"""Faults of machines and media: kills, full disks, files that are cut off or damaged.

A fault ends in a result that is right, or in an error that names the file. More of each with
SPHCLOTH_EXAMPLES=5000, and `python -m sphcloth.stress.kill`.
"""

import os
import random
import re
import time
import warnings

import pytest

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.mesh import ClothMesh
from sphcloth.programs import program
from sphcloth.stress import kill
from sphcloth.stress.kill import SCRIPT
from sphcloth.stress.processes import run_to_end
from sphcloth.trajectory import Trajectory

EXAMPLES = int(os.environ.get("SPHCLOTH_EXAMPLES", 120))


@pytest.fixture
def killed_at_rows(monkeypatch):
    """Runs are killed when their logs have so many rows."""
    rows = iter((3, 9))

    def await_rows(folder, _):
        wanted, log = next(rows), folder / "log.lammps"
        while not log.is_file() or log.read_text().count("\n  - [") < wanted:
            time.sleep(0.01)

    monkeypatch.setattr(kill, "_await", await_rows)


@pytest.mark.usefixtures("killed_at_rows")
def test_a_run_that_was_killed_goes_on_to_the_last_bit():
    found = list(kill.trials(2, [2], ["block"], seed=3))
    assert [trial.complaint for trial in found] == ["", ""]
    assert all(trial.in_time and trial.had_file for trial in found)


@pytest.mark.usefixtures("killed_at_rows")
def test_ranks_that_a_launcher_leaves_over_are_killed_and_counted(monkeypatch):
    """Without any patience it has always left some, and the run goes on all the same."""
    monkeypatch.setattr(kill, "GRACE_SECONDS", 0.0)
    (found,) = kill.trials(1, [2], ["block"], seed=3)
    assert found.left_over and found.in_time and found.had_file
    assert found.complaint == ""


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A folder with a restart file, a dump, a log and a data file of one run."""
    folder = tmp_path_factory.mktemp("kept")
    script = SCRIPT.read_text() + "write_data kill.data nofix\n"
    assert lammps(folder, script, parts=3, frames=1)[0] == 0
    return folder


def lammps(folder, script, **variables):
    (folder / "in.run").write_text(script)
    words = [word for name, value in variables.items() for word in ("-var", name, str(value))]
    return run_to_end([program("lmp"), "-in", "in.run", *words], folder, 600)


# ---- a disk that is full -------------------------------------------------------------------------

FULL = {
    "dump": ("kill.lammpstrj", "Error writing dump scene: No space left"),
    "restart": ("${file}.new\n", "I/O error while writing restart"),
    "last dump": ("end.txt", "Error writing dump WRITE_DUMP: No space left"),
}


@pytest.mark.parametrize(("file", "message"), FULL.values(), ids=FULL)
def test_a_full_disk_is_named(tmp_path, file, message):
    full = "/dev/full\n" if file.endswith("\n") else "/dev/full"
    script = SCRIPT.read_text().replace(f"{file}", full, 1)
    code, text = lammps(tmp_path, script, parts=2, frames=1)
    assert code == 1
    assert re.search(rf"ERROR.*{message}", text)


# ---- a restart file that is not what it was ------------------------------------------------------


@pytest.mark.parametrize("share", [0.01, 0.5, 0.999])
def test_a_restart_file_that_is_cut_off(kept, tmp_path, share):
    whole = (kept / "last.restart").read_bytes()
    (tmp_path / "last.restart").write_bytes(whole[: int(share * len(whole))])
    code, text = lammps(tmp_path, SCRIPT.read_text(), again="yes", parts=4)
    assert code == 1
    assert "ERROR: Incomplete or corrupted LAMMPS restart file" in text


MARK = (0x53504843).to_bytes(4, "little")


def test_a_record_of_another_release_names_the_fix(kept, tmp_path):
    whole = (kept / "last.restart").read_bytes()
    styles = set()
    for mark in re.finditer(MARK, whole):
        old = whole[: mark.start()] + b"old!" + whole[mark.end() :]
        (tmp_path / "last.restart").write_bytes(old)
        code, text = lammps(tmp_path, SCRIPT.read_text(), again="yes", parts=4)
        assert code == 1
        styles.update(re.findall(r"ERROR: fix \w+ (\S+): its record in the restart", text))
    assert styles == {"sph/emit", "sph/drain", "sph/watch", "sph/integrate", "pbd/cloth"}


# ---- files that the package reads ----------------------------------------------------------------

JUNK = [b"\x00", b"\xff\xfe", b"nan", b"1e999", b"ITEM:", b"...\n", b"---\n", b"  - [", b"]", b"\n"]


def damaged(whole, dice):
    """Cut off, a byte changed, some lost, some put in, a line lost or there twice."""
    at = dice.randrange(min(len(whole), dice.choice([3000, len(whole)])))
    lines = whole.split(b"\n")
    line = dice.randrange(len(lines))
    return dice.choice(
        [
            whole[:at],
            whole[:at] + bytes([dice.randrange(256)]) + whole[at + 1 :],
            whole[:at] + whole[at + dice.randrange(1, 200) :],
            whole[:at] + dice.choice(JUNK) + whole[at:],
            b"\n".join(lines[:line] + lines[line + 1 :]),
            b"\n".join([*lines[:line], lines[line], *lines[line:]]),
        ]
    )


READERS = {
    "kill.lammpstrj": lambda path: [len(frame) for frame in Trajectory(path)],
    "log.lammps": ThermoTable.read,
    "kill.data": ClothMesh.read,
}


@pytest.mark.parametrize("name", READERS)
def test_a_damaged_file_is_read_or_refused_by_its_name(kept, tmp_path, name, record_property):
    """Whatever else it raises fails."""
    whole, dice, refused = (kept / name).read_bytes(), random.Random(7), 0
    for _ in range(EXAMPLES):
        (tmp_path / name).write_bytes(damaged(whole, dice))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                READERS[name](tmp_path / name)
        except UserError as error:
            assert name in str(error) or "wound in opposite senses" in str(error)
            refused += 1
    record_property("tried", EXAMPLES)
    record_property("refused", refused)
    assert 0 < refused < EXAMPLES


WRONG = {
    "row": (
        "log.lammps",
        rb"  - \[10, [^,]*,",
        b"  - [10, x,",
        r"log.lammps, line \d+: '- \[10, x,",
    ),
    "short row": (
        "log.lammps",
        rb"  - \[10, [^,]*,",
        b"  - [10,",
        r"log.lammps, line \d+: '- \[10",
    ),
    "bounds": ("kill.lammpstrj", rb"pp pp ff\n\S+", b"pp pp ff\nx", r"trj, line 6: not the bounds"),
    "atom": (
        "kill.lammpstrj",
        rb"\n1 2 \S+",
        b"\n1 2 x",
        r"lammpstrj, line \d+: not a row of numb",
    ),
    "bytes": ("kill.lammpstrj", rb"\n1 2 \S+", b"\n1 2 \xff", r"line \d+: not a row of numbers"),
    "cut off": (
        "kill.data",
        rb"Dihedrals[\s\S]*",
        b"",
        r"0 lines in the section Dihedrals, .*'\d+'",
    ),
}


@pytest.mark.parametrize(("name", "old", "new", "message"), WRONG.values(), ids=WRONG)
def test_the_line_is_named(kept, tmp_path, name, old, new, message):
    text, n = re.subn(old, new, (kept / name).read_bytes(), count=1)
    assert n == 1
    (tmp_path / name).write_bytes(text)
    with pytest.raises(UserError, match=message):
        READERS[name](tmp_path / name)
