"""fix cloth/contact: nothing passes, momentum is kept, whatever the speed and the side."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FREE_SHEET, HEADER

from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.trajectory import Trajectory

# water without pressure, so that contact alone holds it
SHOWER = (
    HEADER
    + """
region box block -1 1 -1 1 -1 1
create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 8
region rim block -0.44 0.44 -0.44 0.44 INF INF side out
create_cloth 2 {areal} size 0.9 0.9 spacing 0.1 group cloth pin rim pins
mass 1 0.125
region drops block -0.3 0.3 -0.3 0.3 {low} {high}
create_atoms 1 random 300 4711 drops overlap 0.01
group fluid type 1
velocity fluid set {velocity}
special_bonds lj/coul 1 1 1
pair_style sph/tait 0.1
pair_coeff 1 1 fluid 1000.0 c0 1e-6
pair_coeff 2 2 boundary
bond_style pbd
bond_coeff 1 1.0
angle_style zero
angle_coeff *
dihedral_style pbd
dihedral_coeff 1 0.1
neighbor 0.1 bin
comm_modify cutoff 0.6
neigh_modify every 1 delay 0 check yes
timestep {dt}
fix step fluid sph/integrate constant
fix sheet cloth pbd/cloth pin pins
fix contact fluid cloth/contact 0.01
"""
)


def shower(velocity, low=0.03, high=0.2, dt=1e-3, areal=2.0):
    lmp = instance()
    lmp.commands_string(
        SHOWER.format(boundary="p p p", velocity=velocity, low=low, high=high, dt=dt, areal=areal)
    )
    return lmp


def crossed(lmp, folder, steps):
    """Run and count, from the dump alone, the particles that went through the sheet."""
    dump, data = folder / "shower.lammpstrj", folder / "shower.data"
    lmp.command(f"write_data {data} nofix")
    lmp.command(f"dump all all custom 1 {dump} id type x y z")
    lmp.command("dump_modify all sort id format float %.10g")
    lmp.command(f"run {steps}")
    lmp.command("undump all")
    return crossings(ClothMesh.read(data), Trajectory(dump)).count


@pytest.mark.parametrize(
    ("speed", "dt"), [(0.5, 1e-3), (3.0, 1e-3), (3.0, 1e-2), (50.0, 2e-4), (300.0, 1e-4)]
)
@pytest.mark.parametrize("areal", [0.2, 20.0])
def test_nothing_passes(speed, areal, dt, tmp_path):
    lmp = shower(f"0 0 {-speed}", areal=areal, dt=dt)
    assert crossed(lmp, tmp_path, max(8, int(0.25 / speed / dt))) == 0
    assert lmp.extract_fix("contact", 0, 1, 0) > 0
    assert lmp.extract_fix("contact", 0, 1, 2) == 0


def test_without_contact_everything_passes(tmp_path):
    lmp = shower("0 0 -3")
    lmp.command("unfix contact")
    assert crossed(lmp, tmp_path, 100) > 250


@pytest.mark.parametrize(
    ("velocity", "low", "high"), [("0 0 3", -0.2, -0.03), ("3 0 -0.2", 0.012, 0.05)]
)
def test_from_below_and_grazing(velocity, low, high, tmp_path):
    lmp = shower(velocity, low=low, high=high)
    assert crossed(lmp, tmp_path, 60) == 0
    assert lmp.extract_fix("contact", 0, 1, 0) > 0


def test_contact_does_nothing_when_far():
    lmp = shower("0 0 0", low=0.3, high=0.4)
    before = by_id(lmp, "x")
    lmp.command("run 10")
    assert lmp.extract_fix("contact", 0, 1, 0) == 0
    np.testing.assert_allclose(by_id(lmp, "x"), before, atol=1e-12)


def test_momentum_of_a_free_sheet_and_its_water():
    """Two fluids of unequal mass, pressure, viscosity, projection and contact together."""
    lmp = instance()
    lmp.commands_string(FREE_SHEET.format(boundary="p p p"))

    def momentum():
        kind, v = by_id(lmp, "type"), by_id(lmp, "v")
        mass = lmp.numpy.extract_atom("mass")[kind]
        return (mass[:, None] * v).sum(axis=0), np.abs(mass[:, None] * v).sum()

    lmp.command("run 1")  # the first kick of the sheet is half of one
    start, scale = momentum()
    lmp.command("run 400")
    end, _ = momentum()
    assert lmp.extract_fix("contact", 0, 1, 0) > 0
    assert lmp.extract_fix("contact", 0, 1, 2) == 0
    assert np.abs(end - start).max() < 1e-12 * scale


def test_collision_never_adds_energy():
    lmp = shower("0.5 0 -3", areal=40.0)
    lmp.command("bond_coeff 1 0.0")
    lmp.command("dihedral_coeff 1 0.0")
    lmp.command("thermo_style custom ke")
    energy = []
    for _ in range(40):
        lmp.command("run 3 post no")
        energy.append(lmp.get_thermo("ke"))
    assert energy[-1] < 0.95 * energy[0]
    assert np.diff(energy).max() < 1e-9 * energy[0]
