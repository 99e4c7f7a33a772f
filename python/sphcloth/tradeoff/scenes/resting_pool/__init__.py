"""A drop falls into a corner of a pool that rests: most of the water has nothing to do."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column

# of the log, s; the settling time is a multiple
INTERVAL = 0.02
COEFFICIENTS = ("0.2", "0.4", "0.8", "1.2", "1.4", "1.6", "1.8", "2.0", "2.2")
FORCE = ("0.05", "0.2")
# for schemes in which particles have steps of their own
UNEQUAL = {"acoustic": COEFFICIENTS[1:6:2], "ceiling": ("1.0", "2.0", "4.0")}


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times of the fall."""
    return Clock(0.5 * values["support"] * values["spacing"] / values["sound"], INTERVAL)


SCENE = Scene(
    name="resting-pool",
    summary="a drop falls into a corner of a pool at rest, two dimensions",
    script=Path(__file__).parent / "in.resting-pool",
    quantities=(
        Quantity("kinetic", "kinetic energy", column("v_kinetic")),
        Quantity("drop", "height of the drop's centre", column("v_drop"), by_range=True),
        Quantity("potential", "potential energy", column("v_potential"), by_range=True),
    ),
    variations={
        "constant": {"acoustic": COEFFICIENTS},
        "global": {"acoustic": COEFFICIENTS[1:6], "force": FORCE},
        "individual": UNEQUAL,
        "block": {"acoustic": COEFFICIENTS[1:6], "sleep": ("0.0", "0.02", "0.1")},
    },
    reference={"scheme": "constant", "acoustic": "0.05"},
    variables={"calm": str(INTERVAL), "frames": "1"},
    quick={"spacing": "0.02", "width": "1.6"},
    clock=clock,
    last_run=True,
)
