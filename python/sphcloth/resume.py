"""Go on with a run that was stopped, in the folder of its output.

LAMMPS begins a new log, and here a new dump too. What there was is kept as ``*.before`` until the
run that goes on has said at which step it began; then both become one file again.
"""

from __future__ import annotations

import itertools
import math
import os
import re
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path

from sphcloth.dump import frame_texts
from sphcloth.errors import UserError

BEFORE = ".before"
# the last bytes of a restart file
END_OF_RESTART = b"LammpS RestartT\0"
ROW = re.compile(r"^  - \[(\d+),.*\]\n")


def newest_restart(folder: Path, name: str) -> Path:
    """Return the restart file of a run that was written last, of those that are whole.

    Raises:
        UserError: there is none.
    """
    files = sorted(folder.glob(f"{name}.restart.*"), key=lambda file: file.stat().st_mtime)
    whole = [file for file in files if _is_whole(file)]
    if not whole:
        raise UserError(
            f"{folder} holds no whole restart file of {name}: only a run with "
            "'--set keep=STEPS' can go on"
        )
    return whole[-1]


def _is_whole(restart: Path) -> bool:
    """Tell whether LAMMPS had come to the end of a restart file."""
    with restart.open("rb") as file:
        file.seek(-min(len(END_OF_RESTART), restart.stat().st_size), os.SEEK_END)
        return file.read() == END_OF_RESTART


def set_aside(*files: Path) -> None:
    """Keep files, so that a run that goes on may write new ones of these names."""
    for file in files:
        if file.exists():
            file.replace(kept(file))


def kept(file: Path) -> Path:
    """Return the name under which a file is kept."""
    return file.with_name(file.name + BEFORE)


def join(log: Path, dump: Path) -> None:
    """Make one log and one dump of those kept and the new ones; nothing where none are kept.

    What the stopped run had written behind the step from which the new one went on is dropped. If
    that has not got as far as its first row, what was kept is put back.
    """
    first = first_step(log)
    if first is None:
        for file in (dump, log):
            if kept(file).exists():
                kept(file).replace(file)
        return
    if kept(dump).exists():
        _join_dumps(kept(dump), dump, first)
    if kept(log).exists():
        _join_logs(kept(log), log, first)


def first_step(log: Path) -> int | None:
    """Return the step of the first complete row of a log; None if there is none."""
    if not log.is_file():
        return None
    with log.open(encoding="utf-8", errors="replace") as lines:
        return next((int(row[1]) for row in map(ROW.match, lines) if row), None)


def _join_logs(old: Path, new: Path, first: int) -> None:
    """Put the old log up to its rows from ``first`` on in front of the new one."""
    text = old.read_text(encoding="utf-8", errors="replace")
    whole = text[: text.rfind("\n") + 1].splitlines(keepends=True)
    lines = list(itertools.takewhile(lambda line: _step_of(line) < first, whole))
    _replace(new, ["".join(_with_end(lines)).encode(), new.read_bytes()])
    old.unlink()


def _step_of(line: str) -> float:
    """Return the step of a row of thermo output; of other lines less than any."""
    row = ROW.match(line)
    return int(row[1]) if row else -math.inf


def _with_end(lines: list[str]) -> list[str]:
    """End the table at the end of a log that was cut there, or leave it out where it has no row."""
    if "---\n" not in lines:
        return lines
    start = len(lines) - 1 - lines[::-1].index("---\n")
    table = lines[start:]
    if not any(map(ROW.match, table)):
        return lines[:start]
    return lines if "...\n" in table else [*lines, "...\n"]


def _join_dumps(old: Path, new: Path, first: int) -> None:
    """Put the whole frames of the old dump up to ``first`` in front of those of the new one."""
    with warnings.catch_warnings():  # that a frame was cut off
        warnings.simplefilter("ignore")
        _replace(new, itertools.chain(_frames(old, until=first), _frames(new, behind=first)))
    old.unlink()


def _replace(file: Path, pieces: Iterable[bytes]) -> None:
    """Put something else in the place of a file, all of it or nothing."""
    whole = file.with_name(file.name + ".new")
    with whole.open("wb") as out:
        out.writelines(pieces)
    whole.replace(file)


def _frames(dump: Path, behind: float = -math.inf, until: float = math.inf) -> Iterator[bytes]:
    """Yield the whole frames of a text dump with ``behind`` < step <= ``until``."""
    frames = frame_texts(dump) if dump.is_file() else ()
    return (text for step, text in frames if behind < step <= until)
