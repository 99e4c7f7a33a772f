# SPDX-License-Identifier: GPL-2.0-or-later
"""Make the reference logs of the examples, or compare them with runs.

    python tests/reference_logs.py [--check | --alike] [--scale NAME=FACTOR] [EXAMPLE ...]

``--check`` compares every digit. On another processor, with another compiler or another release of
LAMMPS the last digits differ, and what is chaotic differs with them: ``--alike`` allows ``TIMES``
times what a number of ranks changes, which are the logs for 1 and for 4 ranks. ``--scale`` shows
what that finds: runs with a variable of the script multiplied, which must not be alike.
"""

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sphcloth.examples import find_example
from sphcloth.log import ThermoTable

EXAMPLES = Path(__file__).parents[1] / "examples"
TINY = {
    name: ("tiny", ["--size", "tiny"])
    for name in (
        *("chair", "cloth_on_water", "curtain", "hammock", "pour", "shower", "stack", "towel"),
        "two_resolutions",
    )
}
RUNS = {**TINY, "banner": ("", ["--set", "t_end=1.0", "--set", "frames=10"])}
PLACE = "Loaded 1 plugins from"  # a folder of this machine
MEASURED = {"v_contact_share"}  # a share of time
TIMES = 10  # of what ranks change
# of the largest value of a column: in the first quarter, and later, when what differs by round-off
# has grown (vectors of another width: 1e-4 of a largest deviation of density at the end of pour)
ALIKE = (1e-6, 1e-3)


def log_of(example: str, ranks: int) -> Path:
    """Return where the reference log is."""
    parts = ["log.22Jul2025", example, RUNS[example][0], str(ranks)]
    return EXAMPLES / example / ".".join(filter(None, parts))


def run(example: str, ranks: int, folder: Path, scale: str) -> Path:
    """Run it, with a variable scaled if asked, and return its log."""
    command = ["run", example, *RUNS[example][1], "--ranks", str(ranks), "--no-pictures"]
    if scale:
        name, factor = scale.split("=")
        value = float(find_example(example).defaults()[name]) * float(factor)
        command += ["--set", f"{name}={value!r}"]
    subprocess.run(
        [Path(sys.executable).with_name("sphcloth"), *command, "--out", str(folder)],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return folder / "log.lammps"


def columns(log: Path) -> dict[str, list[float]]:
    """Return the thermo output without what is measured in time."""
    table = ThermoTable.read(log)
    return {name: list(table[name]) for name in table.columns if name not in MEASURED}


def apart(log: Path, example: str) -> tuple[float, str]:
    """Return by how much a log is off, in units of what is allowed, and where that is most.

    What is allowed grows as the logs for 1 and for 4 ranks drift apart, with a row to spare.
    """
    ours, one, four = columns(log), *(columns(log_of(example, ranks)) for ranks in (1, 4))
    worst = (0.0, "")
    if {name: len(ours.get(name, ())) for name in one} != {n: len(c) for n, c in one.items()}:
        return np.inf, "columns or rows are missing"
    for name in one:  # a column that the example has since is in no log
        column = ours[name]
        reference, other = np.array(one[name]), np.array(four[name])
        scale = max(np.nanmax(np.abs(reference)), 1e-300)
        drift = np.maximum.accumulate(np.nan_to_num(np.abs(reference - other)))
        drift = np.append(drift[1:], drift[-1])
        off = np.nan_to_num(np.abs(np.array(column) - reference), nan=np.inf)
        off[np.isnan(reference) & np.isnan(column)] = 0.0
        early = np.arange(len(off)) < len(off) // 4
        share = off / (np.where(early, *ALIKE) * scale + TIMES * drift)
        row = int(np.argmax(share))
        worst = max(worst, (float(share[row]), f"{name}, row {row} of {len(share)}"))
    return worst


def compare(log: Path, example: str, ranks: int, alike: bool) -> bool:
    """Print how a log compares with the reference; return whether it is as asked."""
    if alike:
        share, where = apart(log, example)
        same = share <= 1.0
        print(f"{example} on {ranks}: {'alike' if same else 'DIFFERENT'}, {share:.2g} ({where})")
    else:
        same = columns(log) == columns(log_of(example, ranks))
        print(f"{log_of(example, ranks).name}: {'same' if same else 'DIFFERENT'}")
    return same


def main() -> int:
    """Return 1 if a log differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--check", action="store_true", help="compare every digit, write nothing")
    how.add_argument("--alike", action="store_true", help="compare up to what ranks change")
    parser.add_argument("--scale", metavar="NAME=FACTOR", default="", help="change a variable")
    parser.add_argument("--ranks", default="1,4", help="numbers of ranks")
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help="all if none is given")
    options = parser.parse_args()
    if options.scale and not options.alike:
        parser.error("--scale goes with --alike")
    differ = 0
    for example in options.examples or sorted(RUNS):
        for ranks in map(int, options.ranks.split(",")):
            with TemporaryDirectory() as folder:
                log = run(example, ranks, Path(folder) / "run", options.scale)
                if options.check or options.alike:
                    differ += not compare(log, example, ranks, options.alike)
                    continue
                lines = log.read_text().splitlines(keepends=True)
                kept = [line for line in lines if not line.startswith(PLACE)]
                log_of(example, ranks).write_text("".join(kept))
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main())
