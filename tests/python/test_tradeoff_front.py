"""Pareto fronts, means over runs and the cheapest settings, by hand."""

from __future__ import annotations

import pytest

from sphcloth.tradeoff.front import Point, cheapest, choices, mean, pareto


def point(scheme: str, updates: float, error: float, wall: float = 1.0) -> Point:
    return Point(scheme, f"{updates:g}", {}, {"q": error}, None, updates, 1, wall)


def test_the_front_holds_what_nothing_beats_in_both() -> None:
    points = [point("a", *each) for each in [(4, 0.1), (1, 0.9), (2, 0.5), (3, 0.5), (5, 0.2)]]
    assert [each.updates for each in pareto(points, "q", "updates")] == [1, 2, 4]


def test_of_two_at_the_same_cost_the_better_one_is_on_the_front() -> None:
    points = [point("a", 1, 0.9), point("b", 1, 0.5)]
    assert pareto(points, "q", "updates") == [points[1]]


def test_a_failed_run_is_on_no_front_and_never_the_cheapest() -> None:
    failed = Point("a", "0", {}, {}, "blew up")
    well = point("a", 9, 0.001)
    assert pareto([failed, well], "q", "updates") == [well]
    assert cheapest([failed, well], "q", "updates", 0.01) == well
    assert cheapest([failed], "q", "updates", 0.01) is None


def test_means_are_over_all_runs_and_one_failure_is_one_too_many() -> None:
    points = [point("a", 4, 0.1, 2.0), point("a", 6, 0.3, 3.0)]
    both = mean(points)
    assert (both.updates, both.wall_s, both.steps) == (5, 2.5, 1)
    assert both.errors == {"q": pytest.approx(0.2)}
    assert both.worst == {"q": 0.3}
    failed = mean([*points, Point("a", "4", {}, {}, "blew up")])
    assert failed.failure == "1 of 3 runs: blew up"
    assert pareto([failed], "q", "updates") == []


def test_savings_are_against_the_cheapest_baseline_within_the_error() -> None:
    points = [
        point("constant", 8, 0.009, wall=2.0),
        point("constant", 4, 0.02, wall=1.0),
        point("individual", 2, 0.005, wall=4.0),
        point("individual", 1, 0.5, wall=0.1),
    ]
    found = choices(points, "q", "updates", 0.01)
    assert found["individual"].point.updates == 2
    assert found["individual"].saving == {"constant": 4.0, "global": None}
    assert choices(points, "q", "wall_s", 0.01)["individual"].saving["constant"] == 0.5
    assert choices(points, "q", "updates", 1e-4) == {}
