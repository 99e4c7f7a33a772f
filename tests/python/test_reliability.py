"""What makes the tables of docs/evidence/reliability.md: small runs of each, and the page."""

import ctypes
import itertools
import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable
from sphcloth.programs import CROWDED, PR_SET_TIMERSLACK, TIMER_SLACK_NS, YIELDING, lammps_on
from sphcloth.stress import endurance, page
from sphcloth.stress.endurance import Growth, Memory, Sample
from sphcloth.stress.equality import LARGE, SAME, SMALL, End, Found, Scene, Way, keep

PAGE = Path(__file__).parents[2] / "docs" / "evidence" / "reliability.md"


def test_ranks_sleep_only_where_they_are_more_than_cores(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    settings = YIELDING | CROWDED
    for name in settings:
        monkeypatch.delenv(name, raising=False)
    told = [f"{name}={value}" for name, value in settings.items()]
    assert lammps_on(2)[1:3] == ["-n", "2"]
    assert lammps_on(3)[: len(told) + 1] == ["env", *told]
    assert lammps_on(2, jobs=2)[: len(told) + 1] == ["env", *told]
    assert lammps_on(1, jobs=4)[1:3] == ["-n", "1"]
    monkeypatch.setenv("MPIR_CVAR_ENABLE_HEAVY_YIELD", "0")
    assert not any("MPIR_CVAR_ENABLE_HEAVY_YIELD" in word for word in lammps_on(3))


def test_ranks_that_sleep_wake_on_time(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 50000, 0, 0, 0)
    launcher = lammps_on(3)[:-1]
    # mpiexec may die of SIGPIPE where ranks end before it has passed its input on
    command = ["sh", "-c", "cat /proc/$$/timerslack_ns; sleep 1"]
    slack = subprocess.check_output([*launcher, *command], text=True)
    assert slack.split() == [str(TIMER_SLACK_NS)] * 3


def test_another_way_ends_in_the_same_state_and_another_scene_does_not(tmp_path):
    scene = Scene(SMALL, "tilted", "block", tmp_path)
    same = scene.way(Way("two ranks", 2, {"grid": "1 2 1"}))
    assert same.passed and 0 < same.place < SAME
    other = scene.way(Way("another step", 1, {"dt": 5e-4}))
    assert not other.passed and not other.complaint
    failed = scene.way(Way("no such kind", 1, {"sort": "no such kind"}))
    assert not failed.passed and failed.complaint


def test_contact_at_a_face_that_moves_does_not_depend_on_when_lists_are_renewed(tmp_path):
    scene = Scene(SMALL, "deforming", "constant", tmp_path)
    assert scene.way(Way("lists at each step", 2, {"check": "no"})).place < 1e-9


@pytest.mark.parametrize(("place", "complaint"), [(1e-20, ""), (0.0, "no end"), (None, "")])
def test_a_restart_is_the_same_to_the_last_bit_or_fails(place, complaint):
    assert not Found("periodic", "block", "restart", 1, True, place, 0.0, complaint).passed
    assert Found("periodic", "block", "restart", 1, True, 0.0, 0.0, "").passed


def test_a_jet_and_a_weir_are_the_same_on_two_ranks(tmp_path):
    scene = Scene(replace(LARGE, steps=100), "tilted", "block", tmp_path)
    assert scene.plain.counted["v_poured"] == 64 and scene.plain.counted["v_drained"] > 0
    same = scene.way(Way("two ranks", 2, {"grid": "1 2 1"}))
    assert same.passed and 0 < same.place < SAME
    log = ThermoTable.read(tmp_path / "plain" / "log.lammps")
    present = len(scene.plain.rows)
    assert scene._counted(log, present) == scene.plain.counted
    with pytest.raises(UserError, match=f"{present - 1} atoms, but {present} came and did not go"):
        scene._counted(log, present - 1)
    pushed = log["v_keeps_x"] + 1e-9 * log["v_each_sum"].max() * np.arange(len(log))
    with pytest.raises(UserError, match=r"1.0e-09 of the momentum is lost, allowed 1e-10"):
        scene._counted(ThermoTable(log.columns | {"v_keeps_x": pushed}, 0.0), present)


def test_a_restart_far_below_the_ceiling_of_the_step_is_the_same_to_the_last_bit(tmp_path):
    """Contact chooses how far ghosts reach by the speed, which grows, and the step."""
    script = tmp_path / "in.contact_alone"
    text = LARGE.script.read_text().replace("2 2 boundary", "2 2 none")
    script.write_text(text.replace("cloth/contact 0.03", "cloth/contact 0.02"))
    alone = replace(LARGE, script=script, steps=40, piece=20, every=0)
    found = Scene(alone, "periodic", "global", tmp_path).restarts(1, 1, 20)
    assert found.exact and found.passed


def test_an_inactive_particle_that_comes_to_a_rank_where_all_are_active_stays_inactive(tmp_path):
    """One does, from the upper rank at step 309."""
    scene = Scene(replace(LARGE, steps=310, every=0), "periodic", "block", tmp_path)
    assert scene.way(Way("upper and lower rank", 2, {"grid": "1 1 2"})).passed


def test_other_particles_or_counts_are_no_same_end():
    rows, moved = np.zeros((2, 7)), np.array([0, 0, 0, 3, 0, 5, 0])
    end = End(rows, {"v_poured": 16.0})
    assert end.differs(End(rows + moved, {"v_poured": 16.0})).tolist() == [3, 5]
    with pytest.raises(UserError, match="v_poured is 16 instead of 32"):
        end.differs(End(rows, {"v_poured": 32.0}))
    with pytest.raises(UserError, match="other particles"):
        end.differs(End(rows + 1, {"v_poured": 16.0}))
    with pytest.raises(UserError, match="other particles"):
        end.differs(End(rows[:1], {"v_poured": 16.0}))


def test_what_was_found_takes_the_place_of_the_same_box_and_scheme(tmp_path):
    file = tmp_path / "new" / "equality.json"
    found = [Found("tilted", scheme, "a", 2, False, 0.0, 0.0, "") for scheme in ("block", "global")]
    keep(found[:1], file)
    keep(found[1:], file)
    keep([replace(found[0], way="b"), replace(found[0], way="c")], file)
    rows = [(row["scheme"], row["way"]) for row in json.loads(file.read_text())]
    assert rows == [("global", "a"), ("block", "b"), ("block", "c")]


def test_mass_and_momentum_stay():
    found = endurance.drift("block", 200, samples=10)
    assert found.mass == 0 and found.momentum < 1e-12 and found.energy_left < 1


def test_looks_at_a_run_that_pours(tmp_path, monkeypatch):
    ticks = itertools.count()
    clock = SimpleNamespace(monotonic=lambda: 0.1 * next(ticks), sleep=lambda _: None)
    monkeypatch.setattr(endurance, "time", clock)
    file = tmp_path / "pour.json"
    words = ["pour", "--minutes", "0.02", "--load", "1", "--json", str(file)]
    CliRunner().invoke(endurance.app, words)
    last = json.loads(file.read_text())["found"]["looks"][-1]
    assert last["poured"] > 10 and last["step"] >= 400
    assert last["resident"] > last["heap"] > last["own"] > 1e6


def test_growth_is_from_when_the_scene_is_full():
    samples = [Sample(k, k, 1, k, 100 + (k < 10), 1000 + k, 10) for k in range(100)]
    assert Growth.of(samples) == Growth(0, 70, 0)


def test_memory_that_is_kept_is_seen():
    before = Memory.now().heap
    kept = bytearray(3 << 20)
    assert Memory.now().heap - before >= len(kept)


def test_instances_leave_little(monkeypatch):
    found = endurance.leak("plugin, all its styles", 20)
    assert found.heap < 1e6


# ---- the page ------------------------------------------------------------------------------------

EXAMPLES = {
    "stress.json": {
        "runs": [
            {"case": "a", "scheme": "block", "ranks": n, "passed": n < 4, "complaints": ["slow"]}
            for n in (1, 2, 4)
        ]
    },
    "equality.json": [
        {"way": "2 ranks", "ranks": 2, "box": "tilted", "scheme": "block", "passed": True,
         "place": 1e-14, "complaint": ""},
    ],
    "equality_large.json": [
        {"way": "4 ranks", "ranks": 4, "box": "tilted", "scheme": "block", "passed": False,
         "place": None, "complaint": "there are other particles"},
    ],
    "kill.json": [
        {"scheme": "block", "ranks": 2, "in_time": True, "had_file": False, "complaint": ""},
    ],
    "mutate.json": [{"bug": "b", "caught": "styles/test_a.py::test_b", "seconds": 3}],
    "mutants.json": {"places": 70, "mutants": [
        {"file": "core/a.h", "line": 3, "folder": "core", "operator": "logic", "right": "a || b",
         "wrong": "a && b", "caught": caught, "new": new, "judged": judged, "equivalent": reason,
         "tried": 5, "left": 2}
        for caught, new, judged, reason in [
            ("a/b/c", False, True, ""), ("a/b/c", True, True, ""), ("", False, True, "why"),
            ("", False, True, ""), ("", False, False, ""), ("", False, False, ""),
        ]
    ], "faults": [
        {"file": "stepping/b.cpp", "right": "x", "wrong": "y", "what": "all is lost",
         "caught": "styles/test_a.py::test_b"},
    ]},
    "steps.json": {"found": [
        {"scheme": "block", "steps": 5, "time": 1.0, "mass": 0.0, "momentum": 1e-15,
         "energy_rise": 0.0, "energy_left": 0.5, "memory": 0},
    ]},
    "pour.json": {"found": {"looks": [
        {"wall_s": 60, "step": 5, "atoms": 1, "poured": 2, "resident": 1, "heap": 2, "own": 3},
    ]}},
    "instances.json": {"found": [{"kind": "wheel", "times": 9, "heap": 1.0, "resident": 2.0}]},
}  # fmt: skip
XML = """<testsuite><testcase name="test_each[bond]"><properties><property name="tried" value="7"/>
<property name="refused" value="4"/></properties></testcase></testsuite>"""
ROWS = [
    "**3 runs of 1 cases, 1 breaches.**",
    "**1 ends compared, 0 differ.**",
    "**1 ends compared, 1 differ.**",
    "| 4 ranks | **there are other particles** |",
    "**7 commands and files.**",
    "**1 of 1 bugs caught.**",
    "| block | 1 runs, 0 breaches | 1 runs, 0 breaches | 1 runs, 1 breaches |",
    "* `a`, block, 4 ranks: slow",
    "| 2 ranks | 1e-14 |",
    "| `block` | 2 | 1 | 1 | 0 | 1 |",
    "| b | `test_a.py`: `test_b` | 3 |",
    "**6 mutants of 70 places: 2 caught, 1 equivalent, 1 not caught, 2 open; "
    "40.0 % of those that are not equivalent are caught.**",
    "| logic | 6 | 1 | 1 | 1 | 2 | 1 |",
    r"| `a.h:3` | `` a \|\| b `` → `` a && b `` | caught by a/b/c |",
    r"| `a.h:3` | `` a \|\| b `` → `` a && b `` | equivalent: why |",
    "| **not caught** by 5 tests, 2 that reach it left out |",
    "| open: not caught by 5 tests so far |",
    "| all is lost | `b.cpp` | `` x `` → `` y `` | `test_a.py`: `test_b` |",
    "| bond | 7 | 4 | 0 |",
    "| wheel | 9 | 1.0 | 2 |",
]


def write_all(folder):
    for name, content in EXAMPLES.items():
        (folder / name).write_text(json.dumps(content))
    (folder / "fuzz.xml").write_text(XML)


def test_all_tables_have_a_place_and_are_renewed(tmp_path):
    write_all(tmp_path)
    text, made = page.renewed(PAGE.read_text(), tmp_path)
    assert made == list(page.TABLES)
    for row in ROWS:
        assert row in text
    assert page.renewed(text, tmp_path)[0] == text
    assert page.renewed(text, tmp_path / "nothing") == (text, [])


def test_the_words_around_stay(tmp_path):
    write_all(tmp_path)

    def outside(text):
        return re.sub(r"(<!-- table \w+ -->).*?(<!-- end -->)", r"\1\2", text, flags=re.S)

    assert outside(page.renewed(PAGE.read_text(), tmp_path)[0]) == outside(PAGE.read_text())


@pytest.mark.parametrize("content", ["{", "[]", '{"runs": 3}', '{"runs": [{"scheme": 1}]}'])
def test_a_file_of_another_form_is_named(tmp_path, content):
    (tmp_path / "stress.json").write_text(content)
    with pytest.raises(UserError, match=r"stress.json: not what a run writes"):
        page.renewed(PAGE.read_text(), tmp_path)


def test_a_page_without_a_place_is_refused(tmp_path):
    write_all(tmp_path)
    with pytest.raises(UserError, match="0 places for the table stress"):
        page.renewed("no tables", tmp_path)
