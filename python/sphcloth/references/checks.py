"""What a reference solution asks of its parameters, and of the places and times of its values."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.arguments import numbers
from sphcloth.errors import UserError


def check_positive(solution: object, *names: str) -> None:
    """Raise UserError if one of these attributes is not above 0, or any field is not finite."""
    for name in names:
        if not np.all(np.asarray(getattr(solution, name)) > 0):
            _refuse(solution, name, "it must be above 0")
    check_finite(solution)


def check_finite(solution: object) -> None:
    """Raise UserError if a field is not finite, but for one that is as by default."""
    for field in fields(solution):
        values = np.asarray(getattr(solution, field.name))
        is_number = values.dtype.kind in "iuf"
        if is_number and not np.isfinite(values).all() and not np.all(values == field.default):
            _refuse(solution, field.name, "it must be finite")


def check(solution: object, name: str, allowed: bool, remedy: str) -> None:
    """Raise UserError with name, value and remedy unless the value is allowed."""
    if not allowed:
        _refuse(solution, name, remedy)


def within(
    solution: object, name: str, values: ArrayLike, low: float, high: float, remedy: str
) -> NDArray[np.float64]:
    """Return places as float64; UserError unless they lie where the solution is defined.

    Args:
        solution: the reference.
        name: of the places, for the message.
        values: the places.
        low: the first one.
        high: the last one.
        remedy: what they are.
    """
    what = f"{type(solution).__name__}: {name}"
    remedy = f"it must be from {low:g} to {high:g}, {remedy}"
    return numbers(what, values, remedy, low=low, high=high)


def since_start(
    solution: object, times: ArrayLike, shapes: Collection[tuple[int, ...]] | None = None
) -> NDArray[np.float64]:
    """Return times as float64; UserError for one before the start, 0, or one that is not finite.

    Args:
        solution: the reference.
        times: the times.
        shapes: those that are allowed; None for any.
    """
    remedy = "it must be from 0, the start, on; frames have times by Trajectory(DUMP, LOG)"
    return numbers(f"{type(solution).__name__}: time", times, remedy, low=0.0, shapes=shapes)


def _refuse(solution: object, name: str, remedy: str) -> None:
    value = getattr(solution, name)
    shown = f"{value:g}" if np.isscalar(value) else f"{value}"
    raise UserError(f"{type(solution).__name__}: {name} = {shown}: {remedy}")
