"""``python -m sphcloth.validation.stock CASE CODE``: measure one code on one case."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.examples import parse_settings
from sphcloth.validation.stock import CODES, compare_stock


def main() -> int:
    """Parse the command line, run, and print what the case measures; 2 if LAMMPS failed."""
    parser = argparse.ArgumentParser(prog="python -m sphcloth.validation.stock")
    parser.add_argument("case", help="poiseuille, couette, ...")
    parser.add_argument("code", choices=CODES)
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="settings")
    parser.add_argument("--quick", action="store_true", help="the smaller size of the case")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("stock"))
    given = parser.parse_args()
    start = time.monotonic()
    try:
        settings = parse_settings(given.settings)
        measured, runner = compare_stock(
            given.case,
            given.code,
            settings,
            given.out,
            Console(stderr=True),
            quick=given.quick,
            ranks=given.ranks,
        )
    except UserError as error:
        print(f"{given.case} {given.code}: {error}", file=sys.stderr)
        return 2
    for name, value in measured.items():
        print(f"{name:22s} {value:.4g}")
    steps = runner.runs[-1].thermo
    print(f"{'time_step':22s} {steps['Dt'][-1]:.4g} (unit of time of the script)")
    print(f"{'steps':22s} {' '.join(map(str, runner.steps()))}")
    print(f"{'particle_updates':22s} {runner.particle_updates():.3g}")
    print(f"{'wall_time':22s} {time.monotonic() - start:.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
