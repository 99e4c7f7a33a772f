"""What a reference solution asks of its parameters."""

from __future__ import annotations

from sphcloth.errors import UserError


def check_positive(solution: object, *names: str) -> None:
    """Raise UserError if one of these attributes is not above 0; NaN is not."""
    for name in names:
        if not getattr(solution, name) > 0:
            _refuse(solution, name, "it must be above 0")


def check(solution: object, name: str, allowed: bool, remedy: str) -> None:
    """Raise UserError with name, value and remedy unless the value is allowed."""
    if not allowed:
        _refuse(solution, name, remedy)


def _refuse(solution: object, name: str, remedy: str) -> None:
    value = getattr(solution, name)
    raise UserError(f"{type(solution).__name__}: {name} = {value:g}: {remedy}")
