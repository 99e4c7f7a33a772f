"""What a case is: its parameters, what it measures and within which limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from sphcloth.errors import UserError
from sphcloth.results import Value
from sphcloth.validation.runner import Runner


@dataclass(frozen=True)
class Parameter:
    """One number or word that ``--set`` may change.

    Attributes:
        name: as in ``--set name=value``.
        default: value of the full case; its type is the type of all values.
        unit: unit of the value, "1" for a pure number.
        description: what it is, in a few words.
        minimum: smallest value allowed, itself included.
        maximum: largest value allowed, itself included.
        choices: the words allowed, for a parameter that is a word.
        quick: value with ``--quick``; None for the default.
    """

    name: str
    default: Value
    unit: str
    description: str
    minimum: float = -math.inf
    maximum: float = math.inf
    choices: tuple[str, ...] = ()
    quick: Value | None = None

    @property
    def allowed(self) -> str:
        """The values allowed, as text."""
        if self.choices:
            return ", ".join(self.choices)
        kind = "a whole number" if isinstance(self.default, int) else "a number"
        return f"{kind} from {self.minimum:g} to {self.maximum:g}"

    def parse(self, text: str) -> Value:
        """Turn the text of a ``--set`` into a value; UserError if it is not allowed."""
        try:
            value = type(self.default)(text)
        except ValueError:
            raise self._refusal(text) from None
        if not self._allows(value):
            raise self._refusal(text)
        return value

    def _allows(self, value: Value) -> bool:
        if self.choices:
            return value in self.choices
        return self.minimum <= value <= self.maximum

    def _refusal(self, text: str) -> UserError:
        return UserError(f"--set {self.name}={text}: {self.description} must be {self.allowed}")


@dataclass(frozen=True)
class Quantity:
    """Something that a case measures.

    Attributes:
        name: as in the JSON.
        unit: unit of the value, "1" for a pure number.
        description: what it is, in a few words.
        limit: largest absolute value that passes; None for a value that is only reported.
        quick_limit: the limit with ``--quick``; None for a value that is only reported then.
    """

    name: str
    unit: str
    description: str
    limit: float | None = None
    quick_limit: float | None = None

    def judge(self, value: float, quick: bool) -> Metric:
        """Compare a value with the limit; one that is not a number does not pass."""
        limit = self.quick_limit if quick else self.limit
        passed = None if limit is None else bool(abs(value) <= limit)
        return Metric(value, limit, self.unit, passed)


@dataclass(frozen=True)
class Metric:
    """A measured value, the largest absolute value that passes, and whether it passes.

    Limit and verdict are None for a value that is only reported.
    """

    value: float
    limit: float | None
    unit: str
    passed: bool | None


@dataclass(frozen=True)
class Case:
    """One validation case.

    Attributes:
        name: as on the command line; the script beside the case's module is ``in.<name>``.
        summary: what is measured, and behind a colon what it is compared with, in one line.
        parameters: all that ``--set`` may change.
        quantities: all that is measured, in the order of the table.
        measure: runs the script for some parameters and returns a value for each quantity. It
            gets all parameters by name, and the runner that runs LAMMPS and knows the folder.
        folder: where the script is.
    """

    name: str
    summary: str
    parameters: tuple[Parameter, ...]
    quantities: tuple[Quantity, ...]
    measure: Callable[[Mapping[str, Value], Runner], Mapping[str, float]]
    folder: Path

    @property
    def script(self) -> Path:
        """The LAMMPS input script."""
        return self.folder / f"in.{self.name}"

    def knows(self, name: str) -> bool:
        """Tell whether the case has a parameter of this name."""
        return any(parameter.name == name for parameter in self.parameters)

    def values(self, settings: Mapping[str, str], quick: bool) -> dict[str, Value]:
        """Return the value of every parameter: the user's, or else the one of this size.

        Raises:
            UserError: a setting with an unknown name or a value that is not allowed.
        """
        known = {parameter.name: parameter for parameter in self.parameters}
        for name in settings:
            if name not in known:
                raise UserError(f"no parameter '{name}' of {self.name}: choose from {_list(known)}")
        return {
            name: parameter.parse(settings[name])
            if name in settings
            else (parameter.quick if quick and parameter.quick is not None else parameter.default)
            for name, parameter in known.items()
        }

    def judge(self, measured: Mapping[str, float], quick: bool) -> dict[str, Metric]:
        """Compare all that was measured with the limits."""
        return {
            quantity.name: quantity.judge(float(measured[quantity.name]), quick)
            for quantity in self.quantities
        }


def _list(names: Mapping[str, object]) -> str:
    return ", ".join(names)
