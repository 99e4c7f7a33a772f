"""Pictures of scenes of cloth on cloth."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sphcloth.validation import compare
from sphcloth.validation.layers.contact import Scenario


def side_view(scenario: Scenario, path: Path, axes: tuple[int, int] = (0, 2)) -> None:
    """Draw the edges in the end, seen along the third axis, and energy and strain over time."""
    figure, (side, over_time) = compare.panels(1, 2)
    positions, edges = scenario.positions(), scenario.scene.mesh.edges
    for number in range(len(scenario.scene.pieces)):
        ours = edges[scenario.scene.parts[edges[:, 0]] == number]
        lines = positions[ours][:, :, axes]
        # NaN parts the lines of one plot
        gaps = np.full((len(lines), 1, 2), np.nan)
        side.plot(*np.concatenate([lines, gaps], axis=1).reshape(-1, 2).T, lw=0.4)
    names = "xyz"
    side.set(xlabel=f"{names[axes[0]]} (m)", ylabel=f"{names[axes[1]]} (m)", aspect="equal")
    thermo = scenario.run.thermo
    over_time.plot(thermo["Time"], thermo["c_strain"], label="largest strain")
    over_time.plot(thermo["Time"], thermo["v_energy"] - thermo["v_energy"][0], label="energy (J)")
    over_time.set(xlabel="time (s)")
    over_time.legend()
    compare.save(figure, path)
