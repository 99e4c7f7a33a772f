"""The values of the fixes: which keyword of a compute stands for which ``f_ID[n]``."""

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
# style of a fix -> n of f_ID[n] by the keyword that its compute has for it
NUMBERS = {
    "sph/integrate": {"limit": 1, "updates": 3, "compression": 4}
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


def column(fix_id: str, style: str, keyword: str) -> str:
    """Return the name of a value in a log: ``f_step[3]`` for the updates of fix step."""
    return f"f_{fix_id}[{NUMBERS[style][keyword]}]"
