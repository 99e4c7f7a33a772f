"""Random scenes, and that each check of theirs sees a breach.  `make stress` runs 300 scenes."""

from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

from sphcloth.cli import app
from sphcloth.stress import oracle, random_run
from sphcloth.stress.case import SCHEMES
from sphcloth.stress.oracle import Evidence
from sphcloth.stress.random_run import random_scenes
from sphcloth.stress.random_scene import draw
from sphcloth.stress.random_script import script_of
from sphcloth.stress.runner import run_script
from sphcloth.stress.unit_systems import UNITS

# 349: by contact alone, heavy water on light vertices; 117: whole steps onto a plate
SEEDS = (*range(1, 21), 117, 349)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_must_hold_holds_in_a_random_scene(seed, tmp_path):
    (verdict,) = random_scenes(seed, 1, tmp_path, Console())
    assert verdict.complaints == []
    assert not list(tmp_path.iterdir())


def test_a_scene_depends_on_its_seed_alone():
    assert script_of(draw(7)) == script_of(draw(7)) != script_of(draw(8))


def test_a_scene_is_the_same_with_each_scheme_but_for_its_steps():
    drawn = draw(7)
    assert draw(7, drawn.scheme) == drawn
    of_steps = ("scheme", "verlet", "density", "dt", "time")
    for scheme in SCHEMES:
        other = draw(7, scheme)
        assert other.scheme == scheme
        assert replace(other, **{name: getattr(drawn, name) for name in of_steps}) == drawn


def run(scene, folder):
    script = folder / "in.scene"
    script.write_text(script_of(scene))
    outcome = run_script(script, folder / "run", {"every": 4}, 1)
    assert outcome.code == 0, outcome.error
    return Evidence(scene, outcome)


# a block of water and a free sheet, on which nothing else acts
FREE = replace(
    draw(1), units="si", ranks=1, boundary="f f f", tilt=0.0, water="block", size=(3, 3, 3),
    sheet="rectangle", slope=0.0, pins="none", walls=False, plate=False, gravity=False,
    coupling="none", contact=True, solver="substeps", iterations=10, order="forward",
    scheme="constant",
    density="summation", tension="no", shift=False, precision="mixed", areal=10.0, verlet=False,
    dt=5e-4, time=0.06,
)  # fmt: skip


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return run(FREE, tmp_path_factory.mktemp("good"))


def with_frames(evidence, change):
    """The same run with its last frame changed."""
    changed = Evidence(evidence.scene, evidence.outcome)
    last = evidence.frames[-1]
    columns = {name: values.copy() for name, values in last.columns.items()}
    columns = change(columns) or columns
    vars(changed)["frames"] = [*evidence.frames[:-1], replace(last, columns=columns)]
    return changed


def lose_one(columns):
    return {name: values[:-1] for name, values in columns.items()}


def speed_up(columns):
    columns["vz"][columns["type"] == 1] *= 1.2


def push(columns):
    columns["vx"][-1] += 1e-6


def pull_a_vertex(columns):
    columns["x"][np.flatnonzero(columns["type"] == 3)[0]] -= 100.0


def pass_through(columns):
    columns["z"][np.flatnonzero(columns["type"] == 1)[0]] -= 0.5


def weigh_more(columns):
    columns["mass"][-1] *= 1.001


BREACHES = {
    "lost": (oracle.mass_is_exact, lose_one),
    "heavier": (oracle.mass_is_exact, weigh_more),
    "momentum": (oracle.momentum_stays, push),
    "energy": (oracle.energy_is_bounded, speed_up),
    "strain": (oracle.strain_is_bounded, pull_a_vertex),
    "crossed": (oracle.nothing_crosses, pass_through),
    "no frame": (oracle.comes_to_its_end, None),
}


@pytest.mark.parametrize(("check", "change"), BREACHES.values(), ids=BREACHES)
def test_a_check_sees_its_breach(good, check, change):
    assert list(check(good)) == []
    if change is None:
        bad = Evidence(good.scene, good.outcome)
        vars(bad)["frames"] = good.frames[:-1]
    else:
        bad = with_frames(good, change)
    assert list(check(bad))


@pytest.mark.parametrize("system", [name for name in UNITS if name != "si"])
def test_a_scene_is_the_same_in_all_units(good, system, tmp_path):
    there = run(replace(FREE, units=system), tmp_path)
    here, there = good.frames[-1], there.frames[-1]
    assert here.step == there.step
    assert np.abs(here.positions - there.positions).max() < 1e-4 * FREE.spacing
    assert here.columns["rho"] == pytest.approx(there.columns["rho"], rel=1e-4)


def test_a_failure_names_its_seed_and_leaves_its_script(monkeypatch, tmp_path):
    monkeypatch.setattr(random_run, "complaints", lambda *_: ["made up"])
    words = ["stress", "random", "--seed", "5", "--count", "1", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 1
    assert "seed 5" in done.output and "made up" in done.output
    assert (tmp_path / "random-5" / "in.random-5").read_text() == script_of(draw(5))


def test_schemes_that_are_named_take_the_place_of_the_one_that_is_drawn(monkeypatch, tmp_path):
    monkeypatch.setattr(random_run, "complaints", lambda *_: ["made up"])
    words = ["--seed", "5", "--count", "1", "--scheme", "constant,block", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, ["stress", "random", *words])
    assert "2 runs: 2 breaches" in done.output
    for scheme in ("constant", "block"):
        name = f"random-5-{scheme}"
        assert (tmp_path / name / f"in.{name}").read_text() == script_of(draw(5, scheme))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--seed", "-1"], "--seed -1: expected a whole number, 0 or above"),
        (["--count", "0"], "--count 0: expected a whole number above 0"),
        (["--scheme", "euler"], "--scheme euler: choose from constant, global, individual, block"),
    ],
)
def test_wrong_use(words, message):
    done = CliRunner().invoke(app, ["stress", "random", *words])
    assert message in str(done.exception)
