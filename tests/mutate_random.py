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
from mutation.population import Population, faults, sources
from mutation.record import CORE, Record, target_of
from mutation.sites import FAULT
from mutation.trial import MutatedTree
from mutation.trials import Trials
from rich.console import Console
from rich.table import Table

STYLES = "tests/styles"
# draws at random itself
NOT_REPEATED = {"tests/styles/test_fuzz.py"}
# s of recorded time that tests may take with one mutant, before the next mutant has its turn
BUDGETS = (10.0, 40.0)
UNTRIED = {"caught": "", "new": False, "judged": False, "reached_by": 0, "tried": 0, "left": 0}
EQUIVALENT = ROOT / "tests/mutation/equivalent.toml"


@dataclass
class Run:
    """What is known of a population, in a folder and a file of results."""

    folder: Path
    results: Path
    population: Population
    tree: MutatedTree
    end: float
    patience: float
    record: Record = field(default_factory=Record)
    trials: Trials = field(default_factory=Trials)
    known: dict[int, dict] = field(default_factory=dict)

    def left(self) -> float:
        """Return for how many seconds more tests may be started."""
        return self.end - time.monotonic()

    def recorded(self, target: str) -> bool:
        """Run a file of tests without a mutant, as far as that is not known and there is time."""
        path = self.folder / "records" / f"{target.replace('/', '.')}.json"
        digest = self._digest(target)
        known = json.loads(path.read_text()) if path.is_file() else {}
        if known.get("digest") != digest:
            known = {"digest": digest, "complete": False, "tests": {}}
        if not known["complete"]:
            if self.left() < 0:
                return False
            known |= self._recorded(target, known["tests"])
            path.parent.mkdir(exist_ok=True)
            path.write_text(json.dumps(known))
        self.record.tests |= known["tests"]
        self.trials.digests |= {name: digest for name in known["tests"]}
        if known["complete"] and target not in self.trials.first:
            self.trials.first[target] = sorted(known["tests"])
            self._keep()
        return known["complete"]

    def _recorded(self, target: str, known: dict[str, dict]) -> dict:
        begin = time.monotonic()
        if target == CORE:
            tests = {case: self.tree.record_case(case) for case in self.tree.cases()}
            found = {"complete": True, "tests": tests}
        else:
            found = self.tree.record_file_of(target, known, self.left())
        failed = [name for name, test in found["tests"].items() if not test["passed"]]
        print(
            f"{target}: {len(found['tests'])} tests, {time.monotonic() - begin:.0f} s,"
            f" without a mutant fail: {', '.join(failed) or 'none'}",
            flush=True,
        )
        return found

    def _digest(self, target: str) -> str:
        digest = hashlib.sha256(f"{self.population.state()} {self.population.passed_over}".encode())
        folder, pattern = ("tests/core", "*.cpp") if target == CORE else (".", target)
        for path in sorted((self.tree.sources / folder).glob(pattern)):
            digest.update(path.read_bytes())
        return digest.hexdigest()[:16]

    def forget_gone(self) -> None:
        """A test that is not there any more catches nothing."""
        for one in self.known.values():
            test = one["caught"].split(": ")[0]
            if "/" in test and test not in self.record.tests:
                one["caught"] = ""
                self._describe(one)

    def try_all(self, numbers: list[int]) -> bool:
        """Try the mutants in rounds of more and more time; return whether that came to an end.

        Those argued to be equivalent take part in the first round, which puts the argument to the
        test.
        """
        reasons = equivalents()
        argued = [number for number in numbers if key(self.known[number]) in reasons]
        others = [number for number in numbers if number not in argued]
        for budget in (*(one for one in BUDGETS if one < self.patience), self.patience):
            for number in [*others, *argued] if budget == BUDGETS[0] else others:
                if self.left() < 0:
                    return False
                self._try(number, budget)
        return True

    def _try(self, number: int, budget: float) -> None:
        """Run tests until one fails, all that reach the mutant have passed or the time is spent."""
        one = self.known[number]
        before = one["judged"]
        while not one["caught"]:
            spent = self.record.seconds(self.trials.passed_by(number))
            chunk = self._next(number, budget - spent) if spent < budget else []
            if not chunk:
                break
            one["caught"] = self._failing(number, chunk)
            self._describe(one)
            self._keep()
        self._describe(one)
        if one["judged"] and not before:
            place = f"{one['file']}:{one['line']}"
            print(f"{number} {place}: {one['caught'] or 'not caught'}", flush=True)

    def _next(self, number: int, seconds: float) -> list[str]:
        """Return tests of one call: first the cases of core/, then by what a catch costs."""
        folder = self.known[number]["folder"]
        passed, caught = self.trials.history(
            one for n, one in self.known.items() if one["folder"] == folder
        )
        done = set(self.trials.passed_by(number))
        direct = self.record.reaching(number)
        for names in (
            [name for name in direct if target_of(name) == CORE],
            direct,
            self.record.beside(direct),
        ):
            if left := [name for name in names if name not in done]:
                order = self.record.ordered(left, passed, caught)
                return order if target_of(order[0]) == CORE else self.record.first(order, seconds)
        return []

    def _failing(self, number: int, chunk: list[str]) -> str:
        """A test that fails without the mutant, too, says nothing."""
        while chunk:
            seconds = self.record.seconds(chunk)
            failed = self.tree.failing(number, chunk, seconds)
            test = failed.split(": ")[0]
            if not failed:
                self.trials.note(number, chunk)
                return ""
            if test in self.trials.sound or test not in chunk:
                return failed
            if not self.tree.failing(None, [test], seconds):
                self.trials.sound.add(test)
                return failed
            print(f"{test} fails alone without a mutant", flush=True)
            self.record.tests[test]["passed"] = False
            chunk = [name for name in chunk if name != test]
        return ""

    def _describe(self, one: dict) -> None:
        """Count the tests, and say whether all that may be run have been."""
        number = one["number"]
        reaching = self.record.reaching(number)
        passed = self.trials.passed_by(number)
        one["reached_by"] = len(reaching)
        one["left"] = len(set(reaching) - set(passed))
        one["tried"] = len(passed)
        one["judged"] = bool(
            one["caught"] or not one["left"] or self.record.seconds(passed) >= self.patience
        )
        one["new"] = bool(one["caught"]) and self.trials.is_new(one["caught"].split(": ")[0])

    def load(self) -> None:
        """Take what is known of the same mutants."""
        before = {}
        if self.results.is_file():
            kept = json.loads(self.results.read_text())
            if kept["state"] == self.population.state():
                before = {one["number"]: one for one in kept["mutants"] + kept["faults"]}
        for mutant in self.population.described():
            self.known[mutant["number"]] = UNTRIED | before.get(mutant["number"], {}) | mutant
        self.trials = Trials.kept(self.folder / "trials.json", self.population.state())

    def _keep(self) -> None:
        self.trials.keep(self.folder / "trials.json", self.population.state())
        self.write()

    def write(self) -> None:
        """Keep the results, with what is known of equivalence today."""
        self.results.parent.mkdir(parents=True, exist_ok=True)
        reasons = equivalents()
        all_ = [
            one | {"equivalent": reasons.get(key(one), "")} for _, one in sorted(self.known.items())
        ]
        what = {
            "state": self.population.state(),
            "seed": self.population.seed,
            "count": self.population.count,
            "patience": self.patience,
            "places": sum(map(len, self.population.orders.values())),
            "passed_over": len(self.population.passed_over),
            "mutants": [one for one in all_ if one["operator"] != FAULT],
            "faults": [
                one | {"what": fault["what"]}
                for one, fault in zip(all_[self.population.count :], faults(), strict=True)
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
    """Return the files of tests: those given, or all of core and styles."""
    if words:
        return words
    styles = sorted(str(one.relative_to(ROOT)) for one in (ROOT / STYLES).glob("test_*.py"))
    return [CORE, *(one for one in styles if one not in NOT_REPEATED)]


def told(known: dict[int, dict]) -> Table:
    """Return the table of what no test catches."""
    table = Table("number", "place", "right", "wrong", "tests that reach it", "left out")
    for number, one in sorted(known.items()):
        if not one["caught"]:
            place = f"{one['file']}:{one['line']}"
            counts = (str(one["reached_by"]), str(one["left"]))
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
    parser.add_argument("--patience", type=float, default=120.0, help="s of tests per mutant")
    return parser.parse_args()


def main() -> int:
    """Return 0 if all has been run, whatever was found."""
    given = parsed()
    end = time.monotonic() + 60 * given.minutes
    population = Population(sources(ROOT / SOURCE), given.seed, given.count, faults=faults())
    folder = given.folder.absolute()
    tree = built(folder, population)
    run = Run(folder, given.json, population, tree, end, given.patience)
    run.load()
    numbers = given.numbers or list(run.known)
    complete = all(run.recorded(target) for target in targets(given.tests))
    if complete:
        run.forget_gone()
        complete = run.try_all(numbers)
    run.write()
    Console().print(told(run.known))
    caught = sum(bool(one["caught"]) for one in run.known.values())
    print(f"{caught} of {len(run.known)} mutants caught")
    if not complete:
        print("there is more to run: the same command goes on")
    return 0 if complete else 1


if __name__ == "__main__":
    sys.exit(main())
