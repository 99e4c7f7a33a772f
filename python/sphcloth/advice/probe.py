"""A short run of a copy of a user's script, with a table of what its fixes report.

The script itself is not touched. In the copy every ``run`` becomes an ``include`` of a few lines:
the same run, cut to the steps that are left, with a ``fix ave/time`` that writes the table and, at
the end, the places of all atoms. These only look; the copy computes what the script does.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.advice.commands import Commands, appended
from sphcloth.advice.evidence import Evidence
from sphcloth.errors import UserError
from sphcloth.run import LOG, copy_companions, lammps_command, last_words, wait_for_lammps
from sphcloth.trajectory import Frame, Trajectory

TABLE, FIRST, FINAL = "advise.table", "advise.first", "advise.final"
USED, CUT = "advise.used", "advise.cut"
# every how many steps a row is written, and of a run of how many steps each one is
EVERY, SHORT = 5, 100
# a script that does not look at the clock is killed after this
TIMEOUT_FACTOR, GRACE_SECONDS = 3.0, 20.0

# a run command, also one in the quotes of an `if`
_RUN = re.compile(r"^\s*run\s+(.+?)\s*$")
_QUOTED_RUN = re.compile(r"""(["'])run\s+(.+?)\1""")
_FIX = re.compile(r"\bfix\s+(\S+)\s+(\S+)\s+(sph/\w+|pbd/cloth|cloth/contact|wall/sph)\b")
# styles whose fix has a vector; fix sph/drain has a scalar
_VECTORS = ("sph/integrate", "pbd/cloth", "cloth/contact", "wall/sph")
_DUMP = "id type x y z v_advise_water v_advise_cloth modify sort id format float %20.15g"


@dataclass(frozen=True)
class Probe:
    """How to run a script.

    Attributes:
        script: the user's.
        variables: name -> value, as with ``-var``.
        ranks: number of MPI ranks.
        steps: after which it is stopped, over all runs of the script.
        seconds: of wall time after which it is stopped.
    """

    script: Path
    variables: Mapping[str, str]
    ranks: int
    steps: int
    seconds: float

    def run(
        self, folder: Path, before: Sequence[str] = (), edits: Mapping[str, str] | None = None
    ) -> Evidence:
        """Run a copy of the script in a folder of its own.

        Args:
            folder: for the copy and all that it writes; made here.
            before: commands to give before each run.
            edits: style of a fix -> what to append to its command.

        Raises:
            UserError: no script, no run command in it, a variable that it does not have, or
                LAMMPS failed.
        """
        copy = self._copy(folder, before, edits or {})
        command = lammps_command(Path(copy.name), self.ranks, self.variables)
        begin = time.monotonic()
        status = wait_for_lammps(command, folder, TIMEOUT_FACTOR * self.seconds + GRACE_SECONDS)
        # one that took too long is read as far as it came
        if status and not _has_quit(folder):
            reason = " ".join(last_words(folder)) or f"exit status {status}"
            raise UserError(f"{self.script} fails: {reason}")
        return self._read(folder, time.monotonic() - begin < self.seconds)

    def _copy(self, folder: Path, before: Sequence[str], edits: Mapping[str, str]) -> Path:
        """Write the script and the files that it reads to a folder; returns the copy."""
        texts = gather(self.script)
        whole = "\n".join(texts.values())
        self._check_variables(whole)
        fixes = _fixes(whole)
        runs: list[str] = []
        folder.mkdir(parents=True)
        for path, text in texts.items():
            copy_companions(path, folder)
            lines = [_edited(_hooked(line, runs), edits) for line in text.splitlines()]
            (folder / path.name).write_text("\n".join(lines) + "\n", encoding="utf-8")
        if not runs:
            raise UserError(f"{self.script} has no 'run' command: nothing to probe")
        for number, arguments in enumerate(runs):
            hook = self._hook(arguments, fixes, before)
            (folder / _hook_name(number)).write_text("\n".join(hook) + "\n", encoding="utf-8")
        copy = folder / self.script.name
        zero = "".join(f"variable {name} equal 0\n" for name in ("advise_used", "advise_spent"))
        clock = f"{zero}timer timeout 0:0:{self.seconds:.0f} every 10\n"
        copy.write_text(clock + copy.read_text(encoding="utf-8"), encoding="utf-8")
        return copy

    def _check_variables(self, text: str) -> None:
        """Raise UserError for a variable that the script and what it includes do not have."""
        if re.search(r"^\s*include\s+\S*\$", text, re.MULTILINE):
            return  # which file that is, LAMMPS knows
        for name in self.variables:
            short = rf"|\${name}" if len(name) == 1 else ""
            used = rf"\bvariable[\s,]+{name}\b|\$\{{{name}\}}|\bv_{name}\b{short}"
            if not re.search(used, text):
                raise UserError(f"{self.script.name} has no variable '{name}'")

    def _hook(self, run: str, fixes: Sequence[re.Match], before: Sequence[str]) -> list[str]:
        """Return the commands in the place of ``run``, whose arguments are given as text."""
        count, _, rest = run.partition(" ")
        end = "step+" if "upto" in rest.split() else ""
        stop = f"print cut file {CUT} screen no"
        return [
            f'if "$(v_advise_used) >= {self.steps}" then "{stop}" "quit 0"',
            "variable advise_time equal time",
            "variable advise_dt equal dt",
            "variable advise_builds equal nbuild",
            "variable advise_speed atom sqrt(vx^2+vy^2+vz^2)",
            "variable advise_water atom 0",
            'variable advise_columns string "v_advise_time v_advise_dt v_advise_builds"',
            *(line for fix in fixes for line in _columns(fix)),
            *_cloth_of(fixes),
            "variable advise_from equal $(step)",
            f'if "$(v_advise_used) == 0" then "write_dump all custom {FIRST} {_DUMP}"',
            *before,
            f"variable advise_wanted equal {count}",
            f"variable advise_left equal {end}{self.steps}-v_advise_used",
            "variable advise_cut equal $(v_advise_wanted>v_advise_left)",
            "variable advise_count equal ternary(v_advise_wanted<v_advise_left,v_advise_wanted,"
            "v_advise_left)",
            f"variable advise_every equal ternary(v_advise_count<{SHORT},1,{EVERY})",
            "fix advise_table all ave/time $(v_advise_every) 1 $(v_advise_every) "
            f'${{advise_columns}} append {TABLE} format " %.15g"',
            "variable advise_start equal $(time)",
            f"run $(v_advise_count:%.0f) {rest}",
            "unfix advise_table",
            'if "$(is_defined(compute,advise_fast))" then "uncompute advise_fast"',
            f"write_dump all custom {FINAL} {_DUMP}",
            "variable advise_done equal step-v_advise_from",
            "variable advise_used equal $(v_advise_used+v_advise_done)",
            "variable advise_spent equal $(v_advise_spent+time-v_advise_start)",
            f'print "$(v_advise_used) $(v_advise_spent) $(time)" file {USED} screen no',
            f'if "$(v_advise_cut*(v_advise_used>={self.steps}))" then "{stop}" "quit 0"',
        ]

    def _read(self, folder: Path, in_time: bool) -> Evidence:
        """Return what a run has left in its folder."""
        commands, columns = Commands.read(folder / LOG), _read_table(folder / TABLE)
        used = folder / USED
        text = used.read_text() if used.is_file() else "0 0 0"
        steps, duration, end = map(float, text.split())
        whole = in_time and used.is_file() and not (folder / CUT).is_file()
        return Evidence(commands, columns, whole, int(steps), end, duration)


def gather(script: Path) -> dict[Path, str]:
    """Return path -> text, continued lines joined, of a script and all that it includes.

    Raises:
        UserError: no such script.
    """
    if not script.is_file():
        raise UserError(f"no script {script}")
    found, waiting = {}, [script]
    while waiting:
        path = waiting.pop()
        text = path.read_text(encoding="utf-8", errors="replace")
        found[path] = re.sub(r"&[ \t]*\n", " ", text)
        names = re.findall(r"^\s*include\s+(\S+)", found[path], re.MULTILINE)
        inner = [path.parent / name for name in names]
        waiting += [each for each in inner if each.is_file() and each not in found]
    return found


def moved(folder: Path, other: Path, kind: str) -> tuple[float, float]:
    """Compare where two probes have left their atoms.

    Args:
        folder: of a probe.
        other: of another one of the same script.
        kind: ``water`` or ``cloth``.

    Returns:
        Largest distance between the two ends, and largest displacement of the first probe; NaN
        where atoms came or went, or there are none.
    """
    start, end, theirs = (
        _places(place, kind) for place in (folder / FIRST, folder / FINAL, other / FINAL)
    )
    both = np.intersect1d(end.ids, theirs.ids)
    lived = np.intersect1d(start.ids, end.ids)
    if not len(both) or len(both) < max(len(end), len(theirs)) or not len(lived):
        return math.nan, math.nan
    apart = end.shortest(end.positions - theirs.positions)
    rows, first = np.isin(end.ids, lived), np.isin(start.ids, lived)
    displacement = end.shortest(end.positions[rows] - start.positions[first])
    return tuple(float(np.linalg.norm(each, axis=1).max()) for each in (apart, displacement))


def _fixes(text: str) -> list[re.Match]:
    """Return the fixes of this package that a script may define, each ID once."""
    lines = "\n".join(line.partition("#")[0] for line in text.splitlines())
    return list({found[1]: found for found in _FIX.finditer(lines)}.values())


def _has_quit(folder: Path) -> bool:
    """Tell whether a script that has run something ended by ``quit``, whatever its status."""
    log = folder / LOG
    if not (folder / USED).is_file() or not log.is_file():
        return False
    # commands are in the log before they are executed, and errors behind them
    text = log.read_text(encoding="utf-8", errors="replace").rstrip()
    return text.rpartition("\n")[2].split()[:1] == ["quit"]


def _hook_name(number: int) -> str:
    return f"advise.run{number}"


def _hooked(line: str, runs: list[str]) -> str:
    """Replace the runs in a line by includes; their arguments are appended to ``runs``."""

    def include(arguments: str) -> str:
        runs.append(arguments)
        return f"include {_hook_name(len(runs) - 1)}"

    if plain := _RUN.match(line.partition("#")[0]):
        return include(plain[1])
    if line.split()[:1] == ["if"]:
        return _QUOTED_RUN.sub(lambda run: f"{run[1]}{include(run[2])}{run[1]}", line)
    return line


def _edited(line: str, edits: Mapping[str, str]) -> str:
    """Append what is to be appended to the fixes of some styles."""
    # in an `if` a command ends with its quotes
    until = r"[^\"']*" if line.split()[:1] == ["if"] else ".*"

    def longer(fix: re.Match) -> str:
        name, group, style, words = fix.groups()
        if style not in edits:
            return fix[0]
        return f"fix {name} {group} {style} {appended(style, words.split(), edits[style])}"

    code = line.partition("#")[0]
    edited = re.sub(f"{_FIX.pattern}({until})", longer, code)
    return line if edited == code else edited


def _columns(fix: re.Match) -> list[str]:
    """Return commands that add what a fix reports to the columns, if it is there by then."""
    name, group, style = fix.groups()
    defined = f'if "$(is_defined(fix,{name}))" then'
    adds = []
    if style in _VECTORS:
        adds.append(f"f_{name}[*]")
    if style == "sph/drain":
        adds.append(f"f_{name}")
    commands = []
    if style == "sph/integrate":
        adds += ["c_advise_fast", "v_advise_atoms"]
        commands += [
            f"compute advise_fast {group} reduce max v_advise_speed",
            f"variable advise_atoms equal count({group})",
            f"variable advise_water atom gmask({group})",
        ]
    if adds:
        commands.append(f"variable advise_columns string '${{advise_columns}} {' '.join(adds)}'")
    return [f'{defined} "{command}"' for command in commands]


def _cloth_of(fixes: Sequence[re.Match]) -> list[str]:
    """Return commands that mark the vertices of all cloths that are there by then."""
    cloths = [(fix[1], fix[2]) for fix in fixes if fix[3] == "pbd/cloth"]
    commands, marks = [], "0"
    for number, (name, group) in enumerate(cloths):
        mark = f"advise_cloth{number}"
        commands.append(f"variable {mark} atom 0")
        defined = f'if "$(is_defined(fix,{name}))" then'
        commands.append(f'{defined} "variable {mark} atom gmask({group})"')
        marks += f"+v_{mark}"
    return [*commands, f"variable advise_cloth atom {marks}"]


def _read_table(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the columns of all runs, one after the other; NaN where a run has no such column."""
    parts: list[tuple[list[str], list[list[float]]]] = []
    for line in path.read_text().splitlines() if path.is_file() else ():
        words = line.split()
        if words[:2] == ["#", "TimeStep"]:
            parts.append((words[1:], []))
        elif words[:1] != ["#"] and parts and len(words) == len(parts[-1][0]):
            parts[-1][1].append([float(word) for word in words])
    names = dict.fromkeys(name for heads, _ in parts for name in heads)
    columns: dict[str, list[NDArray]] = {name: [] for name in names}
    for heads, rows in parts:
        values = dict(zip(heads, np.array(rows).reshape(-1, len(heads)).T, strict=True))
        for name in names:
            columns[name].append(values.get(name, np.full(len(rows), np.nan)))
    return {name: np.concatenate(each) for name, each in columns.items()}


def _places(dump: Path, kind: str) -> Frame:
    """Return the atoms of one kind in a file by ``write_dump``."""
    frame = Trajectory(dump)[-1]
    chosen = frame.columns[f"v_advise_{kind}"] > 0
    return replace(frame, columns={name: each[chosen] for name, each in frame.columns.items()})
