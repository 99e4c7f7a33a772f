"""A flat circular membrane, held at its rim and bulged by a pressure: small and large loads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from sphcloth.meshing.surface import Surface
from sphcloth.references.hencky import PressurizedMembrane, PressurizedNet
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.gas import GasMesh, run
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# of a net of equal springs along the edges of equilateral triangles
RATIO = 1 / 3
# lowest root of the Bessel function J0: omega of a membrane under tension, times radius over speed
ROOT = 2.4048
DRAG = 2.0  # rate over that omega
CLOSEST = 0.05  # of an edge, from a free vertex to the rim

PARAMETERS = (
    Parameter("radius", 1.0, "m", "radius a of the rim", 1e-2, 100.0),
    Parameter("modulus", 1e4, "N/m", "Young's modulus times thickness E", 1.0, 1e8),
    Parameter("small", 1e-4, "1", "small load p a / E", 1e-6, 1e-2),
    Parameter("large", 2e-2, "1", "large load p a / E", 1e-6, 0.1),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("rings", 16, "1", "edges from the middle to the rim", 6, 64, quick=10),
    Parameter("settle", 14.0, "1/omega", "time to rest, omega the lowest mode", 1.0, 1e3),
    *cloth.solver(2e-4, 60, method="substeps"),
    *schemes.parameters(ceiling=1.0),
)

QUANTITIES = (
    Quantity("height", "1", "small load, height of the middle / reference - 1", 0.01, 0.02),
    Quantity("height_net", "1", "the same over that of any slope and strain - 1", 0.001, 0.002),
    Quantity("shape", "height", "small load, largest error of the deflection", 0.01, 0.02),
    Quantity("height_large", "1", "large load, height of the middle / reference - 1", 0.01, 0.02),
    Quantity("height_fichter", "1", "the same over that of small slopes and strains - 1"),
    Quantity("strain", "1", "largest strain of the large load"),
    *order_quantities("in the edges of height_net"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three meshes with the small load, and the finest one with the large load, to rest."""
    small, large = (_membrane(values, values[name]) for name in ("small", "large"))
    rings = three(values["rings"], coarsest=4)
    refined = Refinement.of(partial(_run, values, small, runner), rings)
    heavy = _run(values, large, runner, "large", values["rings"])
    # the small load is large enough for slopes and strains to count at this accuracy
    exact = PressurizedNet(small.radius, small.pressure, small.modulus)
    errors = refined.each(lambda run, _: _middle(run) / exact.height - 1)
    x = refined.fine.trajectory[-1].positions
    differences = x[:, 2] - small.deflection(np.hypot(x[:, 0], x[:, 1]))
    net = PressurizedNet(large.radius, large.pressure, large.modulus)
    _plot({"small": (refined.fine, small), "large": (heavy, net)}, runner.picture)
    return {
        "height": _middle(refined.fine) / small.height - 1,
        "height_net": errors[-1],
        "shape": float(np.max(np.abs(differences)) / small.height),
        "height_large": _middle(heavy) / net.height - 1,
        "height_fichter": _middle(heavy) / large.height - 1,
        "strain": float(heavy.thermo["c_strain"][-1]),
        **refined.orders(errors),
    }


def _membrane(values: Mapping[str, Value], load: float) -> PressurizedMembrane:
    pressure = load * values["modulus"] / values["radius"]
    return PressurizedMembrane(values["radius"], pressure, values["modulus"], RATIO)


def _mesh(values: Mapping[str, Value], rings: int) -> GasMesh:
    """Return a net of equilateral triangles whose edges end on the rim.

    An edge that is cut there to a share of its length is as much stiffer: with the difference of a
    displacement that is zero on the rim over the distance to it, the error is of second order.
    """
    radius, edge = values["radius"], values["radius"] / rings
    i, j = np.mgrid[-2 * rings : 2 * rings + 1, -2 * rings : 2 * rings + 1]
    lattice = edge * np.stack([(i + 0.5 * j).ravel(), (math.sqrt(0.75) * j).ravel()], axis=1)
    inner = lattice[np.hypot(*lattice.T) < radius - CLOSEST * edge]
    links = cKDTree(inner).query_pairs(1.01 * edge, output_type="ndarray")
    starts, cuts = _cut_edges(inner, radius, edge)
    # edges that meet on the rim end at one vertex
    rim, ends = np.unique(np.round(cuts / edge, 6), axis=0, return_inverse=True)
    flat = np.concatenate([inner, edge * rim])
    surface = Surface.of(
        np.column_stack([flat, np.zeros(len(flat))]), Delaunay(flat).simplices.astype(np.int64)
    )
    surface = surface.select(surface.areas > 0.5e-9 * edge**2)
    edges = np.concatenate([links, np.column_stack([starts, len(inner) + ends.ravel()])])
    lengths = np.linalg.norm(flat[edges[:, 0]] - flat[edges[:, 1]], axis=1)
    # stiffness of a whole edge over the modulus: area of the triangles at it / its length^2
    soft = lengths / (edge * values["modulus"] * math.sqrt(0.75))
    masses = values["areal"] * surface.lumped(surface.areas)
    pinned = np.arange(len(flat)) >= len(inner)
    return GasMesh(surface.vertices, surface.triangles, edges, soft, masses, pinned)


def _cut_edges(
    inner: NDArray[np.float64], radius: float, edge: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the vertices from which edges lead across the rim, and where they meet it."""
    angle = math.pi / 3 * np.arange(6)
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    beside = inner[:, None] + edge * ways
    across = np.hypot(beside[..., 0], beside[..., 1]) >= radius - CLOSEST * edge
    starts, number = np.nonzero(across)
    x, way = inner[starts], ways[number]
    along = np.einsum("ij,ij->i", x, way)
    reach = np.sqrt(along**2 + radius**2 - np.einsum("ij,ij->i", x, x)) - along
    return starts, x + reach[:, None] * way


def _run(
    values: Mapping[str, Value],
    membrane: PressurizedMembrane,
    runner: Runner,
    label: str,
    rings: int,
) -> Run:
    speed = math.sqrt(membrane.middle_force / values["areal"])
    omega = ROOT * speed / values["radius"]
    given = {
        "drag": DRAG * omega,
        "gas": f"pressure {membrane.pressure!r} toward 0 0 1",
        **cloth.stepping(values["settle"] / omega, values["dt"], frames=10),
    }
    return run(values, runner, label, _mesh(values, rings), values["settle"] / omega, given)


def _middle(run: Run) -> float:
    return float(run.trajectory[-1].positions[:, 2].max())


def _plot(runs: Mapping[str, tuple[Run, PressurizedMembrane | PressurizedNet]], path: Path) -> None:
    """Draw the deflection over the radius for both loads."""
    figure, sides = compare.panels(1, 2)
    for side, (name, (done, membrane)) in zip(sides, runs.items(), strict=True):
        r = np.linspace(0, membrane.radius, 200)
        x: NDArray[np.float64] = done.trajectory[-1].positions
        side.plot(r, membrane.deflection(r), "k-", label="reference")
        side.plot(np.hypot(x[:, 0], x[:, 1]), x[:, 2], ".", label="fix cloth/gas")
        side.set(xlabel="r (m)", ylabel="deflection (m)", title=f"{name} load")
        side.legend()
    compare.save(figure, path)


CASE = Case(
    "hencky",
    "a circular membrane under pressure: Hencky, net of springs",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
