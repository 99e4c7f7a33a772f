"""Options that several commands share, and options in groups."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import Annotated, get_type_hints

import typer


def _prepared(context: typer.Context, path: Path | None) -> Path | None:
    """Find a file that cannot be written, or must not be, before anything is computed for it."""
    from sphcloth.results import prepare_file

    if path is not None and not context.resilient_parsing:
        prepare_file(path, "--json")
    return path


JsonFile = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write the result here too.", callback=_prepared),
]
Ranks = Annotated[int, typer.Option(min=1, help="Number of MPI ranks.")]


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command whose dataclass parameters typer sees as one option per field.

    The options come in the order of the parameters and, within one, of the fields.
    """
    hints = get_type_hints(command, include_extras=True)
    groups = {name: hint for name, hint in hints.items() if is_dataclass(hint)}

    @wraps(command)
    def ungrouped(**given: object) -> None:
        made = {
            name: group(**{field.name: given.pop(field.name) for field in fields(group)})
            for name, group in groups.items()
        }
        command(**given, **made)

    options = []
    for name, parameter in inspect.signature(command).parameters.items():
        if name in groups:
            options += _options(groups[name])
        else:
            options.append(parameter.replace(kind=parameter.KEYWORD_ONLY, annotation=hints[name]))
    ungrouped.__signature__ = inspect.Signature(options)
    ungrouped.__annotations__ = {}
    return ungrouped


def given(group: object) -> list[str]:
    """Return the options of a group whose values are not the defaults, as on the command line."""
    hints = get_type_hints(type(group), include_extras=True)
    named = []
    for field in fields(group):
        if getattr(group, field.name) != field.default:
            # typer takes the first name for a default until it builds the command
            option = hints[field.name].__metadata__[0]
            names = [option.default, *(option.param_decls or ())]
            usual = f"--{field.name.replace('_', '-')}"
            named.append(next((name for name in names if str(name).startswith("--")), usual))
    return named


def _options(group: type) -> list[inspect.Parameter]:
    """Return a parameter for each field of a dataclass."""
    hints = get_type_hints(group, include_extras=True)
    return [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if field.default is MISSING else field.default,
            annotation=hints[field.name],
        )
        for field in fields(group)
    ]
