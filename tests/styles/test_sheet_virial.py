"""The virial of water with a sheet in it against the energy of a box that is scaled."""

import numpy as np
import pytest
from harness import instance
from scenes import box, cloth_styles, header, jitter, lattice, neighbor, sph_tait

BOX = 0.4


def water_with_a_sheet(boundary, options, contact):
    """Shaken water, and a pinned sheet in its middle whose vertices may be a boundary."""
    lmp = instance()
    lmp.commands_string(
        header("p p p")
        + box(
            f"0 {BOX} 0 {BOX} 0 {BOX}",
            2,
            room="bond/types 1 angle/types 1 dihedral/types 1 &\n"
            " extra/bond/per/atom 8 extra/angle/per/atom 8 extra/dihedral/per/atom 16 &\n"
            " extra/special/per/atom 30",
        )
        + lattice(0.05)
        + "create_atoms 1 box\n"
        + "create_cloth 2 4 size 0.2 0.2 center 0.2 0.2 0.2 spacing 0.05 group cloth\n"
        + "group water type 1\nmass 1 0.135\n"
        + jitter(0.008, 177, "water")
        + sph_tait("1 1 fluid 1000 c0 20", f"2 2 {boundary}", options=options)
        + cloth_styles(hinge="0.02")
        + neighbor(0.03)
        + "timestep 1e-5\nfix step water sph/integrate constant\n"
        + f"fix sheet cloth pbd/cloth pin cloth\n{contact}\n"
        + "compute virial all pressure NULL virial\nthermo_style custom step pe c_virial[*] vol\n"
        + "thermo_modify norm no\n"
    )
    return lmp


def pressures_by_virial_and_by_energy(*scene):
    """Of the scene along x, y and z, from boxes that are scaled by a millionth along each."""
    by_energy, change = [], 1e-6
    with water_with_a_sheet(*scene) as lmp:
        lmp.command("run 0 post no")
        virial = np.array(lmp.numpy.extract_compute("virial", 0, 1)[:3])
        volume = lmp.get_thermo("vol")
    for axis in "xyz":
        energies = []
        for sign in (1, -1):
            with water_with_a_sheet(*scene) as lmp:
                lmp.command(f"change_box all {axis} scale {1 + sign * change:.17g} remap units box")
                lmp.command("run 0 post no")
                energies.append(lmp.get_thermo("pe"))
        by_energy.append(-(energies[0] - energies[1]) / (2 * change) / volume)
    return virial, np.array(by_energy)


AUTO, WALL = "boundary pressure own", "fix contact water cloth/contact 0.005 wall yes"


@pytest.mark.parametrize(
    ("boundary", "options", "contact", "pressure", "off"),
    [
        ("none", "", "", 85809.495, (0.0, 0.0)),
        (f"{AUTO} volume 1.25e-4", "", "", 174241.23, (0.0, 0.0)),
        (AUTO, "", "", 263358, (0.21, 0.21)),
        (AUTO, "density calibrated", "", 263129, (0.23, 0.23)),
        (AUTO, "surface yes tension yes", "", 695229, (0.36, 0.36)),
        ("none", "", WALL, 88703, (0.00139, 0.00209)),
        ("none", "density calibrated", WALL, 66213, (0.00084, 0.00132)),
    ],
)
def test_virial_beside_a_sheet(boundary, options, contact, pressure, off):
    """The volume of a vertex, and where the border of a sheet acts, are fixed in the forces."""
    virial, by_energy = pressures_by_virial_and_by_energy(boundary, options, contact)
    assert virial[0] == pytest.approx(pressure, rel=1e-5)
    assert by_energy[2] == pytest.approx(virial[2], rel=3e-8)
    assert 1 - by_energy[:2] / virial[:2] == pytest.approx(off, rel=0.05, abs=3e-8)
