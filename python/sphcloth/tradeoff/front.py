"""Which settings are worth their cost: the Pareto front, and the cheapest within an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from statistics import fmean

# the baselines: what a user would take instead of individual steps
BASELINES = ("constant", "global")
COSTS = {"updates": "particle updates", "wall_s": "wall time (s)"}


@dataclass(frozen=True)
class Point:
    """One setting and what came of it.

    Attributes:
        scheme: of the time step.
        label: what was varied, in a few words.
        values: the same by name.
        errors: quantity -> error relative to the reference run; empty if the run failed.
        failure: why there is no result; None if there is one.
        updates: how often a particle was updated.
        steps: number of time steps.
        wall_s: wall time of the time loop, s, the shortest if it was measured several times.
        worst: quantity -> the largest of several errors, where ``errors`` are their means.
    """

    scheme: str
    label: str
    values: dict[str, str]
    errors: dict[str, float]
    failure: str | None = None
    updates: float | None = None
    steps: int | None = None
    wall_s: float | None = None
    worst: dict[str, float] = field(default_factory=dict)

    def cost(self, name: str) -> float:
        """Return one of ``COSTS``; the run must not have failed."""
        return getattr(self, name)


@dataclass(frozen=True)
class Choice:
    """The cheapest setting of a scheme within an error.

    Attributes:
        point: the setting.
        saving: baseline scheme -> how many times as much its own cheapest setting costs, None
            if it has none within the error.
    """

    point: Point
    saving: dict[str, float | None]


def mean(points: Sequence[Point]) -> Point:
    """Return what one setting costs, and how wrong it is, on average over several runs.

    A setting that fails once has failed.
    """
    first, failed = points[0], [point.failure for point in points if point.failure is not None]
    if len(points) == 1:
        return first
    if failed:
        reason = f"{len(failed)} of {len(points)} runs: {failed[0]}"
        return Point(first.scheme, first.label, first.values, {}, reason)
    return Point(
        first.scheme,
        first.label,
        first.values,
        {name: fmean(point.errors[name] for point in points) for name in first.errors},
        None,
        fmean(point.updates for point in points),
        round(fmean(point.steps for point in points)),
        fmean(point.wall_s for point in points),
        {name: max(point.errors[name] for point in points) for name in first.errors},
    )


def pareto(points: Sequence[Point], quantity: str, cost: str) -> list[Point]:
    """Return the points that no other beats in error at the same or a lower cost, by cost."""
    front: list[Point] = []
    well = [point for point in points if point.failure is None]
    for point in sorted(well, key=lambda each: (each.cost(cost), each.errors[quantity])):
        if not front or point.errors[quantity] < front[-1].errors[quantity]:
            front.append(point)
    return front


def cheapest(points: Sequence[Point], quantity: str, cost: str, error: float) -> Point | None:
    """Return the cheapest point with at most this error; None if there is none."""
    within = [point for point in points if not point.failure and point.errors[quantity] <= error]
    return min(within, key=lambda point: point.cost(cost), default=None)


def choices(points: Sequence[Point], quantity: str, cost: str, error: float) -> dict[str, Choice]:
    """Return scheme -> its cheapest setting within an error, beside the honest baselines.

    Schemes without a setting within the error are left out.
    """
    schemes = dict.fromkeys(point.scheme for point in points)
    best = {
        scheme: cheapest([each for each in points if each.scheme == scheme], quantity, cost, error)
        for scheme in schemes
    }
    return {
        scheme: Choice(point, {name: _times(best.get(name), point, cost) for name in BASELINES})
        for scheme, point in best.items()
        if point is not None
    }


def _times(baseline: Point | None, point: Point, cost: str) -> float | None:
    return None if baseline is None else baseline.cost(cost) / point.cost(cost)
