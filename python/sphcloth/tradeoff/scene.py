"""What a scene is: a script, what is of interest in it, and what to vary for each scheme."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable

# schemes of run_style sph/adaptive, in the order of tables and colors
SCHEMES = ("constant", "global", "individual", "block")
# the scheme of a script that has no variable of that name
AS_WRITTEN = "as written"
# keywords of fix sph/integrate: what a scheme that chooses its steps may be given
LIMITS = (
    "accuracy",
    "velocity",
    "force",
    "stability",
    "acoustic",
    "wetted",
    "viscous",
    "density",
    "relative",
    "cloth",
    "fluctuation",
    "min",
    "max",
    "growth",
    "below",
    "ratio",
    "gain",
    "sleep",
    "overdue",
)
# those of one scheme alone
ONE_SCHEME = {"overdue": "individual", "ratio": "block", "gain": "block", "sleep": "block"}
# ceiling of chosen steps over h_s / c_0, in packaged scenes: --vary ceiling=2,8
CEILING = "4"
# variables of a packaged scene's script that follow from the scheme and its settings
DERIVED = ("limits", "every", "steps")
# share of the interval by which a whole number of constant steps may miss it
SLACK = 1e-9

Values = Mapping[str, str]


def _rms(difference: NDArray) -> float:
    return float(np.sqrt(np.mean(np.square(difference))))


NORMS: Mapping[str, Callable[[NDArray], float]] = {
    "rms": _rms,
    "max": lambda difference: float(np.max(np.abs(difference))),
    "end": lambda difference: float(abs(difference[-1])),
}


@dataclass(frozen=True)
class History:
    """A quantity over physical time.

    Attributes:
        times: in the units of the script, increasing, shape (rows,).
        values: shape (rows,).
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]


def column(name: str) -> Callable[[ThermoTable], NDArray[np.float64]]:
    """Return the function that takes one column out of the thermo output."""
    return lambda table: table[name]


@dataclass(frozen=True)
class Quantity:
    """Something that the user wants to know, as a function of time.

    Attributes:
        name: as in ``--quantity`` and in the results.
        description: what it is, in a few words.
        of: takes it out of the thermo output of a run, shape (rows,).
        norm: how a difference over time becomes one number, one of ``NORMS``.
        by_range: errors are relative to the range of the reference, for what has no natural
            zero, such as a height; otherwise to its largest absolute value.
    """

    name: str
    description: str
    of: Callable[[ThermoTable], NDArray[np.float64]]
    norm: str = "rms"
    by_range: bool = False

    def history(self, table: ThermoTable) -> History:
        """Return the quantity over time; UserError if the log lacks it or the time."""
        if "Time" not in table:
            raise UserError("runs are compared over physical time: add 'time' to thermo_style")
        return History(table["Time"], self.of(table))

    def error(self, run: History, reference: History) -> float:
        """Return how far a run is from the reference, relative to the size of the quantity.

        The run is interpolated linearly at the reference's times that it covers.
        """
        covered = (reference.times >= run.times[0]) & (reference.times <= run.times[-1])
        here = np.interp(reference.times[covered], run.times, run.values)
        difference = here - reference.values[covered]
        # what has blown up may overflow: the caller sees that the error is not finite
        with np.errstate(over="ignore", invalid="ignore"):
            return NORMS[self.norm](difference) / self._size(reference.values)

    def _size(self, values: NDArray) -> float:
        size = float(np.ptp(values) if self.by_range else np.max(np.abs(values)))
        if size == 0:
            raise UserError(
                f"{self.name} is {'constant' if self.by_range else '0'} in the reference run: "
                "there is nothing to compare errors with"
            )
        return size


@dataclass(frozen=True)
class Clock:
    """What turns a coefficient into steps, and when a packaged scene is looked at.

    Attributes:
        sound_time: h_s / c_0 of the finest particles, s.
        interval: time between two rows of the log, s: all schemes end a step exactly there.
    """

    sound_time: float
    interval: float

    def constant_step(self, wanted: float) -> tuple[float, int]:
        """Return the longest step up to the wanted one that divides the interval, and how often."""
        steps = math.ceil(self.interval / wanted * (1 - SLACK))
        return self.interval / steps, steps


def clock_by_spacing(interval: float) -> Callable[[Mapping[str, float]], Clock]:
    """Return the clock of a script whose ``spacing`` and ``support`` are of the finest particles.

    Args:
        interval: time between two rows of the log, s.
    """
    return lambda values: Clock(
        0.5 * values["support"] * values["spacing"] / values["sound"], interval
    )


@dataclass(frozen=True)
class Scene:
    """A scene to run with many settings.

    Attributes:
        name: as on the command line.
        summary: what happens in it, in one line.
        script: the LAMMPS input script.
        quantities: what is of interest; the first one ranks the settings.
        variables: script variables of all runs that differ from the script's defaults, and the
            ceiling if it does.
        quick: those of the smaller variant.
        variations: scheme -> name -> the values to try; all combinations are run.
        reference: scheme and settings of the reference run.
        clock: times of a scene by its script variables; None for a user's script, whose steps
            and output are its own affair.
        last_run: whether only the last ``run`` of the script counts, since the others set the
            scene up.
    """

    name: str
    summary: str
    script: Path
    quantities: tuple[Quantity, ...]
    variations: Mapping[str, Mapping[str, tuple[str, ...]]] = field(default_factory=dict)
    reference: Values = field(default_factory=dict)
    variables: Values = field(default_factory=dict)
    quick: Values = field(default_factory=dict)
    clock: Callable[[Mapping[str, float]], Clock] | None = None
    last_run: bool = False

    @cached_property
    def text(self) -> str:
        """The script."""
        return self.script.read_text(encoding="utf-8", errors="replace")

    @property
    def has_one_table(self) -> bool:
        """Whether all runs have the same columns, as far as the text tells."""
        tables = re.findall(r"^\s*thermo_modify\b.*\byaml\b", self.text, re.MULTILINE)
        return len(tables) == 1 and not re.search(r"\binclude\s", self.text)

    @cached_property
    def defaults(self) -> dict[str, str]:
        """The script's variables of style index with the values that stand there."""
        pattern = r"""^\s*variable\s+(\w+)\s+index\s+("[^"]*"|'[^']*'|[^\s#]+)"""
        found = re.findall(pattern, self.text, re.MULTILINE)
        return {name: value.strip("\"'") for name, value in found}

    def check_names(self, option: str, names: Mapping[str, object]) -> None:
        """Make sure that all names may be set here; UserError with those that may."""
        known = list(self.defaults)
        if "limits" in known:
            known += LIMITS
        if self.clock is not None:
            known = [*(name for name in known if name not in DERIVED), "ceiling"]
        for name in names:
            if name == "scheme" and option != "--reference":
                raise UserError(f"{option} scheme: schemes are chosen with --scheme")
            if name not in known:
                raise UserError(
                    f"{option} {name}: no such variable in {self.script.name}: choose from "
                    f"{', '.join(known) or 'none, it has no variable of style index'}"
                )

    def acts(self, name: str, scheme: str) -> bool:
        """Tell whether a setting changes anything under a scheme."""
        if name in self.defaults and not (self.clock and name == "dt"):
            return True
        if scheme != "constant":
            return name == "ceiling" or (
                name in LIMITS and ONE_SCHEME.get(name, scheme) in (scheme, AS_WRITTEN)
            )
        # in packaged scenes constant steps are given over h_s / c_0, or in seconds
        return self.clock is not None and name in ("acoustic", "dt")

    def script_variables(self, scheme: str, values: Values, quick: bool) -> dict[str, str]:
        """Return the values of the script's variables for one run.

        Args:
            scheme: one of ``SCHEMES``, or ``AS_WRITTEN``.
            values: settings of the run, and what the user has set for all of them.
            quick: take the smaller variant.
        """
        limits = {name: value for name, value in values.items() if self._is_limit(name)}
        own = {name: value for name, value in values.items() if name not in limits}
        variables = {**self.variables, **(self.quick if quick else {}), **own}
        if scheme != AS_WRITTEN:
            variables["scheme"] = scheme
        if self.clock is not None:
            return self._with_steps(variables, limits)
        return variables | ({"limits": _joined(limits)} if limits else {})

    def _is_limit(self, name: str) -> bool:
        return name in LIMITS and name not in self.defaults

    def _with_steps(self, variables: Values, limits: Values) -> dict[str, str]:
        """Return the variables of a packaged scene with those that set steps and rows of the log.

        Raises:
            UserError: a setting that is not the number that it has to be.
        """
        others = {name: value for name, value in variables.items() if name != "ceiling"}
        numbers = {name: _number(value) for name, value in (self.defaults | others).items()}
        clock = self.clock(numbers)
        if not (clock.sound_time > 0 and clock.interval > 0):
            raise UserError(f"{self.name}: no time step follows from {_joined(others)}")
        if others["scheme"] == "constant":
            # without both, what fix sph/integrate takes by itself
            wanted = _positive("acoustic", limits.get("acoustic", "0.5")) * clock.sound_time
            dt, steps = clock.constant_step(_positive("dt", others.get("dt", repr(wanted))))
            return others | {"dt": repr(dt), "every": "v_later", "steps": str(steps), "limits": ""}
        ceiling = _positive("ceiling", variables.get("ceiling", CEILING))
        longest = repr(ceiling * clock.sound_time)
        words = {"max": longest, "output": repr(clock.interval)} | limits
        return others | {"limits": _joined(words), "every": "v_next", "dt": longest}


def _joined(limits: Values) -> str:
    return " ".join(f"{name} {value}" for name, value in limits.items())


def _number(text: str) -> float:
    """Return a variable's value; NaN for a word."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def _positive(name: str, text: str) -> float:
    value = _number(text)
    if not value > 0:
        raise UserError(f"{name} is {text}: it must be a number above 0")
    return value
