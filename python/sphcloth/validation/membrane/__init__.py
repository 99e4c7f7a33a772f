"""What a sheet of springs is as a membrane, and how sheets of rigid edges hang.

``python -m sphcloth.validation.membrane pull --out FOLDER`` pulls sheets of all patterns at several
angles; Young's modulus and Poisson's ratio beside those of the infinite net. ``... shear`` shears
them both ways, ``... top`` and ``... corners`` hang up sheets of rigid edges, ``... stretch``
sheets of rigid and of compliant edges with several solvers.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from numpy.typing import NDArray
from rich.console import Console

from sphcloth.results import write_json
from sphcloth.validation import compare
from sphcloth.validation.runner import Run, Runner

SCRIPT = Path(__file__).parent / "in.membrane"
CELLS = 16
ANGLES = (0.0, 22.5, 45.0, 67.5, 90.0, 135.0)
SHEARS = (0.01, -0.01, 0.3, -0.3, 0.6, -0.6)
TENSION = 1e-5
SETTLE = 60.0

# sheared far: the tension of the edges limits the step along the directions of the start
SHEARED = {"dt": 0.01, "iterations": 50, "every": 2000}
SHEARED_FOR = 20.0

# hung up, rigid: along current directions, which bear any tension
RIGID = {"edge": 0.0, "diagonal": 0.0, "border": 0.0, "direction": "current"}
HUNG = {"dt": 0.005, "every": 1600}
REST = 8.0
TOP = ((20, (5, 20, 80)), (40, (5, 20, 80)))
CORNERS = ((20, (5, 20, 80, 320)),)
SEEDS = (1, 2, 3)

# hung up by its upper side, of edges of these compliances in m/N, with these iterations
SOLVERS = (
    ("substeps", "start", (2, 5, 10, 20), (0.0, 1e-5, 1e-4, 1e-3)),
    ("gs", "current", (5, 20, 80), (0.0, 1e-4)),
)
HEAVY = {"what": "hang", "held": "top", "cells": 20, "areal": 4.0, "dt": 1e-3, "every": 500}
# hung flat, so that it does not swing
STILL = {"disorder": 0.0, "drag": 20.0}
STILL_FOR = 2.0


@dataclass(frozen=True)
class Net:
    """A sheet whose edges have the stiffness 1 N/m.

    Attributes:
        pattern: that of create_cloth, or ``cross`` for both diagonals.
        diagonal: stiffness of the diagonals, N/m.
        border: stiffness of the edges at the border; a half makes a finite sheet that is as stiff
            as the same piece of an infinite one.
    """

    pattern: str
    diagonal: float = 1.0
    border: float = 0.5

    @property
    def name(self) -> str:
        """What plots and tables call it."""
        border = "" if self.border == 0.5 else ", whole border"
        if self.pattern == "equilateral":
            return f"equilateral{border}"
        return f"{self.pattern}, diagonals {self.diagonal:g}{border}"

    @property
    def label(self) -> str:
        """A name for folders."""
        return self.name.replace(", ", "_").replace(" ", "_")

    def width(self, cells: int) -> float:
        """Return the second side of a sheet of 1 m, of whole rows of equal triangles."""
        if self.pattern != "equilateral":
            return 1.0
        row = math.sqrt(0.75) / cells
        return row * 2 * round(0.5 / row)

    def variables(self, cells: int) -> dict[str, float | str]:
        """Return the variables of the script."""
        return {
            "pattern": self.pattern,
            "diagonal": 1 / self.diagonal,
            "border": 1 / self.border,
            "width": self.width(cells),
        }

    def springs(self) -> list[tuple[float, float, float, float]]:
        """Return stiffness, length over spacing and direction of all springs of a cell."""
        if self.pattern == "equilateral":
            third = math.pi / 3
            return [(1.0, 1.0, math.cos(k * third), math.sin(k * third)) for k in range(3)]
        slope = math.sqrt(0.5)
        up, down = {"square": (1, 0), "diagonal": (0.5, 0.5), "cross": (1, 1)}[self.pattern]
        return [
            (1.0, 1.0, 1.0, 0.0),
            (1.0, 1.0, 0.0, 1.0),
            (up * self.diagonal, math.sqrt(2), slope, slope),
            (down * self.diagonal, math.sqrt(2), slope, -slope),
        ]


NETS = (
    Net("square"),
    Net("square", 0.5),
    Net("diagonal"),
    Net("diagonal", 0.5),
    Net("equilateral"),
    Net("cross"),
    Net("cross", 0.5),
)
WHOLE = (Net("square", border=1.0), Net("diagonal", border=1.0), Net("equilateral", border=1.0))


def stiffness(net: Net) -> NDArray[np.float64]:
    """Return the stiffness of the infinite net in Voigt's notation, N/m.

    At small strain all springs of a net whose vertices are centers of symmetry follow the mean
    strain: they add up k l^2 n n n n over the area of a cell.
    """
    area = math.sqrt(0.75) if net.pattern == "equilateral" else 1.0
    total = np.zeros((3, 3))
    for k, length, x, y in net.springs():
        direction = np.array([x * x, y * y, x * y])
        total += k * length**2 / area * np.outer(direction, direction)
    return total


def moduli(voigt: NDArray[np.float64], degrees: float) -> tuple[float, float]:
    """Return Young's modulus and Poisson's ratio of a pull in a direction."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    strain = np.linalg.solve(voigt, [c * c, s * s, c * s])
    along = float(strain @ [c * c, s * s, c * s])
    across = float(strain @ [s * s, c * c, -c * s])
    return 1 / along, -across / along


def mean_strain(run: Run) -> NDArray[np.float64]:
    """Return the displacement gradient of the inner half of a sheet, by least squares."""
    start, end = run.trajectory[0].positions[:, :2], run.trajectory[-1].positions[:, :2]
    inner = np.max(np.abs(start), axis=1) < 0.2501
    design = np.column_stack([np.ones(np.count_nonzero(inner)), start[inner]])
    fit, *_ = np.linalg.lstsq(design, (end - start)[inner], rcond=None)
    return fit[1:].T


def pull(runner: Runner, net: Net, degrees: float, cells: int = CELLS) -> tuple[float, float]:
    """Return Young's modulus and Poisson's ratio that a sheet shows."""
    label = f"{net.label}_{degrees:g}"
    values = {"what": "pull", "angle": degrees, "tension": TENSION, "cells": cells}
    gradient = mean_strain(runner.run(label, SETTLE, {**net.variables(cells), **values}))
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    along = float(np.array([c, s]) @ gradient @ [c, s])
    across = float(np.array([-s, c]) @ gradient @ [-s, c])
    return TENSION / along, -across / along


def shear(runner: Runner, net: Net, gamma: float, cells: int = CELLS) -> float:
    """Return twice the energy per area over the square of the shear, the border held."""
    values = {"what": "shear", "gamma": gamma, "cells": cells, **SHEARED}
    run = runner.run(f"{net.label}_{gamma:g}", SHEARED_FOR, {**net.variables(cells), **values})
    return 2 * float(run.thermo["c_energy"][-1]) / net.width(cells) / gamma**2


def pull_study(runner: Runner) -> list[dict[str, object]]:
    """Return the moduli of all nets at all angles, measured and of the infinite net."""
    found = []
    for net in (*NETS, *WHOLE):
        for degrees in ANGLES:
            modulus, poisson = pull(runner, net, degrees)
            exact = moduli(stiffness(net), degrees)
            found.append(
                {
                    "sheet": net.name,
                    "angle": degrees,
                    "modulus": modulus,
                    "poisson": poisson,
                    "exact modulus": exact[0],
                    "exact poisson": exact[1],
                }
            )
    return found


def shear_study(runner: Runner) -> list[dict[str, object]]:
    """Return the shear moduli of all nets, sheared both ways, and of the infinite net."""
    found = []
    for net in NETS:
        for gamma in SHEARS:
            modulus, exact = shear(runner, net, gamma), float(stiffness(net)[2, 2])
            found.append(
                {"sheet": net.name, "gamma": gamma, "modulus": modulus, "exact modulus": exact}
            )
    return found


@dataclass(frozen=True)
class Shape:
    """A sheet of 1 m of rigid edges that hangs at rest.

    Attributes:
        sheet: its pattern.
        cells: along a side.
        sweeps: in a step.
        seed: of the displacement at the start.
        depth: of the lowest vertex, m.
        strain: the largest of an edge.
        asymmetry: largest difference of height between a vertex and its mirror image, m.
        twist: angle of the line between the lower corners about the vertical, degrees.
        speed: largest of a vertex, m/s.
    """

    sheet: str
    cells: int
    sweeps: int
    seed: int
    depth: float
    strain: float
    asymmetry: float
    twist: float
    speed: float


def hang(
    runner: Runner, pattern: str, held: str, cells: int, sweeps: int, seed: int
) -> tuple[Shape, Run]:
    """Hang up a sheet."""
    label = f"{held}_{pattern}_{cells}_{sweeps}_{seed}"
    values = {"what": "hang", "pattern": pattern, "held": held, "cells": cells, "seed": seed}
    run = runner.run(label, REST, {**RIGID, **HUNG, **values, "iterations": sweeps})
    first, last = run.trajectory[0], run.trajectory[-1]
    # the displacement at the start is not in the plane of the sheet
    at = {(round(x, 6), round(z, 6)): n for n, (x, _, z) in enumerate(first.positions)}
    place = last.positions
    mirrored = [
        abs(place[n, 2] - place[at[(-x, z)], 2]) for (x, z), n in at.items() if (-x, z) in at
    ]
    across = place[at[(0.5, -0.5)]] - place[at[(-0.5, -0.5)]]
    shape = Shape(
        pattern,
        cells,
        sweeps,
        seed,
        depth=0.5 - float(place[:, 2].min()),
        strain=float(run.thermo["c_strain"][-1]),
        asymmetry=float(max(mirrored)),
        twist=math.degrees(math.atan2(across[1], across[0])),
        speed=float(np.max(np.linalg.norm(last.velocities, axis=1))),
    )
    return shape, run


def top_study(runner: Runner) -> list[dict[str, object]]:
    """Return sheets that hang from their upper side."""
    return [
        asdict(hang(runner, pattern, "top", cells, sweeps, SEEDS[0])[0])
        for cells, counts in TOP
        for pattern in ("square", "diagonal", "equilateral", "cross")
        for sweeps in counts
    ]


def stretch(
    runner: Runner, solver: str, direction: str, iterations: int, compliance: float
) -> dict[str, object]:
    """Hang up a sheet of 4 kg/m^2 and return how much longer than 1 m it hangs, in m."""
    edges = {"edge": compliance, "diagonal": compliance, "border": compliance}
    numbers = {"solver": solver, "direction": direction, "iterations": iterations}
    label = f"{solver}_{iterations}_{compliance:g}"
    run = runner.run(label, STILL_FOR, {**HEAVY, **STILL, **edges, **numbers})
    last = run.trajectory[-1]
    return {
        "solver": f"{solver}, {direction}",
        "iterations": iterations,
        "compliance": compliance,
        "longer": -0.5 - float(np.min(last.positions[:, 2])),
        "speed": float(np.max(np.linalg.norm(last.velocities, axis=1))),
    }


def stretch_study(runner: Runner) -> list[dict[str, object]]:
    """Return how far sheets stretch by their solver and by their compliance."""
    return [
        stretch(runner, solver, direction, iterations, compliance)
        for solver, direction, counts, compliances in SOLVERS
        for iterations in counts
        for compliance in compliances
    ]


def corner_study(runner: Runner) -> list[dict[str, object]]:
    """Return sheets that hang from two corners, and draw those of the most sweeps."""
    found, shown = [], {}
    for cells, counts in CORNERS:
        for pattern in ("square", "diagonal", "equilateral", "cross"):
            for sweeps in counts:
                for seed in SEEDS:
                    shape, run = hang(runner, pattern, "corners", cells, sweeps, seed)
                    found.append(asdict(shape))
                    if seed == SEEDS[0]:
                        shown[pattern] = run
    draw_shapes(shown, runner.out.parent / "corners.png")
    return found


def triangles_of(pattern: str, flat: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the triangles of a flat sheet as create_cloth cuts them."""
    if pattern == "equilateral":
        return Triangulation(*flat.T).triangles
    side = math.isqrt(len(flat))
    row, column = np.divmod(np.arange(side * (side - 1)), side)
    row, column = row[column < side - 1], column[column < side - 1]
    a = row * side + column
    b, d, e = a + 1, a + side, a + side + 1
    turned = (pattern == "diagonal") & ((row + column) % 2 == 1)
    lower = np.column_stack([a, b, np.where(turned, d, e)])
    upper = np.column_stack([np.where(turned, b, a), e, d])
    return np.concatenate([lower, upper])


def draw_shapes(runs: Mapping[str, Run], path: Path) -> None:
    """Draw hanging sheets side by side."""
    figure = Figure(figsize=(4 * len(runs), 4.5), layout="constrained")
    for number, (pattern, run) in enumerate(runs.items()):
        axes = figure.add_subplot(1, len(runs), number + 1, projection="3d")
        flat, place = run.trajectory[0].positions, run.trajectory[-1].positions
        triangles = triangles_of(pattern, flat[:, [0, 2]])
        axes.plot_trisurf(*place.T, triangles=triangles, color="#e3a857", lw=0.2, ec="#7a5520")
        axes.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=(-0.55, 0.5), title=pattern)
        axes.set(xticks=[], yticks=[], zticks=[])
        axes.set_box_aspect((1, 1, 1.05), zoom=1.25)
        axes.view_init(15, -70)
    FigureCanvasAgg(figure).print_figure(path, dpi=100)


def plot_pull(points: Sequence[Mapping[str, object]], path: Path) -> None:
    """Draw modulus and Poisson's ratio over the angle; lines are infinite nets."""
    figure, panels = compare.panels(1, 2)
    fine = np.linspace(0, 135, 136)
    for color, net in enumerate(NETS):
        mine = [point for point in points if point["sheet"] == net.name]
        exact = np.array([moduli(stiffness(net), degrees) for degrees in fine])
        for axes, key, column in zip(panels, ("modulus", "poisson"), (0, 1), strict=True):
            axes.plot(fine, exact[:, column], color=f"C{color}", lw=1)
            angle, value = zip(*((point["angle"], point[key]) for point in mine), strict=True)
            axes.plot(angle, value, "os^vD*P"[color], color=f"C{color}", label=net.name)
    panels[0].set(xlabel="angle of the pull / degrees", ylabel="Young's modulus / (N/m)")
    panels[1].set(xlabel="angle of the pull / degrees", ylabel="Poisson's ratio")
    figure.set_size_inches(14, 4)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    for axes in panels:
        axes.set_xticks(ANGLES)
    compare.save(figure, path)


Points = list[dict[str, object]]
STUDIES: Mapping[str, Callable[[Runner], Points]] = {
    "pull": pull_study,
    "shear": shear_study,
    "top": top_study,
    "corners": corner_study,
    "stretch": stretch_study,
}


def study(name: str, out: Path, console: Console) -> Points:
    """Run one study; writes its points, and its plot if it has one, to a folder."""
    points = STUDIES[name](Runner(SCRIPT, out / name, 1, console))
    if name == "pull":
        plot_pull(points, out / "pull.png")
    write_json(out / f"{name}.json", points)
    return points


def main() -> None:
    """Run the study that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("study", choices=tuple(STUDIES))
    parser.add_argument("--out", type=Path, default=Path("membrane"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    console = Console()
    for point in study(options.study, options.out, console):
        values = (
            f"{key} {value:.4g}" if isinstance(value, float) else f"{value}"
            for key, value in point.items()
        )
        console.print("  ".join(values), highlight=False, soft_wrap=True)
