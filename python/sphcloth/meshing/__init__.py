"""From a triangle mesh to a cloth that LAMMPS reads, and from a dump back to meshes.

``read_surface`` reads and repairs a file, ``build_cloth`` gives it masses, types and pins,
``write_data`` and ``write_molecule`` write it; ``write_sequence`` goes the other way.
"""

from sphcloth.meshing.cloth import Cloth, Material, build_cloth
from sphcloth.meshing.lammps_files import write_data, write_groups, write_molecule
from sphcloth.meshing.load import read_surface
from sphcloth.meshing.sequence import write_sequence
from sphcloth.meshing.sewing import Seams, weld
from sphcloth.meshing.surface import Surface

__all__ = [
    "Cloth",
    "Material",
    "Seams",
    "Surface",
    "build_cloth",
    "read_surface",
    "weld",
    "write_data",
    "write_groups",
    "write_molecule",
    "write_sequence",
]
