"""Scenes of time steps that several files of tests use."""

import numpy as np
from harness import by_id, instance
from scenes import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)

SPACING, SOUND, RHO0 = 0.05, 20.0, 1000.0  # of soaked()
LATTICE_SUM = 1.033835  # sum of W dx^3 on the lattice
VOLUME = SPACING**3 / LATTICE_SUM
CEILING, FLOOR, GROWTH, FLUCTUATION, OUTPUT = range(9, 14)


def free_particles(speed=0.0, options="", extra="", run="run 0", nu=0.0, timestep=0.01):
    """Particles out of each other's reach."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-1 1 -1 1 -1 1")
        + "mass 1 0.125\ncreate_atoms 1 single 0 0 0\ncreate_atoms 1 single 0.5 0 0\n"
        + sph_tait(f"1 1 fluid 1000 c0 20 nu {nu}")
        + neighbor(0.05)
        + f"""timestep {timestep}
        velocity all set {speed} 0 0
        {extra}
        fix step all sph/integrate global {options}
        {run}"""
    )
    return lmp


def soaked_sheet(areal, step, fluid=f"c0 {SOUND}"):
    """Water in a periodic box, and in the place of one of its layers a sheet of loose vertices."""
    half = 4 * SPACING
    return (
        header("p p p")
        + cloth_box(f"-{half} {half} -{half} {half} -{half} {half}")
        + f"mass 1 {RHO0 * SPACING**3 / LATTICE_SUM}\n"
        + sheet(2, areal, "0.35 0.35", SPACING)
        + f"lattice sc {SPACING} origin 0.5 0.5 0\n"
        + "region layer block INF INF INF INF -0.01 0.01 side out units box\n"
        + "create_atoms 1 region layer\ngroup fluid type 1\n"
        + sph_tait(
            f"1 1 fluid {RHO0} {fluid}",
            f"2 2 boundary pressure own volume {VOLUME}",
            options="tension yes",
        )
        + cloth_styles("0", "0")
        + neighbor(0.03)
        + f"timestep 1e-3\nfix step fluid sph/integrate {step}\n"
        + "fix sheet cloth pbd/cloth\n"
    )


def beside_stiff_water(areal, limits):
    """Let some of that water, out of reach of the sheet, take shorter steps than the rest."""
    scene = soaked_sheet(areal, f"global {limits} gain 1").replace("box 2", "box 3")
    return (
        scene.replace("mass 1", f"mass 3 {1000 * SPACING**3 / LATTICE_SUM}\nmass 1")
        .replace(
            "group fluid type 1",
            "region stiff block INF INF INF INF 0.12 INF units box\nset region stiff type 3\n"
            "group fluid type 1 3",
        )
        .replace("pair_coeff 2 2", "pair_coeff 3 3 fluid 1000 c0 160\npair_coeff 2 2")
    ) + "run_style sph/adaptive block\nrun 1 post no\n"


def soaked(areal, step, fluid=f"c0 {SOUND}"):
    lmp = instance()
    lmp.commands_string(soaked_sheet(areal, step, fluid) + "run 0 post no")
    return lmp


def wall_sheet(areal, step):
    """Water at rest in a periodic box, and between two of its layers a mesh of loose vertices.

    It is periodic, too, and a wall to the water.
    """
    n, half = 8, 4 * SPACING
    vertex = np.arange(n * n).reshape(n, n) + 1
    right, up = np.roll(vertex, -1, axis=1), np.roll(vertex, -1, axis=0)
    across = np.roll(right, -1, axis=0)
    border = [(j, i) for j in range(n) for i in range(n) if n - 1 in (j, i)]
    triangles = [(vertex[c], right[c], across[c]) for c in border]
    triangles += [(vertex[c], across[c], up[c]) for c in border]
    return (
        header("p p p")
        + cloth_box(f"-{half} {half} -{half} {half} -{half} {half}")
        + sheet(2, areal, f"{(n - 1) * SPACING} {(n - 1) * SPACING}", SPACING)
        + f"lattice sc {SPACING} origin 0.5 0.5 0.5\ncreate_atoms 1 box\ngroup fluid type 1\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {SOUND} spacing {SPACING}",
            "2 2 none",
            options="tension yes density calibrated",
        )
        + cloth_styles("0", "0")
        + neighbor(0.03)
        + "".join("create_bonds single/angle 1 {} {} {}\n".format(*t) for t in triangles)
        + f"timestep 1e-3\nfix step fluid sph/integrate {step}\n"
        + "fix sheet cloth pbd/cloth\nfix contact fluid cloth/contact 0.005 wall yes\n"
    )


def impact(areal, step, speed, *, wall=False):
    """Let a block of water meet a free sheet of boundary particles, or one that is a wall."""
    half = 8 * SPACING
    return (
        header("p p p")
        + cloth_box(f"-{half} {half} -{half} {half} -{half} {half}")
        + ("" if wall else f"mass 1 {RHO0 * SPACING**3 / LATTICE_SUM}\n")
        + sheet(2, areal, f"{10 * SPACING} {10 * SPACING}", SPACING)
        + f"lattice sc {SPACING} origin 0.5 0.5 0\n"
        + filled("water", "-0.15 0.15 -0.15 0.15 0.12 0.33")
        + "group fluid type 1\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {SOUND}" + (f" spacing {SPACING}" if wall else ""),
            "2 2 none" if wall else f"2 2 boundary pressure own volume {VOLUME}",
            options="density calibrated" if wall else "",
        )
        + cloth_styles("compliance 1e-5", "compliance 1000")
        + neighbor(0.03)
        + f"timestep 2e-3\nfix step fluid sph/integrate {step}\n"
        + "fix sheet cloth pbd/cloth\n"
        + ("fix contact fluid cloth/contact 0.01 wall yes\n" if wall else "")
        + f"velocity fluid set 0 0 {-speed} units box\n"
    )


def stir(lmp, speed=1e-2):
    """Give all small velocities."""
    lmp.numpy.extract_atom("v")[:512] = speed * np.random.default_rng(3).uniform(-1, 1, (512, 3))


def growth_in(lmp, run, speed=1e-2):
    """By how much the energy of small velocities grows; None: of those that there are."""
    if speed is not None:
        stir(lmp, speed)
    mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
    before = mass @ (by_id(lmp, "v") ** 2).sum(axis=1)
    lmp.commands_string(run)
    return mass @ (by_id(lmp, "v") ** 2).sum(axis=1) / before


def momentum_with_sheet(lmp):
    """Return it without the half-kick correction, and the sum of its absolute values."""
    mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
    each = mass[:, None] * by_id(lmp, "v")
    correction = [lmp.extract_fix("sheet", 0, 1, n) for n in (7, 8, 9)]
    return each.sum(axis=0) - correction, np.abs(each).sum()


def dt_and_limit(lmp):
    return lmp.extract_fix("step", 0, 0), int(lmp.extract_fix("step", 0, 1, 0))


def steps_by_limit(lmp):
    counts = {k: int(lmp.extract_fix("step", 0, 1, 4 + k)) for k in range(1, 14)}
    return {k: n for k, n in counts.items() if n}


DAM = (
    header("f p f", FLUID)
    + box("0 1 0 0.2 0 0.6", 2)
    + lattice()
    + filled("water", "0.05 0.4 INF INF 0.05 0.4")
    + filled("wall", "0.05 0.95 0.0 0.2 0.05 INF side out", 2)
    + "mass * 0.125\ngroup fluid type 1\n"
    + sph_tait("1 1 fluid 1000 c0 25 alpha 0.1", "2 2 boundary")
    + neighbor(0.03)
    + "timestep 0.002\n"
    + gravity("fluid")
    + """fix step fluid sph/integrate {scheme}
fix drain fluid sph/drain
{style}
run 100
"""
)
