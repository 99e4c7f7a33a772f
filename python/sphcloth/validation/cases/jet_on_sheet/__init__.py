"""A plane jet on a sheet that is held at two ends, in a thin periodic slab, without gravity."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.references.jet_on_sheet import TurnedJet
from sphcloth.trajectory import Frame
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, lattice_density_in_space, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# the flow counts as steady so long after the first contact, and until the end of the jet is so far
# away from the place where the sheet was; B/v and B
STARTED, BEFORE_END = 11.0, 2.0
# what is so far outside of the ends of the sheet has left it; spacings
OUTSIDE = 2.0
SMOOTH = 25
FRAMES = 80

PARAMETERS = (
    Parameter("thickness", 0.1, "m", "thickness B of the jet", 1e-3, 10.0),
    Parameter("speed", 2.0, "m/s", "speed v of the jet", 1e-2, 100.0),
    REST_DENSITY,
    Parameter("sound", 10.0, "v", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 12, "1", "particles over the thickness", 4, 100, quick=8),
    Parameter("depth", 6, "1", "particles over the periodic depth", 6, 100),
    Parameter("length", 18.0, "B", "length of the jet", 15.0, 100.0),
    Parameter("span", 8.0, "B", "between the ends of the sheet", 5.0, 20.0),
    Parameter("areal", 1.0, "kg/m^2", "mass per area of the sheet", 1e-2, 100.0),
    Parameter("stretch", 0.04, "1", "compliance of an edge times rho0 B v^2", 1e-3, 0.2),
    Parameter("damping", 1.0, "v/B", "rate at which stretching of the sheet decays", 0.0, 100.0),
    Parameter(
        "coupling",
        "contact",
        "1",
        "of water and sheet",
        choices=("contact", "wall", "pressure", "both"),
    ),
    Parameter(
        "wall", "own", "1", "pressure of the vertices", choices=("extrapolate", "mirror", "own")
    ),
    Parameter("gap", 0.2, "spacing", "gap that contact keeps", 0.01, 0.5),
    cloth.ITERATIONS,
    Parameter("solver", "substeps", "1", "what the iterations are", choices=cloth.SOLVERS),
    Parameter("direction", "start", "1", "of the projection", choices=cloth.DIRECTIONS),
    *numerics(alpha=0.1, courant=0.5, support=2.0, disorder=0.0, density="continuity"),
)

QUANTITIES = (
    Quantity("force", "1", "mean force of the pins / rho0 Q v (1 - cos turning) - 1", 0.05, 0.05),
    Quantity("passed_through", "1", "water particles below the sheet", 0.0, 0.0),
    Quantity("force_measured", "N/m", "the mean force itself, per depth"),
    Quantity("force_reference", "N/m", "rho0 Q v (1 - cos turning)"),
    Quantity("balance", "1", "the same with the speed at which the water leaves"),
    Quantity("turning", "degrees", "of what leaves the sheet from the direction of the jet"),
    Quantity("leaving_speed", "v", "mean speed of what leaves the sheet"),
    Quantity("force_halves", "1", "mean of the second half of the window over the first - 1"),
    Quantity("sag", "B", "of the sheet's middle"),
    Quantity("strain", "1", "largest strain of an edge"),
    *order_quantities("of the force"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare the force of the pins with the momentum that is turned."""
    # on a lattice whose summed density is rho0 there is less mass per volume
    mass_per_volume = values["rho0"] / lattice_density_in_space(values)
    jet = TurnedJet(values["thickness"], values["speed"], mass_per_volume)
    across = three(values["across"], coarsest=4)
    refined = Refinement.of(partial(_run, jet, values, runner), across)
    found = refined.each(partial(_balance, jet, values))
    fine, window = refined.fine, _window(jet, values, values["across"])
    _plot(jet, values, refined.labeled(refined.runs), window, found[-1], runner)
    last = fine.trajectory[_steady_frames(fine, window)[-1]]
    sheet = last.select(2).positions
    return {
        **found[-1],
        "passed_through": max(_below(frame) for frame in fine.trajectory),
        "sag": -float(np.min(sheet[:, 2])) / jet.thickness,
        "strain": float(np.max(fine.thermo["v_strain"])),
        **refined.orders([each["force"] for each in found]),
    }


def _run(
    jet: TurnedJet, values: Mapping[str, Value], runner: Runner, label: str, across: int
) -> Run:
    """Run the script with so many particles over the thickness."""
    dropped = ("stretch",)
    shared = {name: values[name] for name in values if name not in dropped}
    t_end, clock = schemes.clock(values, _window(jet, values, across)[1], FRAMES, every="1")
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "across": across,
            "sound": values["sound"] * jet.speed,
            "span": values["span"] * jet.thickness,
            "compliance": values["stretch"] / (jet.rho0 * jet.flow * jet.speed),
            "damping": values["damping"] * jet.speed / jet.thickness,
            "lattice": lattice_density_in_space(values),
        },
    )


def _window(jet: TurnedJet, values: Mapping[str, Value], across: int) -> tuple[float, float]:
    """Return the times in s between which the flow counts as steady."""
    front = 2 * jet.thickness / across
    first = front + STARTED * jet.thickness
    last = front + (values["length"] - BEFORE_END) * jet.thickness
    return first / jet.speed, last / jet.speed


def _forces(run: Run, values: Mapping[str, Value]) -> NDArray[np.float64]:
    """Return the force of the pins in each row, N/m, with what contact does to them directly."""
    time, pushed = run.thermo["Time"], run.thermo["v_pushed"]
    steps = np.diff(time, prepend=time[0] - run.thermo["Dt"][0])
    return run.thermo["v_pins"] - np.diff(pushed, prepend=0.0) / steps


def _steady_frames(run: Run, window: tuple[float, float]) -> NDArray[np.intp]:
    times = run.trajectory.times
    return np.flatnonzero((times >= window[0]) & (times <= window[1] * (1 + 1e-9)))


def _balance(
    jet: TurnedJet, values: Mapping[str, Value], run: Run, across: int
) -> dict[str, float]:
    """Return force, turning and what follows from them, over the steady window."""
    window = _window(jet, values, across)
    time = run.thermo["Time"]
    inside = (time >= window[0]) & (time <= window[1])
    forces = _forces(run, values)[inside]
    mean = float(np.average(forces, weights=np.diff(time, prepend=0.0)[inside]))
    edge = 0.5 * values["span"] * jet.thickness + OUTSIDE * jet.thickness / across
    velocity = np.concatenate(
        [
            _left(run.trajectory[int(n)], edge, edge + jet.thickness)
            for n in _steady_frames(run, window)
        ]
    )
    # both sides leave alike, so what counts is outwards and up
    outwards, upwards = np.mean(velocity, axis=0)
    turning = math.degrees(math.atan2(outwards, -upwards))
    reference = jet.force(turning)
    kept = float(np.hypot(outwards, upwards)) / jet.speed
    first, second = np.array_split(forces, 2)
    return {
        "force": mean / reference - 1,
        "force_measured": mean,
        "force_reference": reference,
        "balance": mean / jet.force(turning, kept) - 1,
        "turning": turning,
        "leaving_speed": float(np.mean(np.linalg.norm(velocity, axis=1))) / jet.speed,
        "force_halves": float(np.mean(second) / np.mean(first) - 1),
    }


def _left(frame: Frame, inner: float, outer: float) -> NDArray[np.float64]:
    """Return velocities outwards and upwards of the water that has just left the sheet."""
    water = frame.select(1)
    x = water.positions[:, 0]
    chosen = (np.abs(x) > inner) & (np.abs(x) < outer)
    velocity = water.velocities[chosen]
    return np.stack([velocity[:, 0] * np.sign(x[chosen]), velocity[:, 2]], axis=1)


def _below(frame: Frame) -> int:
    """Return how many water particles are below the sheet, which is the same at any depth."""
    sheet = frame.select(2).positions
    by_x = sheet[np.argsort(sheet[:, 0], kind="stable")]
    water = frame.select(1).positions
    over = np.abs(water[:, 0]) < by_x[-1, 0]
    level = np.interp(water[over, 0], by_x[:, 0], by_x[:, 2])
    spacing = float(np.max(np.diff(by_x[:, 0])))
    return int(np.sum(water[over, 2] < level - 0.5 * spacing))


def _plot(
    jet: TurnedJet,
    values: Mapping[str, Value],
    runs: Mapping[str, Run],
    window: tuple[float, float],
    found: Mapping[str, float],
    runner: Runner,
) -> None:
    """Draw the force over time in each run, and water and sheet of the fine one."""
    figure, (force, flow) = compare.panels(2)
    scale = jet.thickness / jet.speed
    for label, run in runs.items():
        time, trace = run.thermo["Time"] / scale, _forces(run, values) / found["force_reference"]
        smooth = np.convolve(trace, np.full(SMOOTH, 1 / SMOOTH), mode="same")
        (line,) = force.plot(time, trace, lw=0.3, alpha=0.4)
        force.plot(time, smooth, color=line.get_color(), lw=1, label=f"{label}, smoothed")
    force.axhline(1, color="k", lw=0.8, ls="--", label="rho Q v (1 - cos(turning))")
    force.axvspan(window[0] / scale, window[1] / scale, color="gray", alpha=0.15)
    force.set(xlabel="t v / B", ylabel="force of the pins / reference", ylim=(0, 2))
    force.legend(loc="lower right")
    run = runs["fine"]
    frame = run.trajectory[int(_steady_frames(run, window)[0])]
    water, sheet = frame.select(1), frame.select(2)
    x, _, z = water.positions.T / jet.thickness
    speed = np.linalg.norm(water.velocities, axis=1) / jet.speed
    dots = flow.scatter(x, z, c=speed, s=1, vmin=0, vmax=1.2)
    figure.colorbar(dots, ax=flow, label="speed / v")
    x, _, z = sheet.positions.T / jet.thickness
    flow.plot(x, z, "k.", ms=2)
    half = 0.6 * values["span"]
    flow.set(xlabel="x / B", ylabel="z / B", xlim=(-half, half), ylim=(-2, 3), aspect="equal")
    compare.save(figure, runner.picture)


CASE = Case(
    "jet-on-sheet",
    "force that holds a sheet under a plane jet: its momentum",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
