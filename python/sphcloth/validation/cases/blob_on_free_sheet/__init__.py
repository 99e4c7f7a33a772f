"""A drop of water hits a free sheet, slowly to supersonically, squarely and grazing."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.references.blob_on_free_sheet import Collision
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, lattice_density_in_space, numerics
from sphcloth.validation.runner import Run, Runner

# the run goes on until the drop would have gone so far across the sheet; radii of the drop
FAR = 4.0
# speeds in c0 of the runs, and that of the runs with several ranks
SPEEDS, COMPARED = (0.1, 0.5, 1.0, 3.0), 0.5
FRAMES = 100

PARAMETERS = (
    Parameter("radius", 0.1, "m", "of the drop", 1e-3, 10.0),
    REST_DENSITY,
    Parameter("sound", 20.0, "m/s", "speed of sound at rest c0", 0.1, 1e4),
    Parameter("fastest", 3.0, "c0", "largest speed of the drop", 0.1, 10.0),
    Parameter("grazing", 10.0, "degrees", "angle of the grazing impacts", 5.0, 60.0),
    Parameter("areal", 2.0, "kg/m^2", "mass per area of the sheet", 1e-2, 1e3),
    Parameter("compliance", 1e-4, "m/N", "of its edges", 0.0, 1.0),
    Parameter("length", 12.0, "radius", "of the sheet along the path of the drop", 6.0, 50.0),
    Parameter("width", 8.0, "radius", "of the sheet", 4.0, 50.0),
    Parameter("across", 6, "1", "particles over the radius", 3, 40, quick=4),
    Parameter("mesh", 1.5, "spacing", "spacing of the sheet", 0.5, 3.0),
    Parameter("most_ranks", 4, "1", "of the runs that are compared", 1, 64, quick=2),
    Parameter(
        "coupling",
        "contact",
        "1",
        "of water and sheet",
        choices=("contact", "pressure", "both"),
    ),
    Parameter(
        "wall", "own", "1", "pressure of the vertices", choices=("extrapolate", "mirror", "own")
    ),
    Parameter("thickness", 0.2, "spacing", "gap that contact keeps", 0.01, 0.5),
    cloth.ITERATIONS,
    Parameter("solver", "substeps", "1", "what the iterations are", choices=cloth.SOLVERS),
    Parameter("order", "forward", "1", "of a sweep", choices=("forward", "symmetric")),
    Parameter("direction", "start", "1", "of the projection", choices=cloth.DIRECTIONS),
    Parameter("refined", 1.0, "1", "all time steps over what they would be", 1e-3, 1.0),
    *numerics(alpha=0.1, courant=0.5, support=2.0, disorder=0.0),
)

QUANTITIES = (
    Quantity("momentum", "1", "largest change of the momentum from step 1 on", 1e-12, 1e-12),
    Quantity("energy_rise", "1", "largest rise of all energy over that at first", 1e-4, 1e-4),
    Quantity("kinetic_rise", "1", "largest rise of the kinetic energy"),
    Quantity("crossed", "1", "particles that crossed the sheet, all runs", 0.0, 0.0),
    Quantity("ranks", "1", "distance of runs with several ranks from that with one", 1e-9, 1e-9),
    Quantity("ranks_energy", "1", "the same of all energy, over that at first"),
    Quantity("momentum_at_first", "1", "relative error of the momentum in step 1"),
    Quantity("least_energy", "1", "least kinetic energy over that of one velocity, the least"),
    Quantity("slow_lost", "1", "share of the energy that the slow normal impact loses"),
    Quantity("fast_lost", "1", "share of the energy that the fast normal impact loses"),
)


@dataclasses.dataclass(frozen=True)
class Impact:
    """One run: what it was meant to be, and what it was."""

    collision: Collision
    run: Run

    @property
    def momentum(self) -> NDArray[np.float64]:
        """Total momentum from step 1 on, shape (steps, 3)."""
        return np.stack([self.run.thermo[f"v_p{axis}"][1:] for axis in "xyz"], axis=1)

    @property
    def kinetic(self) -> NDArray[np.float64]:
        """Kinetic energy over that at first."""
        return self.run.thermo["v_kinetic"] / self.collision.energy

    @property
    def total(self) -> NDArray[np.float64]:
        """Kinetic, internal and elastic energy over the kinetic energy at first."""
        stored = self.run.thermo["v_internal"] + np.nan_to_num(self.run.thermo["v_elastic"])
        return self.kinetic + stored / self.collision.energy

    @property
    def change(self) -> float:
        """Largest change of the momentum, relative."""
        size = float(np.linalg.norm(self.collision.momentum))
        return float(np.max(np.abs(self.momentum - self.momentum[0]))) / size

    @property
    def crossed(self) -> int:
        """Number of particles that crossed the sheet."""
        mesh = ClothMesh.read(self.run.folder / f"{self.run.name}.data")
        return crossings(mesh, self.run.trajectory).count


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run all speeds and angles, and one impact on several ranks."""
    speeds = [min(speed, values["fastest"]) for speed in SPEEDS]
    impacts = {
        (speed, angle): _impact(values, runner, speed, angle)
        for angle in (90.0, values["grazing"])
        for speed in dict.fromkeys(speeds)
    }
    normal = [impacts[speed, 90.0] for speed in dict.fromkeys(speeds)]
    every = list(impacts.values())
    _plot(impacts, runner)
    return {
        "momentum": max(impact.change for impact in every),
        "energy_rise": max(rise(impact.total) for impact in every),
        "kinetic_rise": max(rise(impact.kinetic) for impact in every),
        "crossed": sum(impact.crossed for impact in every),
        **_ranks(values, runner),
        "momentum_at_first": max(_first(impact) for impact in every),
        "least_energy": min(_least(impact) for impact in every),
        "slow_lost": 1 - float(normal[0].total[-1]),
        "fast_lost": 1 - float(normal[-1].total[-1]),
    }


def rise(energy: NDArray[np.float64]) -> float:
    """Return by how much a quantity ever exceeds what it was before."""
    return float(np.max(energy - np.minimum.accumulate(energy)))


def _impact(
    values: Mapping[str, Value],
    runner: Runner,
    speed: float,
    angle: float,
    label: str = "",
) -> Impact:
    """Run one impact; the speed is in c0."""
    dropped = ("fastest", "grazing", "most_ranks")
    shared = {name: values[name] for name in values if name not in dropped}
    collision = Collision(1.0, 1.0, speed * values["sound"], angle)
    # along a grazing path the drop comes down slowly, and must not leave the sheet
    down = max(-float(collision.velocity[2]), 0.3 * collision.speed)
    t_end, clock = schemes.clock(values, FAR * values["radius"] / down, FRAMES)
    run = runner.run(
        label or f"{speed:g}_{angle:g}",
        t_end,
        shared
        | clock
        | {
            "speed": collision.speed,
            "angle": angle,
            "length": values["length"] * values["radius"],
            "width": values["width"] * values["radius"],
            "lattice": lattice_density_in_space(values),
        },
    )
    masses = float(run.thermo["v_drop"][0]), float(run.thermo["v_cloth"][0])
    return Impact(Collision(*masses, collision.speed, angle), run)


def _first(impact: Impact) -> float:
    """Return the error of the momentum in step 1."""
    exact = impact.collision.momentum
    return float(np.max(np.abs(impact.momentum[0] - exact)) / np.linalg.norm(exact))


def _least(impact: Impact) -> float:
    """Return the least kinetic energy over what the momentum leaves."""
    least = impact.collision.least_energy / impact.collision.energy
    return float(np.min(impact.kinetic)) / least


def _ranks(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Return how far runs on 2, 4, ... ranks end from that on one, over radius and speed."""
    on_ranks = runner.on_ranks(values["most_ranks"])
    runs = [_impact(values, each, COMPARED, 90.0, label=label) for label, each in on_ranks.items()]
    alone, speed = runs[0], COMPARED * values["sound"]
    distance, energy = [0.0], [0.0]
    for other in runs[1:]:
        # a particle of the lattice has another ID on other ranks: it is found by its first place
        begin = [each.run.trajectory[0].positions for each in (alone, other)]
        end = [each.run.trajectory[-1] for each in (alone, other)]
        same = cKDTree(begin[1]).query(begin[0])[1]
        distance += [
            float(np.max(np.abs(end[1].positions[same] - end[0].positions))) / values["radius"],
            float(np.max(np.abs(end[1].velocities[same] - end[0].velocities))) / speed,
        ]
        energy.append(abs(float(other.total[-1] - alone.total[-1])))
    return {"ranks": max(distance), "ranks_energy": max(energy)}


def _plot(impacts: Mapping[tuple[float, float], Impact], runner: Runner) -> None:
    """Draw the energies over time, and two impacts from the side."""
    figure, axes = compare.panels(2, 2)
    angles = sorted({angle for _, angle in impacts}, reverse=True)
    for angle, energy, side in zip(angles, axes[:2], axes[2:], strict=True):
        chosen = {speed: each for (speed, other), each in impacts.items() if other == angle}
        for speed, impact in chosen.items():
            time = impact.run.thermo["Time"]
            time = time / time[-1]
            (line,) = energy.plot(time, impact.total, lw=1, label=f"{speed:g} c0")
            energy.plot(time, impact.kinetic, ":", lw=1, color=line.get_color())
        title = f"{angle:g} degrees; dotted: kinetic"
        energy.set(xlabel="time / end", ylabel="energy / that at first", title=title)
        energy.legend()
        frames = chosen[max(chosen)].run.trajectory
        # a constant step is longer than the interval of the frames at the largest speed
        frame = frames[len(frames) // 2]
        for kind, marker in ((2, "k."), (1, ".")):
            x, _, z = frame.select(kind).positions.T
            side.plot(x, z, marker, ms=1)
        side.set(xlabel="x (m)", ylabel="z (m)", aspect="equal", title=f"{max(chosen):g} c0")
    compare.save(figure, runner.picture)


CASE = Case(
    "blob-on-free-sheet",
    "momentum and energy as a drop hits a sheet: conservation",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
