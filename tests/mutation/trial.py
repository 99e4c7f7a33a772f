"""Tests against a mutant: those that reach it, cheapest first, until one fails."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mutate import CORES, QUICK, ROOT, SOURCE, TEST_FAILURE, Tree

CORE = "core"  # in the place of a file: the cases of Boost.Test
BYTES = 4096  # MOST in mutant.h
# s of recorded time of the tests of one call of pytest: early ones are short, so that the first
# failure is near
CHUNKS = (4.0, 12.0, 40.0)
# a test with a mutant may be slower: it does not end if it takes more than so many s and so many
# times what was recorded
GRACE, FACTOR = 30.0, 5.0
CASE = re.compile(r"error: in \"(\S+?)\"")


@dataclass
class Record:
    """What the tests reach: their names by file, of Boost cases by suite."""

    tests: dict[str, dict] = field(default_factory=dict)

    def reaching(self, number: int, target: str) -> tuple[list[str], list[str]]:
        """Return a file's tests that reach a mutant, and those that share fixtures with one.

        A fixture may keep runs of LAMMPS for all tests of a file; the first one makes them.
        """
        here = {name: test for name, test in self.tests.items() if target_of(name) == target}
        direct = [
            name for name, test in here.items() if test["passed"] and number in test["reached"]
        ]
        shared = {one for name in direct for one in self.tests[name]["shared"]}
        others = [
            name
            for name, test in here.items()
            if test["passed"] and shared & set(test["shared"]) and name not in direct
        ]
        return self._cheapest(direct), self._cheapest(others)

    def _cheapest(self, names: list[str]) -> list[str]:
        return sorted(names, key=lambda name: self.tests[name]["seconds"])

    def chunks(self, names: list[str]) -> Iterator[tuple[list[str], float]]:
        """Yield tests for one call, with their seconds."""
        limits, chunk, seconds = iter(CHUNKS), [], 0.0
        limit = next(limits)
        for name in names:
            chunk.append(name)
            seconds += self.tests[name]["seconds"]
            if seconds >= limit:
                yield chunk, seconds
                chunk, seconds, limit = [], 0.0, next(limits, CHUNKS[-1])
        if chunk:
            yield chunk, seconds


def target_of(name: str) -> str:
    """Return the file of a test, or that it is a case of C++."""
    return CORE if name.startswith(CORE + "/") else name.split("::")[0]


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

    def record_file_of(self, target: str) -> dict[str, dict]:
        """Run a file of tests without a mutant."""
        self.reached.write_bytes(bytes(BYTES))
        self.record_file.unlink(missing_ok=True)
        code, out = self._with(None, *self._pytest_words("-p", "mutation.recorder", target))
        if not self.record_file.is_file():
            sys.exit(f"{target} could not be run ({code}):\n{out[-4000:]}")
        return json.loads(self.record_file.read_text())

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
