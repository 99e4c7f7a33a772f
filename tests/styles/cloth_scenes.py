"""Sheets that several files of tests use."""

from harness import instance
from scenes import cloth_styles, gravity, header

BOX = """
region box block -2 2 -2 2 -2 2
create_box 1 box bond/types 2 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 16
"""


def styles(k=1.0, bend=0.0, cutoff=0.3):
    """Stiffness of all edges and hinges, and no force but that."""
    return (
        f"pair_style zero {cutoff}\npair_coeff * *\n"
        + cloth_styles(k, bend, types="*")
        + "neigh_modify every 1 delay 0 check yes\n"
    )


def cloth(extra="", k=1.0, bend=0.0, options="", fix="", regions="", newton=""):
    lmp = instance()
    lmp.commands_string(
        header(newton=newton)
        + BOX
        + regions
        + f"create_cloth 1 2.0 size 1.0 1.0 spacing 0.1 group cloth {options}\n"
        + styles(k, bend)
        + gravity()
        + f"fix sheet cloth pbd/cloth {fix}\n"
        + "timestep 1e-3\n"
        + extra
    )
    return lmp
