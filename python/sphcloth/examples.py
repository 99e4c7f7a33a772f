"""The examples in the package: input scripts, their sizes and their variables."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from sphcloth.errors import UserError


@dataclass(frozen=True)
class Example:
    """One example: the folder ``<name>`` with ``in.<name>`` and ``sizes.toml``."""

    name: str
    folder: Path

    @property
    def script(self) -> Path:
        """The LAMMPS input script."""
        return self.folder / f"in.{self.name}"

    def defaults(self) -> dict[str, str]:
        """Return the script's variables of style index with the values that stand there."""
        pattern = r"^\s*variable\s+(\w+)\s+index\s+([^\s#]+)"
        return dict(re.findall(pattern, self.script.read_text(encoding="utf-8"), re.MULTILINE))

    def sizes(self) -> dict[str, dict[str, str]]:
        """Return size name -> variable -> value; each value as text for the command line."""
        table = tomllib.loads((self.folder / "sizes.toml").read_text(encoding="utf-8"))
        return {
            size: {name: str(value) for name, value in values.items()}
            for size, values in table.items()
        }

    def variables(self, size: str, settings: Mapping[str, str]) -> dict[str, str]:
        """Return the variables that a size gives a value, the user's settings on top.

        Raises:
            UserError: no such size, or a setting whose name the script does not know.
        """
        sizes = self.sizes()
        if size not in sizes:
            raise UserError(f"no size '{size}' of example {self.name}: {_listed(sizes)}")
        known = self.defaults()
        for name in settings:
            if name not in known:
                raise UserError(f"no variable '{name}' in {self.script.name}: {_listed(known)}")
        return sizes[size] | dict(settings)


def find_example(name: str) -> Example:
    """Return a packaged example; UserError with the names there are if there is none.

    An example without sizes has no summary either: it is a script for LAMMPS alone.
    """
    folder = _examples_folder()
    names = sorted(path.parent.name for path in folder.glob("*/sizes.toml"))
    if name not in names:
        raise UserError(f"no example '{name}': {_listed(names)}")
    return Example(name, folder / name)


def parse_settings(settings: Sequence[str], option: str = "--set") -> dict[str, str]:
    """Turn the ``name=value`` texts of an option into a dictionary; UserError for other forms.

    ``name=`` is the empty text.
    """
    pairs = [setting.partition("=") for setting in settings]
    for setting, (name, equals, _) in zip(settings, pairs, strict=True):
        if not (name.isidentifier() and equals):
            raise UserError(f"{option} {setting}: expected name=value")
    return {name: value.strip() for name, _, value in pairs}


def _examples_folder() -> Path:
    """Return the examples in the installed package, or those of the source tree."""
    packaged = Path(str(resources.files("sphcloth"))) / "examples"
    return packaged if packaged.is_dir() else Path(__file__).parents[2] / "examples"


def _listed(names: Sequence[str] | Mapping[str, object]) -> str:
    return f"choose from {', '.join(names)}" if names else "there are none"
