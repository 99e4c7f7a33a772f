"""A drop that oscillates in a central force field, in two dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sphcloth.references.oscillating_drop import EllipticDrop
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, lattice_density, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# while the drop settles: rate of the damping and time, in omega and 1/omega
DAMPING, SETTLE = 10.0, 2.0
# half the box over the largest semi-axis
ROOM = 1.5
FRAMES_PER_PERIOD = 50

PARAMETERS = (
    Parameter("radius", 1.0, "m", "radius R", 1e-3, 100.0),
    REST_DENSITY,
    Parameter("omega", 1.0, "1/s", "of the force field -omega^2 r", 1e-2, 1e2),
    Parameter("sigma", 0.5, "omega", "rate of strain at the start", 0.05, 2.0),
    Parameter("sound", 20.0, "omega R", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 80, "1", "particles over the radius", 10, 400, quick=40),
    Parameter("periods", 1, "T", "time of the motion", 1, 50),
    Parameter("shift", 0.1, "1", "strength of the shifting, 0 for none", 0.0, 10.0),
    *numerics(alpha=0.0, courant=1.0, kernel="wendland/c4", support=5.0, density="continuity"),
)

QUANTITIES = (
    Quantity("semi_axis", "R", "largest error of a semi-axis in the first period", 1e-3, 1e-2),
    Quantity("semi_axis_rms", "R", "rms error of both semi-axes in the first period"),
    Quantity("period", "1", "relative error of the period", 2e-3, 5e-3),
    Quantity("period_measured", "s", "the period itself"),
    Quantity("period_reference", "s", "ideal, incompressible fluid"),
    Quantity("energy_loss", "1", "loss of energy per period over the kinetic energy at first"),
    Quantity("motion_loss", "1", "the same of the energy of the strained drop as a whole"),
    Quantity("rest_radius", "R", "radius at rest by the second moments - R"),
    *order_quantities("of the semi-axes' rms error"),
)


@dataclass(frozen=True)
class Motion:
    """The drop over time, from second moments; an ellipse of semi-axis A has <x^2> = A^2 / 4.

    Attributes:
        times: since the start of the motion, s.
        axes: semi-axes along x and y over the radius at rest, shape (2, frames).
        rest_radius: radius at the start of the motion, m.
    """

    times: NDArray[np.float64]
    axes: NDArray[np.float64]
    rest_radius: float

    @classmethod
    def of(cls, run: Run) -> Motion:
        """Measure a run."""
        moments = [np.mean(frame.positions[:, :2] ** 2, axis=0) for frame in run.trajectory]
        axes = 2 * np.sqrt(np.transpose(moments))
        radius = math.sqrt(axes[0, 0] * axes[1, 0])
        return cls(run.trajectory.times - run.trajectory.times[0], axes / radius, radius)

    def errors(self, drop: EllipticDrop) -> NDArray[np.float64]:
        """Return the errors of both semi-axes in the first period, shape (2, frames)."""
        first = self.times <= drop.period
        return self.axes[:, first] - np.array(drop.semi_axes(self.times[first]))

    def period(self, drop: EllipticDrop, periods: int) -> float:
        """Return the mean period in s; NaN if the drop does not pass the circle at the end."""
        passages = CubicSpline(self.times, self.axes[0] - self.axes[1]).roots(extrapolate=False)
        if len(passages) == 0:
            return math.nan
        last = passages[np.argmin(np.abs(passages - periods * drop.period))]
        is_near = abs(last - periods * drop.period) < drop.period / 4
        return float(last) / periods if is_near else math.nan


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare the finer one with the ideal drop."""
    drop = EllipticDrop(values["sigma"] * values["omega"], values["omega"])
    refined = Refinement.of(partial(_run, drop, values, runner), three(values["across"]))
    seen = [Motion.of(run) for run in refined.runs]
    period = seen[-1].period(drop, values["periods"])
    rms = [compare.rms(each.errors(drop)) for each in seen]
    _plot(drop, refined.labeled(seen), runner.picture)
    return {
        "semi_axis": float(np.max(np.abs(seen[-1].errors(drop)))),
        "semi_axis_rms": rms[-1],
        "period": period / drop.period - 1,
        "period_measured": period,
        "period_reference": drop.period,
        "energy_loss": _energy_loss(refined.fine, drop, values),
        "motion_loss": _motion_loss(refined.fine, drop, values),
        "rest_radius": seen[-1].rest_radius / values["radius"] - 1,
        **refined.orders(rms),
    }


def _run(
    drop: EllipticDrop, values: Mapping[str, Value], runner: Runner, label: str, across: int
) -> Run:
    """Run the script with so many particles over the radius."""
    t_settle = SETTLE / drop.omega
    # a little longer than whole periods: the end of the last one lies inside
    t_end = t_settle + (values["periods"] + 0.1) * drop.period
    frames = round(FRAMES_PER_PERIOD * (values["periods"] + 0.1))
    shared = {name: value for name, value in values.items() if name != "periods"}
    t_end, clock = schemes.clock(values, t_end, frames, t_settle)
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "across": across,
            "sigma": drop.sigma,
            "sound": values["sound"] * drop.omega * values["radius"],
            "lattice": lattice_density(values),
            "room": ROOM * drop.largest,
            "damping": DAMPING * drop.omega,
        },
    )


def _energy_loss(run: Run, drop: EllipticDrop, values: Mapping[str, Value]) -> float:
    """Return the loss of kinetic, potential and elastic energy, by the thermo output."""
    thermo = run.thermo
    moving = thermo["Time"] > run.trajectory.times[0]
    energy = thermo["v_kinetic"] + thermo["v_potential"] + thermo["v_elastic"]
    time = np.ptp(thermo["Time"][moving])
    lost = energy[moving][0] - energy[moving][-1]
    mass = thermo["v_mass"][-1]
    return float(lost / (mass * values["radius"] ** 2 * drop.kinetic_energy) * drop.period / time)


def _motion_loss(run: Run, drop: EllipticDrop, values: Mapping[str, Value]) -> float:
    """Return the loss of the energy that the strained ellipse has, by positions and velocities.

    Unlike the loss of all energy it counts what has become disordered motion of the particles.
    """
    frames = [run.trajectory[0], run.trajectory[values["periods"] * FRAMES_PER_PERIOD]]
    kinetic = []
    for frame in frames:
        x, y = frame.positions[:, 0], frame.positions[:, 1]
        vx, vy = frame.velocities[:, 0], frame.velocities[:, 1]
        strain = np.sum(x * vx - y * vy) / np.sum(x**2 + y**2)
        kinetic.append(strain**2 * np.mean(x**2 + y**2))
    return float((1 - kinetic[1] / kinetic[0]) / values["periods"])


def _plot(drop: EllipticDrop, seen: Mapping[str, Motion], path: Path) -> None:
    """Draw the semi-axis along x over time, and the errors in the first period."""
    figure, (axis, error) = compare.panels(2)
    for label, each in seen.items():
        axis.plot(each.times / drop.period, each.axes[0], ".", label=label)
        errors = each.errors(drop)
        time = each.times[: errors.shape[1]] / drop.period
        (line,) = error.plot(time, errors[0], label=f"{label}, along x")
        error.plot(time, errors[1], "--", color=line.get_color(), label=f"{label}, along y")
    times = np.linspace(0, each.times[-1], 400)
    axis.plot(times / drop.period, drop.semi_axes(times)[0], "k-", lw=0.8, label="ideal fluid")
    axis.set(ylabel="semi-axis along x / R")
    error.set(xlabel="time / period", ylabel="error of the semi-axes / R")
    for axes in (axis, error):
        axes.legend()
    compare.save(figure, path)


CASE = Case(
    "oscillating-drop",
    "semi-axes and period of a drop in a field: ideal fluid",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
