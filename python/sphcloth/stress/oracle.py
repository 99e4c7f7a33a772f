"""What must hold in any scene of :mod:`sphcloth.stress.random_scene`, whatever becomes of it.

All of it is computed from the dump, the log and the data file of the run, in SI.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings, edge_strain
from sphcloth.stress.case import Outcome, is_finite
from sphcloth.stress.random_scene import GRAVITY, RandomScene
from sphcloth.stress.random_script import SINK
from sphcloth.stress.unit_systems import UNITS
from sphcloth.trajectory import Frame

GAMMA = 7.0
FLUIDS, VERTEX = (1, 2), 3
# of momentum, over the sum of m times the speed
MOMENTUM = 1e-10
# growth of the energy, over what there is to convert
ENERGY = 0.05
# compliance of an edge over h^2/m from which steps that vary return no more than was stored
SOFT = 10.0
# mass of a vertex over that of a particle, below which whole steps may add energy
LIGHT = 0.5
# by how much one sweep of a solver leaves more of the error of an edge than substeps of its length
# do, where many edges meet
SLOWER = {"substeps": 2.0, "gs": 20.0, "jacobi": 20.0}
# of the default solver in the longest step
DEFAULT_ITERATIONS = 10
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evidence:
    """A scene and what its run wrote."""

    scene: RandomScene
    outcome: Outcome

    @cached_property
    def frames(self) -> list[Frame]:
        """All frames in SI, with places beyond periodic faces."""
        u = UNITS[self.scene.units]
        factors = dict.fromkeys(("x", "y", "z"), u.m)
        factors |= dict.fromkeys(("vx", "vy", "vz"), u.of("m/s"))
        factors |= {"mass": u.kg, "rho": u.of("kg/m^3")}
        return [
            replace(
                frame,
                time=frame.time / u.s,
                box=frame.box / u.m,
                tilt=tuple(one / u.m for one in frame.tilt),
                columns={c: v / factors.get(c, 1.0) for c, v in frame.columns.items()},
            )
            for frame in self.outcome.frames
        ]

    @cached_property
    def mesh(self) -> ClothMesh:
        """Triangles of sheet and plate."""
        return self.outcome.mesh

    def log(self, column: str, unit: str = "1") -> Array:
        """Return a column of the log in SI, a value for each frame."""
        values = dict(zip(self.outcome.log["Step"], self.outcome.log[column], strict=True))
        return np.array([values[f.step] for f in self.frames]) / UNITS[self.scene.units].of(unit)


def complaints(scene: RandomScene, outcome: Outcome) -> list[str]:
    """Return all that is wrong with a run."""
    if outcome.code is None:
        return ["it did not end in time"]
    if outcome.code != 0 or outcome.error:
        return [f"ended with code {outcome.code}: {outcome.error or outcome.text[-300:]}"]
    found = is_finite(outcome)
    if found:
        return [found]
    evidence = Evidence(scene, outcome)
    try:
        missing = list(comes_to_its_end(evidence))
        return missing or [one for check in CHECKS for one in check(evidence)]
    except UserError as error:
        return [str(error)]


# ---- checks -------------------------------------------------------------------------------------


def comes_to_its_end(e: Evidence) -> Iterator[str]:
    """The run ends at its time or at its last step, and each frame has its row in the log."""
    steps, times = e.outcome.log["Step"], e.outcome.log["Time"] / UNITS[e.scene.units].s
    if times[-1] < e.scene.time * (1 - 1e-9) and steps[-1] < e.scene.steps:
        yield f"the run ended in step {steps[-1]:g} at {times[-1]:.6g} s"
    expected = [*range(0, int(steps[-1]) + 1, int(e.outcome.settings.get("every", 4)))]
    if [frame.step for frame in e.frames] != expected:
        yield f"there are no frames of all {len(expected)} steps"
    missing = sorted(set(expected) - set(steps.astype(int)))
    if missing:
        yield f"the log has no row of step {missing[0]}"


def nothing_crosses(e: Evidence) -> Iterator[str]:
    """Where there is contact no particle goes from one side of a mesh to the other."""
    if not e.scene.has_mesh or not (e.scene.contact or e.scene.sheet == "none"):
        return
    for kind in FLUIDS:
        found = crossings(e.mesh, e.frames, kind)
        if found.count:
            yield f"particles {found.ids[:5].tolist()} crossed by step {found.steps[:5].tolist()}"


def mass_is_exact(e: Evidence) -> Iterator[str]:
    """What was there and what was poured is there or was drained; no particle changes its mass."""
    first = e.frames[0]
    expected = len(first) - e.log("v_poured")[0] + e.log("v_poured") - e.log("v_drained")
    for frame, n in zip(e.frames, expected, strict=True):
        if len(frame) != n:
            yield f"{len(frame)} atoms at step {frame.step}, not {n:g}"
            return
    for kind in np.unique(first.types):
        masses = np.concatenate([frame.select(int(kind)).columns["mass"] for frame in e.frames])
        if np.ptp(masses) > 0:
            yield f"type {kind} has masses from {masses.min()} to {masses.max()}"
    yield from _gone_inside(e)


def _gone_inside(e: Evidence) -> Iterator[str]:
    """A particle that is gone was near a face or the drain."""
    for before, after in zip(e.frames, e.frames[1:], strict=False):
        gone = ~np.isin(before.ids, after.ids)
        if not gone.any():
            continue
        where, v = before.positions[gone], before.velocities[gone]
        dt = after.time - before.time
        low, high = before.box
        open_faces = ~np.array(before.periodic)
        sink = -SINK * e.scene.spacing
        to_faces = np.where(open_faces, np.minimum(where - low, high - where), np.inf).min(axis=1)
        distance = np.minimum(to_faces, where[:, 2] - sink)
        reach = 2 * np.linalg.norm(v, axis=1) * dt + GRAVITY * dt**2 + e.scene.spacing
        if np.any(distance > reach):
            k = int(np.argmax(distance - reach))
            yield f"particle {before.ids[gone][k]} is gone at {where[k]} by step {after.step}"
            return


def momentum_stays(e: Evidence) -> Iterator[str]:
    """Where nothing acts from outside, from the first step of the cloth on."""
    s = e.scene
    forces_on_cloth = s.sheet != "none" and s.coupling != "none"
    # the sheet gets its part of an impulse of block steps with the coming step
    if not s.is_closed or s.scheme == "individual" or (s.scheme == "block" and forces_on_cloth):
        return
    if e.log("v_drained")[-1]:
        return
    each = [f.columns["mass"][:, None] * f.velocities for f in e.frames]
    total = np.array([one.sum(axis=0) for one in each])
    if s.sheet != "none":
        total -= np.stack([e.log(f"v_kick{k}", "kg*m/s") for k in (1, 2, 3)], axis=1)
    scale = max(np.linalg.norm(one, axis=1).sum() for one in each)
    change = np.linalg.norm(total[1:] - total[1], axis=1).max(initial=0) if len(each) > 1 else 0
    if change > MOMENTUM * scale:
        yield f"momentum changed by {change / scale:.1e}, allowed {MOMENTUM:.0e}"


def internal_energy(e: Evidence, frame: Frame) -> float:
    """Return what compression stores, by the equation of state."""
    total = 0.0
    for kind, rho0, c0 in zip(FLUIDS, e.scene.rest_density, e.scene.c0, strict=True):
        water = frame.select(kind)
        ratio = water.columns["rho"] / rho0
        if e.scene.tension == "no":
            ratio = np.maximum(ratio, 1.0)
        each = ratio ** (GAMMA - 1) / (GAMMA - 1) + 1 / ratio - GAMMA / (GAMMA - 1)
        total += float(np.sum(water.columns["mass"] * c0**2 / GAMMA * each))
    return total


def energies(e: Evidence) -> tuple[Array, Array]:
    """Return the growth of kinetic and potential energy in each frame, and what there was for it.

    Energies that come in with a jet are those of its speed at the opening; what is drained takes
    along what it had in its last frame. What there is: the kinetic energy that came in, the
    weight's work so far, and the first compression.
    """
    s = e.scene
    g = GRAVITY if s.gravity else 0.0
    opening = s.opening
    growth, available = [], []
    start = kinetic_in = fall = 0.0
    taken = 0.0
    before: dict[int, tuple[float, float]] = {}
    for k, frame in enumerate(e.frames):
        mass, v = frame.columns["mass"], frame.velocities
        # of pinned vertices neither changes; those of the plate do not move
        kinetic, potential = 0.5 * mass * np.sum(v**2, axis=1), mass * g * frame.positions[:, 2]
        now = dict(zip(frame.ids.tolist(), zip(kinetic, potential, strict=True), strict=True))
        if k == 0:
            start, kinetic_in = float(np.sum(kinetic + potential)), float(np.sum(kinetic))
            height_in = float(np.sum(potential))
        else:
            new = ~np.isin(frame.ids, e.frames[k - 1].ids)
            come = mass[new]
            start += float(np.sum(come * (0.5 * s.speed**2 + g * opening)))
            kinetic_in += float(np.sum(come * 0.5 * s.speed**2))
            height_in += float(np.sum(come * g * opening))
            left = [before[i] for i in before.keys() - now.keys()]
            taken += sum(a + b for a, b in left)
            height_in -= sum(b for _, b in left)
        # velocities are those of half a step before
        late = float(np.sum(mass * g * np.abs(v[:, 2]))) * s.dt
        fall = max(fall, height_in - float(np.sum(potential)))
        growth.append(float(np.sum(kinetic + potential)) + taken - start - late)
        available.append(kinetic_in + fall)
        before = now
    return np.array(growth), np.array(available) + internal_energy(e, e.frames[0])


def energy_is_bounded(e: Evidence) -> Iterator[str]:
    """Kinetic and potential energy never exceed what there was, came in, and compression held."""
    if energy_may_grow(e):
        return
    growth, available = energies(e)
    excess = (growth - internal_energy(e, e.frames[0])) / np.maximum(available, 1e-300)
    k = int(np.argmax(excess))
    if excess[k] > ENERGY:
        step = e.frames[k].step
        yield f"energy grew by {excess[k]:.1%} of what there was, step {step}, allowed {ENERGY:.0%}"


def stretch(e: Evidence) -> tuple[float, float]:
    """Return the largest strain of an edge of the sheet, and what the energy at hand can do.

    An edge is a spring of a compliance A, that of the material and that of the solver, which
    leaves W h^2 of what one projection leaves. An energy E strains a single edge of the length d by
    sqrt(2 E A) / d at most.
    """
    s = e.scene
    rows = e.frames[0].ids.searchsorted(e.mesh.ids)
    of_sheet = e.frames[0].types[rows] == VERTEX
    triangles = e.mesh.triangles[of_sheet[e.mesh.triangles].all(axis=1)]
    sheet = ClothMesh(e.mesh.ids, triangles)
    rest = e.frames[0]
    strain = max(float(np.abs(edge_strain(sheet, f, rest)).max()) for f in e.frames)
    length = float(sheet.edge_lengths(rest).min())
    mass = float(rest.select(VERTEX).columns["mass"].min())
    compliance = compliance_bound(s, mass, float(e.log("Dt", "s").max()))
    energy = float(energies(e)[1].max()) * (1 + ENERGY)
    return strain, math.sqrt(2 * energy * compliance) / length


def energy_may_grow(e: Evidence) -> bool:
    """Whether the scene is one of those that may gain energy, see docs/evidence/reliability.md.

    Individual steps do not keep energy; edges that are rigid, or stiffer than a number of
    iterations can make them, may return more than they stored where steps vary; and so may whole
    steps of a sheet that is much lighter than what lies on it.
    """
    s = e.scene
    if s.scheme == "individual" or s.sheet == "none":
        return s.scheme == "individual"
    first = e.frames[0]
    mass = float(first.select(VERTEX).columns["mass"].min())
    dt = float(e.log("Dt", "s").max())
    given = s.iterations > 0
    stiff = given and of_material(s, mass, dt) < SOFT * substep(s, dt) ** 2 / mass
    dense = max(s.rest_density) * s.spacing**3
    whole = s.solver != "substeps" or s.iterations == 1
    light = s.contact and whole and mass < LIGHT * dense
    return light or (stiff and s.scheme != "constant")


def substep(s: RandomScene, dt: float) -> float:
    """Return the length of a sweep; n of whole steps leave what so many of dt / sqrt(n) do."""
    n = sweeps(s)
    return dt / n if s.solver == "substeps" else dt / math.sqrt(n)


def sweeps(s: RandomScene) -> int:
    """Return the iterations in a step, with the default solver in the longest one."""
    return s.iterations or DEFAULT_ITERATIONS


def of_material(s: RandomScene, mass: float, dt: float) -> float:
    """Return the compliance of an edge between two free vertices, m/N; 0: it is rigid."""
    kind, value = s.edge
    if kind == "compliance" or value == 1:
        return value if kind == "compliance" else 0.0
    share = 1 - (1 - value) ** (1 / sweeps(s))
    step = s.dt if s.reference else dt
    h = step / sweeps(s) if s.solver == "substeps" else step
    return 2 / mass * h**2 * (1 - share) / share


def compliance_bound(s: RandomScene, mass: float, dt: float) -> float:
    """Return the largest compliance that an edge may have, m/N."""
    solver = SLOWER[s.solver] * 2 / mass * substep(s, dt) ** 2
    return of_material(s, mass, dt) + solver


def strain_is_bounded(e: Evidence) -> Iterator[str]:
    """No edge is longer than the energy that there is can make it."""
    if e.scene.sheet == "none":
        return
    strain, allowed = stretch(e)
    if strain > allowed + 1e-3:
        yield f"strain {strain:.3g}, the energy allows {allowed:.3g}"


CHECKS = (
    nothing_crosses,
    mass_is_exact,
    momentum_stays,
    energy_is_bounded,
    strain_is_bounded,
)
