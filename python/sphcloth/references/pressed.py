"""Level sheets that lie on one another, the upper one pressed, the lowest one held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check, check_positive


@dataclass(frozen=True)
class Pile:
    """The sheets at rest.

    Attributes:
        sheets: number of free ones, >= 1.
        weight: of one of them, > 0, N.
        load: force on the upper one, >= 0, N.
        thickness: distance from sheet to sheet, > 0, m.

    Raises:
        UserError: a value for which there is no such scene.
    """

    sheets: int
    weight: float
    load: float
    thickness: float

    def __post_init__(self) -> None:
        check_positive(self, "sheets", "weight", "thickness")
        check(self, "load", self.load >= 0, "it must not be negative")

    @property
    def forces(self) -> NDArray[np.float64]:
        """Force from each sheet on the one below it, the lowest first, N, shape (sheets,)."""
        return self.load + self.weight * np.arange(self.sheets, 0, -1)

    @property
    def heights(self) -> NDArray[np.float64]:
        """Height of each free sheet above the held one, the lowest first, m, shape (sheets,)."""
        return self.thickness * np.arange(1, self.sheets + 1)
