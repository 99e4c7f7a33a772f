"""The trade-off: errors by hand, a script of a user's own, and the packaged scenes."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.cli import main
from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.programs import YIELDING
from sphcloth.tradeoff import runs
from sphcloth.tradeoff.command import all_scenes, find_scene, parse_quantity, parse_variations
from sphcloth.tradeoff.report import show, write_all
from sphcloth.tradeoff.runs import count_updates
from sphcloth.tradeoff.scene import AS_WRITTEN, SCHEMES, Clock, History, Quantity, Scene, column
from sphcloth.tradeoff.study import Plan, Study, all_settings, combinations, study, variations

# one mass on a spring: x = cos t, exact to second order in dt; unstable above dt = 2
SPRING = """
units       lj
variable    dt index 0.1
variable    last index 3.0
atom_style  atomic
atom_modify map yes
region      box block -9 9 -9 9 -9 9
create_box  1 box
create_atoms 1 single 0 0 0
mass        1 1.0
pair_style  zero 1.0
pair_coeff  * *
fix         home all spring/self 1.0 x
displace_atoms all move 1 0 0 units box
fix         move all nve
variable    x equal x[1]
timestep    ${dt}
thermo_style custom step time atoms v_x
thermo_modify line yaml lost ignore
thermo      1
run         $(round(v_last/v_dt))
"""


@pytest.fixture
def quiet() -> Console:
    return Console(file=io.StringIO(), width=100)


@pytest.fixture
def spring(tmp_path: Path) -> Path:
    script = tmp_path / "in.spring"
    script.write_text(SPRING)
    return script


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Return the exit code of ``sphcloth tradeoff``."""
    monkeypatch.setattr(sys, "argv", ["sphcloth", "tradeoff", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def plan(**changes: object) -> Plan:
    usual = {
        "schemes": (AS_WRITTEN,),
        "vary": {},
        "settings": {},
        "reference": {},
        "error": 0.01,
        "quick": False,
    }
    return Plan(**(usual | changes))


# errors over time


def quantity(norm: str = "rms", by_range: bool = False) -> Quantity:
    return Quantity("q", "something", column("v_q"), norm, by_range)


def test_a_straight_line_is_the_same_at_any_times() -> None:
    reference = History(np.linspace(0, 4, 9), 2 * np.linspace(0, 4, 9))
    coarse = History(np.array([0.0, 0.7, 4.0]), np.array([0.0, 1.4, 8.0]))
    assert quantity().error(coarse, reference) == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize(
    ("norm", "by_range", "expected"),
    [
        ("rms", False, np.sqrt((9 + 1) / 4) / 10),
        ("max", False, 0.3),
        ("end", False, 0.1),
        ("end", True, 0.2),
    ],
)
def test_norms_and_sizes(norm: str, by_range: bool, expected: float) -> None:
    times = np.arange(4.0)
    reference = History(times, np.array([5.0, 5.0, 10.0, 5.0]))
    run = History(times, np.array([5.0, 8.0, 10.0, 4.0]))
    assert quantity(norm, by_range).error(run, reference) == pytest.approx(expected)


def test_nothing_to_compare_with_is_an_error() -> None:
    nothing = History(np.arange(3.0), np.zeros(3))
    with pytest.raises(UserError, match="0 in the reference"):
        quantity().error(nothing, nothing)
    flat = History(np.arange(3.0), np.ones(3))
    with pytest.raises(UserError, match="constant in the reference"):
        quantity(by_range=True).error(flat, flat)


@pytest.mark.parametrize("wanted", [0.3, 0.25, 0.1, 0.099])
def test_constant_steps_divide_the_interval(wanted: float) -> None:
    dt, steps = Clock(sound_time=1.0, interval=0.5).constant_step(wanted)
    assert dt * steps == pytest.approx(0.5, rel=1e-15)
    assert dt <= wanted * (1 + 1e-9) and 0.5 / (steps - 1 or 0.5) > wanted


# settings


def test_what_the_user_varies_takes_the_place_of_the_scene_s_own() -> None:
    pool = all_scenes()["resting-pool"]
    wish = plan(vary={"force": ("0.1",)})
    assert variations(pool, wish, "global") == {"force": ("0.1",)}
    assert variations(pool, wish, "constant") == pool.variations["constant"]
    assert combinations({"a": ("1", "2"), "b": ("x",)}) == [
        {"a": "1", "b": "x"},
        {"a": "2", "b": "x"},
    ]


@pytest.mark.parametrize("name", sorted(all_scenes()))
def test_the_same_coefficient_is_the_step_of_constant_and_the_limit_of_global(name: str) -> None:
    scene = all_scenes()[name]
    fixed = scene.script_variables("constant", {"acoustic": "0.5"}, quick=True)
    chosen = scene.script_variables("global", {"acoustic": "0.5", "ceiling": "1"}, quick=True)
    assert fixed["limits"] == "" and fixed["every"] == "v_later"
    limits = dict(zip(*[iter(chosen["limits"].split())] * 2, strict=True))
    assert limits["acoustic"] == "0.5"
    assert float(fixed["dt"]) * int(fixed["steps"]) == pytest.approx(float(limits["output"]))
    # rounded down by less than a step in the interval
    assert 0.8 < float(fixed["dt"]) / (0.5 * float(limits["max"])) <= 1 + 1e-9


@pytest.mark.parametrize("name", sorted(all_scenes()))
def test_every_scene_knows_its_names(name: str) -> None:
    scene = all_scenes()[name]
    for names in (scene.variables, scene.quick, *scene.variations.values()):
        scene.check_names("--set", names)
    scene.check_names("--reference", scene.reference)
    assert tuple(scene.variations) == SCHEMES
    assert scene.script.is_file() and scene.reference["scheme"] == "constant"
    finest = float(scene.reference["acoustic"])
    assert all(float(each) > finest for each in scene.variations["constant"]["acoustic"])


def test_updates_are_those_of_the_fix_or_atoms_times_steps() -> None:
    table = {"Step": np.array([0.0, 2, 4]), "Atoms": np.array([10.0, 10, 20])}
    plain = ThermoTable(table, 0.0)
    assert count_updates(plain, "", AS_WRITTEN) == 10 * 2 + 15 * 2
    counted = ThermoTable(table | {"f_mine[3]": np.array([5.0, 9, 12])}, 0.0)
    assert count_updates(counted, "fix mine all sph/integrate global\n", "individual") == 7
    named = ThermoTable(table | {"c_updates": np.array([5.0, 9, 13])}, 0.0)
    assert count_updates(named, "", "individual") == 8
    with pytest.raises(UserError, match="add 'compute updates all sph/step updates'"):
        count_updates(plain, "", "individual")


@pytest.mark.parametrize("text", ["dt", "dt=", "=1", "dt=1,,2", "d t=1"])
def test_a_variation_is_a_name_and_values(text: str) -> None:
    with pytest.raises(UserError, match="expected NAME=A,B"):
        parse_variations([text])


# a script of a user's own


def run_spring(script: Path, out: Path, quiet: Console, *values: str, **options: int) -> Study:
    scene = find_scene(str(script), ["v_x"], last_run=False)
    wish = plan(vary={"dt": values}, reference={"dt": "0.001"})
    return study(scene, wish, out, quiet, **options)


def test_a_spring_converges_to_second_order(spring: Path, tmp_path: Path, quiet: Console) -> None:
    found = run_spring(spring, tmp_path / "out", quiet, "0.3", "0.1")
    coarse, fine = found.points
    assert coarse.errors["v_x"] / fine.errors["v_x"] == pytest.approx(9, rel=0.1)
    assert [each.updates for each in found.points] == [10, 30]
    assert found.best("updates") == AS_WRITTEN
    assert found.choices("updates")[AS_WRITTEN].point == coarse


def test_errors_are_means_over_several_begins(spring: Path, tmp_path: Path, quiet: Console) -> None:
    scene = find_scene(str(spring), ["v_x"], False)
    asked = {"vary": {"dt": ("0.2", "0.05")}, "reference": {"dt": "0.005"}}
    single = [
        study(scene, plan(**asked, settings={"last": last}), tmp_path / last, quiet)
        for last in ("2.0", "3.0")
    ]
    both = study(scene, plan(**asked, over={"last": ("2.0", "3.0")}), tmp_path / "both", quiet)
    for place, merged in enumerate(both.points):
        errors = [each.points[place].errors["v_x"] for each in single]
        assert errors[0] != errors[1]
        assert merged.errors["v_x"] == pytest.approx(np.mean(errors), rel=1e-12)
        assert merged.worst["v_x"] == max(errors)
        assert merged.updates == np.mean([each.points[place].updates for each in single])
    assert both.as_json()["over"] == {"last": ["2.0", "3.0"]}
    write_all(both, tmp_path)
    rows = list(csv.DictReader((tmp_path / "spring.csv").open()))
    assert float(rows[1]["worst_v_x"]) == both.points[0].worst["v_x"]
    with pytest.raises(UserError, match="--over dt: it is varied as well"):
        study(scene, plan(**asked, over={"dt": ("1",)}), tmp_path / "none", quiet)


def test_a_run_that_blows_up_is_a_result(spring: Path, tmp_path: Path, quiet: Console) -> None:
    found = run_spring(spring, tmp_path / "out", quiet, "0.1", "no-number")
    well, wrong = found.points
    assert well.failure is None
    assert "ERROR" in wrong.failure
    show(found, quiet)
    files = write_all(found, tmp_path)
    rows = list(csv.DictReader((tmp_path / "spring.csv").open()))
    assert [row["role"] for row in rows] == ["reference", "", ""]
    assert float(rows[1]["error_v_x"]) == well.errors["v_x"]
    assert rows[2]["error_v_x"] == "" and "ERROR" in rows[2]["failure"]
    assert {path.suffix for path in files} == {".csv", ".json", ".png", ".svg"}
    assert all(path.stat().st_size > 0 for path in files)
    assert "unstable: as written, dt no-number" in quiet.file.getvalue()


def test_values_that_are_no_numbers_are_a_failure(
    spring: Path, tmp_path: Path, quiet: Console
) -> None:
    text = SPRING.replace("v_x\nthermo_modify", "v_x v_bad\nthermo_modify")
    bad = "variable bad equal v_x+0*exp(1000*(v_dt>0.2))\n"
    spring.write_text(text.replace("timestep", bad + "timestep", 1))
    scene = find_scene(str(spring), ["v_bad"], last_run=False)
    wish = plan(vary={"dt": ("0.1", "0.3")}, reference={"dt": "0.01"})
    well, wrong = study(scene, wish, tmp_path / "out", quiet).points
    assert well.failure is None
    assert wrong.failure == "v_bad is not a number at time 0"
    with pytest.raises(UserError, match="the reference run is no good: v_bad"):
        study(scene, plan(vary={"dt": ("0.1",)}, reference={"dt": "0.3"}), tmp_path, quiet)


def test_values_too_large_to_be_squared_are_a_failure(
    spring: Path, tmp_path: Path, quiet: Console
) -> None:
    large = "variable large equal v_x*exp(500*(v_dt>0.2))\n"
    text = SPRING.replace("v_x\nthermo_modify", "v_large\nthermo_modify")
    spring.write_text(text.replace("timestep", large + "timestep", 1))
    scene = find_scene(str(spring), ["v_large"], last_run=False)
    wish = plan(vary={"dt": ("0.1", "0.3")}, reference={"dt": "0.01"})
    found = study(scene, wish, tmp_path / "out", quiet)
    assert [each.failure for each in found.points] == [None, "values too large for an error"]
    write_all(found, tmp_path)


def test_ranks_of_runs_side_by_side_that_are_more_than_cores_sleep(
    spring: Path, tmp_path: Path, quiet: Console, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    for name in YIELDING:
        monkeypatch.delenv(name, raising=False)
    start, asked = runs.start_lammps, []

    def note(command: list[str], folder: Path) -> object:
        asked.append(command[0] == "env")
        return start(command, folder)

    monkeypatch.setattr(runs, "start_lammps", note)
    for jobs in (1, 2):
        workshop = runs.Workshop(
            find_scene(str(spring), ["v_x"], last_run=False), tmp_path / str(jobs), 2, jobs, quiet
        )
        workshop.run([runs.Setting(AS_WRITTEN, {}, {})])
    assert asked == [False, True]


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The folders in which LAMMPS was started, in order."""
    folders: list[Path] = []
    start: Callable = runs.start_lammps

    def count(command: list[str], folder: Path) -> object:
        folders.append(folder)
        return start(command, folder)

    monkeypatch.setattr(runs, "start_lammps", count)
    return folders


def test_a_second_call_runs_what_is_missing(
    spring: Path, tmp_path: Path, quiet: Console, started: list[Path]
) -> None:
    first = run_spring(spring, tmp_path / "out", quiet, "0.3")
    assert len(started) == 2
    again = run_spring(spring, tmp_path / "out", quiet, "0.3", "0.1")
    assert len(started) == 3
    assert again.points[0] == first.points[0]
    # a record without its log is no result
    (started[1] / "log.lammps").unlink()
    run_spring(spring, tmp_path / "out", quiet, "0.3")
    assert started[3:] == [started[1]]
    # another script is another run, and fresh forgets all
    spring.write_text(SPRING.replace("spring/self 1.0", "spring/self 2.0"))
    run_spring(spring, tmp_path / "out", quiet, "0.3")
    assert len(started) == 6
    run_spring(spring, tmp_path / "out", quiet, "0.3", fresh=True)
    assert len(started) == 8 and len(set(started)) == 5


def test_wall_times_are_measured_in_turns(
    spring: Path, tmp_path: Path, quiet: Console, started: list[Path]
) -> None:
    run_spring(spring, tmp_path / "out", quiet, "0.3", "0.1", repeat=2)
    reference, *others = started
    assert others == [*others[:2], *others[:2]]
    kept = json.loads((others[0] / runs.RECORD).read_text())
    assert len(kept["walls_s"]) == 2
    again = run_spring(spring, tmp_path / "out", quiet, "0.3", "0.1", repeat=3)
    assert started == [reference, *others, *others[:2]]
    kept = json.loads((others[0] / runs.RECORD).read_text())
    assert again.points[0].wall_s == min(kept["walls_s"])


def test_equal_settings_are_run_once(
    spring: Path, tmp_path: Path, quiet: Console, started: list[Path]
) -> None:
    found = run_spring(spring, tmp_path / "out", quiet, "0.3", "0.3")
    assert len(started) == 2 and found.points[0] == found.points[1]


def test_side_by_side_is_said(spring: Path, tmp_path: Path, quiet: Console) -> None:
    alone = run_spring(spring, tmp_path / "alone", quiet, "0.3", "0.1")
    both = run_spring(spring, tmp_path / "both", quiet, "0.3", "0.1", jobs=2)
    assert not alone.side_by_side and both.side_by_side
    assert [each.errors for each in both.points] == [each.errors for each in alone.points]
    show(both, quiet)
    assert "side by side" in quiet.file.getvalue()


def test_files_that_the_script_reads_come_along(
    spring: Path, tmp_path: Path, quiet: Console
) -> None:
    (tmp_path / "stiff.in").write_text("fix home all spring/self 4.0 x\n")
    spring.write_text(SPRING.replace("fix         home all spring/self 1.0 x", "include stiff.in"))
    found = run_spring(spring, tmp_path / "out", quiet, "0.1")
    log = next((tmp_path / "out" / "runs").glob("*/log.lammps"))
    table = ThermoTable.read(log)
    assert np.interp(np.pi / 2, table["Time"], table["v_x"]) == pytest.approx(-1, abs=0.01)
    before = found.points[0].errors["v_x"]
    (tmp_path / "stiff.in").write_text("fix home all spring/self 1.0 x\n")
    assert run_spring(spring, tmp_path / "out", quiet, "0.1").points[0].errors["v_x"] != before


def test_the_last_run_alone(spring: Path, tmp_path: Path, quiet: Console) -> None:
    spring.write_text(SPRING + "run 10\n")
    scene = find_scene(str(spring), ["v_x"], last_run=True)
    wish = plan(vary={"dt": ("0.3",)}, reference={"dt": "0.01"}, settings={"last": "0.9"})
    # the last ten steps of the coarse run take 3, those of the reference 0.1, both from 0.9 on
    (found,) = study(scene, wish, tmp_path / "out", quiet).points
    assert found.steps == 10 and found.failure is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none-such"], "no scene and no script 'none-such'"),
        (["dam-break", "--vary", "none=1"], "--vary none: no such variable in in.dam-break"),
        (["dam-break", "--set", "none=1"], "--set none: no such variable"),
        (["dam-break", "--reference", "none=1"], "--reference none: no such variable"),
        (["dam-break", "--set", "limits=max 1"], "--set limits: no such variable"),
        (["dam-break", "--vary", "scheme=global"], "schemes are chosen with --scheme"),
        (["dam-break", "--vary", "acoustic=much"], "acoustic is much: it must be a number above 0"),
        (["dam-break", "--vary", "ceiling=0"], "ceiling is 0: it must be a number above 0"),
        (["dam-break", "--set", "across=-4"], "dam-break: no time step follows from across -4"),
        (["dam-break", "--scheme", "best"], "--scheme best: choose from"),
        (["dam-break", "--quantity", "front:mean"], "no norm 'mean'"),
        (["SPRING"], "give --quantity"),
        (["SPRING", "--quantity", "v_x", "--vary", "dt=1"], "give --reference"),
        (["SPRING", "--quantity", "v_x", "--reference", "dt=0.01"], "nothing to vary"),
        (["SPRING", "--quantity", "v_x", "--scheme", "global"], "no 'variable scheme index'"),
        (["SPRING", "--quantity", "v_x", "--reference", "dt=x", "--vary", "dt=1"], "failed"),
        (
            ["SPRING", "--quantity", "v_y", "--reference", "dt=0.1", "--vary", "dt=0.3"],
            "no thermo column v_y: the log has Step Time Atoms v_x",
        ),
    ],
)
def test_a_mistake_is_one_line(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    spring: Path,
    tmp_path: Path,
    arguments: list[str],
    message: str,
) -> None:
    words = [str(spring) if word == "SPRING" else word for word in arguments]
    assert call(monkeypatch, *words, "--out", str(tmp_path / "out")) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert message in said
    assert "Traceback" not in said


def test_a_log_without_time_is_an_error(spring: Path, tmp_path: Path, quiet: Console) -> None:
    spring.write_text(SPRING.replace("step time", "step"))
    with pytest.raises(UserError, match="add 'time' to thermo_style"):
        run_spring(spring, tmp_path / "out", quiet, "0.3")


# a packaged scene, as small as it can be


def test_all_schemes_of_a_scene_print_at_the_same_times(tmp_path: Path, quiet: Console) -> None:
    scene = all_scenes()["resting-pool"]
    schemes = ("constant", "global", "individual")
    wish = plan(
        schemes=schemes,
        vary={"acoustic": ("0.8",), "force": ("0.05",)},
        settings={"spacing": "0.05", "t_end": "0.5"},
        reference={"acoustic": "0.2"},
        quick=True,
    )
    found = study(scene, wish, tmp_path, quiet)
    assert [each.scheme for each in found.points] == list(schemes)
    assert all(each.failure is None and each.errors["kinetic"] < 0.1 for each in found.points)
    assert all(each.updates < 0.4 * found.reference.updates for each in found.points)
    tables = [ThermoTable.read(log, last_run=True) for log in tmp_path.glob("runs/*/log.lammps")]
    assert len(tables) == 4
    for table in tables:
        assert table["Time"] == pytest.approx(np.linspace(0.4, 0.5, 6), abs=1e-9)
        # all start from the same state
        assert table["v_kinetic"][0] == tables[0]["v_kinetic"][0]


def test_the_command_writes_what_it_found(
    monkeypatch: pytest.MonkeyPatch, spring: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    result = tmp_path / "result.json"
    wish = "--vary dt=0.3,0.1 --reference dt=0.01 --quantity v_x:max --error 0.5"
    files = "--out", str(tmp_path / "out"), "--json", str(result)
    assert call(monkeypatch, str(spring), *wish.split(), *files) == 0
    found = json.loads(result.read_text())
    assert found["best"]["updates"]["overall"] == AS_WRITTEN
    assert found["best"]["updates"]["by_scheme"][AS_WRITTEN]["values"] == {"dt": "0.3"}
    assert found["quantities"][0]["norm"] == "max"
    assert "cheapest by particle updates" in capsys.readouterr().out


def test_the_list_names_all_scenes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert call(monkeypatch, "--list") == 0
    shown = capsys.readouterr().out
    for name in all_scenes():
        assert name in shown


def test_a_quantity_may_name_its_norm() -> None:
    assert parse_quantity("f_sheet[3]:end").norm == "end"
    assert parse_quantity("f_sheet[3]").name == "f_sheet[3]"


def test_settings_of_the_reference_stay_out_of_the_others(spring: Path) -> None:
    scene = Scene("s", "", spring, (quantity(),))
    wish = plan(vary={"dt": ("0.3",)}, reference={"dt": "0.01"}, settings={"last": "1.0"})
    reference, (setting,) = all_settings(scene, wish)
    assert reference.variables == {"dt": "0.01", "last": "1.0"}
    assert setting.variables == {"dt": "0.3", "last": "1.0"}
