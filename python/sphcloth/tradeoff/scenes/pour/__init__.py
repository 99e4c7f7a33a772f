"""Water pours on a sheet that hangs in a frame, by the script of the example."""

from __future__ import annotations

from collections.abc import Mapping

from sphcloth.examples import find_example
from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column

SAMPLES = 25
STEPS = ("0.25", "0.5", "0.75", "1.0", "1.5")
# sound over reference speed, by the script's density fluctuation of 1 %
MACH = 10.0


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times of the example; its support radius is two spacings."""
    return Clock(values["spacing"] / (MACH * values["speed"]), values["t_end"] / SAMPLES)


POUR = find_example("pour")

SCENE = Scene(
    name="pour",
    summary="water poured on a sheet in a frame",
    script=POUR.script,
    quantities=(
        Quantity("sag", "height of the lowest vertex", column("v_lowest"), by_range=True),
        Quantity("kinetic", "kinetic energy of water and sheet", column("v_kinetic")),
    ),
    variations={
        "constant": {"acoustic": STEPS},
        "global": {"acoustic": STEPS},
        "individual": {"acoustic": STEPS},
        "block": {"acoustic": STEPS},
    },
    reference={"scheme": "constant", "acoustic": "0.1"},
    variables=POUR.sizes()["medium"] | {"t_end": "2.0", "frames": "1"},
    quick=POUR.sizes()["tiny"] | {"t_end": "1.0", "frames": "1"},
    clock=clock,
)
