"""The documentation shows every command, and its shell lines are ones that programs take."""

from __future__ import annotations

import importlib.util
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest
import typer
from doc_pages import BLOCKS, ROOT

from sphcloth.cli import app, main
from sphcloth.examples import find_example, parse_settings
from sphcloth.programs import YIELDING

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
        from sphcloth.validation.compare_schemes import cases_with_schemes
        from sphcloth.validation.validate import find_case

        name = given["case"]
        for case in cases_with_schemes(name) if given["schemes"] else [find_case(name)]:
            case.values(settings, given["quick"])
    elif verb == "tradeoff" and given["exact"]:
        from sphcloth.tradeoff import command, exact
        from sphcloth.tradeoff.study import Plan
        from sphcloth.validation.validate import find_case

        case, vary = find_case(given["scene"]), command.parse_variations(given["vary"] or [])
        exact.scene_of(case, given["quantity"] or [])
        exact.settings_of(case, Plan((), vary, settings, {}, given["error"], given["quick"]))
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


def check_echo(words: list[str]) -> None:
    """A value goes to a setting that the kernel has for each process."""
    assert words[1] == ">" and Path(words[2].replace("$$", "self")).is_file()


CHECKS = {
    "echo": check_echo,
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
