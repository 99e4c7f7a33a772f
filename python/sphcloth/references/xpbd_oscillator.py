"""A mass on one compliant constraint, as extended position-based dynamics steps it.

One projection with the compliance alpha solves the constraint exactly, which makes the step that of
implicit Euler: v' = v - h omega^2 x', x' = x + h v' with omega^2 = 1 / (alpha m). In the complex
amplitude z = x + i v / omega this is z' = z / (1 + i omega h), whatever the number of iterations:
the magnitude falls by sqrt(1 + omega^2 h^2) and the phase moves by arctan(omega h) in each step.
Macklin, Mueller and Chentanez, Motion in Games 2016.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.checks import check_positive


@dataclass(frozen=True)
class Oscillator:
    """The mass and its constraint.

    Attributes:
        mass: kg.
        compliance: alpha, m/N.
        step: h, s; the substep where a step is divided.

    Raises:
        UserError: a value for which there is no such scene.
    """

    mass: float
    compliance: float
    step: float

    def __post_init__(self) -> None:
        check_positive(self, "mass", "compliance", "step")

    @property
    def omega(self) -> float:
        """Angular frequency without any step, rad/s."""
        return 1 / math.sqrt(self.compliance * self.mass)

    @property
    def eigenvalue(self) -> complex:
        """Factor of the complex amplitude in one step."""
        return 1 / (1 + 1j * self.omega * self.step)

    def motion(self, start: float, steps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the elongation after some numbers of steps, after a start at rest."""
        return (start * self.eigenvalue**steps).real

    def exact(self, start: float, steps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the elongation of the oscillator itself at the same times."""
        return start * np.cos(self.omega * self.step * steps)
