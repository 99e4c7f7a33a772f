# SPDX-License-Identifier: GPL-2.0-or-later
"""Run examples several times, with steps that differ by a millionth, and say what goes wrong.

    python tests/nudged_examples.py [--runs 5] [--size small] [--jobs 2] [EXAMPLE ...]

What is chaotic comes to another end in each run, and one that holds may be lucky.  A run fails as
``sphcloth run`` does: an error, a particle across a sheet, edges through triangles, mass that is
missing.  The table has the worst of all runs.
"""

import argparse
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from reference_logs import RUNS

from sphcloth.examples import find_example
from sphcloth.log import ThermoTable
from sphcloth.run import LOG, last_words

STEP = "dt"  # a variable of all examples: the largest step
NUDGE = 1e-6  # of it, times the number of the run


def run(example: str, number: int, size: str, folder: Path) -> dict[str, object]:
    """Run it once; return what is worth knowing, and the error if there is one."""
    found = find_example(example)
    step = float((found.defaults() | found.sizes()[size])[STEP]) * (1.0 - number * NUDGE)
    out = folder / f"{example}{number}"
    command = [Path(sys.executable).with_name("sphcloth"), "run", example, "--size", size]
    options = ["--no-pictures", "--set", f"{STEP}={step!r}", "--out", out]
    done = subprocess.run([*command, *options], capture_output=True, text=True)
    found_out: dict[str, object] = {"strain": largest(out / LOG, "v_strain")}
    summary = out / "summary.json"
    if summary.exists():
        found_out |= json.loads(summary.read_text())
    if done.returncode:
        found_out["error"] = f"run {number}: " + " ".join(last_words(out)[-1:])
    return found_out


def largest(log: Path, column: str) -> float:
    """Return the largest value of a column of the log, NaN if there is none."""
    if not log.exists():
        return float("nan")
    table = ThermoTable.read(log)
    return max(table[column]) if column in table.columns else float("nan")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", default="small")
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    failed = False
    print(f"{'example':16s} steps          strain           crossed  through  failed")
    with TemporaryDirectory() as folder, ThreadPoolExecutor(args.jobs) as pool:
        for example in args.examples or RUNS:
            tasks = [
                pool.submit(run, example, number, args.size, Path(folder))
                for number in range(1, args.runs + 1)
            ]
            runs = [task.result() for task in tasks]
            errors = [r["error"] for r in runs if "error" in r]
            failed |= bool(errors)
            steps, strains = ([r[x] for r in runs if x in r] for x in ("steps", "strain"))
            crossed, through = (
                max((r.get(x) or 0 for r in runs), default=0) for x in ("crossed", "intersections")
            )
            print(
                f"{example:16s} {min(steps, default=0):6d} {max(steps, default=0):6d}  "
                f"{min(strains):.4f} {max(strains):.4f}  {crossed:7d}  {through:7d}  {len(errors)}",
                flush=True,
            )
            for error in errors:
                print(f"    {error}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
