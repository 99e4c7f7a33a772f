"""What a case of the stress test is: a scene, what must become of it, and how that is seen.

Checks read what the run wrote, its dump, log and data file, not what the styles say of themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.trajectory import Frame, Trajectory

SCENES = Path(__file__).parent / "scenes"
SCHEMES = ("constant", "global", "individual", "block")
WATER, CLOTH = 1, 2
# of the lattice in all scenes
SPACING = 0.05
# steps within which a run on ranks is that on one: a light sheet that flutters multiplies
# round-off by e in 70 of them
COMPARED = 1000


@dataclass(frozen=True)
class Outcome:
    """What a run left behind.

    Attributes:
        folder: with ``stress.lammpstrj``, ``log.lammps`` and, with cloth, ``stress.data``.
        settings: variable of the script -> value, with the scheme.
        code: exit code of the program, None if it was stopped because it took too long.
        text: all that it printed.
    """

    folder: Path
    settings: Mapping[str, object]
    code: int | None
    text: str

    @cached_property
    def frames(self) -> list[Frame]:
        """All frames of the dump, with their times."""
        found = Trajectory(self.folder / "stress.lammpstrj", self.folder / "log.lammps")
        return [_unwrapped(frame) for frame in found]

    @cached_property
    def log(self) -> ThermoTable:
        """The thermodynamic output."""
        return ThermoTable.read(self.folder / "log.lammps")

    @cached_property
    def mesh(self) -> ClothMesh:
        """Triangles of the cloth."""
        return ClothMesh.read(self.folder / "stress.data")

    @property
    def error(self) -> str:
        """The line with which LAMMPS ended, empty if it came to its end."""
        found = re.search(r"^ERROR.*", self.text, re.MULTILINE)
        return found[0] if found else ""


# returns what is wrong, empty if nothing is
Check = Callable[[Outcome], str]


@dataclass(frozen=True)
class Case:
    """One extreme.

    Attributes:
        name: as on the command line.
        must: what must happen, in one line.
        scene: of the script ``in.<scene>``.
        checks: all must find nothing.
        settings: variables of the script.
        quick: those of the smaller variant, in addition.
        error: pattern of the error with which the run must end; None: it must come to its end.
        or_error: pattern of an error with which it may end instead.
        schemes: of the time step, for which it is meaningful.
        ranks: on which it is meaningful.
        same: largest distance in m of a particle from where it is on one rank, in the last frame
            of the first :data:`COMPARED` steps; None: not compared.
    """

    name: str
    must: str
    scene: str
    checks: tuple[Check, ...]
    settings: Mapping[str, object] = field(default_factory=dict)
    quick: Mapping[str, object] = field(default_factory=dict)
    error: str | None = None
    or_error: str | None = None
    schemes: tuple[str, ...] = SCHEMES
    ranks: tuple[int, ...] = (1, 2, 4)
    same: float | None = 1e-6 * SPACING

    @property
    def script(self) -> Path:
        """The LAMMPS input script."""
        return SCENES / f"in.{self.scene}"

    def complaints(self, outcome: Outcome, on_one: Outcome | None) -> list[str]:
        """Return all that is wrong with a run; on_one: the same on one rank, None if it is that."""
        if outcome.code is None:
            return ["it did not end in time"]
        if self.error is not None:
            return self._wrong_end(outcome)
        if outcome.code and self.or_error and re.search(self.or_error, outcome.error):
            return []
        if outcome.code != 0:
            return [f"ended with code {outcome.code}: {outcome.error or outcome.text[-200:]}"]
        try:
            found = [check(outcome) for check in (is_finite, *self.checks)]
            if on_one is not None and self.same is not None:
                found.append(self._difference(outcome, on_one))
        except UserError as error:
            found = [str(error)]
        return [complaint for complaint in found if complaint]

    def _wrong_end(self, outcome: Outcome) -> list[str]:
        if outcome.code == 0:
            return [f"came to its end without the error '{self.error}'"]
        if outcome.code < 0 or not re.search(self.error, outcome.error):
            return [f"ended with code {outcome.code}: {outcome.error or outcome.text[-200:]}"]
        return []

    def _difference(self, outcome: Outcome, on_one: Outcome) -> str:
        """IDs of created particles depend on the ranks: each is compared with the nearest."""
        there = max((f for f in on_one.frames if f.step <= COMPARED), key=lambda f: f.step)
        here = next((f for f in outcome.frames if f.step == there.step), None)
        if here is None:
            return f"no frame of step {there.step}, which there is on one rank"
        if len(here) != len(there):
            return f"{len(here)} atoms, {len(there)} on one rank"
        if len(here) == 0:
            return ""
        trees = cKDTree(here.positions), cKDTree(there.positions)
        distances = trees[1].query(here.positions)[0], trees[0].query(there.positions)[0]
        distance = max(each.max() for each in distances)
        if distance > self.same:
            return f"{distance:.1e} m from where it is on one rank, allowed {self.same:.0e}"
        return ""


def _unwrapped(frame: Frame) -> Frame:
    """Return a frame of a periodic scene, which has them too, with places beyond the faces."""
    if "xu" not in frame.columns:
        return frame
    return replace(frame, columns=frame.columns | {d: frame.columns[f"{d}u"] for d in "xyz"})


# ---- checks -------------------------------------------------------------------------------------


def is_finite(outcome: Outcome) -> str:
    """No number of the dump or the log is NaN or infinite."""
    for frame in outcome.frames:
        for name, values in frame.columns.items():
            if not np.isfinite(values).all():
                return f"column {name} of step {frame.step} is not finite"
    for name, values in outcome.log.columns.items():
        if not np.isfinite(values).all():
            return f"thermo column {name} is not finite"
    return ""


def nothing_lost(outcome: Outcome) -> str:
    """As many particles in the end as at the begin."""
    first, last = len(outcome.frames[0]), len(outcome.frames[-1])
    return "" if first == last else f"{first} atoms at the begin, {last} in the end"


def nothing_crosses(outcome: Outcome) -> str:
    """No particle goes from one side of the sheet to the other."""
    found = crossings(outcome.mesh, outcome.frames)
    return f"particles {found.ids[:5].tolist()} crossed the sheet" if found.count else ""


def momentum(relative: float) -> Check:
    """Return a check of the sum of m v over that of m times the speed, from the second frame on.

    Velocities of cloth are those of half a step ago from its first step on. Individual steps do not
    keep momentum, and are not looked at.
    """

    def momentum_stays(outcome: Outcome) -> str:
        if outcome.settings["scheme"] == "individual":
            return ""
        frames = outcome.frames[1:]
        each = [frame.columns["mass"][:, None] * frame.velocities for frame in frames]
        scale = max(np.linalg.norm(frame, axis=1).sum() for frame in each)
        change = max(np.linalg.norm(frame.sum(axis=0) - each[0].sum(axis=0)) for frame in each)
        if change <= relative * scale:
            return ""
        return f"momentum changed by {change / scale:.1e}, allowed {relative:.0e}"

    return momentum_stays


def center_stays(within: float) -> Check:
    """Return a check that the center of mass stays where it is, within this in m."""

    def it_stays(outcome: Outcome) -> str:
        frames = outcome.frames[0], outcome.frames[-1]
        mass = frames[0].columns["mass"]
        start, end = (mass @ frame.positions / mass.sum() for frame in frames)
        moved = np.abs(end - start).max()
        return (
            "" if moved <= within else f"center of mass moved by {moved:.1e} m, allowed {within:g}"
        )

    return it_stays


def column(name: str, minimum: float, maximum: float, *, last: bool = False) -> Check:
    """Return a check of a column of the log; last: of its last row alone."""

    def column_is_within(outcome: Outcome) -> str:
        values = outcome.log[name][-1:] if last else outcome.log[name]
        if values.min() >= minimum and values.max() <= maximum:
            return ""
        return f"{name} is {values.min():.4g} to {values.max():.4g}, not {minimum:g} to {maximum:g}"

    return column_is_within


def strain_below(maximum: float, at_step: float) -> Check:
    """Return a check of the largest strain of a flat, pinned sheet of stiffness 1; at_step in s.

    A sweep takes back a share of the sag w that is the strain, and that is as w^2: what a load
    adds in a step, a dt^2, is taken back by n sweeps at n w^3 ~ a dt^2, where the strain is as
    (a dt^2 / n)^(2/3).
    """

    def strain_is_within(outcome: Outcome) -> str:
        found, step = outcome.log["v_strain"].max(), outcome.log["Dt"].max()
        allowed = maximum * (step / at_step) ** (4 / 3)
        return "" if found <= allowed else f"strain {found:.3g}, allowed {allowed:.3g}"

    return strain_is_within


def compressed_by(maximum: float) -> Check:
    """Return a check of the largest rho / 1000 - 1 of water in any frame."""

    def density_is_within(outcome: Outcome) -> str:
        found = max(frame.select(WATER).columns["rho"].max(initial=0) for frame in outcome.frames)
        return (
            ""
            if found / 1000 - 1 <= maximum
            else f"density {found:.4g}, allowed {1000 * (1 + maximum)}"
        )

    return density_is_within


def speed_below(maximum: float) -> Check:
    """Return a check of the largest speed in any frame, m/s."""

    def speed_is_within(outcome: Outcome) -> str:
        each = [np.linalg.norm(frame.velocities, axis=1).max(initial=0) for frame in outcome.frames]
        return "" if max(each) <= maximum else f"speed {max(each):.4g} m/s, allowed {maximum:g}"

    return speed_is_within


def stays_where_it_is(kind: int | None = None, within: float = 0.0) -> Check:
    """Return a check that no particle (of a type) is further from its begin than this, in m."""

    def nothing_moves(outcome: Outcome) -> str:
        frames = [f.select(kind) if kind else f for f in (outcome.frames[0], outcome.frames[-1])]
        moved = np.abs(frames[1].positions - frames[0].positions).max(initial=0)
        return "" if moved <= within else f"moved by {moved:.2e} m, allowed {within:g}"

    return nothing_moves


def says(pattern: str) -> Check:
    """Return a check that the run printed something."""

    def it_is_said(outcome: Outcome) -> str:
        return "" if re.search(pattern, outcome.text) else f"did not say '{pattern}'"

    return it_is_said
