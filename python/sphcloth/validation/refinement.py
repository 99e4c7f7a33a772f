"""One scene at three resolutions in a row, and the order of convergence over them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from sphcloth.validation import compare
from sphcloth.validation.case import Quantity
from sphcloth.validation.runner import Run

T = TypeVar("T")


@dataclass(frozen=True)
class Refinement:
    """Runs of one scene, the finest last.

    Attributes:
        resolutions: label -> particles, layers or links over the same length.
        runs: in the same order.
    """

    resolutions: Mapping[str, int]
    runs: Sequence[Run]

    @classmethod
    def of(cls, run: Callable[[str, int], Run], resolutions: Mapping[str, int]) -> Refinement:
        """Run a scene at each resolution; ``run`` takes the label of a run and its resolution."""
        return cls(resolutions, [run(label, n) for label, n in resolutions.items()])

    @property
    def fine(self) -> Run:
        """The finest run."""
        return self.runs[-1]

    def each(self, measure: Callable[[Run, int], T]) -> list[T]:
        """Return what is measured of each run and its resolution."""
        return [
            measure(run, n) for run, n in zip(self.runs, self.resolutions.values(), strict=True)
        ]

    def labeled(self, values: Sequence[T]) -> dict[str, T]:
        """Return label -> one value of each run."""
        return dict(zip(self.resolutions, values, strict=True))

    def orders(self, errors: Sequence[float]) -> dict[str, float]:
        """Return the quantities of :func:`order_quantities`, of the errors of all runs."""
        return compare.orders(errors, list(self.resolutions.values()))


def order_quantities(what: str) -> tuple[Quantity, Quantity]:
    """Return the quantities that :meth:`Refinement.orders` gives, for the errors of something."""
    return (
        Quantity("order", "1", f"order of convergence {what}, over three in a row"),
        Quantity("order_least", "1", "the smaller of the orders from one to the next"),
    )


def three(fine: int, share: float = 0.5, coarsest: int = 1) -> dict[str, int]:
    """Return three resolutions in a row, each finer by the same factor.

    Args:
        fine: the finest one.
        share: of the fine one, for the coarse run.
        coarsest: the least for the coarse run.
    """
    coarse = max(coarsest, round(share * fine))
    return {"coarse": coarse, "middle": round(math.sqrt(coarse * fine)), "fine": fine}
