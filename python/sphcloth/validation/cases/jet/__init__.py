"""A plane jet on a plate, in two dimensions, without gravity."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.jet import Jet
from sphcloth.trajectory import Frame
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, lattice_density, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# the flow counts as steady from this time after the first contact on, and the end of the jet is
# not felt as long as it is this far away from the plate; B/U and B
STARTED, BEFORE_END = 4.0, 2.0
# thermo rows over which the force is averaged in the plot
SMOOTH = 25
FRAMES = 50

PARAMETERS = (
    Parameter("thickness", 0.1, "m", "thickness B of the jet", 1e-4, 10.0),
    Parameter("speed", 2.0, "m/s", "speed U of the jet", 1e-3, 100.0),
    Parameter("angle", 90.0, "degrees", "between jet and plate", 30.0, 90.0),
    REST_DENSITY,
    Parameter("sound", 10.0, "U", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 32, "1", "particles over the thickness", 8, 200, quick=16),
    Parameter("length", 12.0, "B", "length of the jet", 8.0, 100.0),
    *numerics(alpha=0.1, courant=0.5, disorder=0.0),
)

QUANTITIES = (
    Quantity("force", "1", "relative error of the mean force across the plate", 0.03, 0.05),
    Quantity("force_measured", "N/m", "the mean force itself"),
    Quantity("force_reference", "N/m", "rho B U^2 sin(angle)"),
    Quantity("force_scatter", "1", "rms of its changes in time over the force"),
    Quantity("force_halves", "1", "mean of the second half of the window over the first - 1"),
    Quantity("leaving", "U", "mean velocity across the plate of what flows off"),
    Quantity("sheet_speed", "U", "mean speed of what flows off"),
    Quantity("divided", "1", "share that flows off along the direction of the jet"),
    Quantity("divided_reference", "1", "(1 + cos(angle)) / 2"),
    *order_quantities("of the force"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare the mean force with the momentum that the jet brings."""
    jet = Jet(values["thickness"], values["speed"], values["angle"], values["rho0"])
    refined = Refinement.of(partial(_run, jet, values, runner), three(values["across"]))
    steady = refined.each(lambda run, across: _steady(run, _window(jet, values, across)))
    forces = [force for force, _ in steady]
    window = _window(jet, values, values["across"])
    means = [float(np.average(force, weights=steps)) for force, steps in steady]
    errors = [mean / jet.force - 1 for mean in means]
    _plot(jet, refined.labeled(refined.runs), window, runner.picture)
    first, second = np.array_split(forces[-1], 2)
    return {
        "force": errors[-1],
        "force_measured": means[-1],
        "force_reference": jet.force,
        "force_scatter": float(np.std(forces[-1])) / jet.force,
        "force_halves": float(np.mean(second) / np.mean(first) - 1),
        **_flow_off(jet, refined.fine, window),
        "divided_reference": jet.sheets[0] / jet.thickness,
        **refined.orders(errors),
    }


def _run(jet: Jet, values: Mapping[str, Value], runner: Runner, label: str, across: int) -> Run:
    """Run the script with so many particles over the thickness."""
    t_end, clock = schemes.clock(values, _window(jet, values, across)[1], FRAMES, every="1")
    return runner.run(
        label,
        t_end,
        {
            **values,
            **clock,
            "across": across,
            "sound": values["sound"] * jet.speed,
            "lattice": lattice_density(values),
        },
    )


def _window(jet: Jet, values: Mapping[str, Value], across: int) -> tuple[float, float]:
    """Return the times in s between which the flow counts as steady.

    The script starts the jet with its foremost corner one spacing above the plate.
    """
    slope = math.radians(jet.angle)
    spacing = jet.thickness / across
    front = (spacing + 0.5 * jet.thickness * math.cos(slope)) / math.sin(slope)
    # both ends of the jet are square, so their edges arrive this much before and after their middle
    edge = 0.5 * jet.thickness / math.tan(slope)
    first = front + edge + STARTED * jet.thickness
    last = front - edge + (values["length"] - BEFORE_END) * jet.thickness
    return first / jet.speed, last / jet.speed


def _steady(run: Run, window: tuple[float, float]) -> tuple[NDArray[np.float64], ...]:
    """Return the force of every step within a window, N/m, and the length of the step, s.

    The force is that of the coming step.
    """
    time = run.thermo["Time"]
    inside = np.flatnonzero((time[:-1] >= window[0]) & (time[:-1] <= window[1]))
    return run.thermo["v_force"][inside], np.diff(time)[inside]


def _flow_off(jet: Jet, run: Run, window: tuple[float, float]) -> dict[str, float]:
    """Return how the water flows off, from what lies two thicknesses or more from the middle."""
    times = run.trajectory.times
    frame: Frame = run.trajectory[int(np.searchsorted(times, window[1] - 1e-9)) - 1]
    x, down = frame.positions[:, 0], -frame.velocities[:, 1]
    # what still comes down belongs to the jet
    off = (np.abs(x) > 2 * jet.thickness) & (down < 0.5 * jet.speed * jet.sine)
    velocity = frame.velocities[off]
    return {
        "leaving": float(np.mean(velocity[:, 1])) / jet.speed,
        "sheet_speed": float(np.mean(np.linalg.norm(velocity, axis=1))) / jet.speed,
        "divided": float(np.mean(x[off] > 0)),
    }


def _plot(jet: Jet, runs: Mapping[str, Run], window: tuple[float, float], path: Path) -> None:
    """Draw the force over time in each run, and the particles at the end of the fine one."""
    figure, (force, flow) = compare.panels(2)
    scale = jet.thickness / jet.speed
    for label, run in runs.items():
        time, trace = run.thermo["Time"] / scale, run.thermo["v_force"] / jet.force
        smooth = np.convolve(trace, np.full(SMOOTH, 1 / SMOOTH), mode="same")
        (line,) = force.plot(time, trace, lw=0.3, alpha=0.4)
        force.plot(time, smooth, color=line.get_color(), lw=1, label=f"{label}, smoothed")
    force.axhline(1, color="k", lw=0.8, ls="--", label="rho B U^2 sin(angle)")
    force.axvspan(window[0] / scale, window[1] / scale, color="gray", alpha=0.15)
    force.set(xlabel="t U / B", ylabel="force on the plate / reference", ylim=(0, 2))
    force.legend(loc="lower right")
    frame = run.trajectory[len(run.trajectory) // 2]
    x, y = frame.positions[:, :2].T / jet.thickness
    speed = np.linalg.norm(frame.velocities, axis=1) / jet.speed
    dots = flow.scatter(x, y, c=speed, s=1, vmin=0, vmax=1.2)
    figure.colorbar(dots, ax=flow, label="speed / U")
    flow.set(xlabel="x / B", ylabel="y / B", xlim=(-5, 5), ylim=(-0.5, 4.5), aspect="equal")
    compare.save(figure, path)


CASE = Case(
    "jet",
    "force of a plane jet on a plate: its momentum",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
