"""No module of the package imports itself by way of others.

All imports count: those at the head of a file, in functions, and for types alone. A package that
is loaded only because a module lies in it does not count.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import sphcloth

ROOT = Path(sphcloth.__file__).parent
FILES = {
    ".".join(("sphcloth", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(
        ".__init__"
    ): path
    for path in ROOT.rglob("*.py")
}


def imported(path: Path) -> set[str]:
    """Return the modules of the package that a file imports anywhere."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are written in full"
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in FILES else node.module for name in inner}
    return found & set(FILES)


def test_no_module_imports_itself_by_way_of_others() -> None:
    assert len(FILES) > 100
    TopologicalSorter({name: imported(path) for name, path in FILES.items()}).prepare()


# what a command is to do without waiting for: modules that take long to load
@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("sphcloth.run", ["MDAnalysis", "scipy", "matplotlib", "vtkmodules", "trimesh"]),
        ("sphcloth.summary", ["matplotlib", "vtkmodules", "trimesh"]),
        ("sphcloth.pictures", ["trimesh"]),
    ],
)
def test_nothing_is_loaded_that_is_not_needed(module: str, absent: list[str]) -> None:
    script = f"import sys, {module}; print(*({set(absent)} & set(sys.modules)))"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.split() == []
