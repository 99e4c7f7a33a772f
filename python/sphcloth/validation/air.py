"""What the cases of cloth in air share: parameters, rank counts and distances between runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from sphcloth.validation import cloth, schemes
from sphcloth.validation.case import Parameter, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.runner import Run, Runner

# time steps of the runs of the order of convergence, in that of the case
STEPS = {"coarse": 4.0, "middle": 2.0, "fine": 1.0}

DENSITY = Parameter("air", 1.2, "kg/m^3", "density of the air", 1e-6, 1e3)
NORMAL = Parameter("normal", 1.17, "1", "coefficient across the sheet", 1e-3, 10.0)
TANGENTIAL = Parameter("tangential", 0.05, "1", "coefficient along the sheet", 0.0, 10.0)
RANKS = Parameter("most_ranks", 4, "1", "of the runs that are compared", 1, 64, quick=2)


def parameters(dt: float, areal: float, ceiling: float = 2.0) -> tuple[Parameter, ...]:
    """Return the parameters of air, solver and step.

    Args:
        dt: default of the step of constant, s.
        areal: default of the mass per area, kg/m^2.
        ceiling: default of the longest step of the other schemes over that of constant.
    """
    return (
        Parameter("areal", areal, "kg/m^2", "mass per area", 1e-4, 1e3),
        DENSITY,
        NORMAL,
        TANGENTIAL,
        GRAVITY,
        RANKS,
        *cloth.solver(dt, 10, method="substeps"),
        *schemes.parameters(ceiling=ceiling),
    )


def run_for(
    values: Mapping[str, Value],
    runner: Runner,
    label: str,
    t_end: float,
    frames: int,
    dropped: tuple[str, ...],
) -> Run:
    """Run the script up to a time.

    Args:
        values: of all parameters.
        runner: of the case.
        label: of the run.
        t_end: end of the run, s.
        frames: number of frames up to there.
        dropped: parameters that the script does not know.
    """
    end, clock = schemes.clock(values, t_end, frames)
    skipped = (*dropped, "most_ranks", "gain")
    shared = {name: values[name] for name in values if name not in skipped}
    return runner.run(label, end, shared | clock)


def ranks(values: Mapping[str, Value], runner: Runner, run: Callable[[Runner, str], Run]) -> float:
    """Return how far vertices of runs on 2, 4, ... ranks end from those of a run on one, m."""
    on_ranks = runner.on_ranks(values["most_ranks"])
    alone, *others = (run(each, label) for label, each in on_ranks.items())
    ends = [alone.trajectory[-1].positions - each.trajectory[-1].positions for each in others]
    return max((float(np.max(np.abs(end))) for end in ends), default=0.0)
