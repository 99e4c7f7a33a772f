"""The whole of a trade-off: settings, runs, errors, and which setting to take."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.results import versions, write_json
from sphcloth.tradeoff.front import COSTS, Choice, Point, choices, mean, pareto
from sphcloth.tradeoff.runs import GRACE_SECONDS, TIMEOUT_FACTOR, Record, Setting, Workshop
from sphcloth.tradeoff.scene import History, Quantity, Scene, Values

RUNS = "runs"

Histories = Mapping[str, History]
Variations = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class Plan:
    """What the user asks for beside the scene.

    Attributes:
        schemes: to run, in order.
        vary: name -> values to try, in the place of the scene's own; empty for the scene's own.
        settings: variables of all runs, the reference included.
        reference: settings of the reference that differ from the scene's.
        error: within which the cheapest setting is looked for.
        quick: take the smaller variant.
        over: name -> values with each of which all is run, such as other begins of a motion.
    """

    schemes: tuple[str, ...]
    vary: Variations
    settings: Values
    reference: Values
    error: float
    quick: bool
    over: Variations = field(default_factory=dict)

    def starts(self) -> list[Plan]:
        """Return a plan for each combination of what all is run over."""
        return [
            replace(self, settings=dict(self.settings) | values)
            for values in combinations(self.over)
        ]


@dataclass(frozen=True)
class Study:
    """What a trade-off has found.

    Attributes:
        scene: what was run.
        plan: what was asked for.
        ranks: number of MPI ranks of each run.
        reference: the reference run; None where errors are those of an exact solution.
        points: all settings, in the order of the schemes.
        side_by_side: whether any wall time was measured beside other runs.
    """

    scene: Scene
    plan: Plan
    ranks: int
    reference: Point | None
    points: list[Point]
    side_by_side: bool

    @property
    def quantity(self) -> Quantity:
        """The quantity that ranks the settings."""
        return self.scene.quantities[0]

    def front(self, cost: str) -> list[Point]:
        """Return the points of the Pareto front by one of the costs."""
        return pareto(self.points, self.quantity.name, cost)

    def choices(self, cost: str) -> dict[str, Choice]:
        """Return scheme -> its cheapest setting within the error, by one of the costs."""
        return choices(self.points, self.quantity.name, cost, self.plan.error)

    def best(self, cost: str) -> str | None:
        """Return the scheme with the cheapest setting of all within the error."""
        found = self.choices(cost)
        return min(found, key=lambda scheme: found[scheme].point.cost(cost), default=None)

    def as_json(self) -> dict:
        """Return everything, for the JSON file."""
        fronts = {cost: [_name(point) for point in self.front(cost)] for cost in COSTS}
        return {
            "scene": self.scene.name,
            "quick": self.plan.quick,
            "ranks": self.ranks,
            "settings": dict(self.plan.settings),
            "over": {name: list(values) for name, values in self.plan.over.items()},
            "quantities": [
                {"name": each.name, "description": each.description, "norm": each.norm}
                for each in self.scene.quantities
            ],
            "error": self.plan.error,
            "reference": asdict(self.reference) if self.reference else None,
            "points": [asdict(point) for point in self.points],
            "front": fronts,
            "best": {
                cost: {
                    "overall": self.best(cost),
                    "by_scheme": {
                        scheme: _name(each.point) | {"saving": each.saving}
                        for scheme, each in self.choices(cost).items()
                    },
                }
                for cost in COSTS
            },
            "wall_times_side_by_side": self.side_by_side,
            "versions": versions(),
        }

    def write(self, path: Path) -> None:
        """Write everything as JSON."""
        write_json(path, self.as_json(), allow_nan=False)


def _name(point: Point) -> dict:
    return {"scheme": point.scheme, "values": point.values}


def study(
    scene: Scene,
    plan: Plan,
    out: Path,
    console: Console,
    *,
    ranks: int = 1,
    jobs: int = 1,
    repeat: int = 1,
    fresh: bool = False,
) -> Study:
    """Run a scene with all settings and compare each with the reference run.

    Args:
        scene: what to run.
        plan: with which settings.
        out: output folder; runs that are in it already are not made again.
        console: where the progress appears.
        ranks: number of MPI ranks of a run.
        jobs: number of runs side by side.
        repeat: how often each wall time is measured; the shortest counts.
        fresh: forget what is in the folder.

    Raises:
        UserError: an unknown name, nothing to vary, a reference that failed, or a quantity that
            the log does not have.
    """
    starts = [all_settings(scene, each) for each in plan.starts()]
    workshop = Workshop(scene, out / RUNS, ranks, jobs, console)
    workshop.open(fresh)
    references = [reference for reference, _ in starts]
    workshop.check_columns(references[0])
    firsts = workshop.run(references)
    # a column that is missing is missed here, before all the other runs
    exact = [
        _exact(scene, reference, first, workshop)
        for reference, first in zip(references, firsts, strict=True)
    ]
    timeout = TIMEOUT_FACTOR * jobs * max(first.elapsed_s for first in firsts) + GRACE_SECONDS
    records = iter(
        workshop.run([each for _, settings in starts for each in settings], repeat, timeout)
    )
    at_zero, points, shared = [], [], False
    for (reference, settings), first, histories in zip(starts, firsts, exact, strict=True):
        at_zero.append(_point(scene, reference, first, histories, workshop))
        of_start = [(setting, next(records)) for setting in settings]
        points.append([_point(scene, *each, histories, workshop) for each in of_start])
        shared = shared or any(record.side_by_side for _, record in of_start)
    merged = [mean(each) for each in zip(*points, strict=True)]
    return Study(scene, plan, ranks, mean(at_zero), merged, shared)


def _exact(scene: Scene, reference: Setting, record: Record, workshop: Workshop) -> Histories:
    """Return what a reference run has found; UserError if it is no good."""
    if record.failure is not None:
        raise UserError(
            f"the reference run failed: {record.failure} (log: {workshop.folder(reference)})"
        )
    table = workshop.thermo(reference)
    exact = {each.name: each.history(table) for each in scene.quantities}
    if (wrong := _not_a_number(exact)) is not None:
        raise UserError(f"the reference run is no good: {wrong}")
    return exact


def all_settings(scene: Scene, plan: Plan) -> tuple[Setting, list[Setting]]:
    """Return the reference and all settings to compare with it; UserError for a bad plan."""
    for option, names in (
        ("--vary", plan.vary),
        ("--set", plan.settings),
        ("--reference", plan.reference),
        ("--over", plan.over),
    ):
        scene.check_names(option, names)
    for name in plan.over:
        if name in plan.vary or name in plan.reference:
            raise UserError(
                f"--over {name}: it is varied as well: all runs, the reference too, have each of "
                "its values; leave one out"
            )
    if not (scene.reference or plan.reference):
        raise UserError("which run is the reference? give --reference NAME=VALUE, such as dt=1e-5")
    values = dict(scene.reference) | dict(plan.reference)
    scheme = values.pop("scheme", plan.schemes[0])
    reference = _setting(scene, plan, scheme, values)
    settings = [
        _setting(scene, plan, scheme, each)
        for scheme in plan.schemes
        for each in combinations(variations(scene, plan, scheme))
    ]
    return reference, settings


def variations(scene: Scene, plan: Plan, scheme: str) -> Variations:
    """Return what is varied under a scheme: the user's wish, or else the scene's own.

    Raises:
        UserError: nothing of it acts on the scheme.
    """
    wanted = {name: each for name, each in plan.vary.items() if scene.acts(name, scheme)}
    if wanted:
        return wanted
    own = scene.variations.get(scheme, {})
    if not own:
        raise UserError(
            f"nothing to vary under the scheme {scheme}: give --vary NAME=A,B,... with a "
            f"variable of {scene.script.name}"
        )
    return own


def combinations(varied: Variations) -> list[dict[str, str]]:
    """Return every combination of the values, the last name the fastest."""
    return [dict(zip(varied, each, strict=True)) for each in itertools.product(*varied.values())]


def _setting(scene: Scene, plan: Plan, scheme: str, values: Values) -> Setting:
    shared = {name: value for name, value in plan.settings.items() if name not in values}
    variables = scene.script_variables(scheme, shared | dict(values), plan.quick)
    return Setting(scheme, dict(values), variables)


def _point(
    scene: Scene, setting: Setting, record: Record, exact: Histories, workshop: Workshop
) -> Point:
    """Compare a run with the reference."""
    named = setting.scheme, setting.label, setting.values
    if record.failure is not None:
        return Point(*named, {}, record.failure)
    table = workshop.thermo(setting)
    histories = {each.name: each.history(table) for each in scene.quantities}
    failure = _incomplete(histories, exact) or _not_a_number(histories)
    if failure is not None:
        return Point(*named, {}, failure)
    errors = {
        each.name: each.error(histories[each.name], exact[each.name]) for each in scene.quantities
    }
    if not np.all(np.isfinite(list(errors.values()))):
        return Point(*named, {}, "values too large for an error")
    return Point(*named, errors, None, record.updates, record.steps, record.wall_s)


def _incomplete(histories: Histories, exact: Histories) -> str | None:
    """Say so if a run ends a row of the reference or more before the reference does."""
    end = next(iter(histories.values())).times[-1]
    times = next(iter(exact.values())).times
    if len(times) < 2:
        raise UserError("the log of the reference has one row only: nothing to compare over time")
    return None if end > times[-2] else f"ends at time {end:g}, the reference at {times[-1]:g}"


def _not_a_number(histories: Histories) -> str | None:
    """Say which quantity has a value that is no number; None if all are finite."""
    for name, history in histories.items():
        wrong = ~np.isfinite(history.values)
        if np.any(wrong):
            return f"{name} is not a number at time {history.times[wrong][0]:g}"
    return None
