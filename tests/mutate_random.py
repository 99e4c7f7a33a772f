"""Mutants drawn at random from the numerics: how many of them the tests catch.

``python tests/mutate_random.py --folder build/mutants --json build/reliability/mutants.json`` draws
mutants by a seed, builds a copy of the sources that holds all of them, records which tests reach
which, and runs those that reach a mutant until one fails. Every step is kept: a run that is ended
goes on where it was, and a test that is new or changed is tried with all that are not caught.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from mutate import ROOT, SOURCE
from mutation.population import Population, sources
from mutation.trial import CORE, MutatedTree, Record
from rich.console import Console
from rich.table import Table

STYLES = "tests/styles"
# draws at random itself
NOT_REPEATED = {"tests/styles/test_fuzz.py"}
MORE = ("tests/test_examples.py",)
UNTRIED = {"caught": "", "tried": {}, "left": {}, "reached_by": 0, "seconds": 0.0}
UNTRIED |= {"survived": False}  # all tests that there were; if caught at all, by a new one
EQUIVALENT = ROOT / "tests/mutation/equivalent.toml"


@dataclass
class Run:
    """What is known of a population, in a folder and a file of results."""

    folder: Path
    results: Path
    population: Population
    tree: MutatedTree
    end: float
    digests: dict[str, str] = field(default_factory=dict)
    record: Record = field(default_factory=Record)
    sound: set[str] = field(default_factory=set)
    known: dict[int, dict] = field(default_factory=dict)

    def left(self) -> bool:
        """Return whether there is time for more."""
        return time.monotonic() < self.end

    def recorded(self, target: str) -> bool:
        """Run a file of tests without a mutant, unless that is known or there is no time for it."""
        path = self.folder / "record.json"
        known = json.loads(path.read_text()) if path.is_file() else {}
        digest = self._digest(target)
        if known.get(target, {}).get("digest") != digest:
            if not self.left():
                return False
            known[target] = {"digest": digest, "tests": self._recorded(target)}
            path.write_text(json.dumps(known))
        self.digests[target] = digest
        self.record.tests |= known[target]["tests"]
        return True

    def _recorded(self, target: str) -> dict[str, dict]:
        begin = time.monotonic()
        if target == CORE:
            tests = {case: self.tree.record_case(case) for case in self.tree.cases()}
        else:
            tests = self.tree.record_file_of(target)
        failed = [name for name, test in tests.items() if not test["passed"]]
        print(
            f"{target}: {len(tests)} tests, {time.monotonic() - begin:.0f} s,"
            f" without a mutant fail: {', '.join(failed) or 'none'}",
            flush=True,
        )
        return tests

    def _digest(self, target: str) -> str:
        digest = hashlib.sha256(f"{self.population.state()} {self.population.passed_over}".encode())
        folder, pattern = ("tests/core", "*.cpp") if target == CORE else (".", target)
        for path in sorted((ROOT / folder).glob(pattern)):
            digest.update(path.read_bytes())
        return digest.hexdigest()[:16]

    def try_all(self, target: str, numbers: list[int], patience: float) -> None:
        """Try the tests of a file with the mutants that are not caught yet."""
        for mutant in self.population.described():
            number, digest = mutant["number"], self.digests[target]
            one = self.known[number] = UNTRIED | self.known.get(number, {}) | mutant
            if number in numbers and not one["caught"] and one["tried"].get(target) != digest:
                if not self.left():
                    return
                self._try(one, target, patience)
                self.write()

    def _try(self, one: dict, target: str, patience: float) -> None:
        begin = time.monotonic()
        caught, left, reaching = self._caught(one["number"], target, patience)
        one["caught"] = caught
        one["tried"] = one["tried"] | {target: self.digests[target]}
        one["left"] = {k: n for k, n in one["left"].items() if k != target} | {target: left}
        one["reached_by"] += reaching
        one["seconds"] = round(one["seconds"] + time.monotonic() - begin, 1)
        if not caught and set(targets([])) <= set(one["tried"]):
            one["survived"] = True
        if reaching:
            place = f"{one['file']}:{one['line']}"
            print(f"{one['number']} {place}: {caught or f'not by {target}'}", flush=True)

    def _caught(self, number: int, target: str, patience: float) -> tuple[str, int, int]:
        """Return the test that fails, how many were left out as too slow, and how many reach it."""
        direct, shared = self.record.reaching(number, target)
        spent, tried = 0.0, 0
        for chunk, seconds in self.record.chunks(direct + shared):
            if spent > patience:
                return "", len(direct + shared) - tried, len(direct)
            spent, tried = spent + seconds, tried + len(chunk)
            if failed := self._failing(number, chunk, seconds):
                return failed, 0, len(direct)
        return "", 0, len(direct)

    def _failing(self, number: int, chunk: list[str], seconds: float) -> str:
        """A test that fails without the mutant, too, says nothing."""
        while chunk:
            failed = self.tree.failing(number, chunk, seconds)
            test = failed.split(": ")[0]
            if not failed or test in self.sound or test not in chunk:
                return failed
            if not self.tree.failing(None, [test], seconds):
                self.sound.add(test)
                return failed
            print(f"{test} fails alone without a mutant", flush=True)
            self.record.tests[test]["passed"] = False
            chunk = [name for name in chunk if name != test]
        return ""

    def load(self) -> None:
        """Take the results of an earlier run of the same mutants."""
        if self.results.is_file():
            before = json.loads(self.results.read_text())
            if before["state"] == self.population.state():
                self.known = {one["number"]: one for one in before["mutants"]}

    def write(self) -> None:
        """Keep the results, with what is known of equivalence today."""
        self.results.parent.mkdir(parents=True, exist_ok=True)
        reasons = equivalents()
        what = {
            "state": self.population.state(),
            "seed": self.population.seed,
            "count": self.population.count,
            "places": sum(map(len, self.population.orders.values())),
            "passed_over": len(self.population.passed_over),
            "mutants": [
                one | {"equivalent": reasons.get(key(one), "")}
                for _, one in sorted(self.known.items())
            ],
        }
        self.results.write_text(json.dumps(what, indent=1) + "\n")


def key(mutant: dict) -> tuple:
    """Return what identifies a mutant while lines move."""
    return tuple(mutant[name] for name in ("file", "code", "column", "right", "wrong"))


def equivalents() -> dict[tuple, str]:
    """Return why no behavior differs, of the mutants that have been argued about."""
    entries = tomllib.loads(EQUIVALENT.read_text())["mutant"]
    return {key(entry): entry["reason"] for entry in entries}


def built(folder: Path, population: Population) -> MutatedTree:
    """Build all mutants; those that do not compile are replaced with others of the same file."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "passed_over.json"
    population.load(kept)
    while True:
        tree = MutatedTree(folder, population.written())
        tree.configure()
        errors = tree.errors()
        if not errors:
            return tree
        if not population.pass_over(errors):
            sys.exit(f"does not compile where no mutant is: {errors[:5]}")
        print(f"passed over: {len(population.passed_over)} that do not compile", flush=True)
        population.save(kept)


def targets(words: list[str]) -> list[str]:
    """Return the files of tests: those given, or all of core, styles and examples."""
    if words:
        return words
    styles = sorted(str(one.relative_to(ROOT)) for one in (ROOT / STYLES).glob("test_*.py"))
    return [CORE, *(one for one in styles if one not in NOT_REPEATED), *MORE]


def told(known: dict[int, dict]) -> Table:
    """Return the table of what no test catches."""
    table = Table("number", "place", "right", "wrong", "tests that reach it", "left out")
    for number, one in sorted(known.items()):
        if not one["caught"]:
            place = f"{one['file']}:{one['line']}"
            counts = (str(one["reached_by"]), str(sum(one["left"].values())))
            table.add_row(str(number), place, one["right"], one["wrong"], *counts)
    return table


def parsed() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser()
    parser.add_argument("numbers", nargs="*", type=int, help="mutants; all without")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200, help="mutants to draw")
    parser.add_argument("--folder", type=Path, required=True, help="copy, build and record")
    parser.add_argument("--json", type=Path, required=True, help="results")
    parser.add_argument("--tests", nargs="*", default=[], help="files of tests; 'core' is C++")
    parser.add_argument("--minutes", type=float, default=1e9, help="then stop, to go on later")
    parser.add_argument("--patience", type=float, default=300.0, help="s of tests per mutant")
    return parser.parse_args()


def main() -> int:
    """Return 0 if all has been run, whatever was found."""
    given = parsed()
    end = time.monotonic() + 60 * given.minutes
    population = Population(sources(ROOT / SOURCE), given.seed, given.count)
    tree = built(given.folder.absolute(), population)
    run = Run(given.folder.absolute(), given.json, population, tree, end)
    run.load()
    numbers = given.numbers or list(range(given.count))
    for target in targets(given.tests):
        if not run.recorded(target):
            break
        run.try_all(target, numbers, given.patience)
    run.write()
    Console().print(told(run.known))
    caught = sum(bool(one["caught"]) for one in run.known.values())
    print(f"{caught} of {len(run.known)} mutants caught")
    if not run.left():
        print("there is more to run: the same command goes on")
    return 0 if run.left() else 1


if __name__ == "__main__":
    sys.exit(main())
