"""A flat net towed across its plane: its drag against measurements."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sphcloth.references.net_drag import MEASURED, measured_drag
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, numerics
from sphcloth.validation.refinement import Refinement, three
from sphcloth.validation.runner import Run, Runner

FRAMES = 10
# share of the run at its end over which the drag is averaged
LATE = 0.5
REFINED = "0.2"

PARAMETERS = (
    Parameter("twine", 2e-3, "m", "diameter of the twines", 1e-5, 0.1),
    Parameter("side", 0.5, "m", "of the net", 1e-2, 100.0),
    Parameter("speed", 0.4, "m/s", "of the tow", 1e-2, 10.0),
    Parameter("nu", 1e-6, "m^2/s", "viscosity of the water", 1e-9, 1e-2),
    REST_DENSITY,
    Parameter("sound", 15.0, "1", "speed of sound over that of the tow", 5.0, 100.0),
    Parameter("across", 10, "1", "particles over the side", 4, 100, quick=6),
    Parameter("wide", 3.0, "1", "box across the tow over the side", 1.5, 10.0, quick=2.5),
    Parameter("long", 4.0, "1", "box along the tow over the side", 2.0, 20.0, quick=3.0),
    Parameter("time", 2.5, "side/speed", "of the tow", 1.0, 10.0, quick=2.0),
    *numerics(alpha=0.05, courant=0.5, support=2.0, tension="yes", scheme="global"),
)

# of the measured drag; at small solidities the law of the screen is above it by more
LIMITS = {0.15: (None, None), 0.2: (0.1, 0.1), 0.3: (0.1, 0.1)}

QUANTITIES = (
    *(
        Quantity(f"drag_{s:g}", "1", f"drag at solidity {s:g} / measured - 1", *limits)
        for s, limits in LIMITS.items()
    ),
    Quantity("measured", "1", f"drag coefficient at solidity {REFINED}"),
    Quantity(
        "coarse", "1", "its drag with 0.6 times the particles over the side / fine - 1", 0.1, 0.1
    ),
    Quantity(
        "middle", "1", "its drag with 0.77 times the particles over the side / fine - 1", 0.1, 0.1
    ),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Tow nets of several solidities, one of them at three resolutions."""
    refined = Refinement.of(
        lambda label, across: _run(values, runner, label, float(REFINED), across),
        three(values["across"], 0.6, 4),
    )
    runs = {
        solidity: refined.fine
        if f"{solidity:g}" == REFINED
        else _run(values, runner, f"solidity_{solidity:g}", solidity, values["across"])
        for solidity in LIMITS
    }
    drags = {solidity: _drag(run) for solidity, run in runs.items()}
    coarse, middle, fine = (_drag(run) for run in refined.runs)
    _plot(drags, runs, runner.picture)
    return {
        **{f"drag_{s:g}": drag / measured_drag(s) - 1 for s, drag in drags.items()},
        "measured": measured_drag(float(REFINED)),
        "coarse": coarse / fine - 1,
        "middle": middle / fine - 1,
    }


def _run(
    values: Mapping[str, Value], runner: Runner, label: str, solidity: float, across: int
) -> Run:
    time = values["time"] * values["side"] / values["speed"]
    t_end, clock = schemes.clock(values, time, FRAMES)
    dropped = ("sound", "time", "gain", "across", "disorder")
    shared = {key: values[key] for key in values if key not in dropped}
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "solidity": solidity,
            "across": across,
            "sound": values["sound"] * values["speed"],
            "rise": 0.3 * values["side"] / values["speed"],
        },
    )


def _drag(run: Run) -> float:
    """Return the mean drag coefficient late in the run."""
    time = run.thermo["Time"]
    late = compare.late(time, LATE)
    return float(np.average(run.thermo["v_coefficient"][late], weights=run.thermo["Dt"][late]))


def _plot(drags: Mapping[float, float], runs: Mapping[float, Run], path: Path) -> None:
    """Draw the drag over the solidity and over time."""
    figure, (over, along) = compare.panels(1, 2)
    fine = np.linspace(*MEASURED, 50)
    over.plot(fine, [measured_drag(s) for s in fine], "k-", label="measured (fit)")
    over.plot(list(drags), list(drags.values()), "o", label="fix cloth/pores")
    over.set(xlabel="solidity", ylabel="drag coefficient")
    over.legend()
    for solidity, run in runs.items():
        moving = run.thermo["v_tow"] > 0.5 * run.thermo["v_tow"][-1]
        along.plot(
            run.thermo["Time"][moving],
            run.thermo["v_coefficient"][moving],
            lw=1,
            label=f"{solidity:g}",
        )
    along.set(xlabel="time (s)", ylabel="drag coefficient")
    along.legend()
    compare.save(figure, path)


CASE = Case(
    "net-drag",
    "a net towed through water: measured drag",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
