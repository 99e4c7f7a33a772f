"""Water swings in a tank past a sheet: it is fine at the sheet and coarse beyond."""

from __future__ import annotations

from pathlib import Path

from sphcloth.tradeoff.scene import Quantity, Scene, clock_by_spacing, column
from sphcloth.tradeoff.variations import CEILINGS, SHARES

# of the log, s; the settling time is a multiple
INTERVAL = 0.03
COEFFICIENTS = ("0.2", "0.4", "0.6", "0.8", "1.0", "1.2", "1.4", "1.6", "1.8")
# for schemes in which particles have steps of their own
UNEQUAL = {"stability": SHARES[1:], "ceiling": CEILINGS}


SCENE = Scene(
    name="two-resolutions",
    summary="water swings past a sheet, fine at the sheet and coarse beyond",
    script=Path(__file__).parent / "in.two-resolutions",
    quantities=(
        Quantity("flow", "mean horizontal velocity of the water", column("v_flow")),
        Quantity("kinetic", "kinetic energy of water and sheet", column("v_kinetic")),
        Quantity("billow", "mean deflection of the sheet", column("v_billow")),
    ),
    variations={
        "constant": {"acoustic": COEFFICIENTS},
        "global": {"stability": SHARES},
        "individual": UNEQUAL,
        "block": UNEQUAL | {"ceiling": ("4.0", "8.0")},
    },
    reference={"scheme": "constant", "acoustic": "0.1"},
    variables={"calm": str(INTERVAL), "frames": "1"},
    quick={"across": "16", "layers": "18", "hole": "2", "below": "10"},
    clock=clock_by_spacing(INTERVAL),
    last_run=True,
)
