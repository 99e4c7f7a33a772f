"""Packaged examples at their smallest size, by the command line as a user runs them."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sphcloth import ClothMesh
from sphcloth.log import ThermoTable
from sphcloth.trajectory import Trajectory

EXAMPLES = Path(__file__).parents[1] / "examples"
SPHCLOTH = Path(sys.executable).parent / "sphcloth"


def run(example: str, out: Path, *settings: str) -> tuple[dict, ThermoTable]:
    """Run an example of size tiny on two ranks; return its summary and its log."""
    done = subprocess.run(
        [
            *(SPHCLOTH, "run", example, "--size", "tiny", "--ranks", "2", "--out", out),
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
    for settings in ([], ["dt=0.001"], ["scheme=block"]):
        summary, log = run("pour", tmp_path / "-".join(settings), *settings)
        found["-".join(settings)] = log["v_hang"][-1], summary["on_sheet"]
    heights, water = np.array(list(found.values())).T
    assert np.ptp(heights) < 0.003, found
    assert np.ptp(water) < 0.05 * water.mean(), found


def test_a_light_sheet_floats_and_a_heavy_one_sinks(tmp_path):
    surface = 0.3
    heights = {}
    for areal in (1.0, 60.0):
        summary, log = run("cloth_on_water", tmp_path / str(areal), f"areal={areal}")
        assert summary["poured"] == 192
        assert log["v_contacts"][-1] > 0
        heights[areal] = log["v_height_of_sheet"][-1]
    assert heights[60.0] < surface < heights[1.0], heights


def test_pins_carry_a_full_hammock_which_is_emptied(tmp_path):
    summary, log = run("hammock", tmp_path)
    assert summary["poured"] == 70
    assert log["v_drained"][-1] == 70
    calm = (log["Time"] > 2.0) & (log["Time"] < 2.6)
    held, weight = log["v_held"][calm].mean(), log["v_weight"][calm].mean()
    assert weight > 500
    assert abs(held / weight - 1) < 0.03, (held, weight)


def test_a_shower_runs_off_a_shirt(tmp_path):
    summary, log = run("shower", tmp_path)
    assert summary["poured"] == 200
    assert log["v_contacts"][-1] > 0
    frames = Trajectory(tmp_path / "shower.lammpstrj", tmp_path / "log.lammps")
    shirt = ClothMesh.read(tmp_path / "shower.data")
    side = np.sign(shirt.positions(frames[0])[:, 1].round(3))
    for frame in frames:
        # front and back, which would go through each other, stay apart
        assert (side * shirt.positions(frame)[:, 1])[side != 0].min() > 0.01


def test_coarse_water_takes_fewer_updates_than_steps(tmp_path):
    summary, log = run("two_resolutions", tmp_path)
    assert summary["poured"] == 172
    assert log["v_contacts"][-1] > 0
    every_step = (log["v_fluid"][1:] * np.diff(log["Step"])).sum()
    assert log["v_updates"][-1] < 0.7 * every_step
    frames = Trajectory(tmp_path / "two_resolutions.lammpstrj", tmp_path / "log.lammps")
    densities = [frame.columns["rho"][np.isin(frame.types, (1, 2))] for frame in frames]
    dense = np.mean(np.concatenate(densities) > 1010)
    assert 0 < dense < 1
    assert summary["compressed"] == pytest.approx(dense)


def test_the_shirt_is_what_the_commands_of_its_page_make(tmp_path):
    folder = EXAMPLES / "shower"
    page = (folder / "README.md").read_text()
    commands = re.search(r"^```sh\n(python make_shirt.*?)^```$", page, re.MULTILINE | re.DOTALL)[1]
    shutil.copy(folder / "make_shirt.py", tmp_path)
    for line in commands.splitlines():
        program, *words = shlex.split(line)
        subprocess.run([SPHCLOTH.with_name(program), *words], cwd=tmp_path, check=True)
    assert (tmp_path / "shirt.groups").read_text() == (folder / "shirt.groups").read_text()
    made, kept = (numbers((place / "shirt.data").read_text()) for place in (tmp_path, folder))
    assert np.allclose(made, kept, rtol=0, atol=2e-5)


def numbers(text: str) -> list[float]:
    return [float(word) for word in re.findall(r"(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?", text)]
