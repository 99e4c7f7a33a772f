"""The sources with all mutants in them, built; tests that are recorded, and run with a mutant."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mutate import CORES, QUICK, ROOT, SOURCE, TEST_FAILURE, Tree

from .record import CORE, target_of

BYTES = 4096  # MOST in mutant.h
# a test with a mutant may be slower: it does not end if it takes more than so many s and so many
# times what was recorded
GRACE, FACTOR = 30.0, 5.0
CASE = re.compile(r"error: in \"(\S+?)\"")


class MutatedTree(Tree):
    """A copy of the sources in which every mutant is a choice."""

    def __init__(self, folder: Path, written: dict[str, bytes]) -> None:
        """Copy the sources, with the mutants in the place of what they change."""
        self.written = written
        super().__init__(folder)
        self.reached = (folder / "reached").absolute()
        self.record_file = (folder / "recorded.json").absolute()
        self.environment["PYTHONPATH"] += f":{self.sources / 'tests'}"

    def text_of(self, source: Path) -> bytes:
        """Return a file as it is in the copy."""
        place = ROOT / SOURCE
        file = str(source.relative_to(place)) if source.is_relative_to(place) else ""
        return self.written.get(file) or source.read_bytes()

    def configure(self) -> None:
        """Configure both builds."""
        header = self.sources / "tests/mutation/mutant.h"
        flags = f"-DCMAKE_CXX_FLAGS=-include {header} -Wno-narrowing -w"
        options = (*QUICK, f"-DPython_EXECUTABLE={sys.executable}", flags)
        self._must("cmake", "-S", self.sources / "tests/core", "-B", self.core, *options)
        self._must("cmake", "-S", self.sources, "-B", self.build, *options)

    def errors(self) -> list[tuple[str, int]]:
        """Build; return file and line of what does not compile."""
        found = []
        targets = ((self.build, "sphclothplugin"), (self.core, "test_core"))
        for folder, target in targets:
            code, out = self._run("cmake", "--build", folder, CORES, "--target", target, "--", "-k")
            wrong = re.findall(r"(?:USER-SPHCLOTH/)([\w/]+\.(?:h|cpp)):(\d+):\d+: error", out)
            found += [(file, int(line)) for file, line in wrong]
            if code and not wrong:
                sys.exit(f"the build fails without a mutant:\n{out[-4000:]}")
        if not found:
            self._install(self.build / "sphclothplugin.so")
        return found

    def cases(self) -> list[str]:
        """Return the cases of the tests of core/, as ``core/suite/case``."""
        _, out = self._run(self.core / "test_core", "--list_content=HRF")
        names, suite = [], ""
        for line in out.splitlines():
            word = line.strip().rstrip("*")
            if line.startswith("    "):
                names.append(f"core/{suite}/{word}")
            else:
                suite = word
        return names

    def record_case(self, case: str) -> dict:
        """Run a case without a mutant."""
        self.reached.write_bytes(bytes(BYTES))
        begin = time.monotonic()
        code, _ = self._with(None, *self._boost([case]))
        reached = [k for k, byte in enumerate(self.reached.read_bytes()) if byte]
        seconds = round(time.monotonic() - begin, 2)
        return {"passed": code == 0, "seconds": seconds, "shared": [], "reached": reached}

    def record_file_of(self, target: str, known: dict[str, dict], seconds: float) -> dict:
        """Run a file's tests without a mutant, less those known; start none after so long."""
        self.reached.write_bytes(bytes(BYTES))
        self.record_file.write_text(json.dumps({"complete": False, "tests": known}))
        self.environment["SPHCLOTH_RECORD_SECONDS"] = str(seconds)
        code, out = self._with(None, *self._pytest_words("-p", "mutation.recorder", target))
        found = json.loads(self.record_file.read_text())
        if not found["complete"] and len(found["tests"]) == len(known):
            sys.exit(f"{target} could not be run ({code}):\n{out[-4000:]}")
        return found

    def failing(self, number: int | None, tests: list[str], seconds: float) -> str:
        """Run tests with a mutant; return the one that fails, and how if it does not just fail."""
        patience = GRACE + FACTOR * seconds
        core = target_of(tests[0]) == CORE
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as names:
            names.write("\n".join(tests))
            names.flush()
            words = self._boost(tests) if core else self._pytest_words("-x", f"@{names.name}")
            try:
                code, out = self._with(number, *words, patience=patience)
            except subprocess.TimeoutExpired:
                return f"{tests[0]}: no end within {patience:.0f} s, {seconds:.0f} s without"
        if code == 0:
            return ""
        return self._failed_case(tests, code, out) if core else _failed_test(code, out)

    def _failed_case(self, tests: list[str], code: int, out: str) -> str:
        failed = CASE.search(out)
        if failed:
            return f"core/{failed[1]}"
        if code in (TEST_FAILURE, 200) or code < 0:
            return f"{tests[0]}: ended with {code}"
        sys.exit(f"cases could not be run ({code}):\n{out[-3000:]}")

    def _boost(self, tests: list[str]) -> list[object]:
        chosen = [f"--run_test={name.removeprefix('core/')}" for name in tests]
        return [self.core / "test_core", "--color_output=no", *chosen]

    def _pytest_words(self, *words: str) -> list[object]:
        return [sys.executable, "-m", "pytest", "-vv", "-p", "no:cacheprovider", *words]

    def _with(self, number: int | None, *command: object, patience: float | None = None):
        """Run with a mutant."""
        kept = self.environment
        self.environment = kept | {
            "SPHCLOTH_MUTANT": str(-1 if number is None else number),
            "SPHCLOTH_RECORD": str(self.record_file),
            **({"SPHCLOTH_MUTANTS_REACHED": str(self.reached)} if number is None else {}),
        }
        try:
            return self._run(*command, patience=patience)
        finally:
            self.environment = kept


def _failed_test(code: int, out: str) -> str:
    """Return the test that failed, or during which the process ended."""
    failed = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", out, re.MULTILINE)
    if failed and code == 1:
        return failed[1]
    if code in (2, 3, 4, 5) and "::" not in out:
        sys.exit(f"tests could not be run ({code}):\n{out[-3000:]}")
    end = r"(?: PASSED.*| FAILED.*| Fatal Python.*)?$"
    started = re.findall(rf"^(\S+\.py::.*?){end}", out, re.MULTILINE)
    return f"{started[-1] if started else 'pytest'}: ended with {code}"
