"""The example ``pour`` itself, with water that stays: a pool comes to rest in a sheet.

The script is that of the example, so support, viscosity, pressure of the vertices, contact and
material are what is shipped.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.examples import find_example
from sphcloth.mesh import ClothMesh, read_sections
from sphcloth.metrics import above_sheet, crossings
from sphcloth.references.filled_sheet import AtRest, FilledSheet
from sphcloth.trajectory import Frame
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.lattice import cubic_density_sum
from sphcloth.validation.pool import surface_level
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# what the script has fixed
RHO0, GRAVITY, SUPPORT, KERNEL = 1000.0, 9.81, 2.0, "wendland/c2"
# last share of the time over which is averaged
LATE = 0.2
FRAMES = 200
COUPLINGS = ("pressure", "contact", "wall")
DENSITIES = ("summation", "calibrated")

PARAMETERS = (
    Parameter("size", 1.4, "m", "side of the sheet without load", 0.1, 10.0),
    Parameter("slack", 0.1, "1", "pins are nearer by this over the side", 0.02, 0.3),
    Parameter("areal", 4.0, "kg/m^2", "mass of the sheet per area", 0.1, 1e3),
    Parameter("stretch", 1e-5, "m/N", "compliance of an edge", 1e-7, 1e-2),
    Parameter("water", 0.025, "size^3", "volume of the water", 5e-3, 0.06),
    Parameter("across", 28, "1", "edges and particles over the side", 14, 200, quick=20),
    Parameter("speed", 3.0, "m/s", "reference speed of a fluctuation of 1 %", 1.0, 100.0),
    Parameter("alpha", 0.1, "1", "artificial viscosity", 0.0, 2.0),
    Parameter("density", "calibrated", "1", "of the water", choices=DENSITIES),
    Parameter("strain", 0.01, "1", "largest strain that the solver adds", 1e-4, 0.5),
    Parameter("coupling", "wall", "1", "of water and sheet", choices=COUPLINGS),
    Parameter("thick", 0.0, "1", "volume of a vertex over spacing^3, 0 for auto", 0.0, 3.0),
    Parameter("dt", 2e-3, "s", "largest step", 1e-6, 0.1),
    Parameter("constant", 5e-4, "s", "step of the scheme constant", 1e-6, 0.1),
    Parameter("time", 8.0, "s", "until the pool is at rest", 1.0, 1e3),
    Parameter("scheme", "global", "1", "scheme of the time step", choices=schemes.SCHEMES),
)

QUANTITIES = (
    Quantity("pins", "1", "vertical force of the pins / weight - 1", 5e-3, 5e-3),
    Quantity("sag", "1", "depth of the lowest vertex below the pins / reference - 1", 0.03, 0.03),
    Quantity("depth", "1", "depth of the water over it / reference - 1", 0.03, 0.03),
    Quantity("momentum", "1", "largest sum of the internal forces / weight", 1e-10, 1e-10),
    Quantity("crossed", "particles", "that went through the sheet between frames", 0, 0),
    Quantity("spilled", "particles", "that are not above the sheet in the end"),
    Quantity("sag_reference", "m", "sag of the sheet of springs"),
    Quantity("depth_reference", "m", "depth of the water in it"),
    Quantity("level", "spacing", "height of the surface - reference"),
    Quantity("shape", "spacing", "rms distance of a wet vertex from the reference"),
    Quantity("fold", "1", "sag of the rest shape next to a smooth bowl / sag_reference - 1"),
    Quantity("scatter", "1", "rms of the vertical force between rows / weight"),
    Quantity("speed_water", "m/s", "rms speed of the water in the end"),
    Quantity("speed_sheet", "m/s", "rms speed of the vertices in the end"),
    *order_quantities("of the depth"),
)


@dataclass(frozen=True)
class Pool:
    """What a run showed in its last frames, and the sheet of springs that it should be.

    Attributes:
        run: where it is.
        values: parameters of the case.
        across: edges over the side.
    """

    run: Run
    values: Mapping[str, Value]
    across: int

    @property
    def spacing(self) -> float:
        """Spacing of particles and vertices, m."""
        return self.values["size"] / self.across

    @cached_property
    def mesh(self) -> ClothMesh:
        """The triangles."""
        return ClothMesh.read(self.run.folder / "pour.data")

    @cached_property
    def frames(self) -> list[Frame]:
        """The last frames."""
        times = self.run.trajectory.times
        return [self.run.trajectory[at] for at in np.flatnonzero(compare.late(times, LATE))]

    @cached_property
    def vertices(self) -> NDArray[np.float64]:
        """Mean position of each vertex, m, shape (V, 3)."""
        return np.mean([self.mesh.positions(frame) for frame in self.frames], axis=0)

    @cached_property
    def sheet(self) -> FilledSheet:
        """The sheet of springs with the water of the run."""
        volume = self.remaining * particle_mass(self.values, self.spacing) / RHO0
        return springs(self.run, self.mesh, self.values, volume)

    @cached_property
    def exact(self) -> AtRest:
        """The rest shape with the folds of the run."""
        return self.sheet.at_rest(self.vertices)

    @property
    def smooth(self) -> AtRest:
        """The rest shape next to a bowl without folds."""
        flat = self.vertices.copy()
        side = np.max(np.abs(flat[:, :2]))
        bowl = 4 / 3 * self.exact_sag * np.prod(1 - (flat[:, :2] / side) ** 2, axis=1)
        flat[~self.sheet.held, 2] = self.pins - bowl[~self.sheet.held]
        return self.sheet.at_rest(flat)

    @cached_property
    def pins(self) -> float:
        """Height of the pins, m."""
        return float(np.mean(self.vertices[self.sheet.held, 2]))

    @property
    def exact_sag(self) -> float:
        """Sag of the rest shape, m."""
        return self.pins - self.exact.bottom

    @cached_property
    def level(self) -> float:
        """Height of the surface, in the middle third of the pool, m."""
        water = np.concatenate([frame.select(1).positions for frame in self.frames])
        half = np.max(np.abs(water[:, :2])) / 3
        near = np.all(np.abs(water[:, :2]) < half, axis=1)
        particle = particle_mass(self.values, self.spacing) / RHO0
        layer = len(self.frames) * (2 * half) ** 2 * self.spacing / particle
        return surface_level(water[near, 2], layer, self.spacing)

    @property
    def sag(self) -> float:
        """Depth of the lowest vertex below the pins, m."""
        return self.pins - float(np.min(self.vertices[:, 2]))

    @property
    def depth(self) -> float:
        """Depth of the water over the lowest vertex, m."""
        return self.level - float(np.min(self.vertices[:, 2]))

    @property
    def depth_error(self) -> float:
        """Depth over that of the rest shape - 1."""
        return self.depth / self.exact.depth - 1

    def shape_error(self) -> float:
        """Return the rms distance of wet vertices from the rest shape, m."""
        wet = self.vertices[:, 2] < self.level
        return compare.rms(np.linalg.norm((self.vertices - self.exact.positions)[wet], axis=1))

    @cached_property
    def remaining(self) -> int:
        """Number of particles above the sheet in the end; the others spilled."""
        return int(np.sum(above_sheet(self.mesh, self.frames[-1])))

    def speed(self, kind: int) -> float:
        """Return the rms speed of water, 1, or vertices, 2, in the last frames, m/s."""
        moving = np.concatenate([frame.select(kind).velocities for frame in self.frames])
        return math.sqrt(3) * compare.rms(moving)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run the example at three resolutions until it is at rest, and find the exact rest shapes."""
    refined = Refinement.of(partial(_run, values, runner), three(values["across"]))
    pools = refined.each(lambda run, across: Pool(run, values, across))
    pool, fine = pools[-1], refined.fine
    force = fine.thermo["v_pins"][compare.late(fine.thermo["Time"], LATE)] / pool.sheet.weight
    _plot(pool, runner.picture)
    return {
        "pins": float(np.mean(force)) - 1,
        "sag": pool.sag / pool.exact_sag - 1,
        "depth": pool.depth_error,
        "momentum": float(np.max(fine.thermo["v_momentum"])),
        "crossed": max(crossings(each.mesh, each.run.trajectory).count for each in pools),
        "spilled": particles(values, pool.spacing) - pool.remaining,
        "sag_reference": pool.exact_sag,
        "depth_reference": pool.exact.depth,
        "level": (pool.level - pool.exact.level) / pool.spacing,
        "shape": pool.shape_error() / pool.spacing,
        "fold": (pool.pins - pool.smooth.bottom) / pool.exact_sag - 1,
        "scatter": float(np.std(force)),
        "speed_water": pool.speed(1),
        "speed_sheet": pool.speed(2),
        **refined.orders([each.depth_error for each in pools]),
    }


def particle_mass(values: Mapping[str, Value], spacing: float) -> float:
    """Return the mass that ``pair_coeff ... spacing`` gives a particle, kg."""
    if values["density"] == "calibrated":
        return RHO0 * spacing**3
    return RHO0 * spacing**3 / cubic_density_sum(KERNEL, SUPPORT)


def particles(values: Mapping[str, Value], spacing: float) -> int:
    """Return the number of particles poured."""
    return round(RHO0 * values["water"] * values["size"] ** 3 / particle_mass(values, spacing))


def springs(run: Run, mesh: ClothMesh, values: Mapping[str, Value], volume: float) -> FilledSheet:
    """Return the sheet of the data file, which holds its shape without load."""
    sections = read_sections(run.folder / "pour.data")
    bonds = np.array([line.split()[2:4] for line in sections["Bonds"]], dtype=np.int64)
    edges = np.searchsorted(mesh.ids, bonds)
    flat = mesh.positions(run.trajectory[0])
    length = np.linalg.norm(flat[edges[:, 1]] - flat[edges[:, 0]], axis=1)
    held = np.max(np.abs(flat[:, :2]), axis=1) > values["size"] / 2 * (1 - 1e-6)
    mass = values["areal"] * values["size"] ** 2 / len(flat)
    return FilledSheet(
        edges, length, values["stretch"], mesh.triangles, held, mass, volume, RHO0, GRAVITY
    )


def _run(values: Mapping[str, Value], runner: Runner, label: str, across: int) -> Run:
    """Run the example with so many edges over the side."""
    spacing = values["size"] / across
    names = ("size", "slack", "areal", "speed", "alpha", "density", "coupling", "scheme")
    shared = {name: values[name] for name in names}
    changed = {
        "spacing": spacing,
        "mesh": spacing,
        "pinned": spacing / 2,
        "particles": particles(values, spacing),
        "stretch": f"compliance {values['stretch']!r}",
        "solver": f"strain {values['strain']!r}",
        "volume": values["thick"] * spacing**3 or "auto",
        "dt": values["constant" if values["scheme"] == "constant" else "dt"],
        "frames": FRAMES,
    }
    return runner.run(label, values["time"], shared | changed)


def _plot(pool: Pool, path: Path) -> None:
    """Draw a cut through the middle, and the force of the pins over time."""
    figure, (cut, force) = compare.panels(1, 2)
    x, y, z = pool.frames[-1].select(1).positions.T
    middle = np.abs(y) < pool.spacing
    cut.plot(x[middle], z[middle], ".", ms=4, label="water")
    for name, places in (("sheet", pool.vertices), ("at rest", pool.exact.positions)):
        row = np.abs(pool.vertices[:, 1]) < pool.spacing / 2
        cut.plot(*places[row][:, [0, 2]].T, "x" if name == "sheet" else "k-", ms=4, label=name)
    cut.axhline(pool.exact.level, color="k", lw=0.5)
    cut.set(xlabel="x (m)", ylabel="z (m)", aspect="equal")
    cut.legend()
    time = pool.run.thermo["Time"]
    force.plot(time, pool.run.thermo["v_pins"] / pool.sheet.weight)
    force.axhline(1, color="k", lw=0.5)
    force.set(xlabel="time (s)", ylabel="force of the pins / weight", ylim=(0, 2))
    compare.save(figure, path)


CASE = Case(
    "pour",
    "the example pour at rest: filled sheet of springs",
    PARAMETERS,
    QUANTITIES,
    measure,
    find_example("pour").folder,
)
