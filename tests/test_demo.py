"""The demo at its smallest size, and the same script with other values of its variables."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SPHCLOTH = Path(sys.executable).parent / "sphcloth"

VARIANTS = {
    "as it is": [],
    "corners": ["--set", "hold=corners", "--set", "pinned=0.1"],
    "over a tank": ["--set", "ground=tank", "--set", "t_end=1.0"],
    "two sources, other sheet": [
        *("--set", "sources=2", "--set", "apart=0.25", "--set", "size=0.8", "--set", "hold=sides"),
        *("--set", "areal=8.0", "--set", "scheme=constant", "--set", "dt=4e-4"),
    ],
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_pour(variant, tmp_path):
    done = subprocess.run(
        [
            *(SPHCLOTH, "run", "pour", "--size", "tiny", "--ranks", "2", "--out", tmp_path),
            *("--no-pictures", *VARIANTS[variant]),
        ],
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    summary = json.loads((tmp_path / "summary.json").read_text())
    flat = json.dumps(summary)
    assert summary["poured"] == 150, flat
    assert summary["crossed"] == 0, flat
    assert summary["mass_defect"] == 0, flat
    assert summary["momentum_defect"] < 1e-11, flat
    steps_adapt = "scheme=constant" not in VARIANTS[variant]
    unused = steps_adapt and "density" not in summary["step_set_by"]
    assert any("density" in each["topic"] for each in summary["unused"]) == unused, flat
