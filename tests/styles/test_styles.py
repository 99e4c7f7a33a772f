"""What every style must do, in the scenes of ``registry.py``: nothing here is about one style.

A run that goes on from a restart file is the one that did not stop, to the last bit; ranks, newton
and units change nothing but round-off; a wrong word is an error that names style, keyword, value
and remedy.
"""

import contextlib
import re
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from harness import attempt, instance, last_frame, run, write
from registry import ENTRIES, SCENES, Entry
from scenes import SMALL_SHEET, final_dump
from scenes.units import convert, render, units

from sphcloth.plugin import STYLES

# of positions in m, velocities in m/s, and of the largest value of what a style gives; the same of
# positions, velocities and columns in other units
ROUND_OFF, CONVERSION = 1e-10, 1e-11
# sums over atoms, whose order is another one behind a restart
SUMS = 1e-12
# so that cuts go through sheets, which are level
GRIDS = {1: "1 1 1", 2: "2 1 1", 4: "2 2 1"}
STATE = {"x": "m", "y": "m", "z": "m", "vx": "m/s", "vy": "m/s", "vz": "m/s"}
ERROR_WITHOUT_SETUP = "since the last setup, as write_restart, write_data and balance do: leave 'p"
SYSTEMS = ("lj", "cgs", "micro", "nano", "real", "metal")


def gathered(scene: str, what: str) -> dict:
    """Output, counts, columns or tables of all entries of a scene."""
    found = {}
    for entry in ENTRIES:
        if entry.scene == scene:
            found |= getattr(entry, what)
    return found


def printed(scene: str) -> dict:
    """All thermo keywords of a scene."""
    return gathered(scene, "output") | gathered(scene, "counts")


@dataclass
class End:
    """How a run ended: name -> values."""

    output: dict[str, np.ndarray]
    columns: dict[str, np.ndarray]
    tables: dict[str, np.ndarray]


@dataclass
class Runs:
    """Runs of all scenes, each made once."""

    folder: Path
    made: dict = field(default_factory=dict)

    def end(self, scene: str, ranks=1, newton="on", units="si", again=False) -> End:
        """Return the end of a run, or of what goes on from its restart file."""
        key = scene, ranks, newton, units, again
        if key not in self.made:
            self.made[key] = self._run(*key)
        return self.made[key]

    def _run(self, scene: str, ranks: int, newton: str, units: str, again: bool) -> End:
        folder = self.folder / f"{scene} {ranks} {newton} {units}".replace(" ", "_")
        if again:
            self.end(scene, ranks, newton, units)
        else:
            folder.mkdir(exist_ok=True)
            self._write_data(scene, units, folder)
        for name in gathered(scene, "tables"):
            (folder / name).unlink(missing_ok=True)
        script = write(folder, self._script(scene, ranks, newton, units, again))
        if ranks > 1:
            run(script, ranks)
        else:
            with contextlib.chdir(folder), instance() as lmp:
                lmp.commands_string(script.read_text())
        return self._read(scene, folder)

    def _write_data(self, scene: str, units: str, folder: Path) -> None:
        """The same atoms in all runs, so that random numbers and IDs are the same."""
        make = SCENES[scene].make
        if not make:
            return
        name = re.search(r"write_data (\S+)", make)[1]
        path = self.folder / name
        if not path.exists():
            with contextlib.chdir(self.folder), instance() as lmp:
                lmp.commands_string(make)
        data = path.read_text()
        (folder / name).write_text(
            data if units == "si" else convert(data, units, 2 if "dimension 2" in make else 3)
        )

    def _script(self, scene: str, ranks: int, newton: str, units: str, again: bool) -> str:
        """Thermodynamic output at other steps behind a restart, which must not matter."""
        parts, output = SCENES[scene], printed(scene)
        begin = parts.again("half.restart") if again else f"newton {newton}\n{parts.first()}"
        half = "" if again else f"run {parts.steps}\nwrite_restart half.restart\n"
        return render(
            f"processors {GRIDS[ranks]}\n{begin}thermo_style custom step {' '.join(output)}\n"
            f"thermo_modify norm no\nthermo {0 if again else 7}\n{half}run {parts.steps}\n"
            f"print '{' '.join(f'$({word}:%.17g)' for word in output)}' file output.txt\n"
            + final_dump(" ".join([*STATE, *gathered(scene, "columns")]), "end.txt")
            + parts.finish,
            units,
        )

    def _read(self, scene: str, folder: Path) -> End:
        words = (folder / "output.txt").read_text().split()
        names = ["id", *STATE, *gathered(scene, "columns")]
        return End(
            dict(zip(printed(scene), np.array(words, dtype=float), strict=True)),
            dict(zip(names, last_frame(folder / "end.txt").T, strict=True)),
            {name: np.loadtxt(folder / name) for name in gathered(scene, "tables")},
        )


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return Runs(tmp_path_factory.mktemp("runs"))


def state(end: End) -> dict[str, np.ndarray]:
    """Positions and velocities."""
    return {name: end.columns[name] for name in STATE}


def own(end: End, entry: Entry) -> dict[str, np.ndarray]:
    """What the style itself gives, without what it counts."""
    found = {name: end.columns[name] for name in entry.columns}
    found |= {name: end.output[name] for name in entry.output}
    for name in entry.tables:
        found |= {f"{name} {k}": column for k, column in enumerate(end.tables[name].T)}
    return found


def units_of(entry: Entry) -> dict[str, str]:
    """Name in :func:`own` -> unit."""
    tables = {f"{n} {k}": unit for n, of in entry.tables.items() for k, unit in enumerate(of)}
    return entry.columns | entry.output | tables


def assert_close(one: End, other: End, entry: Entry, system: str = "si") -> None:
    """The second is in some units, the first in SI."""
    limit = ROUND_OFF if system == "si" else CONVERSION
    np.testing.assert_array_equal(one.columns["id"], other.columns["id"])
    for name, here in state(one).items():
        there = state(other)[name] / units(system).of(STATE[name])
        np.testing.assert_allclose(there, here, rtol=0, atol=limit, err_msg=name)
    for name, here in own(one, entry).items():
        there = own(other, entry)[name] / units(system).of(units_of(entry)[name])
        share = limit if name in entry.columns else ROUND_OFF
        np.testing.assert_allclose(
            there, here, rtol=0, atol=share * np.abs(here).max(), err_msg=name
        )
    for name in entry.counts:
        assert one.output[name] == other.output[name], name


def checked(*checks: str):
    """Parameters: each entry with each check."""
    return [
        pytest.param(entry, check, id=f"{check}-{entry}") for entry in ENTRIES for check in checks
    ]


def test_every_registered_style_has_an_entry():
    """If this fails: give the new style a line in ENTRIES of tests/styles/registry.py."""
    assert {(entry.kind, entry.name) for entry in ENTRIES} == set(STYLES)


@pytest.mark.parametrize("entry", ENTRIES, ids=str)
def test_the_style_acts(runs, entry):
    """Otherwise the tests below would prove nothing."""
    end = runs.end(entry.scene)
    found = own(end, entry) | {name: end.output[name] for name in entry.counts}
    assert found
    for name, values in found.items():
        assert np.any(values != 0), name


@pytest.mark.parametrize("scene", SCENES)
def test_fixes_may_be_replaced_by_others_of_their_ids(scene, tmp_path, monkeypatch):
    """LAMMPS deletes the old one first, and leaves its slot empty while the new one is made."""
    monkeypatch.chdir(tmp_path)
    parts = SCENES[scene]
    again = "".join(re.findall(r"^fix (?:.*&\n)*.*\n", parts.fixes, re.MULTILINE))
    with instance() as lmp:
        if parts.make:
            lmp.commands_string(parts.make + "\nclear")
        lmp.commands_string(render(f"{parts.first()}\n{again}run 2\n", "si"))
        assert lmp.extract_global("ntimestep") == 2


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("scene", SCENES)
def test_a_file_is_written_between_runs_of_which_one_has_no_setup(scene, ranks, runs, tmp_path):
    """The same as without the file, or an error that says why: atoms may be in other places."""
    runs._write_data(scene, "si", tmp_path)
    ends = {}
    for between in ("", "write_restart half.restart noinit\n", "write_restart half.restart\n"):
        script = render(
            f"processors {GRIDS[ranks]}\n{SCENES[scene].first()}"
            f"run 12\n{between}run 12 pre no\n{final_dump(' '.join(STATE), 'end.txt')}",
            "si",
        )
        printed = attempt(write(tmp_path, script), ranks)
        if "Total wall time" in printed:
            ends[between] = last_frame(tmp_path / "end.txt")
        else:
            assert "restart\n" in between
            assert ERROR_WITHOUT_SETUP in " ".join(printed.split()), printed[-2000:]
    plain, *others = ends.values()
    np.testing.assert_array_equal(others[0], plain)
    np.testing.assert_allclose(others[-1], plain, rtol=0, atol=ROUND_OFF)


@pytest.mark.parametrize(("entry", "ranks"), checked("1", "2"))
def test_a_restart_continues_to_the_last_bit(runs, entry, ranks):
    whole, again = (runs.end(entry.scene, int(ranks), again=again) for again in (False, True))
    if int(ranks) > SCENES[entry.scene].exact_on:
        assert_close(whole, again, replace(entry, counts={}))
        return
    for name, expected in whole.columns.items():
        np.testing.assert_array_equal(again.columns[name], expected, err_msg=name)
    for name, expected in own(whole, entry).items():
        np.testing.assert_allclose(own(again, entry)[name], expected, rtol=SUMS, err_msg=name)


@pytest.mark.parametrize(("entry", "ranks"), checked("2", "4"))
def test_ranks(runs, entry, ranks):
    assert_close(runs.end(entry.scene), runs.end(entry.scene, int(ranks)), entry)


@pytest.mark.parametrize(("entry", "ranks"), checked("1", "2"))
def test_newton_off(runs, entry, ranks):
    assert_close(runs.end(entry.scene), runs.end(entry.scene, int(ranks), newton="off"), entry)


@pytest.mark.parametrize(("entry", "system"), checked(*SYSTEMS))
def test_units(runs, entry, system):
    assert_close(runs.end(entry.scene), runs.end(entry.scene, units=system), entry, system)


# ---------------------------------------------------------------------- wrong words


def error_of(command: str) -> str:
    """The error with which a command behind the small sheet ends; nothing if it does not."""
    with instance() as lmp:
        lmp.commands_string(SMALL_SHEET)
        try:
            lmp.commands_string(command)
        except Exception as error:
            return str(error).split("\nLast")[0].split(" (src/")[0]
    return ""


def name_in_errors(command: str) -> str:
    """The pattern of a style's name at the begin of its errors."""
    words = command.splitlines()[-1].split()
    if words[0] in ("fix", "compute"):
        return re.escape(f"{words[0]} {words[1]} {words[3]}: ")
    if words[0] in ("pair_style", "run_style"):
        return re.escape(f"{words[0]} {words[1]}: ")
    return rf"{words[0]}( \([\w/]+\))?: "


def keywords(message: str) -> list[str]:
    """The words that an error says it would take."""
    listed = re.split(r", | or ", re.sub(r".*: use (one of )?", "", message))
    return [words.split()[-1] for words in listed]


COMMANDS = [
    pytest.param(entry, command, id=command.splitlines()[-1])
    for entry in ENTRIES
    for command in entry.commands
]


@pytest.mark.parametrize(("entry", "command"), COMMANDS)
def test_a_wrong_word_is_named_with_the_remedy(entry, command):
    """Each keyword without a value, and with one that is none of its kind."""
    name = name_in_errors(command)
    remedy = r"(use|give|define|remove|add) \w+"
    unknown = error_of(f"{command} color red")
    assert re.search(rf"{name}.*'(color|red)'.*: {remedy}", unknown), unknown
    for keyword in keywords(unknown) if "'color'" in unknown else []:
        if re.fullmatch(entry.flags, keyword):
            continue
        alone = error_of(f"{command} {keyword}")
        assert re.search(rf"{name}.*{keyword}.* is missing", alone), (keyword, alone)
        if keyword not in entry.free.split():
            wrong = error_of(f"{command} {keyword} @")
            assert re.search(rf"{name}.*{keyword}.* '@'.*: {remedy}", wrong), (keyword, wrong)
