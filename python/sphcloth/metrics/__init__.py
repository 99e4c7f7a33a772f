"""What a run did to water and cloth, measured from its dump and log alone.

Nothing here uses what the contact styles report: it is an independent check of them. Only
:func:`pin_force` adds up what a compute has written.
"""

from __future__ import annotations

from sphcloth.metrics.cloth import edge_strain, elastic_energy, enclosed_volume, pin_force
from sphcloth.metrics.counts import check_fluid_count, mass_balance, particle_updates
from sphcloth.metrics.motion import (
    angular_momentum,
    kinetic_energy,
    masses,
    masses_of,
    momentum,
    outer_force,
    potential_energy,
)
from sphcloth.metrics.passages import Crossings, above_sheet, crossings
from sphcloth.metrics.water import compressed_share, density_deviation, front, held_volume

__all__ = [
    "Crossings",
    "above_sheet",
    "angular_momentum",
    "check_fluid_count",
    "compressed_share",
    "crossings",
    "density_deviation",
    "edge_strain",
    "elastic_energy",
    "enclosed_volume",
    "front",
    "held_volume",
    "kinetic_energy",
    "mass_balance",
    "masses",
    "masses_of",
    "momentum",
    "outer_force",
    "particle_updates",
    "pin_force",
    "potential_energy",
]
