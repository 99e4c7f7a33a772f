"""Runs cases on several ranks and schemes, and collects what is wrong."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sphcloth.programs import lammps_on
from sphcloth.stress.case import Case, Outcome
from sphcloth.stress.processes import run_to_end

# seconds after which a run counts as hung
TIMEOUT_SECONDS = 900.0


@dataclass(frozen=True)
class Verdict:
    """What was found of one run.

    Attributes:
        case, scheme, ranks: which.
        complaints: all that is wrong, empty if nothing is.
        end: the error with which it ended, empty if it came to its end.
        wall_s: wall time in seconds.
    """

    case: str
    scheme: str
    ranks: int
    complaints: list[str]
    end: str
    wall_s: float

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return not self.complaints


def run_case(
    case: Case, schemes: Sequence[str], ranks: Sequence[int], quick: bool, folder: Path
) -> Iterator[Verdict]:
    """Run a case with every scheme and number of ranks that it has in common with those given.

    Args:
        case: what to run.
        schemes: of the time step.
        ranks: numbers of MPI ranks; others than one are compared with one, which runs for that.
        quick: take the smaller variant.
        folder: where runs go, each to a folder of its own.
    """
    for scheme in (name for name in case.schemes if name in schemes):
        on_one = None
        for n in case.ranks:
            if n not in ranks and not (n == 1 and len(ranks) > 0):
                continue
            start = time.monotonic()
            settings = {**case.settings, **(case.quick if quick else {}), "scheme": scheme}
            outcome = run_script(case.script, folder / f"{case.name}-{scheme}-{n}", settings, n)
            found = case.complaints(outcome, on_one)
            on_one = on_one or outcome
            if n in ranks:
                wall = time.monotonic() - start
                yield Verdict(case.name, scheme, n, found, outcome.error, wall)


def run_script(script: Path, folder: Path, settings: Mapping[str, object], ranks: int) -> Outcome:
    """Run a script in a folder of its own; a run that takes too long is stopped."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy(script, folder)
    words = [word for name, value in settings.items() for word in ("-var", name, str(value))]
    command = [*lammps_on(ranks, bare=True), "-in", script.name, *words]
    code, text = run_to_end(command, folder, TIMEOUT_SECONDS)
    return Outcome(folder, settings, code, text)
