"""One scene at several resolutions, and the order of convergence from coarse to fine."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from sphcloth.validation import compare
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

    def order(self, errors: Sequence[float]) -> float:
        """Return the order of convergence of the errors of a coarse and a fine run."""
        return compare.order(errors, list(self.resolutions.values()))


def coarse_and_fine(fine: int, share: float = 0.5, coarsest: int = 1) -> dict[str, int]:
    """Return the resolutions of two runs: a share of the fine one, and all of it."""
    return {"coarse": max(coarsest, round(share * fine)), "fine": fine}
