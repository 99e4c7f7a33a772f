"""A sheet between two pins holds a pool of water, in three dimensions, periodic along the pool."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.path import Path as Outline
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.references.lintearia import HeavyLintearia, Lintearia
from sphcloth.trajectory import Frame
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY, lattice_density_in_space, numerics
from sphcloth.validation.pool import surface_level
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

MODES = ("wall", "both", "contact", "pressure")
# particles over L of the coarse run of the order of convergence, in those of the case, and at least
COARSE, COARSEST = 0.25, 20
# rows of vertices along y: with fewer an edge would meet its own image
LEAST_ROWS = 3
# last share of the time over which is averaged, and for forces, which swing by a hundredth while
# the pool comes to rest
LATE, LATE_FORCES = 0.15, 0.4

PARAMETERS = (
    Parameter("L", 1.0, "m", "length of the sheet", 1e-2, 100.0),
    Parameter("D", 0.6, "m", "distance of the pins", 1e-3, 100.0),
    Parameter("A", 0.08, "m^2", "cross-section of the water", 1e-6, 1e4),
    Parameter("areal", 0.2, "kg/m^2", "mass of the sheet per area", 1e-3, 1e3),
    Parameter("rho0", 1000.0, "kg/m^3", "density of the water", 1.0, 1e5),
    GRAVITY,
    Parameter("mode", "wall", "1", "what couples water and sheet", choices=MODES),
    Parameter("sound", 10.0, "sqrt(g depth)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("across", 80, "1", "particles over L", 40, 1000, quick=40),
    Parameter("layers", 4, "1", "particles along the pool", 3, 100),
    Parameter("mesh", 1.0, "1", "edge of the sheet over spacing", 0.2, 8.0),
    Parameter("gap", 0.6, "1", "least distance from the sheet at the start over spacing", 0.1, 2.0),
    Parameter("thick", 1.2, "1", "volume of a vertex over area and spacing, 0 for auto", 0.0, 3.0),
    Parameter("thickness", 0.5, "1", "of contact over spacing", 0.01, 1.0),
    Parameter(
        "wall",
        "extrapolate",
        "1",
        "pressure of the sheet",
        choices=("extrapolate", "mirror", "own"),
    ),
    Parameter("settle", 9.0, "sqrt(L/g)", "time to rest", 1.0, 1e3),
    Parameter("drag", 3.2, "sqrt(g/L)", "rate of the drag", 0.0, 100.0),
    Parameter("damping", 5.0, "1/s", "damping of the sheet's edges", 0.0, 1e4),
    Parameter(
        "strain",
        5e-4,
        "1",
        "largest strain that the solver adds in the coarsest run, in finer ones less",
        1e-5,
        0.1,
    ),
    *cloth.solver(1e-4, 0, method="substeps"),
    *numerics(alpha=0.5, courant=0.5, support=2.0, scheme="global"),
)

QUANTITIES = (
    Quantity("lift", "1", "vertical force of the pins / reference - 1", 2e-3, 2e-3),
    Quantity("tension", "1", "tension at the bottom / reference - 1", 0.01, 0.04),
    Quantity("tension_pins", "1", "tension at the pins / reference - 1"),
    Quantity("length", "1", "length of the sheet / L - 1", 1e-3, 1e-3),
    Quantity("sag", "1", "sag / reference - 1", 5e-3, 5e-3),
    Quantity("depth", "1", "depth of the water / reference - 1", 0.02, 0.04),
    Quantity("shape", "spacing", "largest distance of a vertex from the curve", 1.0, 1.0),
    Quantity("crossed", "particles", "that went through the sheet between frames", 0, 0),
    Quantity("below", "particles", "that are below the sheet in the end", 0, 0),
    *order_quantities("of the rms distance from the curve"),
    Quantity("order_missing", "1", "what the order lacks to 1", 0),
    Quantity("first_layer", "spacing", "mean distance of the lowest particles from the sheet"),
    Quantity("speed", "m/s", "rms speed of the water in the end"),
    Quantity("tension_reference", "N/m", "tension at the bottom"),
    Quantity("sag_reference", "m", "sag"),
    Quantity("depth_reference", "m", "depth of the water"),
)


@dataclass(frozen=True)
class Pool:
    """What a run showed in its last frames, on average.

    Attributes:
        spacing: of the particles, m.
        arc: length along the sheet of each row of vertices, m; 0 is the middle.
        pins: height of the pins, m.
        sheet: x and z of each row below the pins' level, m, shape (rows, 2).
        length: of the sheet, m.
        level: of the water below the pins' level, m.
        pull: horizontal and vertical force of one pin per width, N/m.
        first_layer: mean distance from the sheet of the particles nearest to it, m.
        below: number of particles below the sheet in the last frame.
    """

    spacing: float
    arc: NDArray[np.float64]
    pins: float
    sheet: NDArray[np.float64]
    length: float
    level: float
    pull: tuple[float, float]
    first_layer: float
    below: int

    @property
    def sag(self) -> float:
        """Depth of the lowest vertices below the pins, m."""
        return -float(np.min(self.sheet[:, 1]))

    @property
    def depth(self) -> float:
        """Depth of the water, m."""
        return self.level + self.sag

    def tension(self, light: Lintearia) -> float:
        """Return the tension at the bottom: the pull of a pin and the thrust of the water."""
        return self.pull[0] + light.rho0 * light.gravity * self.depth**2 / 2

    def distances(self, exact: HeavyLintearia) -> NDArray[np.float64]:
        """Return the distance of each row from its place on the curve, m."""
        place = exact.shape(self.arc) - np.array([0.0, exact.sag])
        return np.linalg.norm(self.sheet - place, axis=1)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions to rest and compare the finer one with the curve."""
    exact = curve_of(values)
    if round(values["layers"] / values["mesh"]) < LEAST_ROWS:
        raise UserError(
            f"mesh {values['mesh']:g} with layers {values['layers']} makes fewer than {LEAST_ROWS} "
            "rows of vertices: take layers larger"
        )
    refined = Refinement.of(partial(_run, values, runner), resolutions(values))
    pools = refined.each(lambda run, across: pool_of(run, values, across))
    fine, pool = refined.fine, pools[-1]
    _plot(exact, refined.labeled(pools), fine, runner.picture)
    orders = refined.orders([compare.rms(each.distances(exact)) for each in pools])
    return {
        "lift": pool.pull[1] / exact.lift - 1,
        "tension": pool.tension(exact.light) / exact.tension - 1,
        "tension_pins": math.hypot(*pool.pull) / float(exact.pull(values["L"] / 2)) - 1,
        "length": pool.length / values["L"] - 1,
        "sag": pool.sag / exact.sag - 1,
        "depth": pool.depth / exact.depth - 1,
        "shape": float(np.max(pool.distances(exact))) / pool.spacing,
        "crossed": max(_crossed(run) for run in refined.runs),
        "below": max(each.below for each in pools),
        **orders,
        "order_missing": compare.order_missing(orders, 1.0),
        "first_layer": pool.first_layer / pool.spacing,
        "speed": float(np.mean(fine.thermo["v_speed"][compare.late(fine.thermo["Time"], LATE)])),
        "tension_reference": exact.tension,
        "sag_reference": exact.sag,
        "depth_reference": exact.depth,
    }


def resolutions(values: Mapping[str, Value]) -> dict[str, int]:
    """Return particles over L of the three runs."""
    return three(values["across"], COARSE, COARSEST)


def curve_of(values: Mapping[str, Value]) -> HeavyLintearia:
    """Return the exact shape for the parameters of the case."""
    names = "L", "D", "A", "rho0", "gravity"
    return HeavyLintearia(Lintearia(*(values[name] for name in names)), values["areal"])


def _run(values: Mapping[str, Value], runner: Runner, label: str, across: int) -> Run:
    """Run the script with so many particles over L."""
    light = curve_of(values).light
    unit = math.sqrt(values["L"] / values["gravity"])
    shared = {name: values[name] for name in values if name != "settle"}
    return runner.run(
        label,
        values["settle"] * unit,
        shared
        | schemes.keywords(values)
        | _start(values, light, values["L"] / across)
        | {
            "across": across,
            # what the solver adds must not end the order
            "strain": values["strain"] * min(resolutions(values).values()) / across,
            "sound": values["sound"] * math.sqrt(values["gravity"] * light.depth),
            "lattice": lattice_density_in_space(values),
            "drag": values["drag"] / unit,
        },
    )


def _start(values: Mapping[str, Value], light: Lintearia, spacing: float) -> dict[str, Value]:
    """Return the shape with which the sheet starts: legs with the exact slope and an arc.

    The water above is a lattice, filled to a level at which its particles have the right number.
    """
    sine, cosine = math.sin(light.angle), math.cos(light.angle)
    radius = (light.span - light.length * cosine) / 2 / (sine - light.angle * cosine)
    gap = values["gap"] * spacing

    def missing(level: float) -> float:
        """Particles of one layer below a level less those that there should be."""
        columns = (np.arange(round(light.length / spacing)) + 0.5) * spacing
        rows = level - (np.arange(math.floor(level / spacing + 1)) + 0.5) * spacing
        x, z = np.meshgrid(columns, rows)
        on_arc = x * cosine < (radius - z) * sine
        leg = (z - radius * (1 - cosine)) * cosine - (x - radius * sine) * sine
        over = np.where(on_arc, radius - np.hypot(x, z - radius), leg)
        return 2 * np.count_nonzero(over > gap) - light.area / spacing**2

    levels = light.depth + np.arange(0, 4, 0.02) * spacing
    level = min(levels, key=lambda each: abs(missing(each)))
    return {"slope": light.angle, "radius": radius, "level": float(level)}


def pool_of(run: Run, values: Mapping[str, Value], across: int) -> Pool:
    """Average over the last frames and rows of the log."""
    spacing = values["L"] / across
    width = values["layers"] * spacing
    frames = [run.trajectory[at] for at in np.flatnonzero(compare.late(run.trajectory.times, LATE))]
    arc, sheets = zip(*(_rows(frame) for frame in frames), strict=True)
    steps = np.linalg.norm(np.diff(sheets, axis=1), axis=2)
    sheet, rows = np.mean(sheets, axis=0), compare.late(run.thermo["Time"], LATE_FORCES)
    pins = float(np.mean(sheet[[0, -1], 1]))
    pull = (run.thermo[name][rows].mean() / width for name in ("v_pull_x", "v_pull_z"))
    waters = [frame.select(1).positions[:, [0, 2]] for frame in frames]
    return Pool(
        spacing,
        arc[0],
        pins,
        sheet - [0.0, pins],
        float(np.mean(np.sum(steps, axis=1))),
        _level(np.concatenate(waters), len(frames), spacing, values) - pins,
        tuple(pull),
        float(np.mean([_first_layer(w, s, spacing) for w, s in zip(waters, sheets, strict=True)])),
        _below(waters[-1], sheets[-1]),
    )


def _rows(frame: Frame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the length along the sheet of each row of vertices, and its mean x and z."""
    vertices = frame.select(2)
    arc, row = np.unique(np.round(vertices.columns["arc"], 9), return_inverse=True)
    places = vertices.positions[:, [0, 2]]
    sums = [np.bincount(row, weights=each) / np.bincount(row) for each in places.T]
    return arc, np.stack(sums, axis=1)


def _level(water: NDArray, frames: int, spacing: float, values: Mapping[str, Value]) -> float:
    """Return the height of the surface in the middle third of the pool."""
    near = np.abs(water[:, 0]) < np.max(water[:, 0]) / 3
    strip = 2 * np.max(water[:, 0]) / 3
    return surface_level(water[near, 1], frames * values["layers"] * strip / spacing, spacing)


def _below(water: NDArray, sheet: NDArray) -> int:
    """Return the number of particles that are below the sheet, or beside its pins."""
    above = sheet[[-1, 0]] + [0.0, 10 * np.ptp(sheet[:, 0])]
    return int(np.sum(~Outline(np.concatenate([sheet, above])).contains_points(water)))


def _first_layer(water: NDArray, sheet: NDArray, spacing: float) -> float:
    """Return the mean, along the inner half of the wet sheet, of the smallest distance."""
    along = np.linspace(0, len(sheet) - 1, 40 * len(sheet))
    points = np.stack([np.interp(along, np.arange(len(sheet)), each) for each in sheet.T], axis=1)
    distance, nearest = cKDTree(points).query(water)
    x = points[nearest, 0]
    inner = np.abs(x) < np.max(np.abs(water[:, 0])) / 2
    place = np.floor(x[inner] / spacing).astype(int)
    return float(np.mean([np.min(distance[inner][place == each]) for each in np.unique(place)]))


def _crossed(run: Run) -> int:
    """Return the number of particles that went through the sheet, from the dump alone."""
    mesh = ClothMesh.read(run.folder / f"{run.name}.data")
    return crossings(mesh, run.trajectory).count


def _plot(exact: HeavyLintearia, pools: Mapping[str, Pool], run: Run, path: Path) -> None:
    """Draw the pool, the distance of the sheet from the curve, and the force over time."""
    figure, (shape, error, force) = compare.panels(1, 3)
    pool, water = pools["fine"], run.trajectory[-1].select(1).positions
    curve = exact.shape(pool.arc) - [0.0, exact.sag]
    shape.plot(water[:, 0], water[:, 2] - pool.pins, ".", ms=1, label="water")
    shape.plot(*curve.T, "k-", label="exact")
    shape.plot(*pool.sheet.T, ".", ms=3, label="sheet")
    shape.set(xlabel="x (m)", ylabel="z (m)", aspect="equal")
    shape.legend(loc="upper center")
    for label, each in pools.items():
        error.plot(each.arc, each.distances(exact) / each.spacing, label=label)
    error.set(xlabel="length along the sheet (m)", ylabel="distance from the curve / spacing")
    error.legend()
    width = run.thermo["v_width"][-1]
    force.plot(run.thermo["Time"], run.thermo["v_pull_z"] / width / exact.lift)
    force.set(xlabel="time (s)", ylabel="vertical force of a pin / reference", ylim=(0.9, 1.1))
    compare.save(figure, path)


CASE = Case(
    "lintearia",
    "sheet between pins with a pool: exact shape and tension",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
