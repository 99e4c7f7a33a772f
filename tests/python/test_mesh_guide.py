"""docs/howto/from_a_mesh_to_a_scene.md does what it says."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from test_cli import call

GUIDE = Path(__file__).parents[2] / "docs" / "howto" / "from_a_mesh_to_a_scene.md"


def blocks(language: str) -> list[str]:
    """The guide's code blocks in a language, "" for input scripts."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", GUIDE.read_text(), re.MULTILINE | re.DOTALL)
    return [text for name, text in found if name == language]


def test_the_guide_s_scene_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    make_bowl, use_from_python = blocks("python")
    to_cloth, to_meshes = (block for block in blocks("sh") if "bowl" in block)
    scene = next(block for block in blocks("") if "bowl.data" in block)
    exec(make_bowl, {})
    assert call(monkeypatch, *shlex.split(to_cloth)[1:]) == 0
    Path("in.bowl").write_text(scene)
    lmp = [Path(sys.executable).parent / "lmp", "-in", "in.bowl", "-var", "steps", "200"]
    done = subprocess.run(lmp, capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stdout[-2000:]
    assert "WARNING" not in done.stdout
    assert call(monkeypatch, *shlex.split(to_meshes)[1:]) == 0
    assert len(list(Path("bowl_meshes").glob("*.vtp"))) == 3
    exec(use_from_python, {})
    assert Path("bowl.mol").is_file()
