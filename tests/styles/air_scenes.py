"""A sheet in the air, for the tests of fix cloth/air."""

import numpy as np
from harness import instance
from scenes import (
    cloth_box,
    filled,
    header,
    lattice,
    neighbor,
    no_other_bonds,
    sph_tait,
    stiffness,
)

RHO, NORMAL, TANGENTIAL, G = 1.2, 1.3, 0.05, 9.81
COEFFICIENTS = f"density {RHO} normal {NORMAL} tangential {TANGENTIAL}"


def sheet(
    *,
    areal=0.5,
    spacing=0.1,
    pin="",
    shape="block",
    sides="-2 2 -2 2 -2 2",
    axes="1 0 0 0 1 0",
    boundary="p p p",
    more="",
):
    """A square of 0.4 m, free unless a region is pinned."""
    tilt = " 0.3 0.2 -0.4" if shape == "prism" else ""
    box = cloth_box(sides + tilt, 1).replace("block", shape)
    region = f"region held {pin}\n" if pin else ""
    return (
        header(boundary)
        + box
        + region
        + f"create_cloth 1 {areal} size 0.4 0.4 spacing {spacing} axes {axes} group cloth"
        + (" pin held pins\n" if pin else "\n")
        + stiffness("1.0", "0.5")
        + f"pair_style zero 0.2\npair_coeff * *\n{no_other_bonds()}{neighbor(0.05, 0.5)}"
        + more
        + f"fix s cloth pbd/cloth {'pin pins' if pin else ''}\n"
    )


# a region: every vertex is pinned
ALL = "block INF INF INF INF INF INF"


def air_of(script, steps, names=6):
    with instance() as lmp:
        lmp.commands_string(script + f"thermo_style custom step f_air[*]\nrun {steps}")
        return np.array([lmp.extract_fix("air", 0, 1, k, 0) for k in range(names)])


# water over and under a level sheet of 0.4 m, and none
ABOVE, BELOW = "-0.25 0.25 -0.25 0.25 0.02 0.22", "-0.25 0.25 -0.25 0.25 -0.22 -0.02"


def wet_sheet(blocks, pinned):
    """A level sheet that water does not push, with blocks of water beside it."""
    water = "".join(filled(f"w{k}", sides) for k, sides in enumerate(blocks))
    return (
        header("f f f", "hybrid sph molecular")
        + cloth_box("-0.5 0.5 -0.5 0.5 -0.5 0.5")
        + "mass * 0.125\ncreate_cloth 2 0.5 size 0.4 0.4 spacing 0.05 group cloth\n"
        + lattice(0.05)
        + f"{water}group water type 1\n"
        + sph_tait("1 1 fluid 1000 c0 20", "2 2 none")
        + stiffness("1.0", "0.0")
        + no_other_bonds()
        + neighbor(0.05)
        + "group pins union cloth\nfix step water sph/integrate constant\ntimestep 1e-6\n"
        + f"fix s cloth pbd/cloth {'pin pins' if pinned else ''}\n"
    )
