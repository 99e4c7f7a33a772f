"""Fluid above and below a sheet: it does not act through it."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import cloth_box, cloth_styles, final_dump, header, jitter, lattice, neighbor, sph_tait

# two layers of water, one particle spacing apart, at other densities; a sheet between them, or not
POOLS = (
    header()
    + cloth_box("0 0.5 0 0.5 -0.3 0.3", 3)
    + "mass 1 0.125\nmass 2 0.13\nmass 3 1\n"
    + lattice()
    + """region above block 0 0.5 0 0.5 0 0.2 units box
region below block 0 0.5 0 0.5 -0.2 0 units box
{fill}
"""
    + jitter(0.004, 5)
    + """group fluid type 1 2
velocity fluid ramp vx -1 1 y 0 0.5 units box
region rim block 0.001 0.499 0.001 0.499 INF INF side out units box
{sheet}
"""
    + sph_tait("1*2 1*2 fluid 1000.0 c0 20 alpha 0.1 nu 1e-3", "3 3 none")
    + cloth_styles()
    + neighbor(0.03)
    + "timestep 2e-4\nfix step fluid sph/integrate constant\n"
)
SHEET = "create_cloth 3 1.0 center 0.25 0.25 0 size 0.5 0.5 spacing 0.05 group cloth pin rim pins"
FILL = {"above": "create_atoms 1 region above", "below": "create_atoms 2 region below"}
# by contact alone
PARTED = "fix sheet cloth pbd/cloth pin pins\nfix contact fluid cloth/contact 0.005 {sides}\n"


def pools(fill, sides, commands="run 0"):
    lmp = instance()
    both = "\n".join(FILL[name] for name in fill)
    lmp.commands_string(POOLS.format(fill=both, sheet=SHEET) + PARTED.format(sides=sides))
    lmp.commands_string("compute side all sph/atom side\n" + commands)
    return lmp


def compute(lmp, name):
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    return np.array(lmp.numpy.extract_compute(name, 1, 1)[:owned])[order]


def test_a_pool_does_not_feel_the_other_one():
    """Densities and forces above are those of the upper pool alone, and of both without sides."""
    both, alone = pools(("above", "below"), ""), pools(("above",), "")
    through = pools(("above", "below"), "sides no")
    above = by_id(both, "type") == 1
    middle = np.abs(by_id(both, "x")[above] - 0.25)[:, :2].max(axis=1) < 0.15
    for name in ("rho", "f"):
        one, other = by_id(both, name)[above][middle], by_id(alone, name)
        other = other[by_id(alone, "type") == 1][middle]
        assert np.array_equal(one, other)
        seen = by_id(through, name)[above][middle]
        assert np.abs(seen - one).max() > 0.05 * np.abs(one).max()


def test_the_sides_are_those_of_the_triangles():
    lmp = pools(("above", "below"), "", "run 1")
    x, kind, side = by_id(lmp, "x"), by_id(lmp, "type"), compute(lmp, "side")
    inside = np.abs(x[:, :2] - 0.25).max(axis=1) < 0.2
    near = np.abs(x[:, 2]) < 0.1
    assert (side[(kind == 1) & near & inside] == 1).all()
    assert (side[(kind == 2) & near & inside] == -1).all()
    assert (side[np.abs(x[:, 2]) > 0.14] == 0).all()
    assert (side[kind == 3] == 0).all()


def test_minimize_knows_them():
    """Also as the first command of a script: forces at its end are those of a run."""
    lmp = pools(("above", "below"), "", "velocity all set 0 0 0\nminimize 0 0 20 60")
    x, f, kind, side = by_id(lmp, "x"), by_id(lmp, "f"), by_id(lmp, "type"), compute(lmp, "side")
    near = (np.abs(x[:, :2] - 0.25).max(axis=1) < 0.2) & (np.abs(x[:, 2]) < 0.08)
    assert (side[(kind == 1) & near] == 1).all() and (side[(kind == 2) & near] == -1).all()
    lmp.command("run 0")
    np.testing.assert_allclose(by_id(lmp, "f"), f, rtol=0, atol=1e-12 * np.abs(f).max())


def test_it_stays_so_while_the_sheet_moves_on_any_ranks(tmp_path):
    script = POOLS.format(fill="\n".join(FILL.values()), sheet=SHEET)
    script += PARTED.format(sides="")
    script += "compute side all sph/atom side\nrun 100\n"
    script += final_dump("type x y z vx vy vz c_side", "{dump}")
    for ranks in (1, 2):
        text = script.replace("{dump}", f"end{ranks}.txt")
        run(write(tmp_path, text, f"in.{ranks}"), ranks=ranks)
    one, two = (last_frame(tmp_path / f"end{ranks}.txt") for ranks in (1, 2))
    assert np.abs(one - two).max() < 1e-8
    fluid = one[:, 1] < 3
    assert (one[fluid, 8] != 0).sum() > 200
    wrong = np.where(one[:, 1] == 1, -1, 1)
    inside = np.abs(one[:, 2:4] - 0.25).max(axis=1) < 0.2
    assert not (one[fluid & inside, 8] == wrong[fluid & inside]).any()


WALLS = {
    "cloth": "fix sheet cloth pbd/cloth pin cloth\nfix contact fluid cloth/contact 0.005 wall yes",
    "plate": "fix contact fluid cloth/contact 0.005 obstacle cloth wall yes",
}


def test_the_side_is_that_of_the_contact_which_parts():
    """Also where a contact that does not part the fluid is defined before it."""
    lmp = instance()
    lmp.commands_string(
        POOLS.format(fill="\n".join(FILL.values()), sheet=SHEET)
        + "group none empty\nfix sheet cloth pbd/cloth pin pins\n"
        + "fix other none cloth/contact 0.005 sides no\n"
        + "fix contact fluid cloth/contact 0.005\ncompute side all sph/atom side\nrun 0"
    )
    fluid = by_id(lmp, "type") < 3
    assert (compute(lmp, "side")[fluid] != 0).any()


@pytest.mark.parametrize("sides", ["yes", "no"])
def test_a_thin_plate_parts_the_pools_as_a_cloth_does(sides):
    """Density and forces of the water on both sides of an obstacle are those at a pinned cloth."""
    found = {}
    for name, wall in WALLS.items():
        lmp = instance()
        lmp.commands_string(POOLS.format(fill="\n".join(FILL.values()), sheet=SHEET))
        lmp.commands_string(
            f"{wall} sides {sides}\ncomm_modify cutoff 0.3\ncompute side all sph/atom side\nrun 1"
        )
        fluid = by_id(lmp, "type") < 3
        found[name] = [by_id(lmp, key)[fluid] for key in ("rho", "f")]
        assert (compute(lmp, "side")[fluid] != 0).any() == (sides == "yes")
    for one, other in zip(*found.values(), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12 * np.abs(other).max())


def test_the_sheet_carries_the_pool_on_it():
    """By contact alone: what the pins carry is the weight."""
    lmp = pools(
        ("above",),
        "",
        "fix g fluid gravity 9.81 vector 0 0 -1\nfix drag fluid viscous 2.0\nrun 2500",
    )
    kind = by_id(lmp, "type")
    weight = (kind == 1).sum() * 0.125 * 9.81
    carried = []
    for _ in range(20):
        lmp.command("run 50 post no")
        carried.append(lmp.extract_fix("sheet", 0, 1, 2))
    assert np.mean(carried) == pytest.approx(weight, rel=0.02)


TWISTED = """
LAMMPS data file

4 atoms
5 bonds
2 angles
1 atom types
1 bond types
1 angle types
0 1 xlo xhi
0 1 ylo yhi
0 1 zlo zhi

Masses

1 1.0

Atoms # hybrid

1 1 0.2 0.2 0.5 1 0 1 0
2 1 0.4 0.2 0.5 1 0 1 0
3 1 0.4 0.4 0.5 1 0 1 0
4 1 0.2 0.4 0.5 1 0 1 0

Bonds

1 1 1 2
2 1 2 3
3 1 3 4
4 1 4 1
5 1 1 3

Angles

1 1 1 2 3
2 1 1 4 3
"""


def test_a_mesh_without_sides_is_named(tmp_path):
    (tmp_path / "twisted.data").write_text(TWISTED.lstrip())
    setup = (
        header()
        + f"read_data {tmp_path / 'twisted.data'} extra/atom/types 1\nmass 2 1\n"
        + "create_atoms 2 single 0.3 0.3 0.6\ngroup cloth type 1\ngroup fluid type 2\n"
        + "special_bonds lj/coul 1 1 1\npair_style sph/tait 0.1\npair_coeff 1 1 none\n"
        + "pair_coeff 2 2 fluid 1000 c0 10\nbond_style pbd\nbond_coeff 1 1\nangle_style zero\n"
        + "angle_coeff *\ncomm_modify cutoff 0.4\nfix s cloth pbd/cloth\n"
    )
    with pytest.raises(
        Exception, match=r"two triangles run from vertex 1 to vertex 3|3 to vertex 1"
    ):
        instance().commands_string(setup + "fix c fluid cloth/contact 0.01\nrun 0")
    instance().commands_string(setup + "fix c fluid cloth/contact 0.01 sides no\nrun 0")
