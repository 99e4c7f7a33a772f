"""The summary of a finished example: numbers, pictures, plot, verdict."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth import metrics
from sphcloth.advice.evidence import Evidence
from sphcloth.advice.unused import Finding, unused
from sphcloth.fix_values import set_by
from sphcloth.log import ThermoTable
from sphcloth.metrics.intersections import REMEDY, MostMet
from sphcloth.rendering.scene_roles import Choice, SceneRoles
from sphcloth.results import show_rows, text, versions, write_json
from sphcloth.roles import Roles
from sphcloth.trajectory import Frame, Trajectory, samples

CONTACT = "cloth/contact"
# columns of a dump that are measured, beside those that every dump has
MEASURED = ("rho", "ix", "iy", "iz")


@dataclass(frozen=True)
class Summary:
    """What one run showed; None where the log lacks the column, counts in particles.

    Attributes:
        time: physical time reached.
        steps: steps done.
        poured: particles poured.
        on_sheet: particles with the sheet below them in the last frame.
        spilled: particles poured that are not on the sheet: beside it, below it or drained.
        crossed: particles that went through the sheet where it has no pores, from the dump alone;
            None of a dump with a single frame, or where frames are too far apart to tell.
        through_pores: particles that went through its pores; None without fix cloth/pores.
        crossing_steps: for those, the steps of the frames after the crossing, without repeats.
        unclear_steps: the same of particles that moved too far between two frames to tell.
        layers: whether cloth meets cloth (``cloth yes``).
        intersections: pairs of an edge and a triangle, of cloth and cloth or of cloth and obstacle,
            that meet in the frame with most of them; None without ipctk, or without layers.
        mass_defect: largest abs(poured - drained - present) at any time.
        deviation: largest abs(rho - rho0) / rho0 under pressure.
        compressed: share of the water, of all frames, that is denser than at rest by more than 1 %.
        momentum_defect: largest sum of the internal forces over the total weight.
        contact_share: part of the wall time that contact with the cloth took, since the last
            ``run`` command or since the run went on.
        step_set_by: steps by the limit that set them; empty with constant steps.
        particle_updates: number of times a fluid particle was stepped.
        updates_per_second: the same per second of wall time in the loop, of what has both: a run
            that was stopped has no wall time.
        pictures: all PNG files, the contact sheet and the plot first.
        versions: package -> version.
        unused: what is switched on in the script and was never needed.
    """

    time: float
    steps: int
    poured: int | None
    on_sheet: int | None
    spilled: int | None
    crossed: int | None
    through_pores: int | None
    crossing_steps: list[int]
    unclear_steps: list[int]
    layers: bool
    intersections: int | None
    mass_defect: int | None
    deviation: float | None
    compressed: float | None
    momentum_defect: float | None
    contact_share: float | None
    step_set_by: dict[str, int]
    particle_updates: float | None
    updates_per_second: float | None
    pictures: list[str]
    versions: dict[str, str]
    unused: list[Finding]

    @property
    def passed(self) -> bool:
        """Whether nothing crossed the sheet, no cloth meets cloth, and no particle is missing.

        A scene of cloth alone has no particles to show.
        """
        if self.intersections:
            return False
        return self.on_sheet is None or (self.crossed == 0 and self.mass_defect == 0)

    def write(self, path: Path) -> None:
        """Write all values and the verdict as JSON."""
        values = asdict(self) | {"passed": self.passed}
        write_json(path, values)

    def show(self, console: Console) -> None:
        """Print the values on one screen, what must be zero marked by whether it is."""
        show_rows(self._rows(), console)

    def _rows_of_pores(self) -> list[tuple[str, str]]:
        if self.through_pores is None:
            return []
        return [("went through pores", text(self.through_pores))]

    def _crossed(self) -> str:
        if self.crossed is None and self.unclear_steps:
            return "[yellow]frames are too far apart to tell[/]"
        return _must_be_zero(self.crossed)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [
            ("time reached", f"{self.time:.4g}"),
            ("particles poured", text(self.poured)),
            ("on the sheet", text(self.on_sheet)),
            ("spilled", text(self.spilled)),
            ("crossed the sheet", self._crossed()),
            *self._rows_of_pores(),
            ("poured - drained - present", _must_be_zero(self.mass_defect)),
            ("largest density deviation", text(self.deviation, "{:.2%}")),
            ("water denser by more than 1 %", text(self.compressed, "{:.1%}")),
            ("momentum defect / weight", text(self.momentum_defect, "{:.1e}")),
            ("share of contact in the run", text(self.contact_share, "{:.1%}")),
            ("steps", text(self.steps)),
            ("particle updates", text(self.particle_updates, "{:.3e}")),
            ("particle updates per second", text(self.updates_per_second, "{:.3e}")),
        ]
        if self.step_set_by:
            rows.insert(-2, ("the step is set by", set_by(self.step_set_by)))
        if self.layers:
            met = "edges of cloth through triangles"
            without = f"not looked for: {REMEDY}"
            seen = without if self.intersections is None else _must_be_zero(self.intersections)
            rows.insert(5, (met, seen))
        if self.on_sheet is None:
            # a scene of cloth alone: what is not there says nothing
            rows = [row for row in rows if "n/a" not in row[1]]
        for head, steps in (
            ("crossings seen at steps", self.crossing_steps),
            ("frames too far apart at steps", self.unclear_steps),
        ):
            if steps:
                rows.append((head, ", ".join(map(str, steps[:8]))))
        if self.unused:
            rows.append(("never needed", "; ".join(each.topic for each in self.unused)))
        rows += [("", picture) for picture in self.pictures[:2]]
        return rows


def summarize(folder: Path, name: str, frames: int | None) -> Summary:
    """Measure a run from its files, and draw it.

    Args:
        folder: holds ``log.lammps``, ``<name>.lammpstrj`` and ``<name>.data``.
        name: the example's name.
        frames: number of pictures; None draws nothing.

    Raises:
        UserError: a file is missing or cannot be read.
    """
    table = ThermoTable.read(folder / "log.lammps")
    trajectory = Trajectory(folder / f"{name}.lammpstrj", table, MEASURED)
    roles = Roles.read(folder / f"{name}.data")
    some = samples(trajectory)
    scene_roles = SceneRoles.of(some, roles, Choice())
    can_balance = all(column in table for column in ("v_poured", "v_drained", "v_fluid"))
    poured = _last_count(table, "v_poured")
    evidence = Evidence.of_log(folder / "log.lammps", table)
    porous = evidence.commands.porous(scene_roles.mesh)
    layers = any(fix.value("cloth", "no") == "yes" for fix in evidence.commands.styled(CONTACT))
    met = _met(scene_roles) if layers else None
    densities = Densities(roles.rest_density)
    watchers = [met.watch] if met else []
    if scene_roles.mesh is not None and scene_roles.fluid:
        watchers.append(densities.watch)
        # the log counts the water of all types together
        if can_balance and len(scene_roles.fluid) == 1:
            fluid = min(scene_roles.fluid)
            watchers.append(lambda frame: metrics.check_fluid_count(table, frame, fluid))
    # reading takes most of the time, so each frame is read once for all
    passing = _watched(trajectory, watchers)
    water = Water.of(trajectory, passing, scene_roles, porous)
    if watchers:
        deque(passing, maxlen=0)
    pictures = []
    if frames is not None:
        # takes long to load, and a run without pictures has no use for it
        from sphcloth.pictures import draw

        pictures = draw(trajectory, some, scene_roles, table, folder, frames)
    return Summary(
        time=float(table["Time"][-1]),
        steps=int(table["Step"][-1] - table["Step"][0]),
        poured=poured,
        on_sheet=water.on_sheet,
        spilled=None if None in (poured, water.on_sheet) else poured - water.on_sheet,
        crossed=water.crossed,
        through_pores=water.through_pores,
        crossing_steps=water.crossing_steps,
        unclear_steps=water.unclear_steps,
        layers=layers,
        intersections=met.count if met else None,
        mass_defect=metrics.mass_balance(table) if can_balance else None,
        deviation=_largest(table, "v_deviation"),
        compressed=densities.compressed,
        momentum_defect=_largest(table, "v_momentum"),
        contact_share=_contact_share(table.runs[-1]),
        step_set_by=evidence.commands.steps_by_limit,
        particle_updates=_updates(table),
        updates_per_second=_rate(table.runs),
        pictures=pictures,
        versions=versions(),
        unused=unused(evidence),
    )


@dataclass(frozen=True)
class Water:
    """Where the water of a run is; all None in a scene without water or without cloth.

    Attributes:
        on_sheet: particles with the sheet below them in the last frame.
        crossed: particles that went through the sheet where it has no pores; None of a dump with a
            single frame, or where some seem to and moved too far between two frames to tell.
        through_pores: particles that went through pores; None if there are none.
        crossing_steps: the steps of the frames after that, without repeats.
        unclear_steps: the same of those that moved too far.
    """

    on_sheet: int | None = None
    crossed: int | None = None
    through_pores: int | None = None
    crossing_steps: list[int] = field(default_factory=list)
    unclear_steps: list[int] = field(default_factory=list)

    @classmethod
    def of(
        cls,
        trajectory: Trajectory,
        frames: Iterable[Frame],
        scene_roles: SceneRoles,
        porous: Collection[int] = (),
    ) -> Water:
        """Follow all water through a dump.

        Args:
            trajectory: the dump.
            frames: its frames, of which all or none are taken, each once.
            scene_roles: of its atoms.
            porous: angle types of triangles with pores.
        """
        kinds, mesh = sorted(scene_roles.fluid), scene_roles.mesh
        if mesh is None or not kinds:
            return cls()
        on_sheet = int(np.count_nonzero(metrics.above_sheet(mesh, trajectory[-1], kinds)))
        if len(trajectory) < 2:
            return cls(on_sheet)
        found = metrics.crossings(mesh.without_kinds(porous), frames, kinds)
        clear, unclear = (found.steps[found.is_unclear == far] for far in (False, True))
        can_tell = len(clear) or not len(unclear)
        crossed = len(np.unique(found.ids[~found.is_unclear])) if can_tell else None
        through = None
        if porous:
            through = metrics.crossings(mesh.of_kinds(porous), trajectory, kinds).count
        seen = np.unique(clear).tolist(), np.unique(unclear).tolist()
        return cls(on_sheet, crossed, through, *seen)


@dataclass
class Densities:
    """How much water of the frames is compressed."""

    rest: Mapping[int, float]
    dense: float = 0.0
    particles: int = 0

    def watch(self, frame: Frame) -> None:
        """Count those of a frame."""
        for kind, rest in self.rest.items():
            n = int(np.count_nonzero(frame.types == kind))
            if n and "rho" in frame.columns:
                self.dense += n * metrics.compressed_share(frame, rest, kind)
                self.particles += n

    @property
    def compressed(self) -> float | None:
        """Share of the water that is denser than at rest by more than 1 %."""
        return self.dense / self.particles if self.particles else None


def _watched(
    frames: Iterable[Frame], watchers: Sequence[Callable[[Frame], None]]
) -> Iterator[Frame]:
    """Pass frames on, each after all have seen it."""
    for frame in frames:
        for watch in watchers:
            watch(frame)
        yield frame


def _met(scene_roles: SceneRoles) -> MostMet | None:
    """Return what counts edges through triangles; None without ipctk, which finds them."""
    if scene_roles.mesh is None or find_spec("ipctk") is None:
        return None
    return MostMet(scene_roles.mesh, scene_roles.cloth)


def _updates(table: ThermoTable) -> float | None:
    """Return how many times fluid particles were stepped; None if the table does not tell."""
    can_count = "v_updates" in table or "v_fluid" in table
    return metrics.particle_updates(table) if can_count else None


def _rate(runs: Iterable[ThermoTable]) -> float | None:
    """Return the particle updates per second of wall time, of the runs that tell both."""
    both = [(_updates(run), run.loop_seconds) for run in runs]
    both = [(updates, seconds) for updates, seconds in both if updates and seconds]
    return sum(each[0] for each in both) / sum(each[1] for each in both) if both else None


def _contact_share(run: ThermoTable) -> float | None:
    """Return the last share; the first row is written before there is a time to be shared."""
    has_share = "v_contact_share" in run and len(run) > 1
    return float(run["v_contact_share"][-1]) if has_share else None


def _last_count(table: ThermoTable, column: str) -> int | None:
    return int(table[column][-1]) if column in table else None


def _largest(table: ThermoTable, column: str) -> float | None:
    return float(np.nanmax(np.abs(table[column]))) if column in table else None


def _must_be_zero(value: int | None) -> str:
    return f"[{'red' if value else 'green'}]{text(value)}[/]"
