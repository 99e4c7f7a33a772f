"""The collapse of a column of water on a dry floor, by the script of the validation case."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sphcloth.tradeoff.scene import Clock, Quantity, Scene, column
from sphcloth.tradeoff.variations import ONE_RESOLUTION
from sphcloth.validation.cases import dam_break

# of the log, s; the settling time is a multiple
INTERVAL = 0.01


def clock(values: Mapping[str, float]) -> Clock:
    """Return the times of the collapse."""
    smoothing = 0.5 * values["support"] * values["width"] / values["across"]
    return Clock(smoothing / values["sound"], INTERVAL)


SCENE = Scene(
    name="dam-break",
    summary="collapse of a column of water on a dry floor, two dimensions",
    script=Path(dam_break.__file__).parent / "in.dam-break",
    quantities=(
        Quantity("kinetic", "kinetic energy", column("v_kinetic")),
        Quantity("front", "place of the front", column("v_front"), by_range=True),
        Quantity("potential", "potential energy", column("v_potential"), by_range=True),
    ),
    variations=ONE_RESOLUTION,
    reference={"scheme": "constant", "acoustic": "0.05"},
    variables={
        "across": "48",
        "first": "global",
        "settling": f"output {INTERVAL}",
        "t_settle": "0.2",
        "t_end": "0.4",
        "frames": "1",
    },
    quick={"across": "24"},
    clock=clock,
    last_run=True,
)
