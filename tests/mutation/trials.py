"""Which tests have met which mutants, kept between runs."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .record import target_of


@dataclass
class Trials:
    """The tests that a mutant has passed, each with the digest of its file at that time."""

    passed: dict[int, dict[str, str]] = field(default_factory=dict)
    sound: set[str] = field(default_factory=set)  # pass without a mutant, also alone
    first: dict[str, list[str]] = field(default_factory=dict)  # by file, when it was recorded first
    digests: dict[str, str] = field(default_factory=dict)  # of today

    def note(self, number: int, tests: list[str]) -> None:
        """A mutant has passed these tests."""
        self.passed.setdefault(number, {}).update({name: self.digests[name] for name in tests})

    def passed_by(self, number: int) -> list[str]:
        """Return the tests that a mutant has passed as they are today."""
        passed = self.passed.get(number, {}).items()
        return [name for name, digest in passed if self.digests.get(name) == digest]

    def history(self, mutants: Iterable[dict]) -> tuple[Counter, Counter]:
        """Return how many tests of each file mutants have passed, and how many have caught one."""
        passed, caught = Counter(), Counter()
        for one in mutants:
            passed.update(map(target_of, self.passed.get(one["number"], {})))
            if one["caught"]:
                caught[target_of(one["caught"].split(": ")[0])] += 1
        return passed, caught

    def is_new(self, test: str) -> bool:
        """Return whether a test was not there when its file was recorded first."""
        return test not in self.first.get(target_of(test), [])

    def keep(self, path: Path, state: str) -> None:
        """Write what is known of a population."""
        what = {
            "state": state,
            "passed": self.passed,
            "sound": sorted(self.sound),
            "first": self.first,
        }
        path.write_text(json.dumps(what, indent=0))

    @classmethod
    def kept(cls, path: Path, state: str) -> Trials:
        """Read what is known of a population."""
        known = json.loads(path.read_text()) if path.is_file() else {}
        if known.get("state") != state:
            return cls()
        passed = {int(number): of for number, of in known["passed"].items()}
        return cls(passed, set(known["sound"]), known["first"])
