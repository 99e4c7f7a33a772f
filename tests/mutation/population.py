"""Which mutants are tried: drawn by a seed, from every file as many as its share of all places."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .schemata import with_mutants
from .sites import FAULT, Mutant, drawn, hole

FOLDERS = ("core", "stepping", "contact")
# what the sources had wrong once: tried with those drawn, and counted apart
FAULTS = Path(__file__).with_name("faults.toml")


@dataclass
class Population:
    """The mutants of a seed, by number, and those passed over since they do not compile."""

    sources: dict[str, bytes]
    seed: int
    count: int
    passed_over: set[tuple[str, int, int]] = field(default_factory=set)
    faults: list[dict] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Draw in each file all its places once."""
        self.orders = {file: drawn(file, text, self.seed) for file, text in self.sources.items()}
        self.shares = _shares({file: len(of) for file, of in self.orders.items()}, self.count)

    def mutants(self) -> list[Mutant]:
        """Return those chosen; the number of a mutant is its place here."""
        chosen = []
        for file, order in self.orders.items():
            right = [m for m in order if (file, m.start, m.end) not in self.passed_over]
            chosen += right[: self.shares[file]]
        return chosen + [put_back(self.sources[one["file"]], one) for one in self.faults]

    def written(self) -> dict[str, bytes]:
        """Return the files that have mutants, with all of them as choices."""
        by_file: dict[str, list[tuple[int, Mutant]]] = {}
        for number, mutant in enumerate(self.mutants()):
            by_file.setdefault(mutant.file, []).append((number, mutant))
        return {file: with_mutants(self.sources[file], of) for file, of in by_file.items()}

    def pass_over(self, errors: Iterable[tuple[str, int]]) -> bool:
        """Leave out what stands in these lines; return whether that is anything."""
        before = len(self.passed_over)
        for file, line in errors:
            for m in self.mutants():
                last = m.line + self.sources[m.file][m.start : m.end].count(b"\n")
                if m.file == file and m.line <= line <= last:
                    self.passed_over.add((file, m.start, m.end))
        return len(self.passed_over) > before

    def described(self) -> list[dict]:
        """Return the mutants as a reader sees them."""
        return [self._described(number, mutant) for number, mutant in enumerate(self.mutants())]

    def _described(self, number: int, mutant: Mutant) -> dict:
        text = self.sources[mutant.file]
        begin = text.rfind(b"\n", 0, mutant.start) + 1
        line = text[begin:].split(b"\n", 1)[0].decode()
        indent = len(line) - len(line.lstrip())
        return {
            "number": number,
            "file": mutant.file,
            "folder": mutant.folder,
            "line": mutant.line,
            "operator": mutant.operator,
            "code": line.strip(),
            "column": len(text[begin : mutant.start].decode()) - indent,
            "right": mutant.readable(mutant.right, text),
            "wrong": mutant.readable(mutant.wrong, text),
        }

    def state(self) -> str:
        """Return a digest of the sources and the draw."""
        digest = hashlib.sha256(f"{self.seed} {self.count} {self.faults}".encode())
        for file, text in sorted(self.sources.items()):
            digest.update(file.encode() + text)
        return digest.hexdigest()[:16]

    def save(self, path: Path) -> None:
        """Keep what was passed over, which takes builds to find."""
        what = {"state": self.state(), "passed_over": sorted(self.passed_over)}
        path.write_text(json.dumps(what, indent=1) + "\n")

    def load(self, path: Path) -> None:
        """Take what was passed over in an earlier run with the same sources."""
        if path.is_file() and (known := json.loads(path.read_text()))["state"] == self.state():
            self.passed_over = {tuple(one) for one in known["passed_over"]}


def faults() -> list[dict]:
    """Return the faults of the past: file, right and wrong expression, and what went wrong."""
    return tomllib.loads(FAULTS.read_text())["fault"]


def put_back(text: bytes, fault: dict) -> Mutant:
    """Return a fault as a mutant, in whose right expression others may lie."""
    right = fault["right"].encode()
    if text.count(right) != 1:
        raise ValueError(f"{fault['file']} has {text.count(right)} times: {fault['right']}")
    start = text.index(right)
    end, line = start + len(right), text.count(b"\n", 0, start) + 1
    return Mutant(fault["file"], start, end, line, FAULT, hole(start, end), fault["wrong"])


def sources(folder: Path) -> dict[str, bytes]:
    """Return the C++ of the folders in which mutants are drawn, by path from ``folder`` on."""
    paths = [path for name in FOLDERS for path in sorted((folder / name).rglob("*"))]
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in paths
        if path.suffix in (".h", ".cpp")
    }


def _shares(sizes: dict[str, int], count: int) -> dict[str, int]:
    """Divide a number in proportion to sizes, the remainder to the largest fractions."""
    total = sum(sizes.values())
    exact = {name: min(count, total) * size / total for name, size in sizes.items()}
    shares = {name: int(part) for name, part in exact.items()}
    rest = min(count, total) - sum(shares.values())
    for name in sorted(exact, key=lambda n: shares[n] - exact[n])[:rest]:
        shares[name] += 1
    return shares
