"""create_cloth: counts, masses, orientation, pins; rectangles and discs."""

import numpy as np
import pytest
from cloth_scenes import BOX, cloth, styles
from harness import by_id, instance, last_frame, run, write
from scenes import final_dump, gravity, header


@pytest.mark.parametrize("pattern", ["square", "diagonal", "equilateral"])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_create_cloth_counts_and_mass(pattern, newton):
    lmp = cloth(options=f"pattern {pattern}", newton=newton)
    vertices = lmp.get_natoms()
    edges, triangles, hinges = (
        lmp.extract_global(name) for name in ("nbonds", "nangles", "ndihedrals")
    )
    assert vertices + triangles == edges + 1
    assert 3 * triangles == edges + hinges
    assert vertices * lmp.numpy.extract_atom("mass")[1] == pytest.approx(2.0, rel=1e-12)
    x = by_id(lmp, "x")
    assert x.min(axis=0) == pytest.approx([-0.5, -0.5, 0]) and x[:, 2].max() == 0


def test_create_cloth_masses_by_area_where_atoms_have_masses():
    lmp = instance()
    lmp.commands_string(
        header()
        + BOX
        + "fix mass all property/atom rmass ghost yes\n"
        + "create_cloth 1 2.0 size 1.0 1.0 spacing 0.1 pattern square\n"
    )
    mass = by_id(lmp, "rmass")
    assert mass.sum() == pytest.approx(2.0, rel=1e-12)
    assert mass.min() < 0.5 * mass.max()  # corners carry a third or two of a cell


def test_create_cloth_orientation_pins_and_bond_types():
    lmp = cloth(
        options="center 0 0 0.5 axes 1 0 0 0 0 1 pattern square shear 2 pin top pins",
        extra="variable n equal count(pins)\n",
        regions="region top block INF INF INF INF 0.95 INF\n",
    )
    x = by_id(lmp, "x")
    assert np.ptp(x[:, 1]) == 0 and x[:, 2].max() == pytest.approx(1.0)
    assert lmp.extract_variable("n") == 11
    bonds = lmp.numpy.gather_bonds()
    diagonal = np.array(
        [np.ptp(x[b - 1, 0]) > 1e-9 and np.ptp(x[b - 1, 2]) > 1e-9 for b in bonds[:, 1:]]
    )
    assert np.array_equal(bonds[:, 0] == 2, diagonal)


DISC = """
fix mass all property/atom rmass ghost yes
create_cloth 1 2.0 disc 0.5 spacing 0.1 center 0.1 0.2 0.3 axes 0 1 0 0 0 1 group cloth pin rim pins
"""
RIM = "region rim cylinder x 0.2 0.3 0.45 INF INF side out\n"


@pytest.mark.parametrize("newton", ["on", "off"])
def test_a_disc_is_round_and_has_its_mass(newton):
    """Five rings: 6 k vertices at the radius k/5."""
    lmp = instance()
    lmp.commands_string(header(newton=newton) + BOX + RIM + DISC)
    counts = [lmp.get_natoms()]
    counts += [lmp.extract_global(name) for name in ("nbonds", "nangles", "ndihedrals")]
    assert counts == [91, 240, 150, 210]
    x = by_id(lmp, "x") - [0.1, 0.2, 0.3]
    assert np.ptp(x[:, 0]) == 0
    radius = np.linalg.norm(x, axis=1)
    assert radius == pytest.approx(np.repeat(np.arange(6) / 10, [1, 6, 12, 18, 24, 30]), rel=1e-14)
    bonds = lmp.numpy.gather_bonds()[:, 1:] - 1
    edges = np.linalg.norm(x[bonds[:, 1]] - x[bonds[:, 0]], axis=1)
    assert edges.min() == pytest.approx(0.1) and 0.13 < edges.max() < 0.1 * np.hypot(1, np.pi / 3)
    area = 15 * 0.25 * np.sin(np.pi / 15)  # of a regular polygon of 30 corners
    assert by_id(lmp, "rmass").sum() == pytest.approx(2.0 * area, rel=1e-12)
    corners = x[lmp.numpy.gather_angles()[:, 1:] - 1]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert normals[:, 0].min() > 0  # first axis times second
    assert normals[:, 0].sum() / 2 == pytest.approx(area, rel=1e-12)
    lmp.command("variable n equal count(pins)-count(pins,rim)+count(cloth,rim)")
    assert lmp.extract_variable("n") == 30


MAKE_DISC = (
    "processors 1 ${n} 1\n"
    + header()
    + BOX
    + RIM
    + DISC
    + styles(bend=0.1)
    + final_dump("mass x y z", "made${n}.txt")
    + "write_data made${n}.data nofix\n"
    + gravity(vector="1 0 0")
    + "fix sheet cloth pbd/cloth pin pins\ntimestep 1e-3\nrun 50\n"
    + final_dump("x y z", "fallen${n}.txt")
)


def elements(data, section):
    """The bonds, angles or dihedrals of a data file as a sorted list."""
    rows = data.read_text().split(f"\n{section}\n\n")[1].split("\n\n")[0].splitlines()
    return sorted(row.split()[1:] for row in rows)


def test_a_disc_does_not_depend_on_the_ranks(tmp_path):
    script = write(tmp_path, MAKE_DISC)
    for ranks in (1, 2):
        run(script, ranks, n=ranks)
    made, again = (last_frame(tmp_path / f"made{ranks}.txt") for ranks in (1, 2))
    assert np.array_equal(made, again) and np.array_equal(made[:, 0], np.arange(1, 92))
    for section in ("Bonds", "Angles", "Dihedrals"):
        one, two = (elements(tmp_path / f"made{ranks}.data", section) for ranks in (1, 2))
        assert one == two and len(one) > 100
    fallen, again = (last_frame(tmp_path / f"fallen{ranks}.txt") for ranks in (1, 2))
    assert np.abs(fallen - again).max() < 1e-12
    assert np.ptp(fallen[:, 1]) > 1e-4
