"""Every reference solution is public, documented, and refuses what cannot be."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from sphcloth import references
from sphcloth.errors import UserError


@pytest.mark.parametrize("name", references.__all__)
def test_each_solution_says_what_it_is(name: str) -> None:
    solution = getattr(references, name)
    assert inspect.getdoc(solution)
    assert len(inspect.getdoc(inspect.getmodule(solution))) > 60
    for member, value in vars(solution).items() if inspect.isclass(solution) else ():
        if not member.startswith("_") and callable(getattr(value, "fget", value)):
            assert inspect.getdoc(value), f"{name}.{member}"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: references.TaitColumn(1, 1000, 9.81, 20, 1.0), "gamma = 1: it must be above 1"),
        (lambda: references.HangingPolygon(20, 1.0, 1.2, 0.05, 9.81), "below the length, 1"),
        (lambda: references.CouetteStart(1e-3, 0.0, 1e-5), "CouetteStart: nu = 0"),
        (lambda: references.PoiseuilleStart(math.nan, 1e-6, 1.0), "PoiseuilleStart: gap = nan"),
        (lambda: references.StandingWave(-1.0, 2.0, 9.81), "StandingWave: depth = -1"),
        (lambda: references.TaitColumn(1, 1000, -9.81, 20, 7.0), "gravity = -9.81: it must not be"),
        (lambda: references.HangingChain(5, 1, 1, -1e-3, 9.81), "compliance = -0.001: it must not"),
        (lambda: references.LinkedPendulum([1, 0], [1, 1], [0, 0], 9.81), r"lengths = \[1, 0\]"),
        (lambda: references.HeavyElastica(0.0), "HeavyElastica: gamma = 0"),
        (lambda: references.Lintearia(1.0, 0.6, 0.0, 1000, 9.81), "Lintearia: area = 0"),
        (lambda: references.pendulum_period(1.0, 9.81, 3.2), "amplitude = 3.2"),
    ],
)
def test_parameters_without_a_scene_are_refused(make: Callable, message: str) -> None:
    with pytest.raises(UserError, match=message):
        make()


# possible parameters of each solution; FilledSheet has arrays
GOOD = {
    "BreathingShell": (1.0, 1.0, 10.0, 1.4, 0.1),
    "Bulge": (1.0, 1.1, 10.0),
    "Collision": (1.0, 1.0, 1.0, 0.5),
    "Column": (1.0, 9.81),
    "CouetteStart": (1e-3, 1e-6, 1e-5),
    "DrainingColumn": (1.0, 1e3, 1e3, 1e3, 9.81),
    "EllipticDrop": (1.0, 1.0),
    "FallingSheet": (1.0, 1.0, 1.0, 9.81),
    "HangingChain": (5, 1.0, 1.0, 1e-3, 9.81),
    "HangingPolygon": (5, 1.0, 0.6, 1.0, 9.81),
    "HeavyElastica": (5.0,),
    "HeavyLintearia": (references.Lintearia(1.0, 0.6, 0.08, 1e3, 9.81), 0.1),
    "Jet": (1.0, 1.0, 0.5, 1e3),
    "LinkedPendulum": ([1.0, 1.0], [1.0, 1.0], [0.1, 0.2], 9.81),
    "Lintearia": (1.0, 0.6, 0.08, 1e3, 9.81),
    "Load": (1.0, 1.0, 1.0, 1e3, 9.81),
    "Oscillator": (1.0, 1.0, 0.01),
    "Piston": (1.0, 1e3, 1.0, 1e3, 30.0),
    "PoiseuilleStart": (1e-3, 1e-6, 1.0),
    "PressurizedMembrane": (1.0, 10.0, 1e4),
    "PressurizedNet": (1.0, 10.0, 1e4),
    "StandingWave": (1.0, 2.0, 9.81),
    "TaitColumn": (1.0, 1e3, 9.81, 31.3, 7.0),
    "TaylorGreen": (100.0,),
    "TurnedJet": (1.0, 1.0, 1e3),
    "WindPendulum": (1.0, 1.0, 1.0, 1.0, 0.1, 9.81),
}


def test_all_solutions_with_parameters_are_here() -> None:
    named = {name: getattr(references, name) for name in references.__all__}
    assert {name for name, each in named.items() if is_dataclass(each)} == {*GOOD, "FilledSheet"}


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("name", GOOD)
def test_parameters_are_finite(name: str, bad: float) -> None:
    solution, given = getattr(references, name), list(GOOD[name])
    solution(*given)
    for place, (field, value) in enumerate(zip(fields(solution), given, strict=False)):
        if is_dataclass(value):
            continue
        wrong = [bad, *value[1:]] if isinstance(value, list) else bad
        with pytest.raises(UserError, match=rf"{name}: {field.name} = .*: it must be "):
            solution(*given[:place], wrong, *given[place + 1 :])


def solution(name: str) -> object:
    """Return a solution with possible parameters."""
    return getattr(references, name)(*GOOD[name])


# solution, method, its arguments behind the places, the first and the last place
PLACES = [
    ("CouetteStart", "velocity", (0.1,), 0.0, 1e-3),
    ("PoiseuilleStart", "velocity", (0.1,), 0.0, 1e-3),
    ("TaitColumn", "pressure", (), 0.0, 1.0),
    ("TaitColumn", "level", (), 0.0, 1.0),
    ("Lintearia", "shape", (), -0.5, 0.5),
    ("HeavyLintearia", "shape", (), -0.5, 0.5),
    ("HeavyLintearia", "pull", (), -0.5, 0.5),
    ("HeavyElastica", "shape", (), 0.0, 1.0),
    ("PressurizedMembrane", "deflection", (), 0.0, 1.0),
    ("PressurizedNet", "deflection", (), 0.0, 1.0),
]
# solution, method, its arguments before the times
TIMES = [
    ("CouetteStart", "velocity", (1e-4,)),
    ("PoiseuilleStart", "velocity", (1e-4,)),
    ("FallingSheet", "velocity", ()),
    ("FallingSheet", "fall", ()),
    ("DrainingColumn", "levels", ()),
    ("WindPendulum", "swing", (1.0,)),
    ("LinkedPendulum", "positions", ()),
    ("BreathingShell", "volumes", ()),
]


@pytest.mark.parametrize(("name", "method", "after", "first", "last"), PLACES)
def test_places_beyond_a_solution_are_refused(
    name: str, method: str, after: tuple, first: float, last: float
) -> None:
    value, size = getattr(solution(name), method), last - first
    ends = np.array([first, last])
    at_ends = value(ends, *after)
    # positions in a dump are rounded
    rounded = value(ends + size * np.array([-1e-6, 1e-6]), *after)
    np.testing.assert_array_equal(rounded, at_ends)
    for wrong in (first - 0.01 * size, last + 0.01 * size, math.nan, "here"):
        with pytest.raises(
            UserError, match=rf"{name}: \w+ = {wrong}: it must be from {first:g} to"
        ):
            value([wrong] if isinstance(wrong, float) else wrong, *after)


@pytest.mark.parametrize(("name", "method", "before"), TIMES)
@pytest.mark.parametrize("wrong", [-1.0, math.nan])
def test_times_before_the_start_are_refused(
    name: str, method: str, before: tuple, wrong: float
) -> None:
    value = getattr(solution(name), method)
    is_flow = name in ("CouetteStart", "PoiseuilleStart")
    assert np.all(np.isfinite(value(*before, 0.5 if is_flow else np.array([0.5]))))
    with pytest.raises(UserError, match=f"{name}: time = {wrong:g}: it must be from 0, the start"):
        value(*before, wrong if is_flow else np.array([wrong]))


def test_levels_of_a_draining_column_need_no_order() -> None:
    column = solution("DrainingColumn")
    times = np.array([0.0, 0.1, 0.3])
    np.testing.assert_allclose(column.levels(times[::-1]), column.levels(times)[::-1], rtol=1e-12)


def test_limits_of_parameters_have_their_scene() -> None:
    weightless = references.TaitColumn(2.0, 1e3, 0.0, 31.3, 7.0)
    assert weightless.settlement == 0
    np.testing.assert_array_equal(weightless.level([0.0, 0.5, 2.0]), [2.0, 1.5, 0.0])
    light = references.TaitColumn(2.0, 1e3, 1e-9, 31.3, 7.0)
    assert light.settlement == pytest.approx(0, abs=1e-10)
    rigid = references.HangingChain(5, 1.0, 1.0, 0.0, 9.81)
    assert (rigid.slowest, rigid.stretch) == (math.inf, 0)


def test_vortices_decay_and_have_no_divergence() -> None:
    flow, side = references.TaylorGreen(100.0), np.linspace(0, 1, 5)
    places = np.stack([side, 0.3 + 0.1 * side], axis=1)
    later = flow.velocity(places, flow.time(0.5))
    np.testing.assert_allclose(later, 0.5 * flow.velocity(places, 0.0))
    h = 1e-6
    slope = [
        (flow.velocity(places + h * e, 0.1) - flow.velocity(places - h * e, 0.1)) @ e / (2 * h)
        for e in np.eye(2)
    ]
    np.testing.assert_allclose(np.sum(slope, axis=0), 0, atol=1e-8)


def test_surface_of_a_standing_wave() -> None:
    wave = references.StandingWave(depth=1.0, length=2.0, gravity=9.81)
    assert wave.surface(0.0, 0.0, 0.01) == pytest.approx(0.01)
    assert wave.surface(1.0, wave.period / 2, 0.01) == pytest.approx(0.01)
    # the surface moves as the mode at z = depth: for the phase a quarter of a period later
    top = np.array([[0.3, 1.0]])
    rise = wave.surface(0.3, 1e-6 - wave.period / 4, 1.0) / 1e-6 / (2 * np.pi / wave.period)
    assert rise == pytest.approx(wave.mode(top)[0, 1], rel=1e-6)
