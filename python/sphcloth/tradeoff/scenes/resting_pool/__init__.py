"""A drop falls into a corner of a pool that rests: most of the water has nothing to do."""

from __future__ import annotations

from pathlib import Path

from sphcloth.tradeoff.scene import Quantity, Scene, clock_by_spacing, column
from sphcloth.tradeoff.variations import ONE_RESOLUTION, SHARES

# of the log, s; the settling time is a multiple
INTERVAL = 0.02

SCENE = Scene(
    name="resting-pool",
    summary="a drop falls into a corner of a pool at rest, two dimensions",
    script=Path(__file__).parent / "in.resting-pool",
    quantities=(
        Quantity("kinetic", "kinetic energy", column("v_kinetic")),
        Quantity("drop", "height of the drop's center", column("v_drop"), by_range=True),
        Quantity("potential", "potential energy", column("v_potential"), by_range=True),
    ),
    variations=ONE_RESOLUTION
    | {"block": {"stability": SHARES[1:], "sleep": ("0.0", "0.02", "0.1")}},
    reference={"scheme": "constant", "acoustic": "0.05"},
    variables={"calm": str(INTERVAL), "frames": "1"},
    quick={"spacing": "0.02", "width": "1.6"},
    clock=clock_by_spacing(INTERVAL),
    last_run=True,
)
