"""fix cloth/contact ... wall: a mesh fills the kernel of the fluid beside it, as a plane wall does."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import DROP, END, FREE_SHEET, HEADER, MAKE_DROP

# A slab of water over the plane z = 0, where there is a sheet of a given mesh, or a plane wall.
SLAB = (
    HEADER.format(boundary="f f f")
    + """
region box block -1 1 -1 1 -0.5 1
create_box 2 box bond/types 1 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 16
mass 1 0.13
mass 2 1
lattice sc 0.05 origin 0.5 0.5 0.5
region slab block -0.3 0.3 -0.3 0.3 0 0.3 units box
create_atoms 1 region slab
displace_atoms all random 0.01 0.01 0.01 5 units box
group fluid type 1
velocity fluid ramp vx -1 1 z 0 0.3 units box
{sheet}
special_bonds lj/coul 1 1 1
pair_style sph/tait 0.15 density {density}
pair_coeff 1 1 fluid 1000.0 c0 20 nu 1e-3
pair_coeff 2 2 none
bond_style pbd
bond_coeff 1 1.0
angle_style zero
angle_coeff *
dihedral_style pbd
dihedral_coeff 1 0.1
set group all sph/rho 1000
neighbor 0.03 bin
comm_modify cutoff 1.2
neigh_modify every 1 delay 0 check yes
timestep 1e-4
fix step fluid sph/integrate {scheme}
{wall}
run {steps}
"""
)
SHEET = "create_cloth 2 {areal} size 1.4 1.4 spacing {spacing} pattern square group cloth"
MESH = "fix sheet cloth pbd/cloth {pin}\nfix contact fluid cloth/contact 1e-3 sides no wall {wall}"


def slab(wall, sheet="", density="summation", scheme="constant", steps=0):
    lmp = instance()
    lmp.commands_string(
        SLAB.format(wall=wall, sheet=sheet, density=density, scheme=scheme, steps=steps)
    )
    return lmp


def mesh(wall, spacing=0.1, areal=2.0, pin="pin cloth", **options):
    sheet = SHEET.format(spacing=spacing, areal=areal)
    return slab(MESH.format(wall=wall, pin=pin), sheet, **options)


def fluid(lmp, name):
    return by_id(lmp, name)[by_id(lmp, "type") == 1]


@pytest.mark.parametrize("spacing", [0.05, 0.7])
@pytest.mark.parametrize("pressure", ["own", "mirror"])
def test_a_flat_mesh_is_a_plane_wall(pressure, spacing):
    """Density and force as with fix wall/sph, whether the mesh is fine or coarse."""
    plane = slab(f"fix wall fluid wall/sph zlo 0 pressure {pressure}")
    sheet = mesh(pressure, spacing)
    none = slab("")
    for name in ("rho", "f"):
        expected = fluid(plane, name)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(fluid(sheet, name), expected, atol=1e-9 * scale)
        assert np.abs(fluid(none, name) - expected).max() > 0.05 * scale


def test_pressure_behind_is_the_mean_of_the_fluid_there():
    """It is between the extremes of p of the particles, and the force between own and mirror's."""
    own, both, mean = (np.sum(fluid(mesh(w), "f")[:, 2]) for w in ("own", "mirror", "extrapolate"))
    assert own < mean and mean == pytest.approx(both, rel=0.2)


@pytest.mark.parametrize("moves", ["fluid", "cloth"])
def test_an_integrated_density_follows_the_way(moves):
    """One particle without pressure and a mesh approach: the density rises by what the wall adds."""
    change = {}
    for density in ("summation", "continuity"):
        lmp = mesh("own", density=density, pin="")
        one = "group rest subtract fluid one\ndelete_atoms group rest compress no\n"
        lmp.commands_string(
            "group one id 1\n" + one
            + "pair_coeff 1 1 fluid 1000.0 c0 1e-3\nset group one x 0.03 y 0.04 z 0.12\n"
            + f"velocity all set 0 0 0\nvelocity {moves} set 0 0 {-2 if moves == 'fluid' else 2} units box\n"
            + "run 0"
        )
        before = fluid(lmp, "rho")[0]
        lmp.command("run 400")
        change[density] = fluid(lmp, "rho")[0] - before
    assert change["summation"] > 100
    assert change["continuity"] == pytest.approx(change["summation"], rel=1e-4)


@pytest.mark.parametrize("newton", ["on", "off"])
def test_what_the_mesh_gets_is_the_opposite(newton):
    """Forces and torques of water and sheet add up to nothing."""
    lmp = instance()
    script = SLAB.format(
        wall=MESH.format(wall="extrapolate", pin=""),
        sheet=SHEET.format(spacing=0.2, areal=2.0),
        density="summation",
        scheme="constant",
        steps=0,
    )
    lmp.commands_string(f"newton {newton}\n" + script)
    x, f = by_id(lmp, "x"), by_id(lmp, "f")
    on_sheet = f[by_id(lmp, "type") == 2]
    assert on_sheet[:, 2].sum() < -100
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()
    # friction acts between the particle and its foot, at some distance: only pressure is central
    torque = np.cross(x, f).sum(axis=0)
    assert np.abs(torque[2]) < 1e-2 * np.abs(np.cross(x, f)).sum()


def test_nothing_is_filled_beyond_the_border():
    """One particle moves out over the border of the sheet, in its plane and above it."""

    def rho(x, z):
        lmp = mesh("own")
        lmp.commands_string(f"group one id 1\nset group one x {x} y 0 z {z}\nrun 0")
        return by_id(lmp, "rho")[0]

    alone = rho(0.9, 0.5)
    assert rho(0.69, 0.02) - alone > 300
    assert rho(0.72, 0.0) == pytest.approx(alone, abs=1e-6)
    assert rho(0.86, 0.02) == alone
    steps = np.array([rho(x, 0.02) for x in np.linspace(0.66, 0.76, 11)])
    assert (np.diff(steps) < 1e-9).all() and np.diff(steps).min() > -200


def test_a_mesh_behind_another_one_is_not_counted_again():
    """Two sheets, one right under the other: the water sees the upper one only."""
    sheet = SHEET.format(spacing=0.1, areal=2.0)
    below = sheet.replace("spacing 0.1", "spacing 0.1 center 0 0 -0.02").replace("cloth", "under")
    below = below.replace("create_under", "create_cloth")
    fixes = MESH.format(wall="own", pin="pin cloth")
    one = mesh("own")
    both = slab(
        "fix low under pbd/cloth pin under\n" + fixes.replace("cloth/contact", "cloth/contact"),
        sheet + "\n" + below,
    )
    np.testing.assert_allclose(fluid(both, "rho"), fluid(one, "rho"), rtol=1e-12)


def test_light_wet_cloth_shortens_the_step():
    light, heavy = (mesh("own", areal=a, pin="", scheme="global", steps=20) for a in (0.01, 1e3))
    assert light.extract_fix("step", 0, 0) < 0.3 * heavy.extract_fix("step", 0, 0)


WALL_DROP = (
    DROP.replace("pair_coeff 2 2 boundary", "pair_coeff 2 2 none")
    .replace("cloth/contact 0.015", "cloth/contact 0.015 wall extrapolate")
    .replace("neigh_modify", "comm_modify cutoff 0.3\nneigh_modify")
)


@pytest.fixture
def drop(tmp_path):
    run(write(tmp_path, MAKE_DROP, "in.make"))
    run(write(tmp_path, WALL_DROP + END, "in.serial"), dump="serial.txt")
    return tmp_path


def largest_difference(folder, name):
    return np.abs(last_frame(folder / "serial.txt") - last_frame(folder / name)).max()


@pytest.mark.parametrize(("ranks", "newton"), [(2, "on"), (4, "on"), (2, "off")])
def test_ranks(drop, ranks, newton):
    run(write(drop, WALL_DROP + END), ranks=ranks, newton=newton, dump="many.txt")
    assert largest_difference(drop, "many.txt") < 1e-9


def test_restart_continues_bit_for_bit(drop):
    steps = "run 50\nwrite_restart half.bin\nrun 50\n" + END.replace("run ${steps}", "")
    run(write(drop, WALL_DROP + steps, "in.whole"), dump="whole.txt")
    body = WALL_DROP.replace("read_data drop.data", "read_restart half.bin")
    after = body[: body.index("bond_style")] + body[body.index("neigh_modify") :]
    styles = "bond_style pbd\nbond_coeff 1 1.0\nangle_style zero\nangle_coeff *\n"
    styles += "dihedral_style pbd\ndihedral_coeff 1 0.1\nneighbor 0.03 bin\ncomm_modify cutoff 0.3\n"
    after = after.replace("neigh_modify", styles + "neigh_modify", 1)
    run(write(drop, after + END, "in.again"), dump="again.txt", steps=50)
    whole, again = (last_frame(drop / f"{name}.txt") for name in ("whole", "again"))
    assert np.array_equal(whole, again)


def test_momentum_of_a_free_sheet():
    lmp = instance()
    lmp.commands_string(
        FREE_SHEET.replace("pbd/cloth", "pbd/cloth solver gs")
        .replace("3 3 boundary", "3 3 none")
        .replace("cloth/contact 0.03", "cloth/contact 0.03 wall extrapolate")
    )

    def momentum():
        mass = lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]
        each = mass[:, None] * by_id(lmp, "v")
        return each.sum(axis=0), np.abs(each).sum()

    lmp.command("run 1")
    start, scale = momentum()
    lmp.command("run 300")
    assert np.abs(momentum()[0] - start).max() < 1e-12 * scale


@pytest.mark.parametrize(
    ("wall", "words"),
    [
        ("wall yes", "wall is 'yes': use no or own or mirror or extrapolate"),
        ("wall own", "vertex .* is of type 2, a boundary type.*pair_coeff 2 2 none"),
    ],
)
def test_errors(wall, words):
    script = SLAB.format(
        wall=MESH.format(wall="own", pin="pin cloth").replace("wall own", wall),
        sheet=SHEET.format(spacing=0.2, areal=2.0),
        density="summation",
        scheme="constant",
        steps=0,
    )
    with pytest.raises(Exception, match=words):
        instance().commands_string(script.replace("pair_coeff 2 2 none", "pair_coeff 2 2 boundary"))
