"""What couette and poiseuille share: water that starts to move between two plates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.trajectory import Frame
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, lattice_density, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# times of the profiles in gap^2 / nu; those of Morris, Fox and Zhu, and the end
TIMES = (0.0225, 0.045, 0.1125, 0.225, 1.0)
# frames until the last of these times: every one of them is a frame
FRAMES = 400
# every how many frames the speed across the plates is looked at
EVERY = 20
# what the order of convergence must reach
ORDER = 1.5


class Start(Protocol):
    """A flow between plates that starts from rest.

    Attributes:
        gap: distance of the plates, m.
        nu: kinematic viscosity, m^2/s.
        fastest: largest speed of the flow that stays in the end, m/s.
    """

    gap: float
    nu: float
    fastest: float

    def drag(self, rho0: float) -> float:
        """Return the drag on the lower plate in the end, force per area."""

    def velocity(self, y: ArrayLike, t: float) -> NDArray[np.float64]:
        """Return the velocity in m/s at heights in m and a time in s."""


PARAMETERS = (
    Parameter("gap", 1e-3, "m", "distance of the plates L", 1e-6, 10.0),
    REST_DENSITY,
    Parameter("nu", 1e-6, "m^2/s", "kinematic viscosity", 1e-9, 1.0),
    Parameter("sound", 20.0, "V", "speed of sound at rest c0", 5.0, 1000.0),
    Parameter("across", 40, "1", "particles across the gap", 16, 400, quick=24),
    Parameter("plates", "planes", "1", "what they are", choices=("planes", "particles")),
    Parameter("viscous", 0.1, "1", "step of constant over smoothing length^2 / nu", 0.01, 0.3),
)

QUANTITIES = (
    Quantity("profile", "1", "largest L2 of the error of the profile, relative", 0.01, 0.02),
    *(Quantity(f"profile_{time:g}", "1", f"the same at {time:g} L^2/nu") for time in TIMES),
    Quantity("drag", "1", "relative error of the drag on the lower plate in the end"),
    Quantity("across", "V", "largest speed across the plates"),
    *order_quantities("of the mean of the profiles' errors"),
    Quantity("order_missing", "1", f"what the order lacks to {ORDER:g}", 0.0, 0.0),
)


def parameters(*own: Parameter) -> tuple[Parameter, ...]:
    """Return the parameters of a case: its own, and those of the flow and of the method."""
    method = numerics(alpha=0.0, courant=0.5, kernel="cubic", tension="yes", disorder=0.0)
    return *PARAMETERS, *own, *method


def measure(flow: Start, values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare their profiles with the series."""
    refined = Refinement.of(partial(_run, flow, values, runner), three(values["across"]))
    errors = [[_error(flow, frame) for frame in _frames(flow, run)] for run in refined.runs]
    orders = refined.orders([compare.rms(each) for each in errors])
    _plot(flow, refined.fine, refined.labeled(errors), runner.picture)
    drag = refined.fine.thermo["v_lower"][-1]
    return {
        "profile": max(errors[-1]),
        **{f"profile_{t:g}": error for t, error in zip(TIMES, errors[-1], strict=True)},
        "drag": drag / flow.drag(values["rho0"]) - 1,
        "across": _largest_across(refined.fine) / flow.fastest,
        **orders,
        "order_missing": compare.order_missing(orders, ORDER),
    }


def _run(flow: Start, values: Mapping[str, Value], runner: Runner, label: str, across: int) -> Run:
    """Run the script with so many particles across."""
    t_last = TIMES[-1] * flow.gap**2 / flow.nu
    # a little longer than the last time, which is a frame then
    t_end, clock = schemes.clock(values, t_last * (FRAMES + 0.5) / FRAMES, FRAMES + 0.5)
    return runner.run(
        label,
        t_end,
        {
            **values,
            **clock,
            "across": across,
            "columns": 2 * math.ceil(values["support"]) + 2,
            "sound": values["sound"] * flow.fastest,
            "lattice": lattice_density(values),
        },
    )


def _frames(flow: Start, run: Run) -> list[Frame]:
    """Return the frames nearest to the times of the profiles."""
    times = run.trajectory.times * flow.nu / flow.gap**2
    return [run.trajectory[int(np.argmin(np.abs(times - time)))] for time in TIMES]


def _error(flow: Start, frame: Frame) -> float:
    """Return the error of the velocities along the plates over the velocities, both by L2."""
    exact = flow.velocity(frame.positions[:, 1], frame.time)
    return compare.rms(frame.velocities[:, 0] - exact) / compare.rms(exact)


def _largest_across(run: Run) -> float:
    seen = (run.trajectory[n] for n in range(0, len(run.trajectory), EVERY))
    return max(float(np.max(np.abs(frame.velocities[:, 1]))) for frame in seen)


def _plot(flow: Start, run: Run, errors: Mapping[str, list[float]], path: Path) -> None:
    """Draw the profiles of the fine run, and the errors of both runs over time."""
    figure, (profile, error) = compare.panels(1, 2)
    y = np.linspace(0, flow.gap, 200)
    for time, frame in zip(TIMES, _frames(flow, run), strict=True):
        profile.plot(flow.velocity(y, frame.time) / flow.fastest, y / flow.gap, "k-", lw=0.8)
        speed = frame.velocities[:, 0] / flow.fastest
        profile.plot(speed, frame.positions[:, 1] / flow.gap, ".", ms=4, label=f"{time:g}")
    profile.set(xlabel="velocity / V", ylabel="y / L", title="SPH (dots) and series (lines)")
    profile.legend(title="t nu / L^2")
    for label, each in errors.items():
        error.loglog(TIMES, 100 * np.array(each), "o-", label=label)
    error.set(xlabel="t nu / L^2", ylabel="L2 of the error (%)")
    error.legend()
    compare.save(figure, path)
