"""SPlisHSPlasH beside us: its scene of the dam break, and its wheel made to start.

The wheel brings four libraries of OpenGL which end with a segmentation fault on some systems, at
import already. Then a copy of the module in a folder of ours gets links to the system's libraries
in their place; what pip has installed stays as it is.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError

MODULE = "pysplishsplash"
GL_LIBRARIES = ("libGLU", "libGLX", "libGLdispatch", "libOpenGL")
GL_REMEDY = "apt install libglu1-mesa libglx0 libglvnd0 libopengl0"
METHODS = {"wcsph": 0, "dfsph": 4}
VISCOSITY = 0.01  # m^2/s, of the scenes that SPlisHSPlasH comes with
GAMMA = 7.0
CELL = 0.1  # of the map of the walls, as in its own scenes


def is_installed() -> bool:
    """Tell whether pip has installed it, without importing it."""
    return find_spec(MODULE) is not None


def starts(path: str) -> bool:
    """Tell whether Python can import it with a folder in front of the others."""
    command = [sys.executable, "-c", f"import {MODULE}"]
    return subprocess.run(command, env=environment(path), capture_output=True).returncode == 0


def environment(path: str) -> dict[str, str]:
    """Return an environment with one thread and a folder in front of Python's path."""
    before = os.environ.get("PYTHONPATH", "")
    return os.environ | {
        "OMP_NUM_THREADS": "1",
        "PYTHONPATH": os.pathsep.join(p for p in (path, before) if p),
    }


def system_libraries() -> dict[str, Path]:
    """Return where the system has shared libraries, by name without version."""
    ldconfig = shutil.which("ldconfig", path=os.pathsep.join([os.environ["PATH"], "/sbin"]))
    if ldconfig is None:
        return {}
    listed = subprocess.run([ldconfig, "-p"], capture_output=True, text=True).stdout
    rows = re.findall(r"^\s*(lib\w+)\.so\.\d+ \(.*x86-64.*\) => (\S+)$", listed, re.M)
    return {name: Path(file) for name, file in rows}


def copy_with_system_gl(module: Path, folder: Path, system: dict[str, Path]) -> None:
    """Copy the module, with links to the system's OpenGL in the place of what it brings.

    Raises:
        UserError: the system lacks a library.
    """
    libraries = folder / f"{MODULE}.libs"
    libraries.mkdir(parents=True)
    shutil.copy(module, folder)
    for bundled in (module.parent / f"{MODULE}.libs").iterdir():
        name = bundled.name.partition("-")[0]
        if name not in GL_LIBRARIES:
            shutil.copy(bundled, libraries)
        elif name in system:
            (libraries / bundled.name).symlink_to(system[name])
        else:
            raise UserError(f"{MODULE} needs the system's {name}: {GL_REMEDY}")


def make_it_start(folder: Path) -> str:
    """Return the folder that must be in front of Python's path, empty if none.

    Raises:
        UserError: it starts neither as installed nor with the system's libraries.
    """
    if starts(""):
        return ""
    module = Path(find_spec(MODULE).origin)
    copy_with_system_gl(module, folder, system_libraries())
    if not starts(str(folder)):
        raise UserError(f"{MODULE} cannot be imported, with the system's OpenGL neither")
    return str(folder)


def box_mesh() -> str:
    """Return a cube of edge 1 around the origin as OBJ."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    faces = [f"f {a} {b} {c}\nf {a} {c} {d}" for a, b, c, d in quads]
    return "\n".join([*("v {} {} {}".format(*corner) for corner in corners), *faces]) + "\n"


def _stepping(method: str, spacing: float, setting: dict[str, float]) -> dict:
    """Return what a method needs to choose its time step, and its own settings."""
    if method == "wcsph":
        sound = setting["sound"]
        return {
            "cflMethod": 0,
            "timeStepSize": setting["courant"] * spacing / sound,
            "WCSPH": {"stiffness": 1000 * sound**2 / GAMMA, "exponent": GAMMA},
        }
    return {
        "cflMethod": 1,
        "cflFactor": 1,
        "cflMaxTimeStepSize": 0.005,
        "timeStepSize": 0.001,
        "DFSPH": {"maxError": setting["max_error"], "maxErrorV": 2 * setting["max_error"]},
    }


def scene(
    method: str,
    counts: tuple[int, int, int],
    spacing: float,
    tank: tuple[NDArray[np.float64], NDArray[np.float64]],
    setting: dict[str, float],
) -> dict:
    """Return the scene; the block of particles has the number, not yet the place.

    Args:
        method: ``wcsph``, with the settings sound and courant (step times speed of sound over half
            the support), or ``dfsph``, with max_error (per cent of the density); of both,
            viscosity in m^2/s, that of its own scenes if it is not given.
        counts: particles along x, y and z.
        spacing: of the particles, twice their radius; the support is twice as much.
        tank: lower and upper corner.
        setting: of the method.
    """
    lower, upper = tank
    size = upper - lower
    return {
        "Configuration": {
            "particleRadius": spacing / 2,
            "simulationMethod": METHODS[method],
            "gravitation": [0, 0, -9.81],
            "boundaryHandlingMethod": 2,
            **_stepping(method, spacing, setting),
        },
        "Materials": [
            {
                "id": "Fluid",
                "density0": 1000,
                "viscosityMethod": 1,
                "Standard viscosity": {"viscosity": setting.get("viscosity", VISCOSITY)},
            }
        ],
        "RigidBodies": [
            {
                "geometryFile": "box.obj",
                "translation": (0.5 * (lower + upper)).tolist(),
                "scale": size.tolist(),
                "isDynamic": False,
                "isWall": True,
                "mapInvert": True,
                "mapThickness": 0.0,
                "mapResolution": [max(round(float(edge) / CELL), 4) for edge in size],
            }
        ],
        "FluidBlocks": [
            {
                "denseMode": 0,
                "start": [0, 0, 0],
                "end": [spacing * (n + 1) for n in counts],
            }
        ],
    }


class SplishSplash:
    """Runs the dam break in a folder; the map of the walls is made once and found again."""

    def __init__(self, folder: Path, start: NDArray[np.float64]) -> None:
        self.folder = folder
        folder.mkdir()
        self.path = make_it_start(folder / "module")
        (folder / "box.obj").write_text(box_mesh())
        np.save(folder / "start.npy", start.astype(np.float32))

    def __call__(self, scene: dict, every: float, end: float) -> tuple[float, int, list]:
        """Run a scene and return processor time, steps and frames.

        Raises:
            UserError: it failed.
        """
        task = {
            "scene": str(self.folder / "scene.json"),
            "folder": str(self.folder / "output"),
            "start": str(self.folder / "start.npy"),
            "result": str(self.folder / "result.npz"),
            "every": every,
            "end": end,
        }
        Path(task["scene"]).write_text(json.dumps(scene))
        (self.folder / "task.json").write_text(json.dumps(task))
        command = [sys.executable, "-m", "sphcloth.bench.splishsplash_dam"]
        done = subprocess.run(
            [*command, str(self.folder / "task.json")],
            env=environment(self.path),
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise UserError(f"SPlisHSPlasH failed: {(done.stdout + done.stderr).strip()[-300:]}")
        with np.load(task["result"]) as result:
            frames = list(result["frames"].astype(float))
            return float(result["seconds"]), int(result["steps"]), frames
