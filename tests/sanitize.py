"""Runs tests with the plugin of `make sanitize`, and fails if a sanitizer had something to say.

``python tests/sanitize.py SITE [ARGUMENT ...]``: SITE is the folder of the package that was built
with SPHCLOTH_SANITIZE; the arguments are for pytest. A finding ends the process that it is found
in, which a test may take for the error it expects: what decides are the reports, which are kept
beside SITE.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

# Python and LAMMPS keep what they have until they end; a request for too much memory fails as it
# does without sanitizers
OPTIONS = {
    "ASAN_OPTIONS": "detect_leaks=0:handle_abort=1:allocator_may_return_null=1"
    ":max_allocation_size_mb=6144",
    "UBSAN_OPTIONS": "print_stacktrace=1",
}


def runtime() -> str:
    """Return the libraries that must be there before all others."""
    # exceptions of the C++ library are watched: it must be known when the sanitizer starts
    names = ("libasan.so", "libubsan.so", "libstdc++.so.6")
    ask = [["g++", f"-print-file-name={name}"] for name in names]
    return " ".join(subprocess.check_output(command, text=True).strip() for command in ask)


def main() -> int:
    """Run pytest; return its exit code, or 1 if there are reports."""
    site = Path(sys.argv[1]).resolve()
    reports = site.parent / "reports"
    reports.mkdir(exist_ok=True)
    for old in reports.iterdir():
        old.unlink()
    environment = {
        **os.environ,
        **{name: f"{words}:log_path={reports}/found" for name, words in OPTIONS.items()},
        "LD_PRELOAD": runtime(),
        "PYTHONPATH": str(site),
        "PYTHONMALLOC": "malloc",
    }
    # undefined behavior is reported there alone
    command = [sys.executable, "-m", "pytest", "-s", *sys.argv[2:]]
    done = subprocess.run(command, env=environment, stderr=subprocess.PIPE, text=True)
    code = done.returncode
    if "runtime error:" in done.stderr:
        (reports / "undefined").write_text(done.stderr)
    found = sorted(reports.iterdir())
    for report in found:
        print(f"{report}:\n{report.read_text(errors='replace')[:4000]}")
    print(f"{len(found)} reports of sanitizers")
    return code or bool(found)


if __name__ == "__main__":
    sys.exit(main())
