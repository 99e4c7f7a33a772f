"""``sphcloth bench air``: what fix cloth/air and fix cloth/gas cost.

A banner without air, with wind, and with wind and gusts, a lee or added mass; a sphere without and
with gas. Density and pressure are so low that all of them move alike: what differs is the work of
the fix. Times are processor times of one core.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import trimesh
from rich.console import Console
from rich.table import Table

from sphcloth.bench.timing import Runner, Timing, figure, read_timing
from sphcloth.meshing.cloth import Material, build_cloth
from sphcloth.meshing.lammps_files import write_data
from sphcloth.meshing.surface import Surface
from sphcloth.results import versions

SCRIPT = Path(__file__).parent / "in.air"
BALLOON = "balloon"
# what is timed: air and mesh, and the run without it
RUNS = {
    "wind": ("yes", "banner"),
    "wind and gusts": ("gust", "banner"),
    "wind, shaded": ("shaded", "banner"),
    "wind and added mass": ("mass", "banner"),
    "gas": ("gas", BALLOON),
}


def bench_air(rounds: int, across: int, steps: int, console: Console) -> dict:
    """Measure, print a table and return all figures.

    Args:
        rounds: how often everything is measured.
        across: edges along the upper edge of the banner; those of the balloon are about as long.
        steps: length of a timed run.
        console: where the table goes.
    """
    plain: dict[str, list[Timing]] = {"banner": [], BALLOON: []}
    windy: dict[str, list[Timing]] = {name: [] for name in RUNS}
    with tempfile.TemporaryDirectory() as folder:
        run = Runner(SCRIPT, Path(folder), across=across, steps=steps)
        _write_balloon(Path(folder) / f"{BALLOON}.data", across)
        for k in range(rounds):
            with console.status(f"round {k + 1} of {rounds}"):
                for mesh, times in plain.items():
                    times.append(read_timing(run(air="no", mesh=mesh)))
                for name, (air, mesh) in RUNS.items():
                    windy[name].append(read_timing(run(air=air, mesh=mesh)))
    result = {
        "bench": "air",
        "vertices": plain["banner"][0].particles,
        "vertices_of_balloon": plain[BALLOON][0].particles,
        "rounds": rounds,
        "versions": versions("lammps", "sphcloth"),
        "more": {
            name: figure(
                [a.cpu / b.cpu - 1 for a, b in zip(times, plain[RUNS[name][1]], strict=True)]
            )
            for name, times in windy.items()
        },
    }
    show(result, console)
    return result


def _write_balloon(path: Path, across: int) -> None:
    """Write a sphere of the radius 0.5 with edges of about 1 / ``across``."""
    halvings = max(1, int(math.log2(0.5 * across)))  # an icosahedron's edges are 1.05 radii
    sphere = trimesh.creation.icosphere(halvings, 0.5)
    cloth = build_cloth(Surface.of(sphere.vertices, sphere.faces), [Material(0.3)])
    write_data(cloth, path, np.array([[-2.0] * 3, [2.0] * 3]), "molecular")


def show(result: dict, console: Console) -> None:
    """Print all figures."""
    table = Table(
        title=f"a banner of {result['vertices']} vertices, a balloon of "
        f"{result['vertices_of_balloon']}, {result['rounds']} rounds"
    )
    table.add_column("")
    table.add_column("more than without air", justify="right")
    for name, more in result["more"].items():
        spread = f"{more['value']:.1%} ({more['least']:.1%} to {more['most']:.1%})"
        table.add_row(name, spread)
    console.print(table)
