"""A spherical shell without stiffness that breathes on the gas inside."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from sphcloth.meshing.surface import Surface
from sphcloth.references.balloon import BreathingShell
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.gas import GasMesh, run, volume
from sphcloth.validation.refinement import Refinement, order_quantities
from sphcloth.validation.runner import Run, Runner

PERIODS = 2.0
STEPS = 100  # in a period
# of the edges: their force is nothing beside that of the gas
COMPLIANCE = 1e3

PARAMETERS = (
    Parameter("radius", 0.1, "m", "radius at the start", 1e-3, 100.0),
    Parameter("areal", 0.1, "kg/m^2", "mass per area", 1e-4, 1e3),
    Parameter("pressure", 1e5, "Pa", "inside at the start, and outside", 1.0, 1e8),
    Parameter("exponent", 1.4, "1", "n of p V^n", 1.0, 10.0),
    Parameter("swing", 0.02, "1", "amplitude of the radius, about, over the radius", 1e-4, 0.2),
    Parameter("levels", 4, "1", "how often an icosahedron is divided", 2, 6, quick=3),
    *cloth.solver(1e-4, 0, method="substeps"),
    *schemes.parameters(ceiling=1.0),
)

QUANTITIES = (
    Quantity("motion", "amplitude", "largest error of the volume over two periods", 0.01, 0.03),
    Quantity("law", "1", "largest error of p V^n", 1e-9, 1e-9),
    Quantity("volume", "1", "largest error of the volume by its vertices", 1e-11, 1e-11),
    Quantity("energy", "of motion", "largest change of the energy", 0.01, 0.01),
    Quantity("momentum", "1", "of all vertices over the sum of theirs", 1e-12, 1e-12),
    *order_quantities("in the length of the edges of that motion"),
)


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three meshes of a sphere and compare with the shell."""
    levels = {"coarse": -2, "middle": -1, "fine": 0}
    resolutions = {label: 2 ** (values["levels"] + less) for label, less in levels.items()}
    shell = _shell(values)
    refined = Refinement.of(partial(_run, values, shell, runner), resolutions)
    fine = refined.fine
    errors = refined.each(lambda run, _: float(np.max(np.abs(_error(run, shell)))))
    thermo = fine.thermo
    inside, gas = thermo["f_gas[1]"] + values["pressure"], thermo["f_gas[2]"]
    law = inside * gas ** values["exponent"]
    energy = thermo["c_motion"] + thermo["c_elastic"] + thermo["f_gas"]
    _plot(fine, shell, runner.picture)
    last, mesh = fine.trajectory[-1], _mesh(values, shell, resolutions["fine"])
    momenta = mesh.masses[:, None] * last.velocities
    return {
        "motion": errors[-1],
        "law": float(np.max(np.abs(law / law[0] - 1))),
        "volume": float(np.max(np.abs(_volumes(fine, mesh) / gas - 1))),
        "energy": float(np.max(np.abs(energy - energy[0])) / thermo["c_motion"][0]),
        "momentum": float(np.abs(momenta.sum(axis=0)).max() / np.abs(momenta).sum()),
        **refined.orders(errors),
    }


def _shell(values: Mapping[str, Value]) -> BreathingShell:
    shell = BreathingShell(
        values["radius"], values["areal"], values["pressure"], values["exponent"], 1.0
    )
    speed = values["swing"] * values["radius"] * 2 * np.pi / shell.small_period
    return BreathingShell(shell.radius, shell.areal, shell.pressure, shell.exponent, speed)


def _mesh(values: Mapping[str, Value], shell: BreathingShell, cut: int) -> GasMesh:
    """Return a mesh of a sphere; vertices have the mass of the area around them."""
    sphere = trimesh.creation.icosphere(int(np.log2(cut)), shell.radius)
    surface = Surface.of(sphere.vertices, sphere.faces)
    x, edges = surface.vertices, surface.edges
    masses = shell.areal * surface.lumped(surface.areas)
    speed = shell.speed * x / shell.radius
    held = np.zeros(len(x), dtype=bool)
    soft = np.full(len(edges), COMPLIANCE)
    return GasMesh(x, surface.triangles, edges, soft, masses, held, speed)


def _run(
    values: Mapping[str, Value], shell: BreathingShell, runner: Runner, label: str, cut: int
) -> Run:
    time = PERIODS * shell.small_period
    pressure = values["pressure"]
    given = {
        "drag": 0.0,
        "gas": f"polytropic {values['exponent']!r} {pressure!r} {pressure!r}",
        **cloth.stepping(time, min(values["dt"], shell.small_period / STEPS), frames=40),
    }
    return run(values, runner, label, _mesh(values, shell, cut), time, given)


def _volumes(fine: Run, mesh: GasMesh) -> NDArray[np.float64]:
    """Return the volume of the vertices in each frame, m^3."""
    return np.array([volume(frame.positions, mesh.triangles) for frame in fine.trajectory])


def _error(run: Run, shell: BreathingShell) -> NDArray[np.float64]:
    """Return the error of the volume over time, in its amplitude; volumes over their first."""
    times, gas = run.thermo["Time"], run.thermo["f_gas[2]"]
    exact = shell.volumes(times) / shell.volume
    return (gas / gas[0] - exact) / np.max(np.abs(exact - 1))


def _plot(run: Run, shell: BreathingShell, path: Path) -> None:
    """Draw the volume over time, and its error."""
    figure, (motion, error) = compare.panels(1, 2)
    times, gas = run.thermo["Time"], run.thermo["f_gas[2]"]
    fine = np.linspace(0, times[-1], 400)
    motion.plot(fine, shell.volumes(fine) / shell.volume, "k-", label="spherical shell")
    motion.plot(times, gas / gas[0], "o", mfc="none", label="fix cloth/gas")
    motion.set(xlabel="time (s)", ylabel="volume / first volume")
    motion.legend()
    error.plot(times, _error(run, shell))
    error.set(xlabel="time (s)", ylabel="error of the volume / amplitude")
    compare.save(figure, path)


CASE = Case(
    "balloon",
    "a shell that breathes on its gas: p V^n, spherical motion",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
