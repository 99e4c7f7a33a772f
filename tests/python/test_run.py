"""Running an example, with a scene of stock LAMMPS: drops that fall on, or through, a square."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import CLOTH_SCRIPT
from rich.console import Console

import sphcloth.run
from sphcloth import examples
from sphcloth.dump import has_frame
from sphcloth.errors import UserError
from sphcloth.run import run_example
from sphcloth.stress.processes import descendants
from sphcloth.summary import summarize

SCRIPT = f"""\
variable        t_end index 0.5
variable        floor index 0.55   # drops bounce here: above the sheet at 0.5 or not
variable        source index 1     # particles claimed to have been poured
boundary        p p f
{CLOTH_SCRIPT}
write_data      drop.data nofix
group           fluid type 1
fix             1 fluid nve
fix             2 fluid gravity 9.81 vector 0 0 -1
fix             3 fluid wall/reflect zlo ${{floor}}
variable        fluid equal count(fluid)
variable        poured equal ${{source}}
variable        drained equal 0
dump            1 all custom 10 drop.lammpstrj id type x y z vx vy vz
timestep        0.001
thermo          10
thermo_style    custom step time dt v_fluid v_poured v_drained
thermo_modify   line yaml flush yes
variable        n equal round(${{t_end}}/dt)
run             ${{n}}
"""


@pytest.fixture
def drop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the example 'drop' the only one there is; return a folder for its output."""
    folder = tmp_path / "examples" / "drop"
    folder.mkdir(parents=True)
    (folder / "in.drop").write_text(SCRIPT)
    (folder / "sizes.toml").write_text("[tiny]\nt_end = 0.1\n[small]\nt_end = 0.3\n")
    monkeypatch.setattr(examples, "_examples_folder", lambda: folder.parent)
    return tmp_path / "out"


def run(out: Path, size: str = "small", ranks: int = 1, **settings: str) -> tuple[int, str]:
    """Run the example; return the exit code and what it printed."""
    text = io.StringIO()
    code = run_example("drop", size, ranks, out, settings, None, Console(file=text, width=100))
    return code, text.getvalue()


def test_a_sheet_that_holds_is_success(drop: Path) -> None:
    code, text = run(drop, ranks=2)
    summary = json.loads((drop / "summary.json").read_text())
    assert code == 0, text
    assert summary["passed"]
    assert (summary["poured"], summary["on_sheet"], summary["crossed"]) == (1, 1, 0)
    assert summary["time"] == pytest.approx(0.3)
    assert summary["particle_updates"] == 300
    assert summary["deviation"] is None
    assert summary["compressed"] is None  # the dump has no densities
    assert "n/a" in text


def test_what_is_counted_per_second_is_of_the_runs_whose_time_is_known(drop: Path) -> None:
    """A run that was stopped at step 200 and went on; the first row of a run tells no share."""
    run(drop)
    log = drop / "log.lammps"
    text = re.sub(r"Loop time of \S+ on", "Loop time of 0.5 on", log.read_text())
    text = re.sub(r"(?m)^(keywords: .*)]$", r"\1'v_contact_share', ]", text)
    text = re.sub(r"(?m)^(  - \[.*)]$", r"\g<1>0.25, ]", text)
    start, row = re.search(r"(?s)---\n.*?data:\n", text)[0], re.search(r"  - \[200, .*\n", text)[0]
    before, behind = text.split(row)
    again = start + row.replace("0.25", "1e5")
    log.write_text(before + row + "...\n" + again + behind)
    found = summarize(drop, "drop", None)
    assert (found.particle_updates, found.updates_per_second) == (300, 200)
    assert found.contact_share == 0.25
    log.write_text(before + row + "...\n" + again)
    found = summarize(drop, "drop", None)
    assert (found.particle_updates, found.updates_per_second) == (200, None)
    assert found.contact_share is None


def test_only_files_of_the_run_are_removed_and_no_link_is_followed(drop: Path) -> None:
    (drop / "pictures").mkdir(parents=True)
    own = ["log.lammps.before", "drop.restart.1", "pictures/frame_0003.png"]
    others = [
        "notes.before",
        "other.restart.1",
        "drop.restart.good",
        "pictures/frame_3.png",
        "pictures/frame_0003_mine.png",
    ]
    own, others = ([drop / name for name in names] for names in (own, others))
    for file in [*own, *others]:
        file.touch()
    (drop / "log.lammps").symlink_to(drop.parent / "elsewhere")
    code, _ = run(drop, "tiny")
    assert code == 0
    assert not any(file.exists() for file in own)
    assert all(file.exists() for file in others)
    assert not (drop.parent / "elsewhere").exists()


def test_two_runs_do_not_share_a_folder(drop: Path) -> None:
    run(drop, "tiny")
    log = (drop / "log.lammps").read_text()
    with (
        sphcloth.run._alone_in(drop),
        pytest.raises(UserError, match=r"--out .*out: another run is writing there"),
    ):
        run(drop, "tiny")
    assert (drop / "log.lammps").read_text() == log
    assert run(drop, "tiny")[0] == 0


def test_a_particle_through_the_sheet_is_failure(drop: Path) -> None:
    code, _ = run(drop, floor="0.1")
    summary = json.loads((drop / "summary.json").read_text())
    assert code == 1
    assert (summary["crossed"], summary["spilled"], summary["mass_defect"]) == (1, 1, 0)


@pytest.mark.parametrize(("every", "crossed"), [(100, None), (50, 1)])
def test_frames_that_are_too_far_apart_tell_of_no_crossing(
    drop: Path, every: int, crossed: int | None
) -> None:
    """A drop that moves by 0.25 or 0.11 between two frames, through a sheet with edges of 0.1."""
    script = examples.find_example("drop").script
    text = SCRIPT.replace("custom 10 ", f"custom {every} ")
    for old, new in (("0", "0.45"), ("1", "0.55")):
        text = re.sub(rf"(2 single.*) {old} (.*0.5\n)", rf"\1 {new} \2", text)
        text = re.sub(rf"(2 single) {old} ", rf"\1 {new} ", text)
    script.write_text(text)
    code, shown = run(drop, floor="0.1")
    summary = json.loads((drop / "summary.json").read_text())
    assert code == 1
    assert summary["crossed"] == crossed
    assert summary["unclear_steps"] == ([300] if crossed is None else [])
    assert ("frames are too far apart to tell" in shown) == (crossed is None)
    assert not summary["passed"]


def test_a_particle_unaccounted_for_is_failure(drop: Path) -> None:
    code, _ = run(drop, source="2")
    assert code == 1
    assert json.loads((drop / "summary.json").read_text())["mass_defect"] == 1


def test_a_scene_of_cloth_alone_has_nothing_to_fail(drop: Path) -> None:
    script = examples.find_example("drop").script
    dry = SCRIPT.replace("fix             1 fluid", "delete_atoms    group fluid\nfix 1 fluid")
    script.write_text(dry.replace("dt v_fluid v_poured v_drained", ""))
    code, text = run(drop, "tiny")
    summary = json.loads((drop / "summary.json").read_text())
    assert code == 0, text
    assert summary["passed"]
    assert summary["crossed"] is None
    assert "n/a" not in text


def test_pictures_are_drawn(drop: Path) -> None:
    console = Console(file=io.StringIO())
    code = run_example("drop", "tiny", 1, drop, {}, 1, console, drop / "copy.json")
    assert code == 0
    assert (drop / "copy.json").read_text() == (drop / "summary.json").read_text()
    names = ["contact_sheet.png", "history.png", "pictures/frame_0000.png"]
    assert all((drop / name).stat().st_size > 1000 for name in names)


def interrupt_when(log_has: str, monkeypatch: pytest.MonkeyPatch, frame: bool = False) -> None:
    """Let the user stop the run as soon as its log has some words, and its dump a frame."""

    def follow(log: Path, process: subprocess.Popen[bytes]) -> Iterator[dict[str, float]]:
        dump = log.parent / "drop.lammpstrj"
        while not (log.is_file() and log_has in log.read_text() and (has_frame(dump) or not frame)):
            assert process.poll() is None
            time.sleep(0.01)
        raise KeyboardInterrupt
        yield {}

    monkeypatch.setattr(sphcloth.run, "_follow", follow)


# after the first frame there is none, one at the rows, or one between them
@pytest.mark.parametrize(("every", "row"), [(10**9, "[0,"), (10, "[50,"), (7, "[10,")])
def test_a_run_that_is_interrupted_ends_lammps_and_sums_up_what_was_reached(
    drop: Path, monkeypatch: pytest.MonkeyPatch, every: int, row: str
) -> None:
    script = examples.find_example("drop").script
    script.write_text(SCRIPT.replace("custom 10 ", f"custom {every} "))
    interrupt_when(f"  - {row}", monkeypatch, frame=True)
    before = set(descendants(os.getpid()))
    code, text = run(drop, t_end="1e5", ranks=2)
    assert "stopped: the summary is of what was reached" in text and "time reached" in text
    assert set(descendants(os.getpid())) <= before
    summary = json.loads((drop / "summary.json").read_text())
    assert code == 1
    assert summary["time"] < 1e5
    assert summary["on_sheet"] == 1
    assert summary["crossed"] == (None if every == 10**9 else 0)
    assert summary["passed"] == (every != 10**9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [("line yaml", "line one", "   Step "), ("dump ", "#dump ", "  - [0,")],
    ids=["row", "frame"],
)
def test_a_run_that_is_interrupted_before_its_first_row_or_frame_has_nothing_to_sum_up(
    drop: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, words: str
) -> None:
    script = examples.find_example("drop").script
    script.write_text(SCRIPT.replace(old, new))
    interrupt_when(words, monkeypatch)
    code, text = run(drop, t_end="1e5")
    assert code == 1
    assert "stopped before the first row and frame: nothing to sum up" in text
    assert not (drop / "summary.json").exists()


def test_size_and_settings_reach_the_script(drop: Path) -> None:
    run(drop, "tiny")
    assert json.loads((drop / "summary.json").read_text())["steps"] == 100
    run(drop, "tiny", t_end="0.05")
    assert json.loads((drop / "summary.json").read_text())["steps"] == 50


def test_an_error_of_lammps_is_shown_and_leaves_no_old_summary(drop: Path) -> None:
    run(drop, "tiny")
    for name in ("contact_sheet.png", "history.png", "holiday.png"):
        (drop / name).touch()
    code, text = run(drop, "tiny", floor="high")
    assert code == 1
    assert "ERROR" in text
    assert "log.lammps" in text
    assert not (drop / "summary.json").exists()
    assert [path.name for path in drop.glob("*.png")] == ["holiday.png"]


def test_unknown_names_say_what_there_is(drop: Path) -> None:
    with pytest.raises(UserError, match="no size 'huge' of example drop: choose from tiny, small"):
        run(drop, "huge")
    with pytest.raises(UserError, match=r"no variable 'flor' .*: choose from t_end, floor, source"):
        run(drop, flor="1")


@pytest.mark.parametrize("setting", ["t_end", "=1", "=", "1a=2"])
def test_settings_are_name_and_value(setting: str) -> None:
    with pytest.raises(UserError, match="expected name=value"):
        examples.parse_settings([setting])
    assert examples.parse_settings(["a=1", "b=x=y"]) == {"a": "1", "b": "x=y"}


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_variable_is_emptied(drop: Path, ranks: int) -> None:
    script = examples.find_example("drop").script
    script.write_text(
        f"variable more index mistaken\n{SCRIPT.replace('fluid nve', 'fluid nve ${more}')}"
    )
    settings = examples.parse_settings(["more="])
    assert settings == {"more": ""}
    code, text = run(drop, "tiny", ranks, **settings)
    assert code == 0, text
