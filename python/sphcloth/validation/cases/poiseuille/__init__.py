"""Start-up of plane Poiseuille flow, in two dimensions, periodic along the plates."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sphcloth.references.poiseuille import PoiseuilleStart
from sphcloth.validation import channel
from sphcloth.validation.case import Case, Parameter, Value
from sphcloth.validation.runner import Runner

PARAMETERS = channel.parameters(
    Parameter("drive", 1e-4, "m/s^2", "acceleration along the plates", 1e-9, 100.0),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run two resolutions and compare their profiles with the series."""
    flow = PoiseuilleStart(values["gap"], values["nu"], values["drive"])
    return channel.measure(flow, values, runner)


CASE = Case(
    "poiseuille",
    "water set in motion by a force: series solution",
    PARAMETERS,
    channel.QUANTITIES,
    measure,
    Path(__file__).parent,
)
