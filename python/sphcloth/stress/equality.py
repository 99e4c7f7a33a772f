"""One scene in many ways: each must end in the same state.

``python -m sphcloth.stress.equality``. Ranks, cuts of the box, newton, balancing, sorting, runs in
pieces and data files may make a difference of round-off; restart files none, but where they do in
LAMMPS itself.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from sphcloth.errors import UserError
from sphcloth.results import write_json
from sphcloth.stress.case import SCENES, SCHEMES, SPACING
from sphcloth.stress.runner import run_script

SCRIPT = SCENES / "in.equal"
BOXES = ("periodic", "tilted", "deforming")
STEPS = 60
# s, the constant step or the ceiling of the others
STEP = dict.fromkeys(SCHEMES, 1e-3) | {"constant": 3e-4}
# m and m/s by which an end may differ: a millionth of the spacing, and of the speed of the water
SAME_PLACE, SAME_SPEED = 1e-6 * SPACING, 1e-6 * 4.0


@dataclass(frozen=True)
class Way:
    """One way to run the scene.

    Attributes:
        name: what differs.
        ranks: how many.
        settings: variables of the script.
        renews: whether lists are renewed, and atoms put back into the box, at other steps.
        begins: whether runs begin in the middle.
    """

    name: str
    ranks: int = 1
    settings: Mapping[str, object] = field(default_factory=dict)
    renews: bool = False
    begins: bool = False

    def fits(self, box: str, scheme: str) -> bool:
        """Whether LAMMPS ends in the same state without us, see docs/evidence/reliability.md.

        A box that deforms is one step behind: images move by what it grew in the step before,
        which is another way where steps change, and none where a run begins.
        """
        return box != "deforming" or not (self.begins or (self.renews and scheme != "constant"))


WAYS = (
    Way("2 ranks", 2),
    Way("4 ranks", 4),
    Way("8 ranks", 8),
    Way("newton off", 1, {"newton": "off"}),
    Way("newton off, 2 ranks", 2, {"newton": "off"}),
    *(
        Way(f"ranks {grid}", ranks, {"grid": grid})
        for ranks, grid in ((2, "1 2 1"), (2, "1 1 2"), (4, "4 1 1"), (4, "1 2 2"), (8, "1 8 1"))
    ),
    Way("balance, 2 ranks", 2, {"balance": "once"}),
    Way("balance, 4 ranks", 4, {"balance": "once"}),
    Way("fix balance, 2 ranks", 2, {"balance": "while"}, renews=True),
    Way("fix balance, 4 ranks", 4, {"balance": "while"}, renews=True),
    Way("no sorting", 1, {"sort": "no"}),
    Way("sorting at each list", 1, {"sort": "each"}),
    Way("lists at each step", 1, {"check": "no"}, renews=True),
    Way("lists at each step, 2 ranks", 2, {"check": "no"}, renews=True),
    Way("12 runs of 5 steps", 1, {"pieces": 12}, begins=True),
    Way("60 runs of a step, 2 ranks", 2, {"pieces": 60}, begins=True),
)


@dataclass(frozen=True)
class Found:
    """How one way ended.

    Attributes:
        box, scheme, way: which.
        ranks: how many.
        exact: whether it must be the same to the last bit.
        place, speed: largest difference from the plain run, m and m/s; None: there was no end.
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
        return self.place <= SAME_PLACE and self.speed <= SAME_SPEED


# rows of ID, place and velocity, in the order of IDs
State = NDArray[np.float64]


class Scene:
    """The scene in a box with a scheme, in a folder of its own, and the end of the plain run."""

    def __init__(self, box: str, scheme: str, folder: Path) -> None:
        self.box, self.scheme, self.folder = box, scheme, folder
        self._run("made", 1, {"from": "nothing"})
        self.plain = self._end("plain", 1, {})

    def _run(self, name: str, ranks: int, settings: Mapping[str, object]) -> None:
        plain = {"box": self.box, "scheme": self.scheme, "steps": STEPS, "dt": STEP[self.scheme]}
        given = {**plain, **settings}
        outcome = run_script(SCRIPT, self.folder / name, given, ranks)
        if outcome.code != 0:
            raise UserError(outcome.error or outcome.text[-200:] or "it did not end in time")

    def _end(self, name: str, ranks: int, settings: Mapping[str, object]) -> State:
        """Run and return the last state; UserError if the run does not come to its end."""
        self._run(name, ranks, {"from": "data", "data": "../made/equal.data", **settings})
        return np.loadtxt(self.folder / name / "end.txt", skiprows=9)

    def way(self, way: Way) -> Found:
        """Run one way and compare it with the plain run."""
        ends = lambda: (self._end("way", way.ranks, way.settings), self.plain)  # noqa: E731
        return self._compare(way.name, way.ranks, False, ends)

    def restarts(self, ranks: int, stride: int) -> Found:
        """Go on from the restart file of every so many steps."""
        steps = range(stride, STEPS, stride)
        name = f"restart at each of {len(steps)} steps"
        # LAMMPS changes the last bits of places where it reads atoms of a tilted box, and their
        # order where it reads those of several ranks in one that has changed
        exact = self.box == "periodic" or (self.box == "deforming" and ranks == 1)
        return self._compare(name, ranks, exact, lambda: self._restarts(ranks, steps))

    def _restarts(self, ranks: int, steps: range) -> tuple[State, State]:
        """LAMMPS sorts atoms where a run begins: one that goes on begins where the other did."""
        whole = self._end("whole", ranks, {"pieces": STEPS, "files": "yes"})
        again = []
        for step in steps:
            given = {"from": "restart", "file": f"../whole/equal.restart.{step}", "begun": step}
            again.append(self._end("again", ranks, given | {"pieces": STEPS - step}))
        return np.stack(again), np.stack([whole] * len(again))

    def data_file(self) -> Found:
        """Write a data file at the begin and start from it: it holds no rest shape and no step."""
        return self._compare("write_data and back", 1, False, self._data_file)

    def _data_file(self) -> tuple[State, State]:
        self._end("written", 1, {"steps": 0, "last": "copy"})
        return self._end("again", 1, {"data": "../written/copy"}), self.plain

    def _compare(
        self, name: str, ranks: int, exact: bool, ends: Callable[[], tuple[State, State]]
    ) -> Found:
        about = (self.box, self.scheme, name, ranks, exact)
        try:
            here, there = ends()
        except UserError as error:
            return Found(*about, None, None, str(error))
        if here.shape != there.shape:
            return Found(*about, None, None, f"{here.shape} instead of {there.shape} values")
        off = np.abs(here - there)
        return Found(*about, float(off[..., 1:4].max()), float(off[..., 4:].max()), "")


def matrix(boxes: Sequence[str], schemes: Sequence[str]) -> Iterator[Found]:
    """Run everything in each box with each scheme."""
    for box in boxes:
        for scheme in schemes:
            with tempfile.TemporaryDirectory() as folder:
                scene = Scene(box, scheme, Path(folder))
                yield from (scene.way(way) for way in WAYS if way.fits(box, scheme))
                yield scene.restarts(1, 1)
                yield scene.restarts(2, STEPS // 6)
                yield scene.data_file()


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
            what = f.complaint or f"{f.place:.1e} m, {f.speed:.1e} m/s"
            console.print(f"{f.box}, {f.scheme}, {f.way}, {f.ranks} ranks: {what}")


def _cell(found: Found | None) -> str:
    if found is None or found.place is None:
        return "" if found is None else "[red]no end[/]"
    text = f"{found.place / SPACING:.1e}" if found.place else "0"
    return text if found.passed else f"[red]{text}[/]"


def main(
    box: Annotated[str, typer.Option(metavar="A,B,...", help="Boxes.")] = ",".join(BOXES),
    scheme: Annotated[str, typer.Option(metavar="A,B,...", help="Schemes.")] = ",".join(SCHEMES),
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the result here.")] = None,
) -> None:
    """Run one scene in many ways; exit code 1 if one of them ends in another state."""
    console, found = Console(), []
    for one in matrix(box.split(","), scheme.split(",")):
        found.append(one)
        console.print(f"{one.box}, {one.scheme}, {one.way}: {_cell(one)}", highlight=False)
    show(found, console)
    if json_file is not None:
        json_file.parent.mkdir(parents=True, exist_ok=True)
        result = [asdict(one) | {"passed": one.passed} for one in found]
        write_json(json_file, result)
    raise typer.Exit(0 if all(one.passed for one in found) else 1)


if __name__ == "__main__":
    typer.run(main)
