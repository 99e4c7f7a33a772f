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
# hinges with a stiffness k depend on the step by their nature; and while there is no water yet,
# nothing but the ceiling keeps the schemes from folding the sheet with steps of their own
SHARED = {"bend": "0.0", "ceiling": "1", "frames": "1"}

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
        "global": {"acoustic": STEPS},
        "individual": {"acoustic": STEPS},
        "block": {"acoustic": STEPS},
    },
    reference={"scheme": "constant", "acoustic": "0.1"},
    variables=POUR.sizes()["medium"] | SHARED | {"t_end": "2.0"},
    quick=POUR.sizes()["tiny"] | SHARED | {"t_end": "1.0"},
    clock=clock,
)
