"""Water pours on a sheet that hangs in a frame, by the script of the example."""

from __future__ import annotations

from collections.abc import Mapping

from sphcloth.examples import find_example
from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column
from sphcloth.tradeoff.variations import SHARES

SAMPLES = 25
STEPS = ("0.25", "0.5", "0.75", "1.0")
# sound over reference speed, by the script's density fluctuation of 1 %
MACH = 10.0


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times of the example; its support radius is two spacings."""
    return Clock(values["spacing"] / (MACH * values["speed"]), values["t_end"] / SAMPLES)


POUR = find_example("pour")
# A stiffness k depends on the step by its nature, a compliance does not.  A slack sheet takes
# another fold with every other step, so this one is as large as its frame.  Vertices that press
# are what the limit `wetted` is about.
SHARED = {
    "density": "summation",
    "coupling": "pressure",
    "stretch": "compliance 5e-5",
    "bend": "0.0",
    "slack": "0.0",
    "ceiling": "1",
    "frames": "1",
}

SCENE = Scene(
    name="pour",
    summary="water poured on a sheet in a frame",
    script=POUR.script,
    quantities=(
        Quantity("kinetic", "kinetic energy of water and sheet", column("v_kinetic")),
        Quantity("sheet", "mean height of the sheet", column("v_hang"), by_range=True),
    ),
    variations={
        "constant": {"acoustic": STEPS},
        "global": {"stability": SHARES},
        "individual": {"stability": SHARES},
        "block": {"stability": SHARES},
    },
    reference={"scheme": "constant", "acoustic": "0.1"},
    variables=POUR.sizes()["medium"] | SHARED | {"t_end": "2.0"},
    quick=POUR.sizes()["tiny"] | SHARED | {"t_end": "1.0"},
    clock=clock,
)
