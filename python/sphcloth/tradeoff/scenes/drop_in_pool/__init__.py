"""A drop falls into a pool at rest: the drop is fine and the pool is coarse."""

from __future__ import annotations

from pathlib import Path

from sphcloth.tradeoff.scene import Quantity, Scene, clock_by_spacing, column
from sphcloth.tradeoff.variations import CEILINGS, COEFFICIENTS, SHARES

# of the log, s; the settling time is a multiple
INTERVAL = 0.02

SCENE = Scene(
    name="drop-in-pool",
    summary="a drop of fine water falls into a pool of coarse water at rest",
    script=Path(__file__).parent / "in.drop-in-pool",
    quantities=(
        Quantity("kinetic", "kinetic energy of drop and pool", column("v_kinetic")),
        Quantity("drop", "height of the drop's center", column("v_drop"), by_range=True),
        Quantity("spread", "radius of gyration of the drop", column("v_spread"), by_range=True),
    ),
    variations={
        "constant": {"acoustic": COEFFICIENTS},
        "global": {"stability": SHARES},
        "individual": {"stability": SHARES[1:], "ceiling": CEILINGS},
        "block": {"stability": SHARES[1:], "sleep": ("0.0", "0.02")},
    },
    reference={"scheme": "constant", "acoustic": "0.1"},
    variables={"calm": str(INTERVAL), "frames": "1"},
    quick={"across": "16", "layers": "16", "radius": "0.07"},
    clock=clock_by_spacing(INTERVAL),
    last_run=True,
)
