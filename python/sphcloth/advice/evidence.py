"""What was measured in a run: columns by the name of the fix's value, and the commands."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.advice.commands import Commands
from sphcloth.fix_values import FIX_OF, NUMBERS, column
from sphcloth.log import ThermoTable


@dataclass(frozen=True)
class Evidence:
    """A run as far as it went.

    Attributes:
        commands: those of the script.
        columns: ``f_contact[1]`` and the like -> values over the run, shape (rows,).
        whole: whether the run went to the end of the script.
        steps: number of time steps.
        time: physical time reached.
        duration: physical time that the steps took together.
    """

    commands: Commands
    columns: Mapping[str, NDArray[np.float64]]
    whole: bool
    steps: int
    time: float
    duration: float

    @property
    def mean_step(self) -> float:
        """Mean time step."""
        return self.duration / self.steps

    @classmethod
    def of_log(cls, log: Path, table: ThermoTable | None = None) -> Evidence:
        """Take a finished run from its log; a column ``v_x`` counts as what x stands for.

        Args:
            log: of the run.
            table: what was read of it before; None reads it.
        """
        commands = Commands.read(log)
        if table is None:
            table = ThermoTable.read(log)
        columns = dict(table.columns)
        stand_for = {f"v_{name}": formula for name, formula in commands.variables.items()}
        for name, values in table.columns.items():
            meant = _value_of_fix(stand_for.get(name, name), commands)
            if meant:
                columns[meant] = values
        steps = int(table["Step"][-1] - table["Step"][0])
        first, last = (float(table["Time"][row]) for row in (0, -1))
        return cls(commands, columns, True, steps, last, last - first)

    def largest(self, name: str, until: float = math.inf) -> float | None:
        """Return the largest value of a column up to a time of the probe.

        None if there is no such column, or no number in it.
        """
        values = self.columns.get(name, np.empty(0))
        if until < math.inf:
            values = values[self.columns["v_advise_time"] <= until]
        values = values[np.isfinite(values)]
        return float(values.max()) if len(values) else None

    def last(self, name: str) -> float | None:
        """Return the last value of a column, None if there is no such column."""
        values = self.columns.get(name, np.empty(0))
        return float(values[-1]) if len(values) else None


def _value_of_fix(formula: str, commands: Commands) -> str | None:
    """Return what ``f_ID[n]`` a formula is, which may name a compute that gives it by keyword."""
    if re.fullmatch(r"f_\w+(\[\d+\])?", formula):
        return formula
    found = re.fullmatch(r"c_(\w+?)(?:\[(\d+)\])?", formula)
    style, *words = commands.computes.get(found[1], ("",)) if found else ("",)
    if style not in FIX_OF or any("*" in word for word in words):
        return None
    fix_style = FIX_OF[style]
    fixes = [fix.id for fix in commands.styled(fix_style)]
    while "fix" in words:
        place = words.index("fix")
        fixes = words[place + 1 : place + 2]
        del words[place : place + 2]
    keyword = words[int(found[2] or 1) - 1] if int(found[2] or 1) <= len(words) else ""
    known = keyword in NUMBERS[fix_style] and len(fixes) == 1
    return column(fixes[0], fix_style, keyword) if known else None
