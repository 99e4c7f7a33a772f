"""A sheet between two pins that holds a pool of water, by the script of the validation case."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column
from sphcloth.tradeoff.variations import SHARES
from sphcloth.validation.cases import lintearia

SAMPLES = 25
STEPS = ("0.1", "0.2", "0.25", "0.3")
# substeps of the sheet in a step; 0 for as many as its strain needs, the default
SUBSTEPS = ("0", "4", "16")
CHOSEN = {"stability": SHARES[1:], "iterations": SUBSTEPS}


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times until rest."""
    smoothing = 0.5 * values["support"] * values["L"] / values["across"]
    return Clock(smoothing / values["sound"], values["t_end"] / SAMPLES)


SCENE = Scene(
    name="lintearia",
    summary="a pool of water comes to rest in a sheet between two pins",
    script=Path(lintearia.__file__).parent / "in.lintearia",
    quantities=(
        Quantity("speed", "rms speed of the water", column("v_speed")),
        Quantity("sag", "depth of the lowest vertex below the pins", column("v_sag")),
        Quantity("lift", "vertical force of a pin", column("v_pull_z"), norm="end"),
    ),
    variations={
        "constant": {"acoustic": STEPS, "iterations": SUBSTEPS},
        "global": CHOSEN,
        "individual": CHOSEN,
        "block": CHOSEN,
    },
    reference={"scheme": "constant", "acoustic": "0.05", "iterations": "32"},
    # forces of the last step: averages over steps would depend on how long these are
    variables={"across": "40", "t_end": "1.0", "average": "1", "frames": "1", "ceiling": "0.25"},
    quick={"across": "25", "layers": "4", "t_end": "0.5"},
    clock=clock,
)
