"""A flat circular membrane, held at its rim and bulged by a pressure: small and large loads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

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

PARAMETERS = (
    Parameter("radius", 1.0, "m", "radius a of the rim", 1e-2, 100.0),
    Parameter("modulus", 1e4, "N/m", "Young's modulus times thickness E", 1.0, 1e8),
    Parameter("small", 1e-4, "1", "small load p a / E", 1e-6, 1e-2),
    Parameter("large", 2e-2, "1", "large load p a / E", 1e-6, 0.1),
    Parameter("areal", 0.2, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("rings", 16, "1", "edges from the middle to the rim", 6, 64, quick=10),
    Parameter("settle", 20.0, "1/omega", "time to rest, omega the lowest mode", 1.0, 1e3),
    *cloth.solver(2e-4, 20, method="substeps"),
    *schemes.parameters(ceiling=1.0),
)

QUANTITIES = (
    Quantity("height", "1", "small load, height of the middle / reference - 1", 0.01, 0.02),
    Quantity("shape", "height", "small load, largest error of the deflection", 0.01, 0.02),
    Quantity("height_large", "1", "large load, height of the middle / reference - 1", 0.01, 0.02),
    Quantity("height_fichter", "1", "the same over that of small slopes and strains - 1"),
    Quantity("strain", "1", "largest strain of the large load"),
    *order_quantities("in the edges of the height, small load"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three meshes with the small load, and the finest one with the large load, to rest."""
    small, large = (_membrane(values, values[name]) for name in ("small", "large"))
    rings = three(values["rings"], coarsest=4)
    refined = Refinement.of(partial(_run, values, small, runner), rings)
    heavy = _run(values, large, runner, "large", values["rings"])
    errors = refined.each(lambda run, _: _middle(run) / small.height - 1)
    x = refined.fine.trajectory[-1].positions
    differences = x[:, 2] - small.deflection(np.hypot(x[:, 0], x[:, 1]))
    net = PressurizedNet(large.radius, large.pressure, large.modulus)
    _plot({"small": (refined.fine, small), "large": (heavy, net)}, runner.picture)
    return {
        "height": errors[-1],
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
    """Return equilateral triangles, and between them and the rim what fits."""
    edge = values["radius"] / rings
    i, j = np.mgrid[-2 * rings : 2 * rings + 1, -2 * rings : 2 * rings + 1]
    lattice = edge * np.stack([(i + 0.5 * j).ravel(), (math.sqrt(0.75) * j).ravel()], axis=1)
    inner = lattice[np.hypot(*lattice.T) < values["radius"] - 0.55 * edge]
    n_rim = 6 * round(math.pi / 3 * rings)
    angle = 2 * math.pi * np.arange(n_rim) / n_rim
    rim = values["radius"] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    flat = np.concatenate([inner, rim])
    triangles = Delaunay(flat).simplices.astype(np.int64)
    surface = Surface.of(np.column_stack([flat, np.zeros(len(flat))]), triangles)
    surface = surface.select(surface.areas > 0.5e-9 * edge**2)
    x, edges = surface.vertices, surface.edges
    masses = values["areal"] * surface.lumped(surface.areas)
    soft = 1 / (values["modulus"] * _weights(surface))
    return GasMesh(x, surface.triangles, edges, soft, masses, np.arange(len(x)) >= len(inner))


def _weights(surface: Surface) -> NDArray[np.float64]:
    """Return stiffnesses of edges over the modulus: area of the triangles at each / its length^2.

    Of equilateral triangles the net is isotropic, of others about so.
    """
    areas = np.bincount(surface.edge_of_half_edge, np.repeat(surface.areas, 3))
    return areas / surface.edge_lengths**2


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
