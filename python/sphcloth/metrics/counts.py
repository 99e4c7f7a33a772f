"""Balances of particles, from the thermo output of a log."""

from __future__ import annotations

import numpy as np

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.trajectory import Frame


def check_fluid_count(table: ThermoTable, frame: Frame, fluid_type: int = 1) -> None:
    """Make sure that a dumped frame holds the water that the log counts.

    Between two thermo rows the number of particles may change by what is poured and drained in
    that time; a frame past the last row is not checked.

    Raises:
        UserError: too few or too many, as from the dump of a group that new particles do not join.
    """
    if frame.step > table["Step"][-1]:
        return
    row = int(np.searchsorted(table["Step"], frame.step, side="right")) - 1
    rows = [row, min(row + 1, len(table) - 1)]
    least = table["v_fluid"][row] - np.diff(table["v_drained"][rows])[0]
    most = table["v_fluid"][row] + np.diff(table["v_poured"][rows])[0]
    count = np.count_nonzero(frame.types == fluid_type)
    if not least <= count <= most:
        raise UserError(
            f"the dump holds {count} particles of type {fluid_type} at step {frame.step}, the log "
            f"counts {least:.0f} to {most:.0f}: dump a group that poured particles join, or 'all'"
        )


def mass_balance(table: ThermoTable) -> int:
    """Return the largest abs(poured - drained - present) of any thermo row, in particles.

    Rows of a run that printed other columns do not count; UserError if none is left.
    """
    missing = np.abs(table["v_poured"] - table["v_drained"] - table["v_fluid"])
    missing = missing[np.isfinite(missing)]
    if not missing.size:
        raise UserError("no row of the log has v_poured, v_drained and v_fluid together")
    return int(missing.max())


def particle_updates(table: ThermoTable) -> float:
    """Return how many times a fluid particle was stepped.

    That is what the run counted (``v_updates``), or else, right where all particles take every
    step, the number of particles summed over the steps, linear between rows.
    """
    if "v_updates" in table:
        return float(table["v_updates"][-1] - table["v_updates"][0])
    return float(np.trapezoid(table["v_fluid"], table["Step"]))
