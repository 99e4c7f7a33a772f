"""Runs a case's input script through LAMMPS and reads what it wrote."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.log import ThermoTable, error_lines
from sphcloth.results import Value, argument
from sphcloth.run import LOG, SCREEN, lammps_command, run_lammps
from sphcloth.trajectory import Trajectory


@dataclass(frozen=True)
class Run:
    """The output of one finished run of a script ``in.<name>``.

    Attributes:
        folder: holds ``log.lammps`` and ``<name>.lammpstrj``.
        name: the case's name.
    """

    folder: Path
    name: str

    @cached_property
    def thermo(self) -> ThermoTable:
        """The thermo output of the run."""
        return ThermoTable.read(self.folder / LOG)

    @cached_property
    def trajectory(self) -> Trajectory:
        """The dump of the run, with physical times."""
        return Trajectory(self.folder / f"{self.name}.lammpstrj", self.folder / LOG)


@dataclass
class Runner:
    """Where a case runs: its script, the number of ranks and the folder for all output.

    Attributes:
        script: the input script ``in.<name>``.
        out: output folder; each run has a folder of its own in it.
        ranks: number of MPI ranks.
        console: where the progress appears.
        runs: all finished runs, in order.
    """

    script: Path
    out: Path
    ranks: int
    console: Console
    runs: list[Run] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The case's name."""
        return self.script.name.removeprefix("in.")

    @property
    def picture(self) -> Path:
        """Where the case draws what it has found."""
        return self.out / f"{self.name}.png"

    def on_ranks(self, most: int) -> dict[str, Runner]:
        """Return runners on 1, 2, 4 ... ranks up to `most`, by the label of their run."""
        counts = [2**n for n in range(most.bit_length())]
        return {f"ranks_{count}": replace(self, ranks=count) for count in counts}

    def run(self, label: str, t_end: float, variables: Mapping[str, Value]) -> Run:
        """Run the script once.

        Args:
            label: name of the run's folder in ``out``; what an earlier run left there goes.
            t_end: physical time at which the run ends; the script gets it as ``t_end``.
            variables: values of the script's variables.

        Raises:
            UserError: LAMMPS ended with an error, or the user stopped it.
        """
        folder = self.out / label
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        texts = {name: argument(value) for name, value in {**variables, "t_end": t_end}.items()}
        command = lammps_command(self.script.resolve(), self.ranks, texts)
        outcome = run_lammps(command, folder, t_end, self.console)
        if outcome.interrupted:
            raise UserError(f"{self.name} was stopped: no verdict")
        if outcome.status != 0:
            raise UserError(f"{self.name}, run {label}: {_what_went_wrong(folder)}")
        self.runs.append(Run(folder, self.name))
        return self.runs[-1]

    def particle_updates(self) -> float:
        """Return how often a particle was stepped in all runs (thermo column v_updates)."""
        return float(sum(run.thermo["v_updates"][-1] for run in self.runs))


def _what_went_wrong(folder: Path) -> str:
    """Return the last words of LAMMPS, or else of the launcher."""
    words = error_lines(folder / LOG)
    words = words or (folder / SCREEN).read_text(errors="replace").splitlines()[-1:]
    return f"LAMMPS failed: {' '.join(words)} (log: {folder / LOG})"
