"""Decaying Taylor-Green vortices, in two dimensions, periodic along both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.taylor_green import TaylorGreen
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import numerics
from sphcloth.validation.lattice import density_sum
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

FRAMES = 100

PARAMETERS = (
    Parameter("reynolds", 100.0, "1", "U L / viscosity", 1.0, 1e4),
    Parameter("rho0", 1.0, "kg/m^3", "rest density", 1e-3, 1e5),
    Parameter("sound", 10.0, "U", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 100, "1", "particles over the side", 20, 400, quick=50),
    Parameter("until", 0.2, "U", "speed of the exact solution at the end", 0.01, 0.9, quick=0.3),
    Parameter("shift", 1.0, "1", "strength of the shifting, 0 for none", 0.0, 10.0),
    Parameter("clumping", 0.2, "1", "term of the shifting against clumping", 0.0, 10.0),
    Parameter("correct", "no", "1", "whether shifting corrects velocities", choices=("no", "yes")),
    *numerics(
        alpha=0.0,
        courant=0.8,
        kernel="quintic",
        support=5.0,
        tension="yes",
        disorder=0.2,
        density="continuity",
    ),
)

QUANTITIES = (
    Quantity(
        "decay", "1", "relative error of the rate at which the largest speed falls", 0.02, 0.05
    ),
    Quantity("decay_energy", "1", "the same of half the rate of the kinetic energy", 0.02, 0.05),
    Quantity("decay_mode", "1", "the same of the strength of the vortices"),
    Quantity("rate_measured", "1/s", "the rate of the largest speed itself"),
    Quantity("rate_reference", "1/s", "8 pi^2 / Re"),
    Quantity("velocity", "U", "rms error of the velocities, largest over time"),
    Quantity("density", "1", "largest departure of the density over rho0"),
    *order_quantities("of decay"),
)


@dataclass(frozen=True)
class Decay:
    """The vortices over time.

    Attributes:
        times: s.
        largest: largest speed of any particle.
        energy: kinetic energy over that at the start.
        strength: of the exact solution's velocities in those of the particles.
        errors: rms of the velocities' errors.
    """

    times: NDArray[np.float64]
    largest: NDArray[np.float64]
    energy: NDArray[np.float64]
    strength: NDArray[np.float64]
    errors: NDArray[np.float64]

    @classmethod
    def of(cls, run: Run, flow: TaylorGreen) -> Decay:
        """Measure a run."""
        rows = []
        for frame in run.trajectory:
            velocities = frame.velocities[:, :2]
            mode = flow.mode(frame.positions)
            square = np.sum(velocities**2, axis=1)
            strength = np.sum(mode * velocities) / np.sum(mode**2)
            exact = flow.velocity(frame.positions, frame.time)
            error = math.sqrt(np.mean(np.sum((velocities - exact) ** 2, axis=1)))
            rows.append((math.sqrt(square.max()), square.mean(), strength, error))
        largest, energy, strength, errors = np.transpose(rows)
        times = run.trajectory.times
        return cls(times, largest, energy / energy[0], strength, errors)

    def rate(self, values: NDArray) -> float:
        """Return the rate at which values fall: a line through their logarithms, least squares."""
        if not np.all(np.isfinite(values)):
            return math.nan
        return -float(np.polyfit(self.times, np.log(values), 1)[0])


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare the decay of the finer one with the exact one."""
    flow = TaylorGreen(values["reynolds"])
    refined = Refinement.of(partial(_run, flow, values, runner), three(values["across"]))
    seen = [Decay.of(run, flow) for run in refined.runs]
    _plot(flow, refined.labeled(seen), runner.picture)
    fine, thermo = seen[-1], refined.fine.thermo
    errors = [each.rate(each.largest) / flow.rate - 1 for each in seen]
    return {
        "decay": errors[-1],
        "decay_energy": 0.5 * fine.rate(fine.energy) / flow.rate - 1,
        "decay_mode": fine.rate(np.abs(fine.strength)) / flow.rate - 1,
        "rate_measured": fine.rate(fine.largest),
        "rate_reference": flow.rate,
        "velocity": float(np.max(fine.errors)),
        "density": float(max(np.max(thermo["v_most"]) - 1, 1 - np.min(thermo["v_least"]))),
        **refined.orders(errors),
    }


def _run(
    flow: TaylorGreen, values: Mapping[str, Value], runner: Runner, label: str, across: int
) -> Run:
    """Run the script with so many particles over the side."""
    shared = {name: value for name, value in values.items() if name != "until"}
    summed = values["density"] == "summation"
    lattice = density_sum(values["kernel"], values["support"]) if summed else 1.0
    t_end, clock = schemes.clock(values, flow.time(values["until"]), FRAMES)
    return runner.run(label, t_end, shared | clock | {"across": across, "lattice": lattice})


def _plot(flow: TaylorGreen, seen: Mapping[str, Decay], path: Path) -> None:
    """Draw the largest speed and the energy over time, and the errors of the velocities."""
    figure, (decay, error) = compare.panels(2)
    for label, each in seen.items():
        (line,) = decay.semilogy(each.times, each.largest, label=f"{label}, largest speed")
        color = line.get_color()
        root = np.sqrt(each.energy)
        decay.semilogy(each.times, root, ":", color=color, label=f"{label}, root of the energy")
        error.plot(each.times, each.errors, color=color, label=label)
    times = each.times[[0, -1]]
    decay.semilogy(times, np.exp(-flow.rate * times), "k--", lw=0.8, label="exact")
    decay.set(ylabel="over the value at the start")
    error.set(xlabel="time / (L/U)", ylabel="rms error of the velocities / U")
    for axes in (decay, error):
        axes.legend()
    compare.save(figure, path)


CASE = Case(
    "taylor-green",
    "decay of Taylor-Green vortices: exact solution",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
