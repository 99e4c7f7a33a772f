"""What the tests reach without a mutant, and in which order they are tried with one."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

CORE = "core"  # in the place of a file: the cases of Boost.Test
SHORTEST = 0.1  # s, for what a test takes beside its own time
# of a file whose tests have not been tried with mutants of a folder, so many have let one pass
PRIOR = 10


@dataclass
class Record:
    """What is known of the tests by name: seconds, mutants reached, fixtures, whether they pass."""

    tests: dict[str, dict] = field(default_factory=dict)

    def reaching(self, number: int) -> list[str]:
        """Return the tests that reach a mutant."""
        return [
            name
            for name, test in self.tests.items()
            if test["passed"] and number in test["reached"]
        ]

    def beside(self, direct: list[str]) -> list[str]:
        """Return those that share fixtures with tests that reach a mutant, and do not reach it.

        A fixture may keep runs of LAMMPS for all tests of a file; the first one makes them.
        """
        known = set(direct)
        shared = {(target_of(name), one) for name in direct for one in self.tests[name]["shared"]}
        return [
            name
            for name, test in self.tests.items()
            if test["passed"]
            and name not in known
            and shared & {(target_of(name), one) for one in test["shared"]}
        ]

    def seconds(self, names: list[str]) -> float:
        """Return what tests take."""
        return sum(max(self.tests[name]["seconds"], SHORTEST) for name in names)

    def ordered(self, names: list[str], passed: Counter, caught: Counter) -> list[str]:
        """Return tests by seconds for a catch, as files of tests have caught mutants so far."""

        def price(name: str) -> float:
            file = target_of(name)
            return self.seconds([name]) * (passed[file] + PRIOR) / (caught[file] + 1)

        return sorted(names, key=price)

    def first(self, names: list[str], budget: float) -> list[str]:
        """Return the first tests, as many as a time allows or one, those of a file together."""
        chosen, spent = [], 0.0
        for name in names:
            spent += self.seconds([name])
            if chosen and spent > budget:
                break
            chosen.append(name)
        files = list(dict.fromkeys(map(target_of, chosen)))
        return sorted(chosen, key=lambda name: files.index(target_of(name)))


def target_of(name: str) -> str:
    """Return the file of a test, or that it is a case of C++."""
    return CORE if name.startswith(CORE + "/") else name.split("::")[0]
