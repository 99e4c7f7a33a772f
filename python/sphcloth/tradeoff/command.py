"""``sphcloth tradeoff``: from the words of the command line to a study."""

from __future__ import annotations

import importlib
import os
import pkgutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.tradeoff import scenes
from sphcloth.tradeoff.scene import AS_WRITTEN, NORMS, SCHEMES, Quantity, Scene, column


def all_scenes() -> dict[str, Scene]:
    """Return name -> scene for every package in :mod:`sphcloth.tradeoff.scenes`."""
    modules = pkgutil.iter_modules(scenes.__path__, f"{scenes.__name__}.")
    found = [importlib.import_module(module.name).SCENE for module in modules]
    return {scene.name: scene for scene in found}


def find_scene(name: str, quantities: Sequence[str], last_run: bool) -> Scene:
    """Return a packaged scene, or one made of the user's script.

    Args:
        name: of a packaged scene, or path of an input script.
        quantities: texts ``NAME`` or ``NAME:NORM``; the first one ranks the settings.
        last_run: whether only the last run of a user's script counts.

    Raises:
        UserError: neither a scene nor a file, a norm that is unknown, or a script without a
            quantity.
    """
    known = all_scenes()
    if name in known:
        scene = known[name]
        return replace(scene, quantities=_ranked(scene.quantities, quantities))
    script = Path(name)
    if not script.is_file():
        raise UserError(f"no scene and no script '{name}': choose from {', '.join(known)}")
    if not quantities:
        raise UserError(
            f"what is of interest in {script.name}? give --quantity with a column of its log"
        )
    return Scene(
        script.name.removeprefix("in.").removesuffix(".in"),
        f"the script {script.name}",
        script,
        tuple(parse_quantity(text) for text in quantities),
        last_run=last_run,
    )


def find_schemes(scene: Scene, text: str | None) -> tuple[str, ...]:
    """Return the schemes to run; UserError for one that is unknown or that nothing chooses."""
    if text is None:
        if scene.clock is not None:
            return SCHEMES
        return (AS_WRITTEN,)
    found = tuple(word.strip() for word in text.split(","))
    for scheme in found:
        if scheme not in SCHEMES:
            raise UserError(f"--scheme {scheme}: choose from {', '.join(SCHEMES)}")
    if "scheme" not in scene.defaults:
        raise UserError(
            f"--scheme {text}: {scene.script.name} has no 'variable scheme index' to choose it by"
        )
    return found


def parse_quantity(text: str) -> Quantity:
    """Return the quantity that a text ``COLUMN`` or ``COLUMN:NORM`` means."""
    name, _, norm = text.partition(":")
    if norm and norm not in NORMS:
        raise UserError(f"--quantity {text}: no norm '{norm}': choose from {', '.join(NORMS)}")
    return Quantity(name, name, column(name), norm or "rms")


def parse_variations(texts: Sequence[str], option: str = "--vary") -> dict[str, tuple[str, ...]]:
    """Turn ``name=a,b,c`` texts into a dictionary; UserError for any other form."""
    found = {}
    for text in texts:
        name, equals, values = text.partition("=")
        words = tuple(word.strip() for word in values.split(","))
        if not (name.isidentifier() and equals and all(words)):
            raise UserError(f"{option} {text}: expected NAME=A,B,...")
        found[name] = words
    return found


def number_of_jobs(jobs: int, ranks: int) -> int:
    """Return how many runs go side by side; 0 means as many as the cores allow."""
    return jobs or max(1, len(os.sched_getaffinity(0)) // ranks)


def show_scenes(console: Console) -> None:
    """Print every packaged scene with what it measures and varies."""
    for scene in all_scenes().values():
        table = Table(title=f"{scene.name}: {scene.summary}", title_justify="left")
        for head in ("", "", ""):
            table.add_column(head)
        for quantity in scene.quantities:
            table.add_row("quantity", quantity.name, f"{quantity.description} ({quantity.norm})")
        for scheme in find_schemes(scene, None):
            table.add_row("varied", scheme, _listed(scene.variations[scheme]))
        table.add_row("reference", scene.reference["scheme"], _reference(scene))
        console.print(table, "", highlight=False)


def _ranked(own: tuple[Quantity, ...], texts: Sequence[str]) -> tuple[Quantity, ...]:
    """Put the quantities that the user names first, thermo columns of other names included."""
    known = {quantity.name: quantity for quantity in own}
    ranked = {}
    for text in texts:
        parsed = parse_quantity(text)
        usual = known.get(parsed.name, parsed)
        ranked[parsed.name] = replace(usual, norm=parsed.norm) if ":" in text else usual
    for name, quantity in known.items():
        ranked.setdefault(name, quantity)
    return tuple(ranked.values())


def _listed(varied: Mapping[str, tuple[str, ...]]) -> str:
    return "; ".join(f"{name} {', '.join(values)}" for name, values in varied.items())


def _reference(scene: Scene) -> str:
    values = {name: value for name, value in scene.reference.items() if name != "scheme"}
    return ", ".join(f"{name} {value}" for name, value in values.items())
