# SPDX-License-Identifier: GPL-2.0-or-later
"""Make the reference logs of the examples, or compare them with runs: every digit.

    python tests/reference_logs.py [--check] [EXAMPLE ...]

On another processor the last digits differ, and what is chaotic differs with them.
"""

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from sphcloth.log import ThermoTable

EXAMPLES = Path(__file__).parents[1] / "examples"
TINY = {
    name: ("tiny", ["--size", "tiny"])
    for name in ("cloth_on_water", "curtain", "hammock", "pour", "shower", "two_resolutions")
}
RUNS = {**TINY, "banner": ("", ["--set", "t_end=1.0", "--set", "frames=10"])}
PLACE = "Loaded 1 plugins from"  # a folder of this machine
MEASURED = {"v_contact_share"}  # a share of time


def log_of(example: str, ranks: int) -> Path:
    """Return where the reference log is."""
    parts = ["log.22Jul2025", example, RUNS[example][0], str(ranks)]
    return EXAMPLES / example / ".".join(filter(None, parts))


def run(example: str, ranks: int, folder: Path) -> Path:
    """Run it and return its log."""
    command = ["run", example, *RUNS[example][1], "--ranks", str(ranks), "--no-pictures"]
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


def main() -> int:
    """Return 1 if a log differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help="all if none is given")
    options = parser.parse_args()
    differ = 0
    for example in options.examples or sorted(RUNS):
        for ranks in (1, 4):
            with TemporaryDirectory() as folder:
                log = run(example, ranks, Path(folder) / "run")
                if not options.check:
                    lines = log.read_text().splitlines(keepends=True)
                    kept = [line for line in lines if not line.startswith(PLACE)]
                    log_of(example, ranks).write_text("".join(kept))
                    continue
                same = columns(log) == columns(log_of(example, ranks))
                differ += not same
                print(f"{log_of(example, ranks).name}: {'same' if same else 'DIFFERENT'}")
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main())
