"""Packaged examples at their smallest size, by the command line as a user runs them."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from sphcloth import ClothMesh
from sphcloth.log import ThermoTable
from sphcloth.metrics.intersections import Intersections
from sphcloth.roles import Roles
from sphcloth.trajectory import Trajectory

EXAMPLES = Path(__file__).parents[1] / "examples"
SPHCLOTH = Path(sys.executable).parent / "sphcloth"


def run(example: str, out: Path, *settings: str, ranks: int = 1) -> tuple[dict, ThermoTable]:
    """Run an example of size tiny; return its summary and its log.

    Ranks that share a core with other tests wait for each other: two take ten times as long.
    """
    done = subprocess.run(
        [
            *(SPHCLOTH, "run", example, "--size", "tiny", "--ranks", str(ranks), "--out", out),
            *("--no-pictures", *(word for setting in settings for word in ("--set", setting))),
        ],
        capture_output=True,
        text=True,
        timeout=1800,
    )
    # 0 says that nothing crossed the sheet, and no particle is missing
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((out / "summary.json").read_text()), ThermoTable.read(out / "log.lammps")


# scripts that a user starts from
SCRIPTS = [
    *sorted(EXAMPLES.glob("*/in.*")),
    EXAMPLES.parent / "README.md",
    EXAMPLES.parent / "docs" / "tutorial.ipynb",
    EXAMPLES.parent / "docs" / "howto" / "from_a_mesh_to_a_scene.md",
    EXAMPLES / "live_pour" / "live_pour.py",
]


@pytest.mark.parametrize("script", sorted(EXAMPLES.glob("*/in.*")), ids=lambda path: path.name)
def test_no_script_reads_what_it_writes(script):
    """So that it runs a second time in the same folder, and leaves the files of the package."""
    text = script.read_text()
    written = set(
        re.findall(r"write_data +(\S+)|^dump +\w+ +\S+ +\S+ +\S+ +(\S+)", text, re.MULTILINE)
    )
    names = {name for pair in written for name in pair if name}
    assert f"{script.suffix[1:]}.lammpstrj" in names
    read = set(re.findall(r"^(?:read_data|include|molecule +\w+) +(\S+)", text, re.MULTILINE))
    assert not names & read


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_cloth_is_a_material(script):
    """A stiffness k follows the step, a compliance does not."""
    text = script.read_text()
    variables = dict(re.findall(r'variable +(\w+) +index +"?([^"\n#]+)', text))
    for style, given in re.findall(r"(bond|dihedral)_coeff +[\d*]+ +([^\n\\]+)", text):
        words = re.sub(r"\$\{(\w+)\}", lambda found: variables[found[1]], given)
        assert words.startswith("compliance") or "rest zero" in words, f"{style}_coeff {words}"


def test_the_answer_of_pour_follows_neither_step_nor_scheme(tmp_path):
    """Height of the sheet and water on it."""
    found = {}
    for settings in ([], ["limits=stability 0.4"], ["scheme=block"]):
        summary, log = run("pour", tmp_path / "-".join(settings), *settings)
        found["-".join(settings)] = log["v_hang"][-1], summary["on_sheet"]
    heights, water = np.array(list(found.values())).T
    assert np.ptp(heights) < 0.003, found
    # some 110 particles, of which chance moves a few over the rim
    assert np.ptp(water) < 0.1 * water.mean(), found


def test_a_light_sheet_floats_and_a_heavy_one_sinks(tmp_path):
    """The light one has a draft of 1 mm, its mass per area over the density of water."""
    surface, draft = 0.3, 0.001
    heights = {}
    for areal in (1.0, 60.0):
        summary, log = run("cloth_on_water", tmp_path / str(areal), f"areal={areal}", "t_end=0.8")
        assert summary["poured"] == 192
        assert log["v_contacts"][-1] > 0
        heights[areal] = log["v_height_of_sheet"][-1]
    assert heights[1.0] == pytest.approx(surface - draft, abs=0.002), heights
    assert heights[60.0] < heights[1.0] - 0.01, heights


def test_pins_carry_a_full_hammock_which_is_emptied(tmp_path):
    summary, log = run("hammock", tmp_path)
    assert summary["poured"] == 70
    # a particle or two may stay in a fold
    assert log["v_drained"][-1] >= 64
    calm = (log["Time"] > 2.0) & (log["Time"] < 2.6)
    held, weight = log["v_held"][calm].mean(), log["v_weight"][calm].mean()
    assert weight > 500
    assert abs(held / weight - 1) < 0.03, (held, weight)


def test_a_shower_runs_off_a_shirt(tmp_path):
    summary, log = run("shower", tmp_path)
    assert summary["poured"] == 200
    assert log["v_contacts"][-1] > 0
    # its front and back do not go through each other
    assert summary["layers"]
    assert summary["crossed"] == 0
    if find_spec("ipctk"):
        assert summary["intersections"] == 0


def test_coarse_water_takes_fewer_updates_than_steps(tmp_path):
    summary, log = run("two_resolutions", tmp_path, ranks=2)
    assert summary["poured"] == 172
    assert sum(summary["step_set_by"].values()) == pytest.approx(summary["steps"], abs=1)
    assert log["v_contacts"][-1] > 0
    every_step = (log["v_fluid"][1:] * np.diff(log["Step"])).sum()
    assert log["v_updates"][-1] < every_step
    frames = Trajectory(tmp_path / "two_resolutions.lammpstrj", tmp_path / "log.lammps")
    densities = [frame.columns["rho"][np.isin(frame.types, (1, 2))] for frame in frames]
    dense = np.mean(np.concatenate(densities) > 1010)
    assert 0 < dense < 1
    assert summary["compressed"] == pytest.approx(dense)


def layers(example: str, out: Path) -> tuple[dict, ThermoTable]:
    """Run an example of cloth that meets cloth; what no such example may lack."""
    summary, log = run(example, out)
    assert summary["layers"]
    assert summary["crossed"] == 0
    if find_spec("ipctk"):
        assert summary["intersections"] == 0
    assert log["v_contacts"][-1] > 0
    assert log["v_cloth_contacts"][-1] > 0
    return summary, log


def test_a_towel_is_wrung(tmp_path):
    summary, log = layers("towel", tmp_path)
    assert summary["poured"] == 50
    # water stays in it until it is wrung, and leaves it then
    before, after = log["Time"] < 0.6, log["Time"] > 0.6
    assert log["v_drained"][before].max() < 25
    assert log["v_drained"][after].max() > log["v_drained"][before].max()


def test_a_shirt_falls_on_a_chair_under_a_shower(tmp_path):
    summary, _ = layers("chair", tmp_path)
    assert summary["poured"] == 90
    frames = Trajectory(tmp_path / "chair.lammpstrj", tmp_path / "log.lammps")
    shirt, last = frames[0].types == 1, frames[-1]
    # the seat holds it
    assert last.positions[last.types == 1].min(axis=0)[2] > 0.2
    assert shirt.sum() == (last.types == 1).sum()


def test_a_stack_of_sheets_catches_a_jet(tmp_path):
    summary, _ = layers("stack", tmp_path)
    assert summary["poured"] == 100
    frames = Trajectory(tmp_path / "stack.lammpstrj", tmp_path / "log.lammps")
    sheets = ClothMesh.read(tmp_path / "stack.data")
    last = sheets.positions(frames[-1])
    heights = [last[sheets.pieces == piece, 2].mean() for piece in range(3)]
    assert heights == sorted(heights, reverse=True)


def test_water_goes_through_a_strainer_and_not_through_its_hem(tmp_path):
    summary, table = run("strainer", tmp_path)
    assert summary["crossed"] == 0
    assert summary["through_pores"] > 5
    # what the fix counts comes and goes between frames, too
    assert table["v_through"][-1] == pytest.approx(summary["through_pores"], abs=5)


def test_a_net_streams_out_behind_its_upper_edge(tmp_path):
    summary, table = run("net", tmp_path)
    assert summary["crossed"] == 0
    assert summary["through_pores"] > 0
    # the edge that is towed carries the drag
    late = table["Time"] > 0.7 * table["Time"][-1]
    drag, held = np.mean(table["v_drag"][late]), np.mean(table["c_hold[1]"][late])
    assert drag > 0.3
    assert held == pytest.approx(drag, rel=0.15)


def test_a_bag_of_rubber_grows_with_the_water_in_it(tmp_path):
    summary, table = run("water_balloon", tmp_path)
    assert summary["crossed"] == 0 and summary["spilled"] == 0
    assert summary["poured"] > 150
    assert table["v_lowest"][0] == pytest.approx(-0.06)
    assert table["v_lowest"][-1] < -0.07
    assert 0.05 < table["v_strain"].max() < 1


def test_a_parachute_opens(tmp_path):
    _, table = run("parachute", tmp_path)
    assert table["c_radius"][0] == pytest.approx(0.443, abs=1e-3)
    assert table["c_radius"][-1] > 0.7
    assert table["v_speed"][0] == 8
    assert table["v_speed"][-1] < 4.5
    assert table["c_strain"].max() < 0.06
    # lines to the load, which are drawn
    assert len(Roles.read(tmp_path / "parachute.data").strings.links) == 12
    if find_spec("ipctk"):
        mesh = ClothMesh.read(tmp_path / "parachute.data")
        frames = Trajectory(tmp_path / "parachute.lammpstrj")
        canopy = Intersections.of(mesh)
        assert not any(canopy.intersect(mesh.positions(frame)) for frame in frames)


def test_what_the_mouth_catches_opens_the_parachute(tmp_path):
    _, table = run("parachute", tmp_path, "mouth=0")
    assert table["c_radius"][-1] < 0.65
    assert table["v_speed"][-1] > 7


@pytest.mark.parametrize(
    ("example", "mesh", "scripts"),
    [
        ("balloon", "balloon", ["balloon/make_balloon.py"]),
        ("water_balloon", "bag", ["water_balloon/make_bag.py"]),
        ("parachute", "canopy", ["parachute/make_parachute.py"]),
        ("shower", "shirt", ["shower/make_shirt.py"]),
        ("chair", "shirt_and_chair", ["shower/make_shirt.py", "chair/make_chair.py"]),
    ],
)
def test_the_mesh_is_what_the_commands_of_its_page_make(tmp_path, example, mesh, scripts):
    kept_in, folder = EXAMPLES / example, tmp_path / example
    page = (kept_in / "README.md").read_text()
    commands = re.search(r"^```sh\n(python [^\n]*make.*?)^```$", page, re.MULTILINE | re.DOTALL)[1]
    for script in scripts:
        (tmp_path / script).parent.mkdir(exist_ok=True)
        shutil.copy(EXAMPLES / script, tmp_path / script)
    for line in commands.splitlines():
        program, *words = shlex.split(line)
        subprocess.run([SPHCLOTH.with_name(program), *words], cwd=folder, check=True)
    assert (folder / f"{mesh}.groups").read_text() == (kept_in / f"{mesh}.groups").read_text()
    made, kept = (numbers((place / f"{mesh}.data").read_text()) for place in (folder, kept_in))
    assert np.allclose(made, kept, rtol=0, atol=2e-5)


def numbers(text: str) -> list[float]:
    return [float(word) for word in re.findall(r"(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?", text)]
