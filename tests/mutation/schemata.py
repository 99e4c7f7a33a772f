"""Sources that hold all mutants at once, of which an environment variable makes one active.

After Untch, Offutt and Harrold, "Mutation analysis using mutant schemata" (ISSTA 1993).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from .sites import FAULT, HOLE, Mutant

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def with_mutants(text: bytes, numbered: Sequence[tuple[int, Mutant]]) -> bytes:
    """Return a file in which each mutant is a choice by its number; lines keep their numbers."""
    # of two at one place the outer first
    order = sorted(numbered, key=lambda one: (one[1].start, -one[1].end, -_rank(one[1])))
    return _written(text, 0, len(text), order).encode()


def _written(text: bytes, start: int, end: int, inside: list[tuple[int, Mutant]]) -> str:
    """Write a range of bytes, with the mutants that lie in it."""
    out, at, rest = [], start, list(inside)
    while rest:
        (number, mutant), *rest = rest
        lower = [one for one in rest if one[1].end <= mutant.end]
        rest = [one for one in rest if one[1].end > mutant.end]
        out += [text[at : mutant.start].decode(), _choice(text, number, mutant, lower)]
        at = mutant.end
    return "".join(out) + text[at:end].decode()


def _choice(text: bytes, number: int, mutant: Mutant, lower: list[tuple[int, Mutant]]) -> str:
    def filled(template: str) -> str:
        def operand(hole: re.Match) -> str:
            start, end = int(hole[1]), int(hole[2])
            return _written(text, start, end, _between(lower, start, end))

        return _in_one_line(HOLE.sub(operand, template))

    lines = text[mutant.start : mutant.end].count(b"\n")
    right, wrong = filled(mutant.right), filled(mutant.wrong)
    if mutant.statement:
        code = f"{{ if (sphcloth_mutant::at({number})) {{ {wrong} }} else {{ {right} }} }}"
    elif mutant.operator == "assignment":
        code = f"(sphcloth_mutant::at({number}) ? ({wrong}) : ({right}))"
    else:
        code = f"SPHCLOTH_CHOICE({number}, ({right}), ({wrong}))"
    return code + "\n" * lines


def _rank(mutant: Mutant) -> int:
    """A fault is a choice between whole expressions, with mutants in the right one."""
    return 2 if mutant.operator == FAULT else int(mutant.statement)


def _between(mutants: list[tuple[int, Mutant]], start: int, end: int) -> list[tuple[int, Mutant]]:
    return [one for one in mutants if start <= one[1].start and one[1].end <= end]


def _in_one_line(code: str) -> str:
    return COMMENT.sub(" ", code).replace("\n", " ")
