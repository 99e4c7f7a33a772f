"""The cloth of ``sphcloth bench cloth`` in the library pypbd, in a process of its own.

    python -m sphcloth.bench.pypbd_cloth task.json

The task names an .npz file with the vertices, the held ones, the edges and the hinges, the step and
the numbers of iterations to be timed.  Prints JSON: processor time of a step for each number of
iterations.  What is timed is TimeStepController.step() with one sub-step and no velocity
iterations: prediction, projection and velocity update.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np
import pypbd
from numpy.typing import NDArray


class Sheet:
    """The mesh as pypbd's particles and constraints."""

    def __init__(self, task: dict) -> None:
        mesh = np.load(task["mesh"])
        simulation = pypbd.Simulation.getCurrent()
        simulation.initDefault()
        self.model = simulation.getModel()
        self.stepper = simulation.getTimeStep()
        pypbd.TimeManager.getCurrent().setTimeStepSize(task["dt"])
        self.set("NUM_SUB_STEPS", 1)
        self.set("MAX_ITERATIONS_V", 0)

        particles = self.model.getParticles()
        # its gravity is 9.81 along -y, ours along -z
        for x, y, z in mesh["rest"].tolist():
            particles.addVertex([x, z, -y])
        for i, held in enumerate(mesh["held"].tolist()):
            particles.setMass(i, 0.0 if held else task["mass"])
        if "edges" in task["constraints"]:
            for a, b in mesh["edges"].tolist():
                self.model.addDistanceConstraint(a, b, task["k_edge"])
        if "hinges" in task["constraints"]:
            for a, e1, e2, b in mesh["hinges"].tolist():
                self.model.addDihedralConstraint(a, b, e1, e2, task["k_hinge"])
        for i, (x, y, z) in enumerate(mesh["start"].tolist()):
            particles.setPosition(i, [x, z, -y])

    def set(self, name: str, value: int) -> None:
        """Set a parameter of the time stepping."""
        self.stepper.setValueUInt(getattr(pypbd.TimeStepController, name), value)

    def step(self, steps: int, iterations: int) -> float:
        """Make steps and return the processor time that one took."""
        self.set("MAX_ITERATIONS", iterations)
        before = time.process_time()
        for _ in range(steps):
            self.stepper.step(self.model)
        return (time.process_time() - before) / max(steps, 1)

    def positions(self) -> NDArray[np.float64]:
        """Return the vertices as they are now."""
        x = np.array(self.model.getParticles().getVertices())
        return np.column_stack([x[:, 0], -x[:, 2], x[:, 1]])


def main() -> None:
    """Do the task."""
    task = json.loads(Path(sys.argv[1]).read_text())
    sheet = Sheet(task)
    # the first step colors the constraints
    sheet.step(task["before"], task["iterations"][0])
    process, thread = time.process_time(), time.thread_time()
    seconds = [sheet.step(task["steps"], n) for n in task["iterations"]]
    process, thread = time.process_time() - process, time.thread_time() - thread
    if "end" in task:
        np.save(task["end"], sheet.positions())
    json.dump({"seconds": seconds, "threads": process / max(thread, 1e-9)}, sys.stdout)


if __name__ == "__main__":
    main()
