"""Systems of units of LAMMPS, for scenes that are written in any of them."""

from __future__ import annotations

import re
from dataclasses import dataclass

DALTON = 1.66053906660e-27
FACTOR = re.compile(r"([*/]?)(1|[A-Za-z]+)(?:\^(\d))?")


@dataclass(frozen=True)
class Units:
    """1 m, 1 kg and 1 s in a system, and LAMMPS's factor from force over mass to acceleration."""

    m: float
    kg: float
    s: float
    ftm2v: float = 1.0

    def of(self, expression: str) -> float:
        """Return the value of a product of units, such as ``kg/m^3``."""
        newton = self.m * self.kg / self.s**2 / self.ftm2v
        known = {"1": 1.0, "m": self.m, "kg": self.kg, "s": self.s, "N": newton}
        value = 1.0
        for sign, unit, power in FACTOR.findall(expression):
            factor = known[unit] ** int(power or 1)
            value = value / factor if sign == "/" else value * factor
        return value


# the factors of metal and real are those of LAMMPS's Update::set_units()
UNITS = {
    "si": Units(1.0, 1.0, 1.0),
    "cgs": Units(100.0, 1000.0, 1.0),
    "lj": Units(20.0, 8.0, 7.3),
    "metal": Units(1e10, 1 / DALTON, 1e12, 1 / 1.0364269e-4),
    "real": Units(1e10, 1 / DALTON, 1e15, 1 / 48.88821291**2),
}
