"""The collapse of a column of water on a dry floor, in two dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references import dam_break
from sphcloth.references.dam_break import Column
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY, REST_DENSITY, lattice_density, numerics
from sphcloth.validation.refinement import Refinement
from sphcloth.validation.runner import Run, Runner

# shares of the particles over the width, from the coarsest run to the finest
SHARES = {"coarse": 0.25, "middle": 0.5, "fine": 1.0}
# rate of the damping while the column settles, in c0 / height
DAMPING = 3.2
# the collapse ends at this T, past all that is compared
END = 3.3
FRAMES = 66

PARAMETERS = (
    Parameter("width", 0.05715, "m", "width a of the column, 2 a high", 1e-3, 100.0),
    REST_DENSITY,
    GRAVITY,
    Parameter("sound", 20.0, "sqrt(2 g a)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("nu", 1e-6, "m^2/s", "kinematic viscosity", 0.0, 1.0),
    Parameter("slip", "no", "1", "whether the walls are smooth", choices=("no", "yes")),
    Parameter("across", 64, "1", "particles over the width", 24, 400, quick=32),
    Parameter("settle", 3.0, "sqrt(2 a/g)", "time of damping behind the gate", 1.0, 100.0),
    *numerics(alpha=0.1, courant=0.5),
)

QUANTITIES = (
    Quantity("front", "1", "largest excess of the front over the band of experiments", 0.05, 0.05),
    Quantity("front_rms", "1", "the same, rms"),
    Quantity("front_unshifted", "1", "largest excess without the shift of time"),
    Quantity("shift", "sqrt(a/2g)", "shift of time that fits best", dam_break.LARGEST_SHIFT),
    Quantity("front_middle", "a", "rms difference of the half resolution from the finest run"),
    Quantity("front_coarse", "a", "the same of a quarter of the resolution"),
    Quantity("energy_loss", "1", "loss of all energy over the potential energy at first"),
    Quantity("densest", "1", "largest compression of a particle in the collapse"),
    Quantity("order", "1", "order of convergence of the front, by three runs"),
)


@dataclass(frozen=True)
class Front:
    """The front of the water over time.

    Attributes:
        times: T since the column was set free.
        places: Z at these times, 1 at the start.
    """

    times: NDArray[np.float64]
    places: NDArray[np.float64]

    @classmethod
    def of(cls, run: Run, column: Column) -> Front:
        """Measure a run: how far the foremost particle is ahead of the one at the start."""
        foremost = np.array([np.max(frame.positions[:, 0]) for frame in run.trajectory])
        since = run.trajectory.times - run.trajectory.times[0]
        return cls(since / column.time, 1 + (foremost - foremost[0]) / column.width)

    def difference(self, other: Front) -> float:
        """Return the rms difference of two fronts at the times that experiments cover."""
        times = dam_break.COMPARED
        mine = np.interp(times, self.times, self.places)
        return compare.rms(mine - np.interp(times, other.times, other.places))


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions, compare the finest with experiments and the others with it."""
    column = Column(values["width"], values["gravity"])
    across = {label: round(share * values["across"]) for label, share in SHARES.items()}
    runs = Refinement.of(partial(_run, column, values, runner), across)
    fronts = [Front.of(run, column) for run in runs.runs]
    coarse, middle, fine = fronts
    shift = dam_break.best_shift(fine.times, fine.places)
    excess = dam_break.outside(fine.times, fine.places, shift)
    unshifted = dam_break.outside(fine.times, fine.places, 0.0)
    _plot(column, runs.labeled(fronts), runs.fine, shift, runner.picture)
    differences = [coarse.difference(middle), middle.difference(fine)]
    return {
        "front": _largest(excess),
        "front_rms": compare.rms(excess),
        "front_unshifted": _largest(unshifted),
        "shift": shift,
        "front_middle": middle.difference(fine),
        "front_coarse": coarse.difference(fine),
        "energy_loss": _energy_loss(runs.fine, column),
        "densest": float(np.max(_collapse(runs.fine, "v_densest"))),
        "order": compare.order(differences, [across["coarse"], across["middle"]]),
    }


def _run(
    column: Column, values: Mapping[str, Value], runner: Runner, label: str, across: int
) -> Run:
    """Run the script with so many particles over the width."""
    sound = values["sound"] * math.sqrt(2 * column.gravity * column.width)
    t_settle = values["settle"] * math.sqrt(2 * column.width / column.gravity)
    shared = {name: value for name, value in values.items() if name != "settle"}
    t_end, clock = schemes.clock(values, t_settle + END * column.time, FRAMES, t_settle)
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "across": across,
            "sound": sound,
            "lattice": lattice_density(values),
            "damping": DAMPING * sound / (2 * column.width),
        },
    )


def _largest(excess: NDArray) -> float:
    """Return the value that is farthest from 0, with its sign."""
    return float(excess[np.argmax(np.abs(excess))])


def _collapse(run: Run, name: str) -> NDArray[np.float64]:
    """Return a column of the thermo output from the moment on when the gate is gone."""
    return run.thermo[name][run.thermo["Time"] > run.trajectory.times[0]]


def _energies(run: Run, column: Column) -> dict[str, NDArray[np.float64]]:
    """Return the energies in the collapse over the potential energy of the column."""
    scale = _collapse(run, "v_mass") * column.energy
    return {
        name: _collapse(run, f"v_{name}") / scale for name in ("kinetic", "potential", "elastic")
    }


def _energy_loss(run: Run, column: Column) -> float:
    total = np.sum(list(_energies(run, column).values()), axis=0)
    return float(total[0] - total[-1])


def _plot(column: Column, seen: Mapping[str, Front], run: Run, shift: float, path: Path) -> None:
    """Draw the front of each run beside the experiments, and the energies of the finest run."""
    figure, (front, energy) = compare.panels(2)
    for (label, each), style in zip(seen.items(), (":", "--", "-"), strict=True):
        front.plot(each.times, each.places, style, color="C0", lw=1, label=label)
    fine = seen["fine"]
    front.plot(fine.times + shift, fine.places, "C3-", lw=1, label=f"fine, shifted by {shift:.2f}")
    times = dam_break.COMPARED
    lower, upper = dam_break.band(times)
    front.fill_between(times, 0.95 * lower, 1.05 * upper, color="gray", alpha=0.2, label="limit")
    for marker, (name, points) in zip("os", dam_break.EXPERIMENTS.items(), strict=True):
        front.plot(*points.T, marker, color="k", ms=4, label=name)
    front.set(xlabel="t sqrt(2 g / a)", ylabel="x / a")
    front.legend(fontsize="small")
    since = (_collapse(run, "Time") - run.trajectory.times[0]) / column.time
    energies = _energies(run, column)
    for name, values in energies.items():
        energy.plot(since, values, label=name)
    energy.plot(since, np.sum(list(energies.values()), axis=0), "k-", lw=0.8, label="sum")
    energy.set(xlabel="t sqrt(2 g / a)", ylabel="energy / (m g a)")
    energy.legend()
    compare.save(figure, path)


CASE = Case(
    "dam-break",
    "front of a collapsing column: experiments, finest run",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
