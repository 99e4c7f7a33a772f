"""What the cases with gas share: meshes as data files, and runs of them by every scheme."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.mesh import MASS_SECTION
from sphcloth.validation import schemes
from sphcloth.validation.case import Value
from sphcloth.validation.runner import Run, Runner

FOLDER = Path(__file__).parent
ROOM = 1.0  # between mesh and box, of the mesh's extent
FREE, PINNED = 2, 3  # atom types; 1 is water, of which there is none


@dataclasses.dataclass(frozen=True)
class GasMesh:
    """Vertices and triangles as a data file has them; IDs are indices plus 1.

    Attributes:
        vertices: positions, m, shape (n, 3).
        triangles: indices of vertices, shape (m, 3).
        edges: those with a bond, shape (k, 2).
        compliances: of the edges, m/N.
        masses: of the vertices, kg.
        pinned: which vertices are held.
        velocities: at the start, m/s; None for rest.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    edges: NDArray[np.int64]
    compliances: NDArray[np.float64]
    masses: NDArray[np.float64]
    pinned: NDArray[np.bool_]
    velocities: NDArray[np.float64] | None = None

    def write(self, path: Path) -> None:
        """Write the data file."""
        x, n = self.vertices, len(self.vertices)
        # without round-off, so that equal edges are of one type
        kinds, types = np.unique(
            [float(f"{c:.10g}") for c in self.compliances], return_inverse=True
        )
        room = ROOM * np.ptp(x, axis=0).max()
        low, high = x.min(axis=0) - room, x.max(axis=0) + room
        lines = ["mesh with gas", "", f"{n} atoms", f"{len(self.edges)} bonds"]
        lines += [f"{len(self.triangles)} angles", "3 atom types", f"{len(kinds)} bond types"]
        lines += ["1 angle types"]
        lines += [f"{low[d]:.17g} {high[d]:.17g} {axis}lo {axis}hi" for d, axis in enumerate("xyz")]
        kind = np.where(self.pinned, PINNED, FREE)
        atoms = [
            f"{k + 1} {kind[k]} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g} 0 0 1 1"
            for k, p in enumerate(x)
        ]
        velocities = [] if self.velocities is None else self.velocities
        sections = {
            "Bond Coeffs # pbd": [f"{k + 1} compliance {c:.17g}" for k, c in enumerate(kinds)],
            "Atoms # hybrid": atoms,
            MASS_SECTION: [f"{k + 1} {mass:.17g}" for k, mass in enumerate(self.masses)],
            "Velocities": [
                f"{k + 1} {u[0]:.17g} {u[1]:.17g} {u[2]:.17g}" for k, u in enumerate(velocities)
            ],
            "Bonds": [
                f"{k + 1} {types[k] + 1} {a + 1} {b + 1}" for k, (a, b) in enumerate(self.edges)
            ],
            "Angles": [
                f"{k + 1} 1 {a + 1} {b + 1} {c + 1}" for k, (a, b, c) in enumerate(self.triangles)
            ],
        }
        for name, rows in sections.items():
            lines += ["", name, "", *rows] if rows else []
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def volume(x: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    """Return what a closed mesh encloses, or an open one with the cone to the origin."""
    return float(np.linalg.det(x[triangles]).sum() / 6)


def run(
    values: Mapping[str, Value],
    runner: Runner,
    label: str,
    mesh: GasMesh,
    t_end: float,
    variables: Mapping[str, Value],
) -> Run:
    """Run a script of a case with a mesh; it includes ``in.setup`` and ``in.output``."""
    data = runner.out.resolve() / f"{label}.data"
    data.parent.mkdir(parents=True, exist_ok=True)
    mesh.write(data)
    ends = mesh.vertices[mesh.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    shared = ("dt", "iterations", "solver", "direction", "tolerance", "scheme")
    given = {name: values[name] for name in shared} | {
        "scene": str(data),
        "setup": str(FOLDER / "in.setup"),
        "output": str(FOLDER / "in.output"),
        "name": runner.name,
        "edge": float(lengths.max()),
        "limits": "",
        **schemes.keywords(values),
        **variables,
    }
    return runner.run(label, t_end, given)
