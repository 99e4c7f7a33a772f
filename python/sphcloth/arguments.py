"""Checks of the numbers that functions are given."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.errors import UserError

# the least number above 0, as a bound
POSITIVE = float(np.nextafter(0.0, 1.0))
# share of a range by which numbers may lie outside: positions in a dump have six digits
ROUNDING = 1e-5
# LAMMPS has types of 32 bits
MOST_TYPES = 2**31


def numbers(
    what: str,
    values: ArrayLike,
    remedy: str,
    *,
    low: float = -np.inf,
    high: float = np.inf,
    shapes: Collection[tuple[int, ...]] | None = None,
) -> NDArray[np.float64]:
    """Return values as float64, if they are finite and in a range.

    What is outside of a range with two ends by no more than rounding is moved to its end.

    Args:
        what: their name, for the message.
        values: any numbers.
        remedy: what they must be, for the message.
        low: the least that is allowed.
        high: the largest that is allowed.
        shapes: those that are allowed; None for any.

    Raises:
        UserError: other values, with the first of them.
    """
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UserError(f"{what} = {values}: {remedy}") from error
    if shapes is not None and found.shape not in shapes:
        raise UserError(f"{what} has the shape {found.shape}: {remedy}")
    slack = ROUNDING * (high - low) if np.isfinite(high - low) else 0.0
    wrong = ~(np.isfinite(found) & (found >= low - slack) & (found <= high + slack))
    if wrong.any():
        raise UserError(f"{what} = {found[wrong][0]:g}: {remedy}")
    return np.clip(found, low, high)


def types(what: str, values: int | Collection[int]) -> NDArray[np.int64]:
    """Return one type of atoms or angles, or several, as an array of one dimension.

    Raises:
        UserError: anything but whole numbers from 1 on.
    """
    several = isinstance(values, Collection) and not isinstance(values, str | bytes | np.ndarray)
    found = np.atleast_1d(np.array(list(values) if several else values, dtype=object)).ravel()
    wrong = [each for each in found if not _is_type(each)]
    if wrong:
        raise UserError(f"{what} {wrong[0]!r}: types are whole numbers from 1, as 1 or [1, 3]")
    return found.astype(np.int64)


def _is_type(value: object) -> bool:
    is_number = isinstance(value, int | float | np.integer | np.floating)
    is_number = is_number and not isinstance(value, bool)
    return is_number and 1 <= value < MOST_TYPES and value == np.floor(value)
