"""Scenes of the style tests: fragments of input scripts by name, and what is made of them.

A new scene is a sum of fragments, each with its parameters and defaults::

    header("p p f") + box("0 1 0 1 0 1") + lattice() + filled("water", "0 1 0 1 0 0.5")
    + sph_tait("1 1 fluid 1000 c0 20") + neighbor(0.03)

Numbers may carry their unit, ``0.05[m]``, for scenes that run in all unit systems; see
:mod:`scenes.units`.
"""

from scenes.fragments import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    final_dump,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    no_other_bonds,
    sheet,
    sph_tait,
    stiffness,
)
from scenes.shared import (
    AGAIN_DROP,
    DROP,
    END,
    FREE_SHEET,
    MAKE_DROP,
    MAKE_FALL,
    MAKE_FLOW,
    POUR,
    SMALL_SHEET,
    TWO_FLUIDS,
    fall,
    periodic_water,
)

__all__ = [
    "AGAIN_DROP",
    "DROP",
    "END",
    "FLUID",
    "FREE_SHEET",
    "MAKE_DROP",
    "MAKE_FALL",
    "MAKE_FLOW",
    "POUR",
    "SMALL_SHEET",
    "TWO_FLUIDS",
    "box",
    "cloth_box",
    "cloth_styles",
    "fall",
    "filled",
    "final_dump",
    "gravity",
    "header",
    "jitter",
    "lattice",
    "neighbor",
    "no_other_bonds",
    "periodic_water",
    "sheet",
    "sph_tait",
    "stiffness",
]
