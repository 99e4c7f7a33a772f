"""LAMMPS's own SPH packages on the validation cases, measured by the cases themselves.

``python -m sphcloth.validation.stock CASE CODE`` runs ``in.CASE-CODE`` in place of the case's own
script. What is measured, and how, is the function ``measure`` of the case.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.validation.case import Case, Value
from sphcloth.validation.runner import Run, Runner

FOLDER = Path(__file__).parent

# parameters of a case that these codes have otherwise: negative pressure acts, and the density
# follows from continuity unless --set says summation
FIXED = {"tension": "yes", "density": "continuity"}
# support over spacing: rheo's kernel is a quintic spline made for 3
SUPPORT = {"sph": "4", "rheo": "3"}
CODES = tuple(SUPPORT)


@dataclass
class StockRunner(Runner):
    """A runner whose script takes some variables more than the case gives.

    Attributes:
        extra: script variables that are no parameters of the case.
    """

    extra: dict[str, str] = field(default_factory=dict)

    def run(self, label: str, t_end: float, variables: Mapping[str, Value]) -> Run:
        """Run the script once with the variables of the case and the additional ones."""
        return super().run(label, t_end, {**variables, **self.extra})

    def steps(self) -> list[int]:
        """Return the number of steps of every run."""
        return [int(run.thermo["Step"][-1]) for run in self.runs]


def pairs() -> dict[str, list[str]]:
    """Return case -> codes for which there is a script."""
    found: dict[str, list[str]] = {}
    for script in sorted(FOLDER.glob("in.*")):
        case, code = script.name.removeprefix("in.").rsplit("-", 1)
        found.setdefault(case, []).append(code)
    return found


def find(name: str, code: str) -> tuple[Case, Path]:
    """Return the case and the script of a code; UserError if there is none."""
    script = FOLDER / f"in.{name}-{code}"
    if not script.is_file():
        known = ", ".join(f"{case} {' '.join(codes)}" for case, codes in pairs().items())
        raise UserError(f"no script for {name} by {code}: choose from {known}")
    module = f"sphcloth.validation.cases.{name.replace('-', '_')}"
    return importlib.import_module(module).CASE, script


def compare_stock(
    name: str,
    code: str,
    settings: Mapping[str, str],
    out: Path,
    console: Console,
    *,
    quick: bool = False,
    ranks: int = 1,
) -> tuple[dict[str, float], StockRunner]:
    """Run a case by one of the codes and measure it as the case is measured.

    Args:
        name: the case.
        code: ``sph`` or ``rheo``.
        settings: parameters of the case and variables of the script that differ from the default.
        out: folder for logs, dumps and the plot.
        console: where progress appears.
        quick: take the smaller size.
        ranks: number of MPI ranks.

    Returns:
        Name -> value of every quantity of the case, and the runner with its runs.

    Raises:
        UserError: no such script, a setting that is not allowed, or LAMMPS failed.
    """
    case, script = find(name, code)
    known = {parameter.name for parameter in case.parameters}
    own = FIXED | {"support": SUPPORT[code]} | dict(settings)
    values = case.values({key: text for key, text in own.items() if key in known}, quick)
    extra = {key: text for key, text in own.items() if key not in known}
    _check(extra, script)
    out.mkdir(parents=True, exist_ok=True)
    runner = StockRunner(script, out, ranks, console, extra=extra)
    return dict(case.measure(values, runner)), runner


def _check(extra: Mapping[str, str], script: Path) -> None:
    """Raise UserError for a variable that the script does not have."""
    text = script.read_text(encoding="utf-8")
    for name in extra:
        if f"variable {name} " not in text:
            raise UserError(f"{script.name} has no variable '{name}'")
