"""Scenes of block steps that several files of tests use."""

from scenes import (
    FLUID,
    box,
    header,
    lattice,
    neighbor,
    sph_tait,
)

# A drop falls into a pool at rest, without gravity: nothing in the pool asks for short steps.
SPLASH = (
    header("f f f", FLUID)
    + box("-0.5 0.5 -0.5 0.5 -0.5 0.7")
    + lattice(0.052)
    + """region pool block -0.26 0.26 -0.26 0.26 -0.208 0 units box
region drop block -0.1 0.1 -0.1 0.1 {height} INF units box
region drop_end block INF INF INF INF INF $({height}+0.15) units box
region falls intersect 2 drop drop_end
create_atoms 1 region pool
create_atoms 1 region falls
group falls region falls
mass 1 0.125
set group all sph/rho 1000
velocity falls set 0 0 -3 units box
"""
    + sph_tait("1 1 fluid 1000 c0 30 alpha 0.1")
    + neighbor(0.03)
    + """timestep {ceiling}
fix step all sph/integrate global gain 1 velocity 0 acoustic 0.5 force 0.05 until {end} {limits}
run_style sph/adaptive {scheme}
thermo_modify norm no
"""
)
