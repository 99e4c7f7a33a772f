"""A known weight of water on a square sheet that is pinned all around."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.mesh import ClothMesh
from sphcloth.metrics import above_sheet, crossings
from sphcloth.references.pinned_weight import Load
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY, lattice_density_in_space, numerics
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

MODES = ("both", "contact", "wall")
# last share of the time over which is averaged; there is no drag then
LATE = 0.2

PARAMETERS = (
    Parameter("side", 1.0, "m", "side of the sheet at rest", 1e-2, 100.0),
    Parameter("slack", 0.1, "1", "pins are nearer by this over the side", 0.02, 0.3),
    Parameter("areal", 0.2, "kg/m^2", "mass of the sheet per area", 1e-2, 1e3),
    Parameter("rho0", 1000.0, "kg/m^3", "density of the water", 1.0, 1e5),
    Parameter("water", 0.03125, "side^3", "volume of the water", 1e-3, 0.05),
    GRAVITY,
    Parameter("mode", "both", "1", "what couples water and sheet", choices=MODES),
    Parameter("sound", 10.0, "sqrt(g depth)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 24, "1", "edges and particles over the side", 12, 200, quick=16),
    Parameter("thickness", 0.1, "1", "of contact over spacing", 0.01, 0.5),
    Parameter(
        "wall", "own", "1", "pressure of the sheet", choices=("extrapolate", "mirror", "own")
    ),
    Parameter("settle", 8.0, "sqrt(side/g)", "time with drag", 1.0, 1e3),
    Parameter("time", 3.0, "sqrt(side/g)", "time of rest without drag", 0.5, 1e3),
    Parameter("drag", 6.4, "sqrt(g/side)", "rate of the drag", 0.1, 100.0),
    Parameter("damping", 5.0, "1/s", "damping of the sheet's edges", 0.0, 1e4),
    *cloth.solver(3e-5, 0, method="substeps"),
    *numerics(alpha=0.5, courant=0.5, support=2.0, scheme="global"),
)

QUANTITIES = (
    Quantity("pins", "1", "vertical force of the pins / weight - 1", 2e-3, 2e-3),
    Quantity("pins_by_atom", "1", "the same, summed over compute pbd/atom", 2e-3, 2e-3),
    Quantity("pins_sideways", "1", "horizontal force of all pins / weight", 2e-3, 2e-3),
    Quantity("crossed", "particles", "that went through the sheet between frames", 0, 0),
    Quantity("below", "particles", "that are not above the sheet in the end", 0, 0),
    Quantity("contact_on_pins", "1", "impulse of contact on pins / weight / time"),
    Quantity("scatter", "1", "rms of the vertical force between rows / weight"),
    Quantity("pins_coarse", "1", "pins in the coarse run"),
    *order_quantities("of the vertical force"),
    Quantity("sag", "m", "depth of the lowest vertex below the pins"),
    Quantity("sag_coarse", "m", "the same in the coarse run"),
    Quantity("strain", "1", "largest strain of an edge"),
    Quantity("speed", "m/s", "rms speed of the water in the end"),
    Quantity("weight", "N", "weight of water and sheet"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions to rest and weigh them."""
    load = _load(values)
    refined = Refinement.of(partial(_run, values, runner), three(values["across"]))
    runs = refined.runs
    coarse, fine = runs[0], refined.fine
    errors = [_mean(run, "v_pins_z") / load.weight - 1 for run in runs]
    _plot(load, refined, runner.picture)
    return {
        "pins": errors[-1],
        "pins_by_atom": _mean(fine, "v_atoms_z") / load.weight - 1,
        "pins_sideways": math.hypot(_mean(fine, "v_pins_x"), _mean(fine, "v_pins_y")) / load.weight,
        "crossed": max(crossings(_mesh(run), run.trajectory).count for run in runs),
        "below": max(_below(run) for run in runs),
        "contact_on_pins": float(fine.thermo["v_given"][-1] / fine.thermo["Time"][-1])
        / load.weight,
        "scatter": float(np.std(fine.thermo["v_pins_z"][_late(fine)])) / load.weight,
        "pins_coarse": errors[0],
        **refined.orders(errors),
        "sag": _sag(fine),
        "sag_coarse": _sag(coarse),
        "strain": _mean(fine, "c_strain"),
        "speed": _mean(fine, "v_speed"),
        "weight": load.weight,
    }


def _load(values: Mapping[str, Value]) -> Load:
    water = values["water"] * values["side"] ** 3
    return Load(values["side"], values["areal"], water, values["rho0"], values["gravity"])


def _run(values: Mapping[str, Value], runner: Runner, label: str, across: int) -> Run:
    """Run the script with so many edges over the side."""
    load, unit = _load(values), math.sqrt(values["side"] / values["gravity"])
    settle = values["settle"] * unit
    # the water is about as deep as a fifth of the side
    sound = values["sound"] * math.sqrt(values["gravity"] * 0.2 * values["side"])
    shared = {name: values[name] for name in values if name not in ("settle", "time")}
    changed = {
        "across": across,
        "water": load.water,
        "sound": sound,
        "drag": values["drag"] / unit,
        "lattice": lattice_density_in_space(values),
        "t_settle": settle,
    }
    return runner.run(
        label, settle + values["time"] * unit, shared | schemes.keywords(values) | changed
    )


def _late(run: Run) -> NDArray[np.bool_]:
    time = run.thermo["Time"]
    return compare.late(time, LATE)


def _mean(run: Run, name: str) -> float:
    return float(np.mean(run.thermo[name][_late(run)]))


def _mesh(run: Run) -> ClothMesh:
    return ClothMesh.read(run.folder / f"{run.name}.data")


def _below(run: Run) -> int:
    """Return the number of particles without the sheet below them in the end."""
    return int(np.sum(~above_sheet(_mesh(run), run.trajectory[-1])))


def _sag(run: Run) -> float:
    """Return the depth of the lowest vertex in the end, m; the pins are at z = 0."""
    return -float(np.min(run.trajectory[-1].select(2).positions[:, 2]))


def _plot(load: Load, refined: Refinement, path: Path) -> None:
    """Draw the force of the pins over time, and a cut through the middle of the fine run."""
    figure, (force, cut) = compare.panels(1, 2)
    for label, run in refined.labeled(refined.runs).items():
        # the first row is printed before there is anything to average
        time, lift = run.thermo["Time"][1:], run.thermo["v_pins_z"][1:]
        force.plot(time, lift / load.weight, label=label)
    force.axhline(1, color="k", lw=0.5)
    force.set(xlabel="time (s)", ylabel="force of the pins / weight", ylim=(0.9, 1.1))
    force.legend()
    frame = refined.fine.trajectory[-1]
    for kind, mark, label in ((1, ".", "water"), (2, "x", "sheet")):
        x, y, z = frame.select(kind).positions.T
        middle = np.abs(y) < load.side / 30
        cut.plot(x[middle], z[middle], mark, ms=4, label=label)
    cut.set(xlabel="x (m)", ylabel="z (m)", aspect="equal")
    cut.legend()
    compare.save(figure, path)


CASE = Case(
    "pinned-weight",
    "forces of the pins of a sheet: weight of water and sheet",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
