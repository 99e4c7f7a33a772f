"""What the cases of cloth on cloth share: parameters, the fix, runs, and what is asked of them.

Limits of every scene:

* ``met`` and ``not_free`` are 0, and those of obstacles: cloth does not go through cloth, whatever
  else is true of it.
* ``missing`` is at most 1/2: the thickness is a distance at which contact holds, and parts that
  come nearer than half of it have lost most of it; what contact promises beyond that is only that
  they do not meet.
* ``strain`` is at most 5 %, the bound of other solvers for these scenes: edges are rigid, and a
  longer one is an error of the solver under the load of the contact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.metrics.intersections import Passage, check_installed, inspect
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Parameter, Quantity, Value
from sphcloth.validation.common import GRAVITY
from sphcloth.validation.layers.scene import Scene
from sphcloth.validation.runner import Run, Runner

FOLDER = Path(__file__).parent
# frames of which one is asked for the smallest distance and the strain
GAP_EVERY = 10


def parameters(
    thickness: float,
    dt: float,
    time: float,
    quick_time: float,
    friction: float = 0.0,
    gravity: float = GRAVITY.default,
    jitter: float = 1e-3,
) -> tuple[Parameter, ...]:
    """Return the parameters of every scene.

    Args:
        thickness: default of the thickness of the contact, m.
        dt: default of the time step, s.
        time: default of the time of the run, s.
        quick_time: the same with ``--quick``.
        friction: default of the coefficient of friction of cloth on cloth.
        gravity: default of the acceleration of gravity, m/s^2.
        jitter: default of the displacement of vertices at the start, in thicknesses.
    """
    return (
        Parameter("contact", "yes", "1", "whether cloth touches cloth", choices=("yes", "no")),
        Parameter("thickness", thickness, "m", "of the contact", 1e-6, 1.0),
        Parameter("friction", friction, "1", "coefficient of cloth on cloth", 0.0, 10.0),
        Parameter("gravity", gravity, "m/s^2", "acceleration g", 0.0, 1e3),
        Parameter("fold", 0.02, "1", "stiffness k of the hinges", 0.0, 1.0),
        Parameter("time", time, "s", "time of the run", 1e-3, 100.0, quick=quick_time),
        Parameter("jitter", jitter, "thickness", "displacement at the start", 0.0, 0.2),
        Parameter("seed", 1, "1", "seed of the displacement", 1, 900_000_000),
        Parameter("repeats", 1, "1", "runs, each with the next seed; the worst counts", 1, 100),
        Parameter("every", 1, "1", "steps between frames that are looked at", 1, 1000),
        *cloth.solver(dt, 0, method="substeps"),
        *schemes.parameters("constant", 1.0),
    )


def exact_parameters(*arguments, **named) -> tuple[Parameter, ...]:
    """Return the same for a scene that means nothing without contact, and is run once."""
    left_out = ("contact", "repeats")
    found = parameters(*arguments, **named)
    return tuple(each for each in found if each.name not in left_out)


MEETINGS = (
    Quantity("met", "frames", "in which an edge of cloth goes through cloth", 0, 0),
    Quantity("not_free", "steps", "in which straight paths of cloth and cloth meet", 0, 0),
    Quantity("met_obstacle", "frames", "in which edges of cloth and an obstacle do", 0, 0),
    Quantity("not_free_obstacle", "steps", "in which their straight paths meet", 0, 0),
    Quantity("missing", "thickness", "by which the smallest distance is too small", 0.5, 0.5),
    Quantity("strain", "1", "largest elongation of a rigid edge", 0.05, 0.05),
    Quantity("most", "1", "edges through triangles in the worst frame"),
    Quantity("first", "step", "that is not free; -1 for none"),
    Quantity("frames", "1", "that were looked at, in all runs"),
)


def contact_command(values: Mapping[str, Value], group: str = "cloth", obstacle: str = "") -> str:
    """Return the command of fix cloth/contact for a scene, empty with ``contact`` no.

    Args:
        values: of the parameters.
        group: group of LAMMPS that touches; its cloth touches itself and other cloth.
        obstacle: group of the vertices of an obstacle.
    """
    keywords = [f"obstacle {obstacle}"] if obstacle else []
    if values.get("contact", "yes") == "yes":
        keywords += ["cloth yes", f"cloth/friction {values['friction']!r}"]
    elif obstacle:
        group = "water"
    else:
        return ""
    return " ".join([f"fix touch {group} cloth/contact {values['thickness']!r}", *keywords])


@dataclass(frozen=True)
class Scenario:
    """A scene and its run.

    Attributes:
        scene: at the start, before it is jittered.
        run: the finished run of LAMMPS.
        thickness: of the contact, m.
    """

    scene: Scene
    run: Run
    thickness: float

    @cached_property
    def passage(self) -> Passage:
        """What the oracle says to every frame."""
        return inspect(
            self.scene.oracle, self.scene.mesh, self.run.trajectory, self.thickness, GAP_EVERY
        )

    @property
    def moved(self) -> NDArray[np.float64]:
        """Mean displacement of the free vertices, weighted by mass, in each frame, m, (F, 3)."""
        free, masses = self.free, self.scene.masses
        start = self.positions(0)[free]
        return np.array(
            [
                np.average(frame.positions[free] - start, axis=0, weights=masses[free])
                for frame in self.run.trajectory
            ]
        )

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which vertices are free, shape (V,)."""
        return np.concatenate([(p.held == 0) & (not p.is_obstacle) for p in self.scene.pieces])

    @property
    def strain(self) -> float:
        """Largest elongation of a rigid edge over its length, in one of ``GAP_EVERY`` frames."""
        edges, rest = self.scene.rigid
        trajectory, found = self.run.trajectory, []
        for number in {*range(0, len(trajectory), GAP_EVERY), len(trajectory) - 1}:
            start, end = trajectory[number].positions[edges.T]
            found.append(np.max(np.linalg.norm(end - start, axis=1) / rest - 1))
        return float(np.max(found))

    def momentum(self) -> NDArray[np.float64]:
        """Return the momentum of the cloth in each row of the log, kg m/s, shape (rows, 3)."""
        return np.stack([self.run.thermo[f"v_p{axis}"] for axis in "xyz"], axis=1)

    def speed(self) -> float:
        """Return the rms speed of the cloth in the end, m/s."""
        velocities = self.velocities()[: self.scene.moving]
        return compare.rms(np.linalg.norm(velocities, axis=1))

    def positions(self, frame: int = -1) -> NDArray[np.float64]:
        """Return the positions of all vertices in a frame, m, shape (V, 3)."""
        return self.run.trajectory[frame].positions

    def velocities(self, frame: int = -1) -> NDArray[np.float64]:
        """Return the velocities of all vertices in a frame, m/s, shape (V, 3)."""
        return self.run.trajectory[frame].velocities


def play(
    values: Mapping[str, Value],
    runner: Runner,
    scene: Scene,
    variables: Mapping[str, Value],
    obstacle: str = "",
    label: str = "run",
) -> list[Scenario]:
    """Run a scene as often as ``repeats`` says, each time displaced by the next seed.

    Args:
        values: of the parameters.
        runner: runs LAMMPS.
        scene: at the start.
        variables: of the script, besides those of all scenes.
        obstacle: group of the vertices of an obstacle.
        label: name of the folder of the first run; a number is appended to those of the others.
    """
    check_installed()
    found = []
    for n in range(values.get("repeats", 1)):
        jittered = scene.jittered(values["jitter"] * values["thickness"], values["seed"] + n)
        data = runner.out.resolve() / f"{label}{n or ''}.data"
        jittered.write(data)
        shared = ("gravity", "every", "iterations", "solver", "direction", "tolerance", "scheme")
        given = {name: values[name] for name in (*shared, "dt", "fold")}
        given |= {
            "scene": str(data),
            "setup": str(FOLDER / "in.setup"),
            "output": str(FOLDER / "in.output"),
            "name": runner.name,
            "edge": scene.longest_edge,
            "cutoff": 3 * scene.longest_edge,
            "contact": contact_command(values, obstacle=obstacle),
            "limits": "",
            "shear": 0.0,
            **schemes.keywords(values),
            **variables,
        }
        run = runner.run(f"{label}{n or ''}", values["time"], given)
        found.append(Scenario(scene, run, values["thickness"]))
    return found


def meetings(scenarios: Sequence[Scenario]) -> dict[str, float]:
    """Return the quantities of ``MEETINGS``, the worst of all runs."""
    passages = [each.passage for each in scenarios]
    firsts = [passage.first for passage in passages if passage.first >= 0]
    return {
        "met": sum(passage.met for passage in passages),
        "not_free": sum(passage.not_free for passage in passages),
        "met_obstacle": sum(passage.met_obstacles for passage in passages),
        "not_free_obstacle": sum(passage.not_free_obstacles for passage in passages),
        "missing": max(max(0.0, 1 - passage.gap) for passage in passages),
        "strain": worst(scenarios, lambda each: each.strain),
        "most": max(passage.most for passage in passages),
        "first": min(firsts, default=-1),
        "frames": sum(passage.frames for passage in passages),
    }


def worst(scenarios: Sequence[Scenario], measure: Callable[[Scenario], float]) -> float:
    """Return the largest absolute value of all runs; one that is no number counts as largest."""
    found = [abs(measure(each)) for each in scenarios]
    return float(np.max(found))


def growth(scenario: Scenario, gravity: float, fall: float) -> float:
    """Return by how much the energy ever exceeds that at first, over the weight times a fall in m.

    Kinetic and potential; elastic energy is none at first, and never negative. Contact and friction
    only take energy where no pin moves.
    """
    thermo, scene = scenario.run.thermo, scenario.scene
    weight = float(np.sum(scene.masses[: scene.moving])) * gravity
    energy = thermo["v_energy"]
    return float(np.max(energy - energy[0])) / (weight * fall)
