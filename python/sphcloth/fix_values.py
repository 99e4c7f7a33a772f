"""The values of the fixes: which keyword of a compute stands for which ``f_ID[n]``."""

from collections.abc import Mapping

# limits of a particle's step, by their number, from 1
LIMITS = [
    "velocity",
    "force",
    "acoustic",
    "viscous",
    "density",
    "relative",
    "wetted",
    "cloth",
    "max",
]
# what a limit of a step stands for, by the name of fix sph/integrate
SET_BY = {
    "velocity": "accuracy (velocity)",
    "force": "accuracy (force)",
    "density": "accuracy (density)",
    "relative": "accuracy (relative)",
    "cloth": "accuracy (cloth)",
    "fluctuation": "accuracy (fluctuation)",
    "acoustic": "stability of the water",
    "wetted": "stability at the sheet",
    "viscous": "stability under friction",
    "output": "output",
    "growth": "growth",
    "max": "max",
    "min": "min",
}
# style of a fix -> n of f_ID[n] by the keyword that its compute has for it
NUMBERS = {
    "sph/integrate": {"limit": 1, "updates": 3, "compression": 4, "pairs": 36}
    | {f"particles/{limit}": 19 + n for n, limit in enumerate(LIMITS)},
    "pbd/cloth": {"strain": 4},
    "cloth/contact": {"contacts": 1, "stops": 2},
}
# style of a compute -> that of its fix
FIX_OF = {
    "sph/step": "sph/integrate",
    "pbd/cloth": "pbd/cloth",
    "cloth/contact": "cloth/contact",
}


def set_by(steps: Mapping[str, int]) -> str:
    """Say by what the steps of a run were set, from their number by limit: most steps first."""
    total = sum(steps.values())
    shares = sorted(steps.items(), key=lambda each: -each[1])
    # what set a step in a thousand is not worth a word
    return ", ".join(
        f"{SET_BY[name]} {count / total:.0%}" for name, count in shares if count > 0.005 * total
    )


def column(fix_id: str, style: str, keyword: str) -> str:
    """Return the name of a value in a log: ``f_step[3]`` for the updates of fix step."""
    return f"f_{fix_id}[{NUMBERS[style][keyword]}]"
