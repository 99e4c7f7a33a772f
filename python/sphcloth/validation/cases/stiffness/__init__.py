"""The paper's figure 3: a sheet held at its border falls into its pins at several k."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from sphcloth.references import stiffness
from sphcloth.validation import cloth
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.runner import Run, Runner

STIFFNESSES = (0.0, 0.3, 1.0)
FRAMES = (0, 5, 15)
# sweeps with which a single edge must do the same
SWEEPS = (1, 5, 20)

PARAMETERS = (
    Parameter("cells", 20, "1", "cells along each side", 4, 200, quick=10),
    Parameter("size", 1.0, "m", "side of the sheet", 1e-2, 100.0),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("bend", 0.0, "1", "stiffness of the hinges", 0.0, 1.0),
    GRAVITY,
    Parameter("frame", 0.02, "s", "time from frame to frame", 1e-3, 1.0),
    *cloth.solver(1e-3, 10, direction="current"),
)

QUANTITIES = (
    Quantity("sag_middle", "1", "sag with k 0.3 over the sag with k 0", 0.5, 0.5),
    Quantity("sag_stiff", "1", "sag with k 1 over the sag with k 0.3", 0.9, 0.9),
    Quantity("sag_0", "m", "sag with k 0 after 15 frames"),
    Quantity("sag_0.3", "m", "the same with k 0.3"),
    Quantity("sag_1", "m", "the same with k 1"),
    Quantity("free", "1", "sag with k 0 over free fall - 1", 1e-9, 1e-9),
    Quantity("edge", "1", "one edge: error of (1 - k) g dt^2, any iterations", 1e-9, 1e-9),
    Quantity("step", "1", "sag with k 0.3 at half the step over that at the step"),
    Quantity("sweeps", "1", "sag with k 0.3 at twice the iterations over that at once"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run the sheet at each k, and a single edge at several numbers of sweeps."""
    runs = {k: _sheet(values, runner, f"k_{k:g}", k) for k in STIFFNESSES}
    sags = {k: _sag(run) for k, run in runs.items()}
    halved = _sheet({**values, "dt": 0.5 * values["dt"]}, runner, "half_step", 0.3)
    doubled = {**values, "iterations": 2 * values["iterations"]}
    doubled = _sheet(doubled, runner, "twice_the_sweeps", 0.3)
    step = cloth.substep(_stepped(values))
    steps = round(FRAMES[-1] * values["frame"] / step)
    fall = stiffness.free_fall(values["gravity"], step, steps, cloth.first_kick(values))
    _picture(runs, values, runner.picture)
    return {
        "sag_middle": sags[0.3] / sags[0.0],
        "sag_stiff": sags[1.0] / sags[0.3],
        "sag_0": sags[0.0],
        "sag_0.3": sags[0.3],
        "sag_1": sags[1.0],
        "free": sags[0.0] / fall - 1,
        "edge": max(_edge(values, runner, n) for n in SWEEPS),
        "step": _sag(halved) / sags[0.3],
        "sweeps": _sag(doubled) / sags[0.3],
    }


def _stepped(values: Mapping[str, Value]) -> dict[str, Value]:
    """Return the values with a step that divides a frame."""
    return {**values, **cloth.stepping(values["frame"], values["dt"])}


def _sheet(values: Mapping[str, Value], runner: Runner, label: str, k: float) -> Run:
    shared = {name: value for name, value in _stepped(values).items() if name != "frame"}
    return runner.run(label, FRAMES[-1] * values["frame"], shared | {"k": k})


def _sag(run: Run) -> float:
    return -float(np.min(run.trajectory[-1].positions[:, 2]))


def _edge(values: Mapping[str, Value], runner: Runner, sweeps: int, k: float = 0.3) -> float:
    """Return the relative error of the stretch of a single edge after one step."""
    step = values["dt"]
    shared = {name: value for name, value in values.items() if name != "frame"}
    changed = {"what": "edge", "k": k, "iterations": sweeps, "every": 1}
    # sweeps do not divide the step here, whatever the solver of the sheet
    changed["solver"] = "gs" if values["solver"] == "substeps" else values["solver"]
    run = runner.run(f"edge_{sweeps}", step, shared | changed)
    exact = stiffness.first_stretch(k, values["gravity"], step, cloth.first_kick(values))
    stretch = -float(run.trajectory[-1].positions[1, 2]) - values["size"]
    return abs(stretch / exact - 1)


def _picture(runs: Mapping[float, Run], values: Mapping[str, Value], path: Path) -> None:
    """Draw the sheets: k from left to right, frames from top to bottom, as in the paper."""
    flat = runs[0.0].trajectory[0].positions
    triangles = Triangulation(flat[:, 0], flat[:, 1]).triangles
    deepest = min(float(run.trajectory[FRAMES[-1]].positions[:, 2].min()) for run in runs.values())
    figure = Figure(figsize=(10, 9), layout="constrained")
    for row, frame in enumerate(FRAMES):
        for column, (k, run) in enumerate(runs.items()):
            number = row * len(runs) + column + 1
            axes = figure.add_subplot(len(FRAMES), len(runs), number, projection="3d")
            sheet = run.trajectory[frame].positions
            axes.plot_trisurf(*sheet.T, triangles=triangles, color="#e3a857", lw=0.2, ec="#7a5520")
            half = values["size"] / 2
            axes.set(xlim=(-half, half), ylim=(-half, half), zlim=(deepest, 0.1 * half))
            axes.set_box_aspect((1, 1, max(0.3, -deepest / values["size"])))
            sag = 0.0 - float(sheet[:, 2].min())
            axes.set(xticks=[], yticks=[], title=f"k = {k:g}, frame {frame}, sag {sag:.2g} m")
            axes.tick_params(labelsize="x-small")
    FigureCanvasAgg(figure).print_figure(path, dpi=100)


CASE = Case(
    "stiffness",
    "sag of a sheet at several k: figure 3 of the paper",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
