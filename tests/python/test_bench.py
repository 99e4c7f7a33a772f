"""sphcloth bench: what it reads and what it reports."""

import io
import itertools
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from sphcloth.bench import activity, block
from sphcloth.bench.activity import Steps, bench_activity, usual_steps
from sphcloth.bench.air import RUNS, bench_air
from sphcloth.bench.block import Compared, Ratios, bench_block
from sphcloth.bench.coupling import bench_coupling
from sphcloth.bench.layers import bench_layers
from sphcloth.bench.messages import Cluster, Counter, Sent, expect
from sphcloth.bench.size import bench_size, edges, figures_of
from sphcloth.bench.timing import Runner, Spread, read_timing
from sphcloth.bench.watch import bench_watch
from sphcloth.errors import UserError
from sphcloth.tradeoff.command import all_scenes

LOG = """
Per MPI rank memory allocation (min/avg/max) = 3.5 | 4.0 | 4.5 Mbytes
Loop time of 0.25 on 2 procs for 50 steps with 1000 atoms
80.0% CPU use with 2 MPI tasks x 1 OpenMP threads
MPI task timing breakdown:
Section |  min time  |  avg time  |  max time  |%varavg| %total
Pair    | 0.1        | 0.125      | 0.15       |   0.0 | 50.00
Neigh   | 0.02       | 0.025      | 0.03       |   0.0 | 10.00
Output  | 0.004      | 0.005      | 0.006      |   0.0 |  2.00
Neighbor list builds = 7
"""


def test_times_are_those_of_the_last_run() -> None:
    timing = read_timing(LOG.replace("0.125", "9") + LOG)
    assert timing.pair == 0.125
    assert timing.per_particle(timing.pair) == pytest.approx(2500.0)
    assert timing.per_particle(timing.lists) == pytest.approx(500.0)
    assert timing.output == 0.005
    assert timing.builds == 7
    assert timing.cpu == pytest.approx(0.2)
    assert timing.memory == pytest.approx(8 * 1024**2)


def test_a_run_that_did_not_finish_is_an_error() -> None:
    with pytest.raises(UserError, match="did not finish"):
        read_timing("ERROR: Lost atoms")


def test_spread_is_median_and_extremes() -> None:
    spread = Spread.of([3.0, 1.0, 9.0])
    assert (spread.value, spread.least, spread.most) == (3.0, 1.0, 9.0)


def test_a_small_benchmark_from_end_to_end(tmp_path: Path) -> None:
    command = [Path(sys.executable).parent / "sphcloth", "bench", "pair", "--rounds", "1"]
    command += ["--across", "10", "--steps", "5", "--json", tmp_path / "out.json"]
    subprocess.run(command, check=True, capture_output=True, timeout=1800)
    figures = json.loads((tmp_path / "out.json").read_text())
    assert figures["particles"] == 1000
    for scene in ("dam", "block"):
        codes = figures["scenes"][scene]["codes"]
        assert set(codes) == {"stock", "double", "mixed"}
        for code in codes.values():
            assert code["pair_ns"]["value"] > 0
            assert 100 < code["bytes_per_particle"] < 1e6
    # a jittered cubic lattice has 26 to 32 neighbors within two spacings
    assert 26 < figures["scenes"]["block"]["neighbors_inside"] < 33


def test_an_unknown_benchmark_is_named() -> None:
    command = [Path(sys.executable).parent / "sphcloth", "bench", "sail"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2
    known = "pair, cloth, coupling, layers, watch, messages, peers"
    assert f"no benchmark 'sail': use {known}" in " ".join(done.stderr.split())


def test_a_small_sheet_from_end_to_end(tmp_path: Path) -> None:
    command = [Path(sys.executable).parent / "sphcloth", "bench", "cloth", "--rounds", "1"]
    command += ["--across", "12", "--steps", "5", "--json", tmp_path / "out.json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=1800)
    result = json.loads((tmp_path / "out.json").read_text())
    # 11 x 11 cells: two triangles each, three edges and their share of the border
    assert (result["vertices"], result["edges"]) == (144, 3 * 121 + 22)
    assert result["hinges"] == result["edges"] - 44
    figures = result["figures"]
    assert figures["codes"]["sphcloth"]["step_ns"]["value"] > 0
    assert set(figures["ways"]) >= {"direction start", "solver substeps", "solver jacobi"}
    assert 50 < figures["fix_bytes_per_vertex"] < 1e5
    if find_spec("pypbd"):
        # the same constraints in the same order: the same sheet
        assert result["fall"]["mean_distance"] < 1e-9
        assert result["fall"]["lowest"][0] == pytest.approx(result["fall"]["lowest"][1], abs=1e-9)
    else:
        assert "pip install 'sphcloth[bench]'" in done.stdout
        assert set(figures["codes"]) == {"sphcloth"}


def test_a_sheet_out_of_reach_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_coupling(1, 10, 5, Console(file=said, width=200), size="tiny")
    assert result["particles"] == 1000
    assert set(result["step_ns"]) == {"water", "sheet", "contact"}
    for scene in ("sheet", "contact"):
        # so few steps of so small a block say nothing of the cost
        assert result["ratios"][scene]["value"] > 0
    assert 0 < result["pour"]["contact_share"] < 1
    assert "share of contact in pour, size tiny" in said.getvalue()


def test_layers_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_layers(1, 10, 5, Console(file=said, width=200))
    # 11 x 11 vertices, and four sheets of 10 x 10
    assert result["vertices"] == {"alone": 121, "apart": 121, "pile": 521}
    # so few steps say nothing of the cost; without contact there is next to none
    assert result["contact_us"]["alone"]["value"] < result["contact_us"]["pile"]["value"]
    assert result["apart_over_alone"]["value"] > 0
    assert "contact that touches nothing" in said.getvalue()


def test_air_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_air(1, 10, 5, Console(file=said, width=200))
    assert result["vertices"] == 11 * 15
    assert result["vertices_of_balloon"] == 162
    # so few steps say nothing of the cost
    assert list(result["more"]) == list(RUNS)
    assert "more than without air" in said.getvalue()


def test_a_look_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_watch(1, 8, 5, Console(file=said, width=200))
    assert set(result["look"]) == {"finite", "all"}
    # so few steps say nothing of the cost
    assert -1 < result["look"]["all"]["value"] < np.inf
    assert "every 20 steps" in said.getvalue()


def test_what_ranks_send_is_counted(tmp_path: Path) -> None:
    """Forward and back through six faces, of which two lie between two ranks: 11 numbers of the
    atom style, 2 of the pair style, and 5 that come back with newton on."""
    count = Counter(tmp_path, across=10)
    none, _ = count(1, {"steps": 5})
    assert none.messages == 0
    sent = {}
    for newton in ("on", "off"):
        variables = {"newton": newton, "renew": 1000, "scheme": "constant"}
        short, _ = count(2, {**variables, "steps": 5})
        long, ghosts = count(2, {**variables, "steps": 15})
        sent[newton] = long.less(short, 10)
    assert sent["off"].messages == 2 * 2 and sent["on"].messages == 3 * 2
    # those that a rank gets from itself need no message
    of_neighbors = sent["off"].bytes / (8 * 13)
    assert 0.3 * ghosts < of_neighbors < ghosts
    assert sent["on"].bytes == pytest.approx(8 * 18 * of_neighbors)


def test_ranks_that_share_memory_send_no_messages_for_a_sheet(tmp_path: Path) -> None:
    count = Counter(tmp_path, across=10)
    sent = {}
    for shared in ("yes", "no"):
        variables = {"scene": "sheet", "shared": shared}
        short, _ = count(2, {**variables, "steps": 20})
        long, _ = count(2, {**variables, "steps": 40})
        sent[shared] = long.less(short, 20).messages
    # three of water, as above, and new lists
    assert 3 * 2 < sent["yes"] < 5 * 2
    assert sent["no"] > 20 * sent["yes"]


def test_what_is_expected_of_a_cluster() -> None:
    step = Sent(messages=10, bytes=0, collectives=1, collective_bytes=8)
    on = Cluster(latency=1e-6, bandwidth=1e9, particle=1e-7)
    # 1000 particles in 100 us, 10 messages and a collective call among 1024 ranks in 20 us
    assert expect(step, 100, 1000, 1024, on) == pytest.approx(100 / 120)
    # a cube of 10 x 10 x 10 has 14.8^3 - 1000 ghosts, 100 bytes each
    step = Sent(messages=0, bytes=100 * 50, collectives=0, collective_bytes=0)
    ghosts = 14.8**3 - 1000
    assert expect(step, 50, 1000, 2, on) == pytest.approx(100 / (100 + 0.1 * ghosts))


def test_sizes_are_a_geometric_series() -> None:
    counts = [n**3 for n in edges(100)]
    assert (counts[0], counts[-1]) == (22**3, 100**3)
    assert all(2.8 < b / a < 3.4 for a, b in itertools.pairwise(counts))


def test_flatness_is_taken_round_by_round() -> None:
    flat = figures_of({10: [1.0, 4.0], 20: [2.0, 3.0]})["dearest_over_cheapest"]
    assert (flat["least"], flat["most"]) == (pytest.approx(4 / 3), 2.0)


def test_a_small_series_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_size(1, 30, 5, Console(file=said, width=200))
    assert result["particles"][-1] == 27000
    for code in ("double", "mixed"):
        steps = result["codes"][code]["step_ns"]
        assert len(steps) == 5 and all(step["value"] > 0 for step in steps)
    assert "dearest / cheapest" in said.getvalue()


def test_what_is_left_out_is_what_its_steps_cost_beside_those_who_are_updated() -> None:
    active = np.array([1.0, 0.2, 0.2, 0.6] * 6)
    ns = np.where(active == 0.6, 1e3, 100.0 * active + 10.0 * (1 - active))
    ns[1] = 1e6  # new lists
    steps = usual_steps(ns, active)
    assert steps == Steps(0.2, pytest.approx(28.0), 100.0)
    assert steps.left_out == pytest.approx(10.0)
    for wrong in (np.ones(24), np.full(24, 0.2)):
        with pytest.raises(UserError, match="raise --steps"):
            usual_steps(ns, wrong)


def test_activity_from_end_to_end() -> None:
    said = io.StringIO()
    result = bench_activity(1, 16, 128, Console(file=said, width=200))
    assert [corner["share"] for corner in result["corners"]] == [0.01, 0.05, 0.2]
    for corner in result["corners"]:
        assert 0 < corner["active"] < 0.5
        assert corner["over_all"]["value"] > 0
    assert "left out" in said.getvalue()


def test_what_block_steps_save_is_a_share_of_what_the_updates_say() -> None:
    assert Ratios(0.8, 0.5).saved == pytest.approx(0.4)
    assert Ratios(1.1, 0.5).saved == pytest.approx(-0.2)
    rounds = [Ratios(0.8, 0.5), Ratios(0.7, 0.5), Ratios(1.0, 0.5)]
    found = block.figures_of("basins", rounds)
    assert list(found) == ["basins", "basins_updates", "basins_saved"]
    assert found["basins"] == {"value": 0.8, "least": 0.7, "most": 1.0}
    assert found["basins_saved"]["value"] == pytest.approx(0.4)
    assert list(block.figures_of("basins", [Ratios(0.8, 1.0)])) == ["basins", "basins_updates"]
    assert list(block.figures_of("light_cloth", rounds)) == ["light_cloth", "light_cloth_updates"]
    assert list(block.figures_of("uniform", rounds)) == ["uniform"]


@pytest.mark.parametrize("name", block.COMPARED)
def test_scenes_with_block_steps_are_run_as_the_trade_off_runs_them(name: str) -> None:
    compared = block.COMPARED[name]
    varied = all_scenes()[compared.scene].variations["block"]
    assert all(value in varied[setting] for setting, value in compared.block.items())
    assert not compared.both


def test_block_steps_from_end_to_end(monkeypatch: pytest.MonkeyPatch) -> None:
    pool = {"across": "8", "layers": "8", "radius": "0.05", "t_settle": "0.4", "t_fall": "0.06"}
    small = {
        "two_resolutions": Compared("drop-in-pool", {"gain": "1"}, pool, quick=True),
        "basins": Compared(
            "basins", {"sleep": "0.5"}, {"spacing": "0.04", "t_end": "4.3"}, quick=True
        ),
        "drop_in_pool": Compared("drop-in-pool", {"sleep": "0.02"}, pool, quick=True),
        "light_cloth": Compared("pour", both={"t_end": "0.2"}, quick=True, saves=False),
    }
    monkeypatch.setattr(block, "COMPARED", small)
    said = io.StringIO()
    result = bench_block(1, 16, 128, Console(file=said, width=200))
    scenes = ("two_resolutions", "basins", "drop_in_pool")
    ratios = [f"{name}{metric}" for name in scenes for metric in ("", "_updates")]
    ratios += ["light_cloth", "light_cloth_updates", "uniform", "one_percent_active"]
    # so short runs say nothing of the cost, but updates are the same on any machine
    figures = result["figures"]
    assert set(ratios) <= set(figures)
    assert all(0 < figures[name]["value"] < np.inf for name in ratios)
    assert figures["basins_updates"]["value"] < 0.9 and np.isfinite(
        figures["basins_saved"]["value"]
    )
    pairs = [figures[f"{name}_pairs"]["value"] for name in scenes]
    assert figures["pair_evaluations_per_update"]["value"] == pytest.approx(max(pairs))
    assert all(0.8 < each < 2 for each in pairs)
    assert "saved of" in said.getvalue() and "pair evaluations per update" in said.getvalue()


def test_one_metric_of_block_steps_alone(tmp_path: Path) -> None:
    command = [Path(sys.executable).parent / "sphcloth", "bench"]
    options = ["--rounds", "1", "--only", "light_cloth", "--json", tmp_path / "out.json"]
    subprocess.run([*command, "block", *options], check=True, capture_output=True, timeout=600)
    figures = json.loads((tmp_path / "out.json").read_text())["figures"]
    assert list(figures) == ["light_cloth", "light_cloth_updates", "light_cloth_pairs"]
    assert 0.8 < figures["light_cloth_pairs"]["value"] < 1.3
    done = subprocess.run([*command, "air", *options], capture_output=True, text=True)
    assert done.returncode == 2 and "only block has metrics" in " ".join(done.stderr.split())
    with pytest.raises(UserError, match="--only sail: choose from two_resolutions, basins"):
        bench_block(1, 16, 128, Console(), only="sail")


def test_all_steps_of_water_at_rest_are_equal_with_both_schemes(tmp_path: Path) -> None:
    """The ceiling sets them, so that both schemes take as many."""
    run = Runner(activity.SCRIPT, tmp_path, across=10, steps=40, share=0)
    for scheme in block.SCHEMES:
        said = run(scheme=scheme)
        assert "steps by limit: max 104\n" in said
        assert read_timing(said).steps == 40
