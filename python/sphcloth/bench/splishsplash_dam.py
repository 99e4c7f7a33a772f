"""The dam break of ``sphcloth bench peers`` in SPlisHSPlasH, in a process of its own.

    python -m sphcloth.bench.splishsplash_dam task.json

The task names a scene file, an .npz file for the result, the time from frame to frame and the end.
The result has the positions in every frame, the processor time of the steps and their number. What
is timed is all that happens from the end of one step to the end of the next, but for the frames.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np
import pysplishsplash as splishsplash


class Dam:
    """The simulation, and what is taken down of it after each step."""

    def __init__(self, task: dict) -> None:
        self.task = task
        self.base = splishsplash.Exec.SimulatorBase()
        self.base.init(
            sceneFile=task["scene"],
            outputDir=task["folder"],
            useGui=False,
            initialPause=False,
            stopAt=task["end"],
        )
        self.base.initSimulation()
        self.water = splishsplash.Simulation.getCurrent().getFluidModel(0)
        self.place(np.load(task["start"]))
        self.frames: list[np.ndarray] = []
        self.seconds, self.steps = 0.0, 0
        self.last: float | None = None

    def positions(self) -> np.ndarray:
        """Return the positions that the simulation works with, and room for more."""
        return np.array(self.water.getFieldBuffer("position"), copy=False)

    def place(self, start: np.ndarray) -> None:
        """Put the particles where the other codes have them."""
        if self.water.numActiveParticles() != len(start):
            raise RuntimeError(f"{self.water.numActiveParticles()} particles, not {len(start)}")
        self.positions()[: len(start)] = start

    def after_step(self) -> None:
        """Book the step; the first one has the walls made and is left out."""
        if self.last is not None:
            self.seconds += time.process_time() - self.last
            self.steps += 1
        now = splishsplash.TimeManager.getCurrent().getTime()
        # its clock has single precision
        if now > self.task["every"] * (len(self.frames) + 1) - 1e-6:
            self.frames.append(self.positions()[: self.water.numActiveParticles()].copy())
        self.last = time.process_time()

    def run(self) -> None:
        """Run to the end and write the result."""
        self.base.setTimeStepCB(self.after_step)
        self.base.runSimulation()
        np.savez(
            self.task["result"],
            frames=np.array(self.frames),
            # and the first step
            seconds=self.seconds * (1 + 1 / max(self.steps, 1)),
            steps=self.steps + 1,
        )


if __name__ == "__main__":
    Dam(json.loads(Path(sys.argv[1]).read_text())).run()
