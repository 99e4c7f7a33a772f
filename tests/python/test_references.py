"""Every reference solution is public, documented, and refuses what cannot be."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable

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
        (lambda: references.HeavyElastica(0.0), "HeavyElastica: gamma = 0"),
        (lambda: references.Lintearia(1.0, 0.6, 0.0, 1000, 9.81), "Lintearia: area = 0"),
        (lambda: references.pendulum_period(1.0, 9.81, 3.2), "amplitude = 3.2"),
    ],
)
def test_parameters_without_a_scene_are_refused(make: Callable, message: str) -> None:
    with pytest.raises(UserError, match=message):
        make()


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
