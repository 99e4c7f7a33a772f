"""Runs are killed at random moments and go on from their last restart file.

``python -m sphcloth.stress.kill --times 100``. What goes on must end, to the last bit, where the
run that was not killed ends.
"""

from __future__ import annotations

import contextlib
import random
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.programs import lammps_on
from sphcloth.results import write_json
from sphcloth.stress.case import SCENES, SCHEMES
from sphcloth.stress.processes import descendants, kill_all, run_to_end, start

SCRIPT = SCENES / "in.kill"
# Seconds that the launcher has to end the other ranks after one of them was killed, and a run at
# all.  Rarely MPICH's does not: it sees the end of what started the killed rank before that of the
# connection to it, and forgets the others.
GRACE_SECONDS, TIMEOUT_SECONDS = 20.0, 1800.0


@dataclass(frozen=True)
class Trial:
    """One run that was killed.

    Attributes:
        scheme, ranks: of the run.
        killed: "one" or "all" of its ranks.
        at: seconds after its start.
        in_time: whether it still ran then.
        left_over: whether the launcher left other ranks running, which were killed then.
        had_file: whether there was a restart file to go on from; otherwise it began anew.
        complaint: what went wrong, empty if it ended as the run that was not killed.
    """

    scheme: str
    ranks: int
    killed: str
    at: float
    in_time: bool
    left_over: bool
    had_file: bool
    complaint: str


def trials(times: int, ranks: Sequence[int], schemes: Sequence[str], seed: int) -> Iterator[Trial]:
    """Kill so many runs, by turns of each scheme and number of ranks.

    Raises:
        UserError: the run that is not killed does not come to its end.
    """
    dice = random.Random(seed)
    with tempfile.TemporaryDirectory() as scratch:
        kinds = [(scheme, n) for scheme in schemes for n in ranks][:times]
        whole = {kind: _whole(Path(scratch) / f"{kind[0]}-{kind[1]}", *kind) for kind in kinds}
        for k in range(times):
            kind = kinds[k % len(kinds)]
            wall, end = whole[kind]
            killed = "one" if dice.random() < 0.5 else "all"
            folder = Path(scratch) / f"trial-{k}"
            yield _trial(folder, *kind, killed, wall * dice.random(), end)


def _command(scheme: str, ranks: int, again: str) -> list[str]:
    words = ["-in", str(SCRIPT), "-var", "scheme", scheme, "-var", "again", again]
    return [*lammps_on(ranks), *words]


def _whole(folder: Path, scheme: str, ranks: int) -> tuple[float, bytes]:
    """Run to the end; return the wall time and the last state."""
    folder.mkdir()
    start = time.monotonic()
    complaint = _finish(folder, scheme, ranks, "no")
    if complaint:
        raise UserError(f"the run of {scheme} on {ranks} ranks: {complaint}")
    return time.monotonic() - start, (folder / "end.txt").read_bytes()


def _trial(folder: Path, scheme: str, ranks: int, killed: str, at: float, end: bytes) -> Trial:
    folder.mkdir()
    in_time, left_over = _run_and_kill(folder, scheme, ranks, killed, at)
    had_file = (folder / "last.restart").exists()
    complaint = _finish(folder, scheme, ranks, "yes" if had_file else "no")
    if not complaint and (folder / "end.txt").read_bytes() != end:
        complaint = "it ended in another state"
    return Trial(scheme, ranks, killed, at, in_time, left_over, had_file, complaint)


def _run_and_kill(
    folder: Path, scheme: str, ranks: int, killed: str, at: float
) -> tuple[bool, bool]:
    """Return whether the run was still there when it was killed, and whether ranks were left."""
    run = start(_command(scheme, ranks, "no"), folder)
    _await(folder, at)
    in_time = run.poll() is None
    family = descendants(run.pid)
    one = [pid for pid in family if _is_rank(pid)][-1:] if killed == "one" else []
    victims = one or family
    left_over = False
    kill_all(victims)
    try:
        # before it has started its ranks it comes to its end
        run.wait(GRACE_SECONDS if victims else TIMEOUT_SECONDS)
    except subprocess.TimeoutExpired:
        left_over = True
    finally:
        kill_all([*family, *descendants(run.pid)])
        kill_all([run.pid] if run.poll() is None else [])
        run.wait()
    return in_time, left_over


def _await(_: Path, at: float) -> None:
    """Return when a run that was started in a folder is to be killed."""
    time.sleep(at)


def _is_rank(pid: int) -> bool:
    """Is it LAMMPS itself, and not one of the two launchers?

    MPICH's waits for ever where the wheel's is killed before it has started LAMMPS.
    """
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/exe").readlink().name.startswith("lmp")
    return False


def _finish(folder: Path, scheme: str, ranks: int, again: str) -> str:
    """Run to the end, from the beginning or the restart file; return what went wrong."""
    code, text = run_to_end(_command(scheme, ranks, again), folder, TIMEOUT_SECONDS)
    if code is None:
        return "it did not end"
    return "" if code == 0 else f"ended with {text[-300:]}"


def show(found: Sequence[Trial], console: Console) -> bool:
    """Print a row for each scheme and number of ranks; return whether all went well."""
    table = Table(
        "scheme", "ranks", "killed", "ranks left over", "had a file", "same to the last bit"
    )
    for scheme, ranks in dict.fromkeys((t.scheme, t.ranks) for t in found):
        here = [t for t in found if (t.scheme, t.ranks) == (scheme, ranks)]
        counts = (
            sum(t.in_time for t in here),
            sum(t.left_over for t in here),
            sum(t.had_file for t in here),
            sum(not t.complaint for t in here),
        )
        table.add_row(scheme, str(ranks), *(str(n) for n in counts))
    console.print(table)
    for t in found:
        if t.complaint:
            console.print(f"{t.scheme}, {t.ranks} ranks, at {t.at:.2f} s: {t.complaint}")
    return not any(t.complaint for t in found)


def main(
    times: Annotated[int, typer.Option(min=1, help="How many runs are killed.")] = 100,
    seed: Annotated[int, typer.Option(help="Of the moments.")] = 1,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the result here.")] = None,
) -> None:
    """Kill runs at random moments; exit code 1 if one does not go on as if nothing had happened."""
    console = Console()
    found = []
    with console.status("") as status:
        for trial in trials(times, (1, 2), SCHEMES, seed):
            found.append(trial)
            status.update(f"{len(found)} of {times}")
    if json_file is not None:
        write_json(json_file, [asdict(t) for t in found])
    raise typer.Exit(0 if show(found, console) else 1)


if __name__ == "__main__":
    typer.run(main)
