"""Start-up of plane Couette flow, in two dimensions, periodic along the plates."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sphcloth.references.couette import CouetteStart
from sphcloth.validation import channel
from sphcloth.validation.case import Case, Parameter, Value
from sphcloth.validation.runner import Runner

PARAMETERS = channel.parameters(
    Parameter("lid", 1.25e-5, "m/s", "velocity V of the upper plate", 1e-9, 10.0),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run two resolutions and compare their profiles with the series."""
    flow = CouetteStart(values["gap"], values["nu"], values["lid"])
    return channel.measure(flow, values, runner)


CASE = Case(
    "couette",
    "water set in motion by a sliding plate: series solution",
    PARAMETERS,
    channel.QUANTITIES,
    measure,
    Path(__file__).parent,
)
