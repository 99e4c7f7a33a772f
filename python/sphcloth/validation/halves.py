"""Settings of an example against the same scene with half the spacing.

``python -m sphcloth.validation.halves EXAMPLE --vary NAME=A,B --out FOLDER`` runs an example that
starts with all of its water with every combination, and once more with half the spacing and the
last value of each. It prints the differences to that run, rms over the frames of the dump, of
lengths over the spacing, of energies over the largest, and what each run costs. Frames of two runs
are up to a step apart.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.examples import find_example, parse_settings
from sphcloth.mesh import read_masses
from sphcloth.metrics import kinetic_energy, masses
from sphcloth.results import Value, points_table, write_json
from sphcloth.roles import Roles
from sphcloth.tradeoff.command import parse_variations
from sphcloth.tradeoff.study import Variations, combinations
from sphcloth.validation.compare import rms
from sphcloth.validation.runner import Run, Runner

ENERGY = "kinetic energy"
QUANTITIES = ("water, along", "water, height", ENERGY, "cloth, along", "cloth, height")


def course(run: Run) -> dict[str, NDArray[np.float64]]:
    """Return the mean places of water and cloth and the kinetic energy of the water over its mass.

    Each is an array over the frames, in the units of the script; ``along`` is x, the height z.
    """
    data = run.folder / f"{run.name}.data"
    kinds, by_type = sorted(Roles.read(data).fluid or ()), read_masses(data)
    rows = []
    for frame in run.trajectory:
        water = np.isin(frame.types, kinds)
        mass = np.where(water, masses(frame, by_type), 0.0)
        place = np.average(frame.positions, axis=0, weights=mass)
        cloth = frame.positions[~water].mean(axis=0)
        energy = kinetic_energy(frame, mass) / mass.sum()
        rows.append((place[0], place[2], energy, cloth[0], cloth[2]))
    return dict(zip(QUANTITIES, np.array(rows).T, strict=True))


def compare(run: Run, fine: Mapping[str, NDArray[np.float64]], spacing: float) -> dict[str, Value]:
    """Return errors against the fine run, the largest compression in the log, and costs.

    Raises:
        UserError: the two runs have not the same number of frames.
    """
    found: dict[str, Value] = {}
    for name, values in course(run).items():
        if len(values) != len(fine[name]):
            raise UserError(f"{run.folder}: {len(values)} frames, the fine run {len(fine[name])}")
        unit = float(fine[ENERGY].max()) if name == ENERGY else spacing
        found[name] = rms(values - fine[name]) / unit
    log = run.thermo
    return found | {
        "largest compression": float(log["v_deviation"].max()),
        "steps": int(log["Step"][-1]),
        "particle updates": float(log["v_updates"][-1]),
        "loop time, s": log.loop_seconds,
    }


def study(
    name: str, size: str, settings: Mapping[str, str], varied: Variations, out: Path
) -> list[dict[str, Value]]:
    """Run an example with all combinations of values and return a row for each.

    Args:
        name: the example's name.
        size: one of its sizes.
        settings: variables of its script that all runs share.
        varied: variable -> values.
        out: folder for all runs and ``halves.json``.

    Raises:
        UserError: no such example, size or variable, no water in the scene or a source of it, or a
            run that failed.
    """
    example = find_example(name)
    last = {key: values[-1] for key, values in varied.items()}
    given = example.variables(size, {**settings, **last})
    texts = example.defaults() | given
    if "particles" in texts:
        raise UserError(f"{name} has a source, whose jet changes with the spacing: no comparison")
    if "density" not in texts:
        raise UserError(f"{name} has no water: its script has no variable 'density'")
    runner = Runner(example.script, out, 1, Console(stderr=True))

    def run(label: str, values: Mapping[str, str]) -> Run:
        return runner.run(label, float(texts["t_end"]), given | values)

    spacing = float(texts["spacing"])
    fine = course(run("half", {"spacing": f"{spacing / 2:.6g}"}))
    rows: list[dict[str, Value]] = []
    for setting in combinations(varied):
        label = "_".join(setting.values()) or "default"
        rows.append({**setting, **compare(run(label, setting), fine, spacing)})
    write_json(out / "halves.json", rows)
    return rows


def main() -> None:
    """Compare what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("example")
    parser.add_argument("--size", default="small")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--vary", action="append", default=[], metavar="NAME=A,B")
    parser.add_argument("--out", type=Path, default=Path("halves"))
    options = parser.parse_args()
    try:
        rows = study(
            options.example,
            options.size,
            parse_settings(options.set),
            parse_variations(options.vary),
            options.out,
        )
    except UserError as error:
        raise SystemExit(f"error: {error}") from None
    print(points_table(rows))


if __name__ == "__main__":
    main()
