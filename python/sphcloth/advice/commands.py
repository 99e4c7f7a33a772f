"""The commands of a run as LAMMPS has echoed them into the log, variables filled in."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sphcloth.errors import UserError
from sphcloth.fix_values import column
from sphcloth.mesh import ClothMesh

# what fix sph/integrate prints at the end of a run
STEPS_BY_LIMIT = "sph/integrate: steps by limit:"

# styles whose keywords need a word before them, and what stands for it if nothing follows
LEADING = {"sph/integrate": ("global",)}
# keywords of a fluid, each with one value
VISCOSITY = ("alpha", "nu", "switch")


@dataclass(frozen=True)
class Fluid:
    """One type of water.

    Attributes:
        kind: atom type, or the range, as in the script.
        words: all arguments of ``pair_coeff``.
        sound: speed of sound at rest, the fastest if it follows the flow.
        follows: does it?
        speed: reference speed of ``fluctuation``; None if the script gives the speed of sound.
        alpha, nu: artificial and kinematic viscosity.
        support: radius of the kernel.
    """

    kind: str
    words: tuple[str, ...]
    sound: float
    follows: bool
    speed: float | None
    alpha: float
    nu: float
    support: float

    @property
    def inviscid(self) -> str:
        """The command without viscosity, which a fluid has only where it is given."""
        kept, words = [], iter(self.words)
        for word in words:
            if word in VISCOSITY:
                next(words)
            else:
                kept.append(word)
        return f"pair_coeff {' '.join(kept)}"

    @classmethod
    def of(cls, words: Sequence[str], support: float) -> Fluid:
        """Read the arguments of ``pair_coeff I I fluid rho0 ...``."""
        given = {word: words[n + 1 : n + 3] for n, word in enumerate(words) if n > 3}
        follows = "follow" in given
        number = {word: float(rest[0]) for word, rest in given.items() if _is_number(rest[:1])}
        speed = None
        if follows:
            sound = float(given["follow"][1])
        elif "fluctuation" in given:
            share, speed = map(float, given["fluctuation"])
            sound = speed / math.sqrt(share)
        else:
            sound = number["c0"] if "c0" in number else math.sqrt(number["k"])
        viscosity = number.get("alpha", 0.0), number.get("nu", 0.0)
        own = number.get("support", support)
        return cls(words[0], tuple(words), sound, follows, speed, *viscosity, own)


@dataclass(frozen=True)
class Fix:
    """One fix: its ID, group, style and what follows."""

    id: str
    group: str
    style: str
    arguments: tuple[str, ...]

    def value(self, keyword: str, default: str) -> str:
        """Return the word behind a keyword, the last one if it is there twice."""
        found = [n for n, word in enumerate(self.arguments[:-1]) if word == keyword]
        return self.arguments[found[-1] + 1] if found else default

    def output(self, keyword: str) -> str:
        """Return the column of the value that the fix's compute has for a keyword."""
        return column(self.id, self.style, keyword)

    @property
    def line(self) -> str:
        """The command without its keywords."""
        return f"fix {self.id} {self.group} {self.style}"

    def extended(self, keywords: str) -> str:
        """Return the command with keywords behind its own, for which dots stand."""
        if not self.arguments:
            return f"{self.line} {appended(self.style, self.arguments, keywords)}"
        return f"{self.line} ... {keywords}"


@dataclass(frozen=True)
class Commands:
    """What a script has told LAMMPS, later commands in the place of earlier ones.

    Attributes:
        fixes: by ID, those deleted by ``unfix`` as well: they were there for a while.
        fluids: by type.
        pair_style, neighbor, dihedral_style, run_style: arguments; empty without the command.
        bonds, hinges: by type, the arguments behind it.
        variables: equal-style variables, name -> formula.
        computes: ID -> style and arguments.
        steps_by_limit: name of a limit -> steps that it set, over all runs of one fix.
    """

    fixes: dict[str, Fix] = field(default_factory=dict)
    fluids: dict[str, Fluid] = field(default_factory=dict)
    pair_style: tuple[str, ...] = ()
    neighbor: tuple[str, ...] = ()
    dihedral_style: tuple[str, ...] = ()
    run_style: tuple[str, ...] = ()
    bonds: dict[str, tuple[str, ...]] = field(default_factory=dict)
    hinges: dict[str, tuple[str, ...]] = field(default_factory=dict)
    variables: dict[str, str] = field(default_factory=dict)
    computes: dict[str, tuple[str, ...]] = field(default_factory=dict)
    steps_by_limit: dict[str, int] = field(default_factory=dict)

    @classmethod
    def read(cls, log: Path) -> Commands:
        """Read the commands from a log; UserError if there is none."""
        if not log.is_file():
            raise UserError(f"no log file {log}")
        text = log.read_text(encoding="utf-8", errors="replace")
        given: dict[str, list[list[str]]] = {}
        limits: dict[str, int] = {}
        for line in text.splitlines():
            if STEPS_BY_LIMIT in line:
                # the fix goes on counting in the next run
                counts = line.partition(STEPS_BY_LIMIT)[2].split()
                limits = dict(zip(counts[::2], map(int, counts[1::2]), strict=True))
                continue
            # what still has a $ is echoed again with its value
            words = [] if "$" in line else line.partition("#")[0].split()
            if words:
                given.setdefault(words[0], []).append(words[1:])
        return cls._of(given, limits)

    @classmethod
    def _of(cls, given: dict[str, list[list[str]]], limits: dict[str, int]) -> Commands:
        def last(command: str) -> tuple[str, ...]:
            return tuple(given.get(command, [[]])[-1])

        def by_type(command: str) -> dict[str, tuple[str, ...]]:
            return {words[0]: tuple(words[1:]) for words in given.get(command, []) if words}

        # a fix begins what it says with "fix ID style:"
        fixes = [w for w in given.get("fix", []) if len(w) > 2 and not w[1].endswith(":")]
        style = last("pair_style")
        support = float(style[1]) if style[:1] == ("sph/tait",) else math.nan
        coefficients = [words for words in given.get("pair_coeff", []) if words[2:3] == ["fluid"]]
        formulas = [w for w in given.get("variable", []) if len(w) > 2 and w[1] == "equal"]
        return cls(
            {words[0]: Fix(*words[:3], tuple(words[3:])) for words in fixes},
            {words[0]: Fluid.of(words, support) for words in coefficients},
            style,
            last("neighbor"),
            last("dihedral_style"),
            last("run_style"),
            by_type("bond_coeff"),
            by_type("dihedral_coeff"),
            {words[0]: "".join(words[2:]) for words in formulas},
            {words[0]: tuple(words[2:]) for words in given.get("compute", []) if len(words) > 2},
            limits,
        )

    def styled(self, style: str) -> list[Fix]:
        """Return all fixes of a style, in order."""
        return [fix for fix in self.fixes.values() if fix.style == style]

    def porous(self, mesh: ClothMesh | None) -> frozenset[int]:
        """Return the angle types of a mesh that have pores, by fix cloth/pores."""
        ranges = [fix.arguments[0] for fix in self.styled("cloth/pores")]
        if mesh is None or mesh.kinds is None or not ranges:
            return frozenset()
        kinds = set(mesh.kinds.tolist())
        return frozenset(kind for kind in kinds for words in ranges if _is_in(kind, words))

    @property
    def stepper(self) -> Fix | None:
        """The fix sph/integrate."""
        return next(iter(self.styled("sph/integrate")), None)


def appended(style: str, arguments: Sequence[str], keywords: str) -> str:
    """Return the arguments of a fix with keywords behind them."""
    return " ".join([*(arguments or LEADING.get(style, ())), keywords])


def _is_number(words: Sequence[str]) -> bool:
    return bool(words) and re.fullmatch(r"[-+]?[\d.]+(e[-+]?\d+)?", words[0], re.I) is not None


def _is_in(kind: int, words: str) -> bool:
    """Tell whether a type is in a range of LAMMPS: 2, 1*3, 2*, *3 or *."""
    low, star, high = words.partition("*")
    if not star:
        return kind == int(low)
    return int(low or 1) <= kind <= int(high or kind)
