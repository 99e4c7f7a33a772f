"""``sphcloth advise``: probe a script, try what could be left out, and say what was found."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth.advice.evidence import Evidence
from sphcloth.advice.probe import Probe, moved
from sphcloth.advice.rules import Proposal, facts, needs
from sphcloth.advice.unused import Finding, unused
from sphcloth.errors import UserError
from sphcloth.results import write_json

# part of the largest displacement by which an end may differ: what is tried is not needed then
SAME = 0.01


@dataclass(frozen=True)
class Advice:
    """What ``sphcloth advise`` found.

    Attributes:
        script: the user's.
        run: the probe.
        facts: what was measured.
        needs: what to change.
        unused: what to leave out.
    """

    script: Path
    run: Evidence
    facts: list[Finding]
    needs: list[Finding]
    unused: list[Finding]

    @property
    def reach(self) -> str:
        """How far the probe came, in words."""
        how = "to the end of the script" if self.run.whole else "stopped there"
        return f"{self.run.steps} steps, to time {self.run.time:.4g}, {how}"

    def write(self, path: Path) -> None:
        """Write everything as JSON."""
        probe = {"steps": self.run.steps, "time": self.run.time, "whole": self.run.whole}
        kinds = ("facts", "needs", "unused")
        found = {kind: [asdict(each) for each in getattr(self, kind)] for kind in kinds}
        write_json(path, {"script": str(self.script), "probe": probe} | found)

    def show(self, console: Console) -> None:
        """Print what was found, each with the line to type."""
        head = f"probe of {self.script}: {self.reach}"
        console.print(head, markup=False, highlight=False, soft_wrap=True)
        _show("measured", self.facts, console)
        if not self.needs and not self.unused:
            console.print("\nnothing to change", style="green")
        _show("to change", self.needs, console)
        _show("not needed" if self.run.whole else "not needed so far", self.unused, console)
        if self.unused and not self.run.whole:
            console.print("--probe-steps or --probe-time reach further", highlight=False)


def advise(
    probe: Probe, console: Console, *, speed: float | None = None, stretch: float = 0.01
) -> Advice:
    """Probe a script and return what it needs.

    Args:
        probe: how to run it.
        console: where the progress appears.
        speed: largest speed that the user expects.
        stretch: strain of an edge that the user accepts.

    Raises:
        UserError: the script is missing or fails, or holds no run or no water of this package.
    """
    with tempfile.TemporaryDirectory(prefix="sphcloth-advise-") as name:
        folder = Path(name)
        with console.status("probing"):
            run = probe.run(folder / "probe")
        check(probe.script, run)
        with console.status("trying what it says"):
            proposals = enumerate(needs(run, speed, stretch))
            found = [_proven(each, probe, run, folder / f"trial{n}") for n, each in proposals]
            spare = [*unused(run), *_tried(probe, run, folder)]
    return Advice(probe.script, run, facts(run), found, spare)


def check(script: Path, run: Evidence) -> None:
    """Raise UserError if there is nothing to advise about."""
    if run.commands.pair_style[:1] != ("sph/tait",):
        style = " ".join(run.commands.pair_style) or "none"
        raise UserError(f"{script} has no 'pair_style sph/tait' but {style}: no water to advise on")
    if run.commands.stepper is None:
        raise UserError(f"{script} has no 'fix sph/integrate': nothing moves the water")
    if not run.steps:
        raise UserError(f"{script} took no step: nothing was measured")


def _tried(probe: Probe, run: Evidence, folder: Path) -> Iterator[Finding]:
    """Run the scene again without hinges, and without viscosity, and compare the ends."""
    for name, kind, before, line in _trials(run):
        other = folder / name
        again = probe.run(other, before=before)
        if again.steps != run.steps:
            continue
        apart, moved_by = moved(folder / "probe", other, kind)
        if np.isfinite(moved_by) and moved_by > 0 and apart < SAME * moved_by:
            measured = (
                f"without it the {kind} ends {apart:.2g} elsewhere, "
                f"after a displacement of {moved_by:.2g}"
            )
            yield Finding(name, measured, line)


def _trials(run: Evidence) -> Iterator[tuple[str, str, list[str], str]]:
    """What can be left out, what it moves, the commands that do so, and the line to type."""
    commands = run.commands
    stiff = {kind: words for kind, words in commands.hinges.items() if words[:1] != ("0",)}
    if commands.dihedral_style[:1] == ("pbd",) and stiff:
        yield "bending", "cloth", ["dihedral_coeff * 0"], "dihedral_style none"
    viscous = [fluid for fluid in commands.fluids.values() if fluid.alpha or fluid.nu]
    if viscous:
        inviscid = [fluid.inviscid for fluid in viscous]
        yield "viscosity", "water", inviscid, inviscid[0]


def _proven(proposal: Proposal, probe: Probe, run: Evidence, folder: Path) -> Finding:
    """Try an advice; what does not help loses its line, and what it showed is added."""
    finding, trial = proposal
    if trial is None:
        return finding
    try:
        again = probe.run(folder, trial.before, trial.edits)
    except UserError as error:
        return Finding(finding.topic, f"{finding.measured}; '{finding.line}' fails: {error}")
    if not again.steps:
        return Finding(finding.topic, f"{finding.measured}; with '{finding.line}' it takes no step")
    showed, helps = trial.judge(run, again)
    measured = f"{finding.measured}; {showed}{'' if helps else ': not worth it'}"
    return Finding(finding.topic, measured, finding.line if helps else None)


def _show(title: str, findings: list[Finding], console: Console) -> None:
    if findings:
        console.print(f"\n{title}", style="bold")
    for each in findings:
        console.print(
            f"  {each.topic}: {each.measured}", markup=False, highlight=False, soft_wrap=True
        )
        if each.line:
            console.print(
                f"    {each.line}", style="cyan", markup=False, highlight=False, soft_wrap=True
            )
