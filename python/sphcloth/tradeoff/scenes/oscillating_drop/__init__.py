"""A drop that oscillates in a central force field, by the script of the validation case.

Densities come from summation here, which all schemes can do.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from numpy.typing import NDArray

from sphcloth.log import ThermoTable
from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column
from sphcloth.tradeoff.variations import ONE_RESOLUTION
from sphcloth.validation.cases import oscillating_drop
from sphcloth.validation.lattice import density_sum

# of the log, s; the settling time is a multiple
INTERVAL = 0.2
KERNEL, SUPPORT = "wendland/c2", 4.0


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times of the motion."""
    smoothing = 0.5 * values["support"] * values["radius"] / values["across"]
    return Clock(smoothing / values["sound"], INTERVAL)


def total_energy(table: ThermoTable) -> NDArray:
    """Return kinetic, potential and elastic energy together, per depth, shape (rows,)."""
    return table["v_kinetic"] + table["v_potential"] + table["v_elastic"]


SCENE = Scene(
    name="oscillating-drop",
    summary="a drop in a central force field, one period, two dimensions",
    script=Path(oscillating_drop.__file__).parent / "in.oscillating-drop",
    quantities=(
        Quantity("kinetic", "kinetic energy", column("v_kinetic")),
        Quantity("shape", "second moment of the drop", column("v_potential"), by_range=True),
        Quantity("energy", "total energy", total_energy, norm="end"),
    ),
    variations=ONE_RESOLUTION,
    reference={"scheme": "constant", "acoustic": "0.05"},
    variables={
        "across": "40",
        "first": "global",
        "settling": f"output {INTERVAL}",
        "density": "summation",
        "kernel": KERNEL,
        "support": str(SUPPORT),
        "lattice": repr(density_sum(KERNEL, SUPPORT)),
        "alpha": "0.05",
        "t_settle": "2.0",
        "t_end": "6.6",
        "frames": "1",
    },
    quick={"across": "20"},
    clock=clock,
    last_run=True,
)
