"""What the benchmarks share: LAMMPS's time table of a run, and medians over rounds.

Every figure is the median over several rounds; in a round the codes run one after the other, so
that a slow spell of the machine hits all of them.
"""

from __future__ import annotations

import re
import shutil
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sphcloth.errors import UserError
from sphcloth.programs import finish, lammps_on


@dataclass(frozen=True)
class Timing:
    """What LAMMPS printed of one run, in seconds and bytes."""

    loop: float
    cpu: float  # processor time of a rank in the loop
    pair: float
    lists: float
    output: float
    builds: int
    steps: int
    particles: int
    memory: float

    def per_particle(self, seconds: float) -> float:
        """Return nanoseconds per particle and step."""
        return 1e9 * seconds / self.steps / self.particles


@dataclass(frozen=True)
class Spread:
    """Median and extremes of several rounds."""

    value: float
    least: float
    most: float

    @classmethod
    def of(cls, values: list[float]) -> Spread:
        """Summarize measured values."""
        return cls(statistics.median(values), min(values), max(values))

    def __str__(self) -> str:
        return f"{self.value:.3g} ({self.least:.3g} to {self.most:.3g})"


def figure(values: list[float]) -> dict[str, float]:
    """Return median and extremes for a JSON file."""
    return vars(Spread.of(values))


def cell(value: object) -> str:
    """Return a figure as a table shows it, the extremes below the median."""
    if isinstance(value, dict):
        spread = Spread(**value)
        return f"{_short(spread.value)}\n{_short(spread.least)} to {_short(spread.most)}"
    return "" if value is None else _short(value)


def _short(value: float) -> str:
    return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"


def read_timing(log: str) -> Timing:
    """Read the time table of the last run in a log.

    Raises:
        UserError: the log has none.
    """
    last = log.rsplit("Per MPI rank memory allocation", 1)[-1]
    loop = re.search(r"Loop time of (\S+) on (\d+) procs for (\d+) steps with (\d+) atoms", last)
    memory = re.search(r"= \S+ \| (\S+) \| \S+ Mbytes", last)
    share = re.search(r"([\d.]+)% CPU use", last)
    if loop is None or memory is None or share is None:
        raise UserError(f"the benchmark did not finish: {log.strip().splitlines()[-1:]}")

    def section(name: str) -> float:
        return float(re.search(rf"^{name} +\| \S+ +\| (\S+)", last, re.M)[1])

    return Timing(
        loop=float(loop[1]),
        # a loop shorter than a tick of the processor's clock shows no use
        cpu=float(loop[1]) * (float(share[1]) or 100.0) / 100.0,
        pair=section("Pair"),
        lists=section("Neigh"),
        output=section("Output"),
        builds=int(re.search(r"Neighbor list builds = (\d+)", last)[1]),
        steps=int(loop[3]),
        particles=int(loop[4]),
        memory=1024.0**2 * float(memory[1]) * int(loop[2]),
    )


class Runner:
    """Runs a script in one folder, with variables that all runs share."""

    def __init__(self, script: Path, folder: Path, **shared: object) -> None:
        self.script = script.name
        self.folder = folder
        self.shared = shared
        shutil.copy(script, folder)

    def __call__(self, ranks: int = 1, **variables: object) -> str:
        """Run LAMMPS and return its log."""
        return self.run(lammps_on(ranks, bare=True), variables)

    def run(self, lammps: Sequence[str], variables: Mapping[str, object]) -> str:
        """Run the script by a command that starts LAMMPS, and return its log.

        Raises:
            UserError: it failed.
        """
        given = {**self.shared, **variables}
        words = [word for name, value in given.items() for word in ("-var", name, str(value))]
        command = [*lammps, "-in", self.script, "-log", "none", *words]
        done = finish(command, self.folder)
        if done.returncode:
            raise UserError(f"LAMMPS failed: {(done.stdout + done.stderr).strip()[-300:]}")
        return done.stdout

    def time(self, ranks: int = 1, **variables: object) -> Timing:
        """Time one run from the prepared state."""
        return read_timing(self(ranks, task="time", **variables))
