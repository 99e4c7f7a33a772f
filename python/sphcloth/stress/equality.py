"""One scene in many ways: each must end in the same state.

``python -m sphcloth.stress.equality``. Ranks, cuts of the box, newton, balancing, sorting, runs in
pieces and data files may make a difference of round-off; restart files none, but where they do in
LAMMPS itself. ``--size large`` is another scene, with a jet, a weir and a floor, where round-off
has time to grow: one way displaces a particle by little more than that.
"""

from __future__ import annotations

import json
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.results import write_json
from sphcloth.stress.case import SCENES, SCHEMES, SPACING, Outcome, nothing_crosses
from sphcloth.stress.runner import run_script

# by which an end may differ, of the spacing and of the speed of the water
SAME = 1e-6
# of the sum of m |v|, by which momentum may change where nothing acts from outside
MOMENTUM = 1e-10


@dataclass(frozen=True)
class Way:
    """One way to run the scene.

    Attributes:
        name: what differs.
        ranks: how many.
        settings: variables of the script.
        like: those of the run on one rank with which it is compared.
        renews: whether lists are renewed, and atoms put back into the box, at other steps.
        begins: whether runs begin in the middle.
    """

    name: str
    ranks: int = 1
    settings: Mapping[str, object] = field(default_factory=dict)
    like: Mapping[str, object] = field(default_factory=dict)
    renews: bool = False
    begins: bool = False

    def fits(self, box: str, scheme: str) -> bool:
        """Whether LAMMPS ends in the same state without us, see docs/evidence/reliability.md.

        A box that deforms is one step behind: images move by what it grew in the step before,
        which is another way where steps change, and none where a run begins.
        """
        return box != "deforming" or not (self.begins or (self.renews and scheme != "constant"))


RANKS = (
    Way("2 ranks", 2),
    Way("4 ranks", 4),
)
NEWTON = (
    Way("newton off", 1, {"newton": "off"}),
    Way("newton off, 2 ranks", 2, {"newton": "off"}),
)
BALANCE = (
    Way("balance, 2 ranks", 2, {"balance": "once"}),
    Way("balance, 4 ranks", 4, {"balance": "once"}),
)


def _cut(*grids: tuple[int, str]) -> tuple[Way, ...]:
    return tuple(Way(f"ranks {grid}", ranks, {"grid": grid}) for ranks, grid in grids)


@dataclass(frozen=True)
class Setup:
    """A scene, and in how many ways it runs.

    Attributes:
        script: of LAMMPS.
        boxes: kinds of the periodic box.
        steps: how many.
        step: scheme -> the constant step or the ceiling of the others, s.
        speed: of the water, m/s.
        ways: to run it.
        restarts: ranks that write, ranks that go on, and steps from one restart file to the next.
        piece: steps of the runs between restart files.
        with_data_file: whether it also begins from the data file that another run has written.
        exact: columns of the log that must be the same to the last digit in the end.
        every: steps between frames in which particles must not have crossed the sheet.
    """

    script: Path
    boxes: tuple[str, ...]
    steps: int
    step: Mapping[str, float]
    speed: float
    ways: tuple[Way, ...]
    restarts: tuple[tuple[int, int, int], ...]
    piece: int = 1
    with_data_file: bool = False
    exact: tuple[str, ...] = ()
    every: int = 0


SMALL = Setup(
    script=SCENES / "in.equal",
    boxes=("periodic", "tilted", "deforming"),
    steps=60,
    step=dict.fromkeys(SCHEMES, 1e-3) | {"constant": 3e-4},
    speed=4.0,
    ways=(
        *RANKS,
        Way("8 ranks", 8),
        *NEWTON,
        *_cut((2, "1 2 1"), (2, "1 1 2"), (4, "4 1 1"), (4, "1 2 2"), (8, "1 8 1")),
        *BALANCE,
        Way("fix balance, 2 ranks", 2, {"balance": "while"}, renews=True),
        Way("fix balance, 4 ranks", 4, {"balance": "while"}, renews=True),
        Way("no sorting", 1, {"sort": "no"}),
        Way("sorting at each list", 1, {"sort": "each"}),
        Way("lists at each step", 1, {"check": "no"}, renews=True),
        Way("lists at each step, 2 ranks", 2, {"check": "no"}, renews=True),
        Way("12 runs of 5 steps", 1, {"pieces": 12}, begins=True),
        Way("60 runs of a step, 2 ranks", 2, {"pieces": 60}, begins=True),
    ),
    restarts=((1, 1, 1), (2, 2, 10)),
    with_data_file=True,
)
# What the weir drains depends on when lists are renewed: such ways are compared with one rank.
LARGE = Setup(
    script=SCENES / "in.equal_large",
    boxes=("periodic", "tilted"),
    steps=2000,
    step=dict.fromkeys(SCHEMES, 4e-3) | {"constant": 5e-4},
    speed=2.0,
    ways=(
        Way("a particle displaced by 1e-13", 1, {"moved": 1e-13 * SPACING}),
        *RANKS,
        *NEWTON,
        *_cut((2, "1 2 1"), (2, "1 1 2"), (4, "1 2 2")),
        *BALANCE[1:],
        Way("fix balance, 4 ranks", 4, {"balance": "while"}, {"balance": "while"}),
        Way("no sorting", 1, {"sort": "no"}),
        Way("4 runs of 500 steps, 2 ranks", 2, {"pieces": 4}, {"pieces": 4}),
    ),
    restarts=((1, 1, 500), (2, 2, 500), (1, 4, 1000)),
    piece=500,
    exact=("Step", "Atoms", "v_poured", "v_drained", "v_caught"),
    every=20,
)


class Size(StrEnum):
    """Which scene."""

    SMALL = "small"
    LARGE = "large"


SETUPS = {Size.SMALL: SMALL, Size.LARGE: LARGE}


@dataclass(frozen=True)
class Found:
    """How one way ended.

    Attributes:
        box, scheme, way: which.
        ranks: how many.
        exact: whether it must be the same to the last bit.
        place, speed: largest difference from the plain run, of the spacing and of the speed of the
            water; None: there was no end.
        complaint: what else went wrong, empty if nothing.
    """

    box: str
    scheme: str
    way: str
    ranks: int
    exact: bool
    place: float | None
    speed: float | None
    complaint: str

    @property
    def passed(self) -> bool:
        """Whether it is the same."""
        if self.complaint or self.place is None or self.speed is None:
            return False
        if self.exact:
            return self.place == self.speed == 0
        return self.place <= SAME and self.speed <= SAME


@dataclass(frozen=True)
class End:
    """The last state of a run: rows of ID, place and velocity by ID, and what was counted."""

    rows: NDArray[np.float64]
    counted: Mapping[str, float]

    def differs(self, other: End) -> NDArray[np.float64]:
        """Return the largest difference of a place and of a velocity, m and m/s, shape (2,).

        Raises:
            UserError: other particles, or other numbers of the log.
        """
        for name, value in self.counted.items():
            if value != other.counted[name]:
                raise UserError(f"{name} is {value:.17g} instead of {other.counted[name]:.17g}")
        if not np.array_equal(self.rows[:, 0], other.rows[:, 0]):
            raise UserError("there are other particles")
        off = np.abs(self.rows - other.rows)
        return np.array([off[:, 1:4].max(), off[:, 4:].max()])


class Scene:
    """The scene in a box with a scheme, in a folder of its own, and the end of the plain run.

    Raises:
        UserError: the plain run does not come to its end, or to a wrong one.
    """

    def __init__(self, setup: Setup, box: str, scheme: str, folder: Path) -> None:
        self.setup, self.box, self.scheme, self.folder = setup, box, scheme, folder
        self._run("made", 1, {"from": "nothing"})
        self.plain = self._end("plain", 1, {"every": setup.every} if setup.every else {})
        if setup.every:
            self._look_at_crossings()

    def _run(self, name: str, ranks: int, settings: Mapping[str, object]) -> Outcome:
        setup = self.setup
        plain = {"box": self.box, "scheme": self.scheme, "steps": setup.steps}
        given = {**plain, "dt": setup.step[self.scheme], **settings}
        outcome = run_script(setup.script, self.folder / name, given, ranks)
        if outcome.code != 0:
            raise UserError(outcome.error or outcome.text[-200:] or "it did not end in time")
        return outcome

    def _end(self, name: str, ranks: int, settings: Mapping[str, object]) -> End:
        """Run and return the last state; UserError if the run does not come to its end."""
        given = {"from": "data", "data": "../made/equal.data", **settings}
        outcome = self._run(name, ranks, given)
        rows = np.loadtxt(outcome.folder / "end.txt", skiprows=9)
        return End(rows, self._counted(outcome.log, len(rows)) if self.setup.exact else {})

    def _counted(self, log: ThermoTable, present: int) -> dict[str, float]:
        """Return what was counted in the end; UserError if atoms or momentum went amiss."""
        made = (self.folder / "made" / "equal.data").read_text(encoding="utf-8")
        begun = int(re.search(r"^(\d+) atoms", made, re.MULTILINE)[1])
        atoms = begun + log["v_poured"] - log["v_drained"]
        if (atoms != log["Atoms"]).any() or atoms[-1] != present:
            raise UserError(f"{present} atoms, but {atoms[-1]:.0f} came and did not go")
        # from the first step on, which is half a kick of the sheet
        kept = np.stack([log["v_keeps_x"], log["v_keeps_y"]])[:, 1:]
        lost = np.abs(kept - kept[:, :1]).max() / log["v_each_sum"].max()
        # which individual steps do not conserve
        if lost > MOMENTUM and self.scheme != "individual":
            raise UserError(f"{lost:.1e} of the momentum is lost, allowed {MOMENTUM:.0e}")
        return {name: log[name][-1] for name in self.setup.exact}

    def _look_at_crossings(self) -> None:
        """Images are not looked at: nothing goes around the box."""
        folder = self.folder / "plain"
        shutil.copy(self.folder / "made" / "equal.data", folder / "stress.data")
        if complaint := nothing_crosses(Outcome(folder, {}, 0, "")):
            raise UserError(complaint)

    def way(self, way: Way) -> Found:
        """Run one way and compare it with the plain run, or with its like."""

        def ends() -> Iterator[tuple[End, End]]:
            like = self._end("like", 1, way.like) if way.like else self.plain
            yield self._end("way", way.ranks, way.settings), like

        return self._compare(way.name, way.ranks, False, ends)

    def restarts(self, writers: int, ranks: int, stride: int) -> Found:
        """Go on, on so many ranks, from the restart file of every so many steps."""
        steps = range(stride, self.setup.steps, stride)
        at = f"each of {len(steps)} steps" if len(steps) > 1 else f"step {stride}"
        name = f"restart at {at}" + (f" of {writers} on {ranks} ranks" if writers != ranks else "")
        # LAMMPS changes the last bits of places where it reads atoms of a tilted box, and their
        # order where it reads those of several ranks in one that has changed
        same = self.box == "periodic" or (self.box == "deforming" and ranks == 1)
        exact = same and writers == ranks
        return self._compare(name, ranks, exact, lambda: self._restarts(writers, ranks, steps))

    def _restarts(self, writers: int, ranks: int, steps: range) -> Iterator[tuple[End, End]]:
        """LAMMPS sorts atoms where a run begins: one that goes on begins where the other did."""
        length, piece = self.setup.steps, self.setup.piece
        whole = self._end("whole", writers, {"pieces": length // piece, "files": "yes"})
        for step in steps:
            given = {"from": "restart", "file": f"../whole/equal.restart.{step}", "begun": step}
            given["pieces"] = (length - step) // piece
            yield self._end("again", ranks, given), whole

    def data_file(self) -> Found:
        """Write a data file at the begin and start from it: it holds no rest shape and no step."""
        return self._compare("write_data and back", 1, False, self._data_file)

    def _data_file(self) -> Iterator[tuple[End, End]]:
        self._end("written", 1, {"steps": 0, "last": "copy"})
        yield self._end("again", 1, {"data": "../written/copy"}), self.plain

    def _compare(
        self, name: str, ranks: int, exact: bool, ends: Callable[[], Iterable[tuple[End, End]]]
    ) -> Found:
        about = (self.box, self.scheme, name, ranks, exact)
        try:
            off = np.max([here.differs(there) for here, there in ends()], axis=0)
        except UserError as error:
            return Found(*about, None, None, str(error))
        return Found(*about, *(off / (SPACING, self.setup.speed)).tolist(), "")


def all_ways(setup: Setup, box: str, scheme: str) -> Iterator[Found]:
    """Run everything in a box with a scheme."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            scene = Scene(setup, box, scheme, Path(folder))
        except UserError as error:
            yield Found(box, scheme, "plain", 1, False, None, None, str(error))
            return
        yield from (scene.way(way) for way in setup.ways if way.fits(box, scheme))
        yield from (scene.restarts(*given) for given in setup.restarts)
        if setup.with_data_file:
            yield scene.data_file()


def keep(found: Sequence[Found], path: Path) -> None:
    """Write what was found, in the place of what a file had of the same boxes and schemes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    here = {(one.box, one.scheme) for one in found}
    rows = [row for row in rows if (row["box"], row["scheme"]) not in here]
    rows += [asdict(one) | {"passed": one.passed} for one in found]
    order = lambda row: (SCHEMES.index(row["scheme"]), SMALL.boxes.index(row["box"]))  # noqa: E731
    write_json(path, sorted(rows, key=order))


def show(found: Sequence[Found], console: Console) -> None:
    """Print a row for each way, a column for each box and scheme, and what went wrong."""
    kinds = list(dict.fromkeys((f.box, f.scheme) for f in found))
    table = Table("way", *(f"{box}, {scheme}" for box, scheme in kinds))
    for way in dict.fromkeys((f.way, f.ranks) for f in found):
        here = {(f.box, f.scheme): f for f in found if (f.way, f.ranks) == way}
        table.add_row(way[0], *(_cell(here.get(kind)) for kind in kinds))
    console.print("largest difference of a place over the spacing", table)
    for f in found:
        if not f.passed:
            what = f.complaint or f"{f.place:.1e} of the spacing, {f.speed:.1e} of the speed"
            console.print(f"{f.box}, {f.scheme}, {f.way}, {f.ranks} ranks: {what}")


def _cell(found: Found | None) -> str:
    if found is None or found.place is None:
        return "" if found is None else "[red]no end[/]"
    text = f"{found.place:.1e}" if found.place else "0"
    return text if found.passed else f"[red]{text}[/]"


def main(
    size: Annotated[Size, typer.Option(help="Of the scene.")] = Size.SMALL,
    box: Annotated[str, typer.Option(metavar="A,B,...", help="Boxes; all without.")] = "",
    scheme: Annotated[str, typer.Option(metavar="A,B,...", help="Schemes.")] = ",".join(SCHEMES),
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the result here; other boxes and schemes stay."),
    ] = None,
) -> None:
    """Run one scene in many ways; exit code 1 if one of them ends in another state."""
    setup, console, found = SETUPS[size], Console(), []
    for one_box in box.split(",") if box else setup.boxes:
        for one_scheme in scheme.split(","):
            here = []
            for one in all_ways(setup, one_box, one_scheme):
                here.append(one)
                console.print(f"{one.box}, {one.scheme}, {one.way}: {_cell(one)}", highlight=False)
            found += here
            if json_file is not None:
                keep(here, json_file)
    show(found, console)
    raise typer.Exit(0 if all(one.passed for one in found) else 1)


if __name__ == "__main__":
    typer.run(main)
