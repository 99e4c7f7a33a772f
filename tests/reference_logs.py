# SPDX-License-Identifier: GPL-2.0-or-later
"""Make the reference logs of the examples, or compare them with runs.

    python tests/reference_logs.py [--check | --alike] [--runs 1,4,nudged] [--scale NAME=FACTOR]
                                   [EXAMPLE ...]

An example has three logs: of a run on 1 rank, on 4 ranks, and of a *nudged* run, on 1 rank with all
particles and vertices displaced at the start by up to ``NUDGE`` of their distance from the middle
of the box, at random. One that is chaotic has more of these, each nudged in another way.

``--check`` compares every digit. On another processor, with another compiler or another release of
LAMMPS the last digits differ, and what is chaotic differs with them: ``--alike`` allows ``TIMES``
times the spread of the logs that there are. ``--runs nudged8``, and so on, shows what that refuses
by mistake: runs that are nudged in other ways. ``--scale`` shows what that finds: runs with a
variable of the script multiplied, which must not be alike.
"""

import argparse
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sphcloth.examples import find_example
from sphcloth.log import ThermoTable
from sphcloth.run import LOG, copy_companions, lammps_command

EXAMPLES = Path(__file__).parents[1] / "examples"
# size, and variables of the script
TINY = {
    name: ("tiny", {})
    for name in (
        *("balloon", "chair", "cloth_on_water", "curtain", "hammock", "net", "parachute", "pour"),
        *("sail", "shower", "stack", "strainer", "towel", "two_resolutions", "water_balloon"),
    )
}
RUNS = {**TINY, "banner": ("small", {"t_end": "1.0", "frames": "10"})}
# how many logs of nudged runs an example has if not one: as many as allow what other nudges change
SEVEN = dict.fromkeys(("chair", "stack", "strainer", "towel"), 7)
CHAOTIC = {**SEVEN, "hammock": 9, "pour": 3, "shower": 3}
NUDGED = ("nudged", *(f"nudged{way}" for way in range(2, max(CHAOTIC.values()) + 1)))
LOGS = ("1", "4", *NUDGED)  # the first is what is compared with
NUDGE = 1e-13  # what round-off may come to in thousands of steps
PLACE = "Loaded 1 plugins from"  # a folder of this machine
MEASURED = {"v_contact_share"}  # a share of time
TIMES = 10  # of the spread of the logs
# of the largest value of a column: in the first quarter, and later, when what differs by round-off
# has grown (vectors of another width: 1e-4 of a largest deviation of density at the end of pour)
ALIKE = (1e-6, 1e-3)
ROUND_OFF = 1e-9  # of the largest value of a column: less than any event changes


def log_of(example: str, which: str) -> Path:
    """Return where a reference log is: that for a number of ranks, or of a nudged run."""
    size, changed = RUNS[example]
    parts = ["log.22Jul2025", example, "" if changed else size, which]
    return EXAMPLES / example / ".".join(filter(None, parts))


def run(example: str, ranks: str, folder: Path, scale: str) -> Path:
    """Run it, with a variable scaled if asked, and return its log."""
    size, settings = RUNS[example]
    if scale:
        name, factor = scale.split("=")
        value = float(find_example(example).defaults()[name]) * float(factor)
        settings = settings | {name: repr(value)}
    command = ["run", example, "--size", size, "--ranks", ranks, "--no-pictures"]
    for name, value in settings.items():
        command += ["--set", f"{name}={value}"]
    subprocess.run(
        [Path(sys.executable).with_name("sphcloth"), *command, "--out", str(folder)],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return folder / LOG


def logs_of(example: str) -> list[str]:
    """Return which logs an example has."""
    return [*LOGS[:2], *NUDGED[: CHAOTIC.get(example, 1)]]


def run_nudged(example: str, which: str, folder: Path) -> Path:
    """Run a copy of its script with a nudge on one rank, and return the log."""
    found = find_example(example)
    folder.mkdir()
    copy_companions(found.script, folder)
    script = folder / found.script.name
    text = nudged(found.script.read_text(encoding="utf-8"), which)
    script.write_text(text, encoding="utf-8")
    command = lammps_command(script, 1, found.variables(*RUNS[example]))
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return folder / LOG


def nudged(script: str, which: str = NUDGED[0]) -> str:
    """Return a script that displaces all that there is before its first run.

    Towards the middle of the box, as a particle on its face would be lost outside of it.
    """
    nudge = "".join(
        f"variable nudge_{x} atom {NUDGE}*random(0,1,{seed})*(0.5*({x}lo+{x}hi)-{x})\n"
        for seed, x in enumerate("xyz", 3 * way_of(which) - 2)
    )
    nudge += "displace_atoms all move v_nudge_x v_nudge_y v_nudge_z units box\n"
    text, times = re.subn(r"^(?=run\s)", nudge, script, count=1, flags=re.MULTILINE)
    if not times:
        raise ValueError("no line of the script begins with 'run'")
    return text


def way_of(which: str) -> int:
    """Return how a run is nudged: 1 for nudged, 4 for nudged4; 0 if it is not."""
    found = re.fullmatch(rf"{NUDGED[0]}([2-9]|[1-9]\d+)?", which)
    return int(found[1] or 1) if found else 0


def columns(log: Path) -> dict[str, list[float]]:
    """Return the thermo output without what is measured in time."""
    table = ThermoTable.read(log)
    return {name: list(table[name]) for name in table.columns if name not in MEASURED}


def apart(log: Path, example: str) -> tuple[float, str]:
    """Return by how much a log is off, in units of what is allowed, and where that is most.

    What is allowed grows as the reference logs drift apart, with a row to spare. Where steps
    adapt, chaos may change their number, and so that of rows.
    """
    ours = columns(log)
    known = [
        columns(path) for path in (log_of(example, w) for w in logs_of(example)) if path.exists()
    ]
    if missing := known[0].keys() - ours.keys():
        return np.inf, f"columns are missing: {', '.join(sorted(missing))}"
    counts, ends = ([f(table["Step"]) for table in known] for f in (len, max))
    too_far = [
        abs(here - of[0]) > TIMES * np.ptp(of)
        for here, of in ((len(ours["Step"]), counts), (max(ours["Step"]), ends))
    ]
    if all(too_far):
        return np.inf, f"rows: {len(ours['Step'])}, not {counts[0]}"
    rows = min(len(ours["Step"]), *counts)
    beside = rows_beside(
        *(np.array([table[x][:rows] for table in known]) for x in ("Step", "Time"))
    )
    tables = {  # a column that the example has since is in no log
        name: np.array([table[name][:rows] for table in known if name in table])
        for name in known[0]
    }
    by_chance = chaotic(list(tables.values()))
    worst = (0.0, "")
    for name, values in tables.items():
        share = off(np.array(ours[name][:rows]), values, beside, by_chance * event(values))
        row = int(np.argmax(share))
        worst = max(worst, (float(share[row]), f"{name}, row {row} of {rows}"))
    return worst


def rows_beside(steps: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return for each row how many before and after it may have what it has.

    Rows are a number of steps apart. Where steps adapt and chaos moves them by a step or more, what
    happens at a time, as the end of pouring, is in another row.
    """
    moved = drift(times)
    between = np.maximum(np.gradient(times[0]), 1e-300)
    step = between / np.maximum(np.gradient(steps[0]), 1.0)
    return np.where(moved >= step, np.ceil(moved / between), 0).astype(int)


def chaotic(tables: Sequence[np.ndarray]) -> np.ndarray:
    """Return for each row whether known logs have gone apart by then, in a quarter of columns."""
    shares = [drift(known) / largest(known[0]) for known in tables]
    return np.mean(np.array(shares) > ALIKE[1], axis=0) >= 0.25


def event(known: np.ndarray) -> float:
    """Return the least by which known logs differ in a row, beyond round-off; 0 if they do not.

    In a column that counts that is one event more or less. When the first particle falls off a
    swinging sheet is chance, and a few logs may all have it late: from where they are chaotic on,
    they are taken to differ by one event, also where none of them has seen one yet.
    """
    between = np.abs(known[:, None] - known[None])
    return min(between[between > ROUND_OFF * largest(known[0])], default=0.0)


def largest(column: np.ndarray) -> float:
    """Return the scale of a column, which is not zero."""
    return max(np.nanmax(np.abs(column)), 1e-300)


def off(
    column: np.ndarray, known: np.ndarray, beside: np.ndarray, least: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return by how much a column is off the first that is known, in units of what is allowed.

    Args:
        column: what is compared.
        known: the column of each reference log.
        beside: see ``rows_beside``.
        least: by how much known logs are taken to differ at least.
    """
    reference = known[0]
    near = [reference[max(row - n, 0) : row + n + 1] for row, n in enumerate(beside)]
    low, high = ([extreme.reduce(values) for values in near] for extreme in (np.fmin, np.fmax))
    difference = np.nan_to_num(np.maximum(low - column, column - high), nan=np.inf)
    difference[np.isnan(reference) & np.isnan(column)] = 0.0
    early = np.arange(len(column)) < len(column) // 4
    spread = np.maximum(drift(known), least)
    return difference / (np.where(early, *ALIKE) * largest(reference) + TIMES * spread)


def drift(known: np.ndarray) -> np.ndarray:
    """Return by how much columns differ from the start to each row, with a row to spare."""
    so_far = np.maximum.accumulate(np.nan_to_num(np.ptp(known, axis=0)))
    return np.append(so_far[1:], so_far[-1])


def compare(log: Path, example: str, which: str, alike: bool) -> bool:
    """Print how a log compares with the reference; return whether it is as asked."""
    if alike:
        share, where = apart(log, example)
        same = share <= 1.0
        print(f"{example} on {which}: {'alike' if same else 'DIFFERENT'}, {share:.2g} ({where})")
    else:
        same = columns(log) == columns(log_of(example, which))
        print(f"{log_of(example, which).name}: {'same' if same else 'DIFFERENT'}")
    return same


def main() -> int:
    """Return 1 if a log differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--check", action="store_true", help="compare every digit, write nothing")
    how.add_argument("--alike", action="store_true", help="compare up to what a nudge changes")
    parser.add_argument("--scale", metavar="NAME=FACTOR", default="", help="change a variable")
    parser.add_argument("--runs", help="as 1,4,nudged; 1,4 with --alike, else all that there are")
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help="all if none is given")
    options = parser.parse_args()
    if options.scale and not options.alike:
        parser.error("--scale goes with --alike")
    differ = 0
    for example in options.examples or sorted(RUNS):
        known = LOGS[:2] if options.alike else logs_of(example)
        for which in options.runs.split(",") if options.runs else known:
            reference = log_of(example, which)
            if options.check and not reference.exists():
                print(f"{reference.name}: there is none")
                continue
            with TemporaryDirectory() as parent:
                folder = Path(parent) / "run"
                if way_of(which):
                    log = run_nudged(example, which, folder)
                else:
                    log = run(example, which, folder, options.scale)
                if options.check or options.alike:
                    differ += not compare(log, example, which, options.alike)
                    continue
                lines = log.read_text().splitlines(keepends=True)
                reference.write_text("".join(x for x in lines if not x.startswith(PLACE)))
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main())
