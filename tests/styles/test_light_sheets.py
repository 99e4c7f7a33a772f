"""Contact of heavy particles with vertices that weigh next to nothing."""

import numpy as np
import pytest
from harness import instance
from scenes import cloth_box, header

ACROSS, SPACING, LOAD, DRAWN = 6, 0.025, 3.0, 0.005
N = ACROSS**2
STYLES = f"""
pair_style zero 0.06
pair_coeff * *
bond_style pbd
bond_coeff 1 compliance {DRAWN / LOAD} rest zero
angle_style zero
angle_coeff *
neighbor 0.0125 bin
neigh_modify every 1 delay 0 check yes
group water type 1
group sheet type 2
group cloth type 2 3
group ends type 3
timestep 1.7e-4
fix pull water addforce 0 0 {-LOAD}
fix step water nve
fix cloth cloth pbd/cloth pin ends
fix contact water cloth/contact 0.005
thermo 1000000
"""


def bed_of_springs(seed):
    """A periodic sheet, each vertex on a spring that bears one particle, particles on diagonals."""
    places = [(i, j) for j in range(ACROSS) for i in range(ACROSS)]
    aside = np.random.default_rng(seed).uniform(-1e-4, 1e-4, (N, 2))
    lines = [f"create_atoms 2 single {i * SPACING} {j * SPACING} 0 units box" for i, j in places]
    lines += [
        f"create_atoms 3 single {i * SPACING} {j * SPACING} {DRAWN} units box" for i, j in places
    ]
    for i, j in places:
        here, east, north, beyond = (
            1 + (i + a) % ACROSS + (j + b) % ACROSS * ACROSS
            for a, b in ((0, 0), (1, 0), (0, 1), (1, 1))
        )
        lines += [
            f"create_bonds single/angle 1 {here} {east} {beyond} special no",
            f"create_bonds single/angle 1 {here} {beyond} {north} special no",
            f"create_bonds single/bond 1 {here} {here + N} special no",
        ]
    lines += [
        f"create_atoms 1 single {(i + 0.5 + a) * SPACING} {(j + 0.5 + b) * SPACING} 0.005 units box"
        for (i, j), (a, b) in zip(places, aside, strict=True)
    ]
    side = ACROSS * SPACING
    return (
        header("p p f")
        + cloth_box(f"0 {side} 0 {side} -0.1 0.1", 3)
        + "mass 1 0.3\nmass 2*3 6e-6\n"
        + "\n".join(lines)
        + STYLES
    )


@pytest.mark.parametrize("seed", [1, 2])
def test_vertices_under_particles_at_their_edges_do_not_flutter(seed):
    """50 000 times lighter: they reach 0.7 to 1.4 m/s if pushed at points of earlier substeps."""
    with instance() as lmp:
        lmp.commands_string(bed_of_springs(seed) + "run 200 post no")
        speeds = []
        for _ in range(200):
            lmp.command("run 1 pre no post no")
            owned = lmp.extract_setting("nlocal")
            is_vertex = lmp.numpy.extract_atom("type")[:owned] == 2
            speeds.append(lmp.numpy.extract_atom("v")[:owned][is_vertex, 2].std())
        assert np.mean(speeds) < 0.3
        assert np.max(lmp.numpy.extract_atom("x")[:owned][is_vertex, 2]) < DRAWN
