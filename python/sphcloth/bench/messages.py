"""``sphcloth bench messages``: what ranks send in a step, and what that makes of large scenes.

A library that is loaded before LAMMPS counts messages, collective calls and their bytes. A step is
the difference of a long and a short run over its steps, so that nothing of the start is in it; its
share of new lists is. Counts are what a busy machine does not change. From them, and from the time
of a particle on one core, follows what to expect on clusters (:func:`expect`).
"""

from __future__ import annotations

import math
import re
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Spread, read_timing
from sphcloth.errors import UserError
from sphcloth.plugin import LIBRARIES
from sphcloth.programs import lammps_on
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.messages"
RANKS = (2, 4, 8)
# what is in the scene, and the scheme of the time step; of the last one, ranks that share no memory
SCENES = {
    "water": {"scene": "water"},
    "water, newton off": {"scene": "water", "newton": "off"},
    "water, global": {"scene": "water", "scheme": "global"},
    "water, block": {"scene": "water", "scheme": "block"},
    "sheet in one node": {"scene": "sheet"},
    "sheet, messages alone": {"scene": "sheet", "shared": "no"},
}
RENEW = 20  # steps from list to list in the script
REACH = 2.4  # support and skin over the spacing: how far ghosts lie beyond a rank
PARTICLES = (10_000_000, 1_000_000_000)
PER_RANK = (1_000_000, 100_000, 10_000, 1_000)


@dataclass(frozen=True)
class Sent:
    """What one rank sends, in the mean over ranks.

    Attributes:
        messages: to other ranks.
        bytes: in these.
        collectives: calls in which all ranks take part.
        collective_bytes: that the rank contributes to these.
    """

    messages: float
    bytes: float
    collectives: float
    collective_bytes: float

    def less(self, other: Sent, parts: int) -> Sent:
        """Return one of so many equal parts of the difference."""
        mine, theirs = asdict(self).values(), asdict(other).values()
        return Sent(*((a - b) / parts for a, b in zip(mine, theirs, strict=True)))


@dataclass(frozen=True)
class Cluster:
    """A machine: s for a message, bytes per second and rank, s for a particle in a step."""

    latency: float = 2e-6
    bandwidth: float = 1e9
    particle: float = 2e-7


def expect(step: Sent, ghosts: float, per_rank: int, ranks: int, on: Cluster) -> float:
    """Return the share of its time that a rank computes, where messages hide behind nothing.

    A step costs the computation of its particles, a latency for each message, the bytes over
    the bandwidth, and for each collective call log2 of the ranks latencies. Ranks are cubes;
    bytes go with their ghosts.

    Args:
        step: what a rank sends in a step, measured.
        ghosts: of the rank that was measured.
        per_rank: particles.
        ranks: how many.
        on: the machine.
    """
    side = per_rank ** (1 / 3)
    of_cube = (side + 2 * REACH) ** 3 - per_rank
    hops = step.messages + step.collectives * math.log2(max(ranks, 2))
    sending = hops * on.latency + step.bytes * of_cube / ghosts / on.bandwidth
    work = per_rank * on.particle
    return work / (work + sending)


class Counter:
    """Runs the script with the counting library in one folder."""

    def __init__(self, folder: Path, across: int) -> None:
        self.folder, self.script = folder, Runner(SCRIPT, folder, across=across)
        self.library = LIBRARIES / "sphclothmessages.so"
        if not self.library.is_file():
            raise UserError(f"{self.library} is missing: install sphcloth again, from source")

    def run(self, ranks: int, variables: Mapping[str, object]) -> str:
        """Return the log of a whole run.

        With ``shared`` no ranks send messages as if each had a node of its own.
        """
        variables = dict(variables)
        shared = str(variables.pop("shared", "yes"))
        command = lammps_on(ranks)
        options = command.index("-n")
        counted = ["-genv", "LD_PRELOAD", str(self.library)]
        counted += ["-genv", "SPHCLOTH_MESSAGES", str(self.folder / "sent")]
        counted += ["-genv", "SPHCLOTH_SHARED_MEMORY", shared]
        return self.script.run([*command[:options], *counted, *command[options:]], variables)

    def __call__(self, ranks: int, variables: Mapping[str, object]) -> tuple[Sent, float]:
        """Return what a rank sent in a whole run, and how many ghosts it had in the end."""
        for old in self.folder.glob("sent.*"):
            old.unlink()
        log = self.run(ranks, variables)
        files = sorted(self.folder.glob("sent.*"))
        if len(files) != ranks:
            raise UserError(
                f"{len(files)} of {ranks} ranks were counted: {self.library} is not loaded"
            )
        rows = [[float(word) for word in file.read_text().split()] for file in files]
        ghosts = re.findall(r"^Nghost: +(\S+) ave", log, re.M)
        return Sent(*(sum(column) / ranks for column in zip(*rows, strict=True))), float(ghosts[-1])


def bench_messages(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Count, print tables and return all figures.

    Args:
        rounds: how often the time of a particle on one core is measured.
        across: particles along an edge of the block.
        steps: length of the shorter run.
        console: where the tables go.
    """
    found = []
    with tempfile.TemporaryDirectory() as name, console.status("") as status:
        count = Counter(Path(name), across)
        for title, variables in SCENES.items():
            for ranks in RANKS:
                status.update(f"{title} on {ranks} ranks")
                found.append({"scene": title, **_count(count, ranks, steps, variables)})
        particle = _time_of_particle(Path(name), rounds, across, steps)
        shared = {str(ranks): _time_shared(count, ranks, rounds, steps) for ranks in RANKS[:2]}
    result = {
        "bench": "messages",
        "particles": across**3,
        "versions": versions("lammps", "mpich", "sphcloth"),
        "found": found,
        "particle_ns": 1e9 * particle,
        "time_shared": {ranks: asdict(spread) for ranks, spread in shared.items()},
        "expected": _expected(found, Cluster(particle=particle)),
    }
    show(result, console)
    return result


def _count(count: Counter, ranks: int, steps: int, variables: Mapping[str, object]) -> dict:
    """Return what a step sends on so many ranks."""
    length = RENEW * max(1, round(steps / RENEW))
    short, _ = count(ranks, {**variables, "steps": length})
    long, ghosts = count(ranks, {**variables, "steps": 2 * length})
    return {"ranks": ranks, "ghosts": ghosts, **asdict(long.less(short, length))}


def _time_of_particle(folder: Path, rounds: int, across: int, steps: int) -> float:
    """Return the least processor time of a step over the particles, on one core, in seconds."""
    run = Runner(SCRIPT, folder, across=across, steps=steps)
    times = [read_timing(run()) for _ in range(rounds)]
    return min(timing.cpu / timing.steps / timing.particles for timing in times)


def _time_shared(count: Counter, ranks: int, rounds: int, steps: int) -> Spread:
    """Return the time of a step with a sheet over that with messages alone, side by side."""
    ratios = []
    for _ in range(rounds):
        time = {
            shared: read_timing(
                count.run(ranks, {"scene": "sheet", "shared": shared, "steps": steps})
            ).loop
            for shared in ("yes", "no")
        }
        ratios.append(time["yes"] / time["no"])
    return Spread.of(ratios)


def _expected(found: list[dict], on: Cluster) -> list[dict]:
    """Return the share of computation for sizes of scenes and of ranks, from the most ranks."""
    rows = []
    for title in SCENES:
        most = max((row for row in found if row["scene"] == title), key=lambda row: row["ranks"])
        step = Sent(**{name: most[name] for name in Sent.__annotations__})
        for particles in PARTICLES:
            shares = {n: expect(step, most["ghosts"], n, particles // n, on) for n in PER_RANK}
            rows.append({"scene": title, "particles": particles, "shares": shares})
    return rows


def show(result: dict, console: Console) -> None:
    """Print what was counted and what is expected."""
    counted = Table(title=f"{result['particles']} particles of water: a rank sends in a step")
    for head in ("scene", "ranks", "ghosts", "messages", "bytes\na ghost", "collective\ncalls"):
        counted.add_column(head, justify="left" if head == "scene" else "right")
    for row in result["found"]:
        figures = (row["messages"], row["bytes"] / row["ghosts"], row["collectives"])
        counted.add_row(
            row["scene"], str(row["ranks"]), f"{row['ghosts']:.0f}", *(f"{f:.3g}" for f in figures)
        )
    console.print(counted)
    for ranks, spread in result["time_shared"].items():
        console.print(
            f"time of {ranks} ranks with a sheet over that with messages alone: "
            f"{spread['value']:.2f} ({spread['least']:.2f} to {spread['most']:.2f})"
        )
    on = Cluster(particle=1e-9 * result["particle_ns"])
    expected = Table(
        title="share of its time that a rank computes:\n"
        f"{result['particle_ns']:.0f} ns a particle, {1e6 * on.latency:g} us a message, "
        f"{on.bandwidth / 1e9:g} GB/s a rank"
    )
    expected.add_column("scene")
    expected.add_column("particles", justify="right")
    for n in PER_RANK:
        expected.add_column(f"{n:.0e}\na rank", justify="right")
    for row in result["expected"]:
        shares = (f"{share:.0%}" for share in row["shares"].values())
        expected.add_row(row["scene"], f"{row['particles']:.0e}", *shares)
    console.print(expected)
