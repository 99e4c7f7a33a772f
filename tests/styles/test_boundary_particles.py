"""Boundary particles of pair_style sph/tait: volumes, pressures and what they carry."""

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import C0, RHO0, H, lattice, tait, two_particles, wendland, wendland_slope
from scenes import FLUID, box, filled, gravity, header, neighbor, sph_tait
from scenes import lattice as sites


@pytest.mark.parametrize(("pressure", "factor"), [("own", 1), ("mirror", 2), ("extrapolate", 2)])
def test_boundary_counts_with_its_own_volume_and_pushes_back(pressure, factor):
    volume, r = 2e-4, 0.03
    coeff = f"fluid {RHO0} c0 {C0}"
    second = f"pair_coeff 2 2 boundary volume {volume} pressure {pressure}"
    lmp = two_particles(r, coeff=coeff, second=second)
    rho = wendland(0) + RHO0 * volume * wendland(r)
    force = -factor * RHO0 * volume * tait(rho) / rho**2 * wendland_slope(r)
    np.testing.assert_allclose(by_id(lmp, "rho")[0], rho, rtol=1e-14)
    np.testing.assert_allclose(by_id(lmp, "f")[:, 0], [-force, force], rtol=1e-12)


@pytest.mark.parametrize("volume", ["", "volume auto", "volume 1e-3 volume auto"])
def test_measured_volume_of_a_lone_boundary_particle(volume):
    coeff = f"fluid {RHO0} c0 {C0}"
    lmp = two_particles(0.03, coeff=coeff, second=f"pair_coeff 2 2 boundary {volume}")
    rho = wendland(0) + RHO0 / wendland(0) * wendland(0.03)
    np.testing.assert_allclose(by_id(lmp, "rho")[0], rho, rtol=1e-14)


def test_boundary_stiffness_of_its_own():
    coeff, volume = f"fluid {RHO0} c0 {C0}", "pair_coeff 2 2 boundary volume 2e-4"
    plain = two_particles(0.03, coeff=coeff, second=volume)
    stiff = two_particles(0.03, coeff=coeff, second=f"{volume}\npair_coeff 1 2 c0 {2 * C0}")
    np.testing.assert_allclose(by_id(stiff, "f"), 4 * by_id(plain, "f"), rtol=1e-12)


@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_water_and_its_boundary_push_each_other_alike(precision):
    lmp = lattice(setting=f"precision {precision}", types=2)
    lmp.commands_string(f"""
        region floor block INF INF INF INF INF -0.1 units box
        set region floor type 2
        pair_coeff 1 1 fluid {RHO0} c0 {C0}
        pair_coeff 2 2 boundary pressure own volume 1.234567890123e-4
        fix 1 all nve
        run 0""")
    f = by_id(lmp, "f")
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()


def test_column_of_water_rests_on_its_floor():
    """The floor carries the weight, and the pressure grows with depth."""
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.2 0 0.2 -0.2 0.6", 2)
        + "mass 1 0.125\nmass 2 1\n"
        + sites()
        + filled("floor", "INF INF INF INF -0.026 0.0", 2)
        + filled("water", "INF INF INF INF 0.0 0.4", 1)
        + "group fluid type 1\ngroup floor type 2\n"
        + sph_tait("1 1 fluid 1000 c0 20 alpha 0.5", "2 2 boundary")
        + neighbor(0.03)
        + "timestep 0.002\n"
        + gravity("fluid")
        + """
        fix step fluid sph/integrate global
        compute push floor reduce sum fz
        fix mean all ave/time 1 1000 1000 c_push
        run 3000"""
    )
    weight = 4 * 4 * 8 * 0.125 * 9.81
    assert -lmp.extract_fix("mean", 0, 0) == pytest.approx(weight, rel=0.02)
    z = by_id(lmp, "x")[:, 2][by_id(lmp, "type") == 1]
    rho = by_id(lmp, "rho")[by_id(lmp, "type") == 1]
    deep, shallow = z < 0.15, (z > 0.2) & (z < 0.3)
    assert tait(rho[deep].mean()) > tait(rho[shallow].mean()) > 0
    assert z.min() > 0 and z.max() < 0.45


def test_boundary_takes_the_mean_pressure_of_the_fluid_around_it():
    """Two fluid particles of unequal density at unequal distances of one wall particle."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-1 1 -1 1 -1 1", 3)
        + "mass * 1.0\nmass 2 1.4\ncreate_atoms 1 single 0.04 0 0\n"
        + "create_atoms 2 single -0.07 0 0\ncreate_atoms 3 single 0 0 0\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0}",
            f"2 2 fluid {RHO0} c0 {C0}",
            "3 3 boundary volume 1e-4",
            support=H,
        )
        + neighbor(0.02)
        + "run 0\n"
    )
    rho = by_id(lmp, "rho")[:2]
    p = tait(rho) / rho**2
    w = wendland(np.array([0.04, 0.07]))
    at_wall = (w * p).sum() / w.sum()
    slope = wendland_slope(np.array([0.04, 0.07]))
    force = -np.array([1.0, 1.4]) * 1e-4 * RHO0 * (p + at_wall) * slope * np.array([1, -1])
    np.testing.assert_allclose(by_id(lmp, "f")[:2, 0], force, rtol=1e-12)
    np.testing.assert_allclose(by_id(lmp, "f")[2, 0], -force.sum(), rtol=1e-12)


@pytest.mark.parametrize("fluid", [False, True])
def test_volumes_follow_a_boundary_only_while_there_is_fluid(fluid):
    """A plane of boundary particles is drawn apart; a fluid particle is far away, or none."""
    lmp = instance()
    lmp.commands_string(
        header(atoms=FLUID)
        + box("-1 1 -1 1 -1 1", 2)
        + "mass * 1\nlattice sc 0.05\n"
        + filled("plane", "-0.2 0.2 -0.2 0.2 -0.01 0.01", 2)
        + ("create_atoms 1 single 0.9 0.9 0.9 units box\n" if fluid else "")
        + "variable u atom x\ngroup plane type 2\nvelocity plane set v_u NULL NULL\n"
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0}", "2 2 boundary", support=H)
        + neighbor(0.05)
        + "compute volume plane sph/atom volume\nfix go plane nve\ntimestep 1e-2\nrun 0\n"
    )
    lmp.commands_string("compute mean plane reduce sum c_volume\nthermo_style custom step c_mean")
    lmp.command("run 0")
    before = lmp.extract_compute("mean", 0, 0)
    lmp.command("run 3")
    grown = lmp.extract_compute("mean", 0, 0) / before
    assert (grown > 1.01) if fluid else (grown == 1.0)


# what moves a boundary without giving it a velocity
MOVERS = {
    "box, and all with it": "fix move all deform 1 x erate 0.5 remap x\nrun 10\n",
    "box alone": "fix move all deform 1 x erate 0.5 remap none\nrun 10\n",
    "barostat": "fix move all press/berendsen iso 1e5 1e5 1.0 modulus 1e5\nrun 10\n",
    "minimization": "min_modify dmax 2e-3\nminimize 0 0 5 50\n",
}


@pytest.mark.parametrize("mover", MOVERS)
def test_volumes_follow_what_moves_without_a_velocity(mover):
    """With lists for the whole run as with new ones, for which they are measured anyway."""
    found = []
    for skin in (1e-6, 0.05):
        lmp = instance()
        lmp.commands_string(
            header("p p p", FLUID)
            + box("0 0.4 0 0.4 0 0.4", 2)
            + "mass * 0.125\n"
            + sites()
            + filled("floor", "INF INF INF INF INF 0.15", 2)
            + filled("water", "INF INF INF INF 0.15 INF", 1)
            + "group water type 1\ngroup floor type 2\n"
            + "displace_atoms all random 0.003 0.003 0.003 4711\n"
            + sph_tait("1 1 fluid 1000 c0 10", "2 2 boundary")
            + neighbor(skin)
            + "timestep 1e-3\nfix step water sph/integrate constant\n"
            + "compute volume floor sph/atom volume\ncompute sum floor reduce sum c_volume\n"
            + "thermo_style custom step c_sum\nrun 0\n"
        )
        before = lmp.extract_compute("sum", 0, 0)
        lmp.commands_string(MOVERS[mover])
        found.append(lmp.extract_compute("sum", 0, 0) / before)
    assert abs(found[0] - 1) > 1e-3
    assert found[1] == pytest.approx(found[0], rel=1e-9)
