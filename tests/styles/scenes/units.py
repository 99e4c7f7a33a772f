"""The same scene in other units.

Scenes say numbers in SI with their unit behind them, ``9.81[N/kg]``; :func:`render` writes them in
the units that LAMMPS is told to use, :func:`convert` does the same with a data file.
"""

import re
from dataclasses import dataclass
from functools import cache

from harness import instance

# 1 m, 1 kg and 1 s in each system; lj has no units of its own, so any will do
DALTON = 1.66053906660e-27
SYSTEMS = {
    "si": (1.0, 1.0, 1.0),
    "cgs": (100.0, 1000.0, 1.0),
    "lj": (1 / 0.05, 1 / 0.125, 7.3),
    "micro": (1e6, 1e15, 1e6),
    "nano": (1e9, 1e21, 1e9),
    "real": (1e10, 1 / DALTON, 1e15),
    "metal": (1e10, 1 / DALTON, 1e12),
}
NUMBER = re.compile(r"(?<![\w.])([-+]?\d+\.?\d*(?:[eE][-+]?\d+)?)\[([^\]]+)\]")
FACTOR = re.compile(r"([*/]?)(1|[A-Za-z]+)(?:\^(\d))?")
# of the columns of a data file's atoms, behind the atom ID
ATOMS = {
    "hybrid": ("", "m", "m", "m", "kg/m^3", "J", "J", "", "", "", ""),
    "sph": ("", "kg/m^3", "J", "J", "m", "m", "m", "", "", ""),
}


@dataclass(frozen=True)
class Units:
    """Numeric values of SI units in a system, with LAMMPS's own constants of conversion."""

    name: str
    m: float
    kg: float
    s: float
    ftm2v: float
    nktv2p: float

    def of(self, expression: str) -> float:
        """Return the value of a product of units, such as ``kg/m^3``; of nothing: 1."""
        newton = self.m * self.kg / self.s**2 / self.ftm2v
        known = {"1": 1.0, "m": self.m, "kg": self.kg, "s": self.s, "N": newton}
        known |= {"J": newton * self.m, "Pa": newton / self.m**2 * self.nktv2p}
        value = 1.0
        for sign, unit, power in FACTOR.findall(expression):
            factor = known[unit] ** int(power or 1)
            value = value / factor if sign == "/" else value * factor
        return value


@cache
def units(name: str) -> Units:
    """Return a system of units by LAMMPS's name for it."""
    with instance() as lmp:
        lmp.command(f"units {name}")
        constants = [lmp.extract_global(constant) for constant in ("ftm2v", "nktv2p")]
    return Units(name, *SYSTEMS[name], *constants)


def render(script: str, name: str = "si") -> str:
    """Return a script in some units; in SI numbers stay as they are written."""
    if name == "si":
        return NUMBER.sub(r"\1", script)
    system = units(name)
    script = script.replace("units si\n", f"units {name}\n")
    return NUMBER.sub(lambda said: f"{float(said[1]) * system.of(said[2]):.17g}", script)


def convert(data: str, name: str, dimension: int = 3) -> str:
    """Return a data file of LAMMPS, written in SI and without coefficients, in other units."""
    data = data.replace("units = si", f"units = {name}")
    system, section, lines = units(name), "", []
    for line in data.splitlines():
        words = line.split()
        if words and words[0].isalpha():
            section = line
        columns = _columns(section, words, dimension)
        if columns:
            words[1:] = [
                f"{float(word) * system.of(unit):.17g}" if unit else word
                for word, unit in zip(words[1:], columns, strict=True)
            ]
        elif line.endswith(("xhi", "yhi", "zhi", "yz")):
            words = [
                f"{float(word) * system.m:.17g}" if not word[:1].isalpha() else word
                for word in words
            ]
        lines.append(" ".join(words) if columns or words else line)
    return "\n".join(lines) + "\n"


def _columns(section: str, words: list[str], dimension: int) -> tuple[str, ...]:
    """Units of what stands behind the first number of a line, none where it has no units."""
    if not words or words[0].isalpha():
        return ()
    if section.startswith("Masses"):
        return ("kg",)
    if section.startswith("Velocities"):
        return ("m/s",) * 3
    if section.startswith("Atoms"):
        columns = ATOMS[section.split("# ")[1]]
        return tuple(unit.replace("m^3", f"m^{dimension}") for unit in columns)
    return ()
