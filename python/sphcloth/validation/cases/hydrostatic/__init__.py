"""A column of water at rest, in two or three dimensions, on particles, a plane or a sheet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.references.hydrostatic import TaitColumn
from sphcloth.trajectory import Frame
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import (
    GRAVITY,
    REST_DENSITY,
    SURFACE,
    WALL,
    lattice_density,
    lattice_density_in_space,
    numerics,
)
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# rate of the damping while the column settles, in c0 / H
DAMPING = 3.2
# time without damping of the coarse run, s
COARSE_TIME = 10.0
# last share of the free time in which the column should be at rest
LATE = 0.1
FRAMES = 100
FLOORS = ("particles", "plane", "sheet")

LATTICE = {2: lattice_density, 3: lattice_density_in_space}

PARAMETERS = (
    Parameter("height", 1.0, "m", "undisturbed height H", 1e-3, 100.0),
    REST_DENSITY,
    GRAVITY,
    Parameter("sound", 10.0, "sqrt(g H)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("layers", 50, "1", "particles over the height", 12, 400, quick=40),
    Parameter("across", 10, "1", "particles over the periodic width", 8, 100),
    Parameter("settle", 6.0, "sqrt(H/g)", "time of damping", 1.0, 1000.0),
    Parameter("time", 100.0, "s", "time of rest without damping", 0.1, 1e4, quick=10.0),
    Parameter("dimension", 2, "1", "of the scene", 2, 3),
    Parameter("floor", "particles", "1", "what the water stands on", choices=FLOORS),
    WALL,
    Parameter("thick", 0.0, "1", "volume of a vertex over spacing^3, 0 for auto", 0.0, 3.0),
    Parameter("thickness", 0.2, "1", "of contact with a sheet over spacing", 0.01, 1.0),
    SURFACE,
    *numerics(alpha=0.5, courant=0.5),
)

QUANTITIES = (
    Quantity("pressure", "rho0 g H", "L2 of p - rho0 g d, inside", 0.01, 0.01),
    Quantity("pressure_everywhere", "rho0 g H", "the same with the free surface"),
    Quantity("lowest", "rho0 g d", "mean of p - rho0 g d in the lowest layer"),
    Quantity("lowest_height", "spacing", "mean height of the lowest layer over the base"),
    Quantity("base_force", "1", "force on the base / weight - 1", 1e-3, 1e-3),
    Quantity("speed", "sqrt(g H)", "largest speed of a particle at rest", 1e-3, 1e-3),
    Quantity("drift", "H", "change of the mean height while at rest", 1e-4, 1e-3),
    Quantity("settlement", "H", "how far the surface sinks"),
    Quantity("settlement_reference", "H", "the same of the Tait column"),
    *order_quantities("of the pressure"),
)


@dataclass(frozen=True)
class State:
    """The column in one frame.

    Attributes:
        depth: undisturbed depth of each particle, m.
        pressure: of each particle, Pa.
        level: height of each particle, m.
        inside: whether a particle and all of its neighbors have no free surface in reach.
    """

    depth: NDArray[np.float64]
    pressure: NDArray[np.float64]
    level: NDArray[np.float64]
    inside: NDArray[np.bool_]

    def error(self, column: TaitColumn) -> NDArray[np.float64]:
        """Return p - rho0 g d of each particle over rho0 g H."""
        return (self.pressure - column.pressure(self.depth)) / column.pressure(column.height)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare the finest one with the Tait column."""
    _check_floor(values)
    column = _column(values)
    refined = Refinement.of(partial(_run, values, runner), three(values["layers"]))
    fine = refined.fine
    rest = refined.each(lambda run, layers: _state(run.trajectory[-1], values, layers))
    errors = [compare.rms(state.error(column)[state.inside]) for state in rest]
    _plot(column, rest[-1], fine, runner.picture)
    return {
        "pressure": errors[-1],
        "pressure_everywhere": compare.rms(rest[-1].error(column)),
        **_lowest(column, rest[-1], values["layers"]),
        "base_force": _base_force(fine),
        "speed": _largest_speed(fine) / math.sqrt(column.gravity * column.height),
        "drift": _drift(fine) / column.height,
        "settlement": _settlement(column, rest[-1]) / column.height,
        "settlement_reference": column.settlement / column.height,
        **refined.orders(errors),
    }


def _check_floor(values: Mapping[str, Value]) -> None:
    """Refuse a floor that the other parameters exclude."""
    if values["floor"] == "sheet" and values["dimension"] == 2:
        raise UserError("--set floor=sheet: a sheet has two dimensions: add --set dimension=3")
    if values["floor"] == "plane" and values["wall"] == "extrapolate":
        raise UserError(
            "--set floor=plane: a plane has no wall=extrapolate: add --set wall=mirror or own"
        )


def _column(values: Mapping[str, Value]) -> TaitColumn:
    sound = values["sound"] * math.sqrt(values["gravity"] * values["height"])
    return TaitColumn(values["height"], values["rho0"], values["gravity"], sound, values["gamma"])


def _run(values: Mapping[str, Value], runner: Runner, label: str, layers: int) -> Run:
    """Run the script with so many layers; the coarse run is without damping for a shorter time."""
    time = min(COARSE_TIME, values["time"]) if label == "coarse" else values["time"]
    sound = _column(values).sound
    t_settle = values["settle"] * math.sqrt(values["height"] / values["gravity"])
    shared = {name: values[name] for name in values if name not in ("sound", "settle", "time")}
    t_end, clock = schemes.clock(values, t_settle + time, FRAMES, t_settle, every="1")
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "layers": layers,
            "sound": sound,
            "lattice": LATTICE[values["dimension"]](values),
            "base": math.ceil(values["support"]) + 1,
            "damping": DAMPING * sound / values["height"],
        },
    )


def _state(frame: Frame, values: Mapping[str, Value], layers: int) -> State:
    column = _column(values)
    depth = column.height - frame.columns["y0"]
    reach = values["support"] * column.height / layers
    pressure = compare.tait_pressure(
        frame.columns["rho"], column.rho0, column.sound, column.gamma, values["tension"] == "yes"
    )
    return State(depth, pressure, frame.positions[:, 1], depth > 2 * reach)


def _lowest(column: TaitColumn, rest: State, layers: int) -> dict[str, float]:
    """Return error and height of the layer that lies on the base."""
    spacing = column.height / layers
    lowest = rest.depth > column.height - spacing
    exact = column.pressure(rest.depth[lowest])
    return {
        "lowest": float(np.mean(rest.pressure[lowest] / exact - 1)),
        "lowest_height": float(np.mean(rest.level[lowest])) / spacing,
    }


def _base_force(run: Run) -> float:
    """Return the relative excess of the force on the base over the weight, late in the run."""
    time = run.thermo["Time"]
    late = np.flatnonzero(compare.late(time, LATE)[:-1])
    if not np.any(np.diff(time)[late]):
        raise UserError("--set time: too short for two rows of the log at rest: take it larger")
    share = run.thermo["v_base_force"][late] / run.thermo["v_weight"][late]
    # the force is that of the coming step
    return float(np.average(share, weights=np.diff(time)[late]) - 1)


def _largest_speed(run: Run) -> float:
    """Return the largest speed of a particle late in the run, m/s."""
    late = np.flatnonzero(compare.late(run.trajectory.times, LATE))
    return max(
        float(np.max(np.linalg.norm(run.trajectory[frame].velocities, axis=1))) for frame in late
    )


def _drift(run: Run) -> float:
    """Return how much the mean height changes while the column should be at rest, m."""
    first, last = (np.mean(run.trajectory[frame].positions[:, 1]) for frame in (0, -1))
    return float(last - first)


def _settlement(column: TaitColumn, rest: State) -> float:
    """Return how far the surface would have sunk, from the uppermost particles inside, m.

    The particles at the surface itself are no measure: they lie closer than elsewhere, since
    the density sum lacks what would be above them.
    """
    below = np.min(rest.depth[rest.inside])
    upper = rest.inside & (rest.depth < 2 * below)
    excess = column.level(rest.depth[upper]) - rest.level[upper]
    return column.settlement + float(np.mean(excess))


def _plot(column: TaitColumn, rest: State, run: Run, path: Path) -> None:
    """Draw pressure and its error over depth, and the force on the base over time."""
    figure, (pressure, error, force) = compare.panels(1, 3)
    depth = np.linspace(0, column.height, 100)
    pressure.plot(column.pressure(depth), depth, "k-", label="rho0 g d")
    pressure.plot(rest.pressure, rest.depth, ".", label="SPH")
    pressure.set(xlabel="pressure (Pa)", ylabel="undisturbed depth (m)")
    pressure.legend()
    error.plot(100 * rest.error(column), rest.depth, ".", color="lightgray", label="surface")
    error.plot(100 * rest.error(column)[rest.inside], rest.depth[rest.inside], ".", label="inside")
    error.set(xlabel="error of the pressure (% of rho0 g H)")
    error.legend()
    for axes in (pressure, error):
        axes.invert_yaxis()
    force.plot(run.thermo["Time"], run.thermo["v_base_force"] / run.thermo["v_weight"])
    force.set(xlabel="time (s)", ylabel="force on the base / weight", ylim=(0.9, 1.1))
    compare.save(figure, path)


CASE = Case(
    "hydrostatic",
    "pressure and force on the base of a column: Tait column",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
