"""Ranks of one node hand the vertices of a cloth to each other in shared memory."""

import os
import subprocess
from pathlib import Path

import pytest
from harness import last_frame, run, write
from scenes import DROP, END, MAKE_DROP

from sphcloth.programs import lammps_on

RANKS = 4
# with lists, and lanes, that are made anew while the sheet moves
SCRIPT = DROP.replace("read_data", "processors 2 2 1\nread_data") + END
SHARED = Path("/dev/shm")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A folder with the script, and the result of four ranks that share memory."""
    folder = tmp_path_factory.mktemp("shared")
    run(write(folder, MAKE_DROP, "in.make"))
    run(write(folder, SCRIPT, "in.drop"), ranks=RANKS, dump="shared.txt")
    return folder


def test_the_answer_is_that_of_messages_to_the_last_bit(scene, monkeypatch):
    monkeypatch.setenv("SPHCLOTH_SHARED_MEMORY", "no")
    run(scene / "in.drop", ranks=RANKS, dump="messages.txt")
    assert (last_frame(scene / "messages.txt") == last_frame(scene / "shared.txt")).all()


def test_a_rank_that_does_not_share_gets_messages(scene):
    *launcher, lmp = lammps_on(RANKS)
    alone = 'test "$PMI_RANK" = 1 && export SPHCLOTH_SHARED_MEMORY=no; exec "$@"'
    command = [*launcher, "sh", "-c", alone, "sh", lmp, "-in", "in.drop", "-var", "dump", "one.txt"]
    subprocess.run(command, cwd=scene, check=True, capture_output=True, timeout=600)
    assert (last_frame(scene / "one.txt") == last_frame(scene / "shared.txt")).all()


def test_nothing_is_left_behind(scene):
    mine = [path for path in SHARED.glob("sphcloth-*") if path.stat().st_uid == os.getuid()]
    # those of a test beside this one have a process that lives
    assert not [path for path in mine if not Path(f"/proc/{path.name.split('-')[1]}").exists()]
