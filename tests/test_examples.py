"""Packaged examples at their smallest size, by the command line as a user runs them."""

import json
import subprocess
import sys
from pathlib import Path

from sphcloth.log import ThermoTable

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
        timeout=300,
    )
    # 0 says that nothing crossed the sheet, and no particle is missing
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((out / "summary.json").read_text()), ThermoTable.read(out / "log.lammps")


def test_a_light_sheet_floats_and_a_heavy_one_sinks(tmp_path):
    surface = 0.3
    heights = {}
    for areal in (1.0, 60.0):
        summary, log = run("cloth_on_water", tmp_path / str(areal), f"areal={areal}")
        assert summary["poured"] == 192
        assert log["v_contacts"][-1] > 0
        heights[areal] = log["v_height_of_sheet"][-1]
    assert heights[60.0] < surface < heights[1.0], heights
