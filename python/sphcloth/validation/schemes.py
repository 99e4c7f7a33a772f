"""The schemes of the time step in the cases with water: what a script needs for each."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sphcloth.errors import UserError
from sphcloth.validation.case import Parameter, Value

SCHEMES = ("constant", "global", "individual", "block")
# share of a frame
EARLY = 1e-6


def parameters(scheme: str = "constant", ceiling: float = 4.0) -> tuple[Parameter, ...]:
    """Return the parameters of the time step, with these defaults."""
    of_ceiling = "longest step of the other schemes over that of constant"
    return (
        Parameter("scheme", scheme, "1", "scheme of the time step", choices=SCHEMES),
        Parameter("ceiling", ceiling, "1", of_ceiling, 1.0, 100.0),
        Parameter("gain", 1.0, "1", "updates that unequal steps must save, block", 1.0, 100.0),
    )


def check(values: Mapping[str, Value]) -> None:
    """Refuse a scheme that the other settings of a case cannot be combined with.

    Raises:
        UserError: names the setting, its value and the remedy.
    """
    scheme = values.get("scheme")
    if scheme == "individual" and values.get("density") == "continuity":
        raise UserError(
            f"--set scheme={scheme}: individual steps need densities by summation, not "
            "density=continuity: add --set density=summation, or take another scheme"
        )
    if scheme == "block" and values.get("density") == "continuity" and values.get("shift"):
        raise UserError(
            "--set scheme=block: density=continuity follows positions and does not know what is a "
            "shift of particles: add --set density=summation or --set shift=0, or take another "
            "scheme"
        )


def keywords(values: Mapping[str, Value]) -> dict[str, Value]:
    """Return the script's variables for a scheme: the ceiling, and keywords of fix sph/integrate.

    No limit is among them: what a user gets without any is what is looked at.
    """
    limits = {"limits": f"gain {values['gain']!r}"} if values["scheme"] == "block" else {}
    return {"ceiling": values["ceiling"], **limits}


def clock(
    values: Mapping[str, Value],
    t_end: float,
    frames: float,
    t_settle: float = 0.0,
    every: str = "v_next",
) -> tuple[float, dict[str, Value]]:
    """Return the end of a run in s, and the script's variables for a scheme, frames and log.

    With ``block`` all velocities belong to one time at exact output times only: every frame, the
    start of the motion and its end are made such times.

    Args:
        values: of the parameters of the case.
        t_end: time at which the run ends, s.
        frames: number of frames from ``t_settle`` to the end.
        t_settle: time at which the first frame is written and the motion starts, s.
        every: steps from row to row of the log with ``block``.
    """
    settled = {"t_settle": t_settle} if t_settle else {}
    variables = {"frames": frames, **settled, **keywords(values)}
    if values["scheme"] != "block":
        return t_end, variables
    interval = (t_end - t_settle) / frames
    variables["limits"] += f" output {interval!r}"
    # a little before the output time, which is then the first step that reaches it
    begin = math.ceil(t_settle / interval - EARLY)
    if t_settle:
        variables["t_settle"] = (begin - EARLY) * interval
        variables["settling"] = variables["limits"]
    t_end = (begin + math.floor(frames) - EARLY) * interval
    return t_end, variables | {"interval": interval, "every": every}
