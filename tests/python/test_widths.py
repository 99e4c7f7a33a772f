"""Tables and lists of the commands fit a terminal of 80 columns."""

from __future__ import annotations

import io
import itertools
from collections.abc import Callable

import pytest
from rich.console import Console

from sphcloth.bench import (
    activity,
    air,
    block,
    cloth,
    coupling,
    messages,
    pair,
    peers,
    size,
    watch,
)
from sphcloth.stress.command import show_cases as show_stress_cases
from sphcloth.tradeoff import report
from sphcloth.tradeoff.front import Point
from sphcloth.tradeoff.scenes import dam_break
from sphcloth.tradeoff.study import Plan, Study
from sphcloth.validation.validate import all_cases, show_case, show_cases

FIGURE = {"value": 1234.5, "least": 1198.7, "most": 12345.6}
SMALL = {"value": 0.1234, "least": 0.09876, "most": 0.2345}


def lines(show: Callable[[Console], None], width: int) -> list[str]:
    text = io.StringIO()
    show(Console(file=text, width=width))
    found = text.getvalue().splitlines()
    assert max(map(len, found)) <= width
    return found


def figures_of_a_sheet() -> dict:
    names = ("edges_ns", "hinges_ns", "both_ns", "step_ns", "bare_step_ns")
    each = dict.fromkeys(names, FIGURE)
    single = ("two_ranks", "two_ranks_cpu", "steps_per_renewal", "lists_ns")
    single += ("bytes_per_vertex", "fix_bytes_per_vertex")
    figures = {
        "codes": {"sphcloth": each, "pypbd": each},
        "ratios": each,
        "ways": dict.fromkeys(cloth.WAYS, SMALL),
        "dry_pair_ns": {"sph/tait": FIGURE, "zero": FIGURE},
    }
    return figures | dict.fromkeys(single, FIGURE)


def figures_of_water() -> dict:
    names = ("pair_ns", "pair_ns_per_neighbor", "list_ns_per_step", "best_skin", "share_of_peak")
    names += ("step_ns_at_best_skin", "steps_per_build", "bytes_per_particle")
    ratios = {f"{kind}_ratio_{code}": SMALL for kind in ("pair", "run") for code in pair.CODES}
    codes = {code: dict.fromkeys(names, FIGURE) for code in pair.CODES}
    return {"neighbors_inside": 26.1, "codes": codes, "two_ranks": SMALL} | ratios


def figures_of_peers() -> dict:
    row = {
        "setting": {"max_error": 0.3},
        "cpu_s_per_s": FIGURE,
        "steps": 123456,
        "density_error": {"mean": 0.0123, "tail": 0.0456},
        "center_of_mass": {"x": 1.234, "z": 0.567},
        "over_ours": {"mean": FIGURE, "tail": None},
    }
    failed = {"setting": {"sound": 30.0}, "failed": "it did not end"}
    sheet = {
        "vertices": 1600,
        "iterations": 20,
        "cpu_s_per_s": {"sphcloth": FIGURE, "pypbd": FIGURE},
        "ratio": SMALL,
    }
    water = {code: [row, failed] for code in peers.PLAN}
    counts = {"particles": 12345, "simulated_s": 1.2, "rounds": 3}
    return {"water": water, "sheet": sheet, "missing": []} | counts


def figures_of_messages() -> dict:
    counts = {"ranks": 64, "ghosts": 12345.0, "messages": 123.0, "bytes": 1e7, "collectives": 3.2}
    shares = dict.fromkeys(messages.PER_RANK, 0.987)
    return {
        "particles": 110592,
        "particle_ns": 1234.5,
        "time_shared": dict.fromkeys(("2", "4"), SMALL),
        "found": [{"scene": scene} | counts for scene in messages.SCENES],
        "expected": [
            {"scene": scene, "particles": 1e9, "shares": shares} for scene in messages.SCENES
        ],
    }


def figures_of_size() -> dict:
    figures = {"step_ns": [FIGURE] * 3, "dearest_over_cheapest": SMALL}
    counts = {"particles": [1000, 100000, 1000000], "rounds": 5}
    return counts | {"codes": dict.fromkeys(size.CODES, figures)}


CORNER = {"active": 0.0123} | dict.fromkeys(
    ("step_ns", "all_ns", "over_all", "left_out_ns"), FIGURE
)
COUPLING = {
    "particles": 64000,
    "step_ns": dict.fromkeys(coupling.SCENES, FIGURE),
    "ratios": dict.fromkeys(list(coupling.SCENES)[1:], SMALL),
    "pour": {"size": "small", "contact_share": 0.0123},
}
LOOKS = dict.fromkeys(watch.LIMITS, SMALL)
AIR = dict.fromkeys(air.RUNS, SMALL)
SAVED = {"value": -0.1234, "least": -0.2345, "most": -0.09876}
BLOCK = {
    f"{name}{metric}": figure
    for name in block.METRICS
    for metric, figure in (("", SMALL), ("_updates", SMALL), ("_saved", SAVED))
}
COUNTS = {"particles": 110592, "rounds": 5}
SHEET = {"vertices": 25600, "edges": 76000, "hinges": 75000, "figures": figures_of_a_sheet()}

TABLES = {
    "pair": lambda console: pair.show("block", figures_of_water(), console),
    "cloth": lambda console: cloth.show(SHEET, console),
    "peers": lambda console: peers.show(figures_of_peers(), console),
    "messages": lambda console: messages.show(figures_of_messages(), console),
    "size": lambda console: size.show(figures_of_size(), console),
    "activity": lambda console: activity.show(COUNTS | {"corners": [CORNER] * 3}, console),
    "watch": lambda console: watch.show(COUNTS | {"look": LOOKS}, console),
    "coupling": lambda console: coupling.show(COUPLING, console),
    "air": lambda console: air.show(
        SHEET | COUNTS | {"vertices_of_balloon": 2562, "more": AIR}, console
    ),
    "block": lambda console: block.show(COUNTS | {"figures": BLOCK}, console),
}


@pytest.mark.parametrize("name", TABLES)
def test_no_cell_of_a_benchmark_is_broken(name: str) -> None:
    assert len(lines(TABLES[name], 80)) == len(lines(TABLES[name], 300))


def test_a_table_of_settings_shows_all_of_them() -> None:
    """Settings are folded at spaces, numbers and marks are whole."""
    label = "overdue yes, ceiling 4, acoustic 1.2"
    errors = dict.fromkeys(("kinetic", "front", "potential"), 1.2e-3)
    points = [
        Point(scheme, label, {}, errors, None, 1.24e6, 123456, 1234.5)
        for scheme in ("individual", "global")
    ]
    plan = Plan(("individual", "global"), {}, {}, {}, 0.01, True)
    study = Study(dam_break.SCENE, plan, 1, points[0], points, False)
    shown = lines(lambda console: report.show(study, console), 80)
    text = " ".join(shown)
    for whole in ("individual", "acoustic", "overdue", "1.24e+06", "1.2e-03", "potential", "UW"):
        assert whole in text, whole
    assert "…" not in text


def test_the_list_of_cases_has_one_line_each() -> None:
    shown = lines(show_cases, 80)
    for name in all_cases():
        assert len([line for line in shown if line.split()[0] == name]) == 1
    # and a heading and a hint
    assert len(shown) == len(all_cases()) + 2


@pytest.mark.parametrize("name", all_cases())
def test_no_parameter_takes_more_than_a_few_lines(name: str) -> None:
    case = all_cases()[name]
    shown = lines(lambda console: show_case(case, console), 80)
    for each in (*case.parameters, *case.quantities):
        assert any(line.split()[:1] == [each.name] for line in shown)
    assert len(shown) < 3 * (len(case.parameters) + len(case.quantities)) + 6


def test_no_case_of_the_stress_test_takes_more_than_a_few_lines() -> None:
    shown = lines(show_stress_cases, 80)
    starts = [k for k, line in enumerate(shown) if line[2:3].strip()] + [len(shown)]
    assert max(b - a for a, b in itertools.pairwise(starts)) <= 3
