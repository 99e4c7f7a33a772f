"""Scenes of time steps that several files of tests use."""

from harness import instance
from scenes import (
    FLUID,
    box,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    sph_tait,
)

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
