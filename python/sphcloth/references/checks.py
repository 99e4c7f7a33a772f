"""What a reference solution asks of its parameters."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

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


def _refuse(solution: object, name: str, remedy: str) -> None:
    value = getattr(solution, name)
    shown = f"{value:g}" if np.isscalar(value) else f"{value}"
    raise UserError(f"{type(solution).__name__}: {name} = {shown}: {remedy}")
