"""fix cloth/contact ... wall yes: a mesh fills the kernel of the fluid beside it."""

import numpy as np
import pytest
from harness import by_id, instance
from scenes import (
    FREE_SHEET,
    cloth_box,
    cloth_styles,
    filled,
    gravity,
    header,
    jitter,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)
from scipy.integrate import quad
from test_stepping import own_steps

# A slab of water over the plane z = 0, where there is a sheet of a given mesh, or a plane wall.
SLAB = (
    header("f f f")
    + cloth_box("-1 1 -1 1 -0.5 1")
    + "mass 1 {mass}\nmass 2 1\n"
    + lattice()
    + filled("slab", "-0.3 0.3 -0.3 0.3 0 0.3")
    + jitter(0.01, 5)
    + "group fluid type 1\nvelocity fluid ramp vx -1 1 z 0 0.3 units box\n{sheet}\n"
    + sph_tait(
        "1 1 fluid 1000.0 c0 20 nu 1e-3", "2 2 none", support=0.15, options="density {density}"
    )
    + cloth_styles()
    + "set group all sph/rho 1000\n"
    + neighbor(0.03, cutoff=1.2)
    + """timestep 1e-4
fix step fluid sph/integrate {scheme}
{wall}
run {steps}
"""
)
SHEET = "create_cloth 2 {areal} size 1.4 1.4 spacing {spacing} pattern square group cloth"
MESH = "fix sheet cloth pbd/cloth {pin}\nfix contact fluid cloth/contact 1e-3 sides no wall yes"


def slab(wall, sheet="", density="summation", scheme="constant", steps=0, mass=0.13):
    lmp = instance()
    lmp.commands_string(
        SLAB.format(wall=wall, sheet=sheet, density=density, scheme=scheme, steps=steps, mass=mass)
    )
    return lmp


def mesh(spacing=0.1, areal=2.0, pin="pin cloth", **options):
    sheet = SHEET.format(spacing=spacing, areal=areal)
    return slab(MESH.format(pin=pin), sheet, **options)


def fluid(lmp, name):
    return by_id(lmp, name)[by_id(lmp, "type") == 1]


def covered(distance, support):
    """Share of a Wendland C2 kernel in space that lies behind a plane, by quadrature."""

    def ring(r):
        return (
            21 / (2 * np.pi) * (1 - r) ** 4 * (1 + 4 * r) * 2 * np.pi * r * (r - distance / support)
        )

    return quad(ring, distance / support, 1)[0]


@pytest.mark.parametrize("spacing", [0.05, 0.7])
def test_density_is_the_sum_over_what_is_not_covered(spacing):
    """Whether the mesh is fine or coarse."""
    sheet, none = mesh(spacing), slab("")
    z = fluid(sheet, "x")[:, 2]
    gamma = np.array([1 - covered(min(d, 0.15), 0.15) for d in z])
    assert gamma.min() < 0.7
    np.testing.assert_allclose(fluid(sheet, "rho"), fluid(none, "rho") / gamma, rtol=1e-6)


@pytest.mark.parametrize("spacing", [0.05, 0.2])
def test_forces_are_the_gradient_of_the_energy(spacing):
    """On a particle near the sheet and on a vertex under the water, by finite differences."""
    lmp = mesh(spacing, mass=0.15)
    lmp.command("pair_coeff 1 1 fluid 1000.0 c0 20 nu 0")
    lmp.commands_string("thermo_style custom pe\nrun 0")
    x, kind, f = by_id(lmp, "x"), by_id(lmp, "type"), by_id(lmp, "f")
    particle = np.flatnonzero((kind == 1) & (x[:, 2] < 0.03) & (abs(x[:, :2]).max(axis=1) < 0.2))[0]
    vertex = np.flatnonzero((kind == 2) & (abs(x[:, :2] - 0.01).max(axis=1) < 0.12))[0]
    lmp.command("fix_modify sheet energy no")
    h = 1e-6

    def energy(atom, axis, by):
        shift = ["0", "0", "0"]
        shift[axis] = str(by)
        lmp.commands_string(
            f"group one id {atom + 1}\ndisplace_atoms one move {' '.join(shift)} units box\n"
            "run 0\ngroup one delete"
        )
        return lmp.get_thermo("pe")

    for atom in (particle, vertex):
        for axis in range(3):
            up = energy(atom, axis, h)
            down = energy(atom, axis, -2 * h)
            energy(atom, axis, h)
            slope = (up - down) / (2 * h)
            assert f[atom][axis] == pytest.approx(-slope, abs=1e-4 * np.abs(f).max())
        assert np.abs(f[atom][2]) > 1e-2 * np.abs(f).max()


@pytest.mark.parametrize("obstacle", [False, True])
def test_minimize_feels_a_mesh(obstacle):
    """The energy falls, over several neighbor lists; it and forces end as those of a run."""
    plate = "fix contact fluid cloth/contact 1e-3 sides no wall yes obstacle cloth"
    wall = plate if obstacle else MESH.format(pin="")
    lmp = slab(wall, SHEET.format(spacing=0.1, areal=2.0))
    lmp.commands_string("velocity all set 0 0 0\nthermo_style custom pe\nrun 0")
    x, before = by_id(lmp, "x"), lmp.get_thermo("pe")
    lmp.command("minimize 0 0 20 60")
    found, forces = lmp.get_thermo("pe"), by_id(lmp, "f")
    assert found < 0.1 * before
    assert np.abs(by_id(lmp, "x") - x).max() > 0.03
    assert np.abs(forces[by_id(lmp, "type") == 2]).max() > 1e-2 * np.abs(forces).max()
    lmp.command("run 0")
    assert lmp.get_thermo("pe") == pytest.approx(found, rel=1e-12)
    np.testing.assert_allclose(by_id(lmp, "f"), forces, rtol=0, atol=1e-12 * np.abs(forces).max())


@pytest.mark.parametrize("moves", ["fluid", "cloth"])
def test_an_integrated_density_follows_the_way(moves):
    """A particle without pressure and a mesh approach: the density rises by what is covered."""
    change, speed = {}, -2 if moves == "fluid" else 2
    for density in ("summation", "continuity"):
        lmp = mesh(density=density, pin="")
        one = "group rest subtract fluid one\ndelete_atoms group rest compress no\n"
        lmp.commands_string(
            "group one id 1\n"
            + one
            + "pair_coeff 1 1 fluid 1000.0 c0 1e-3\nset group one x 0.03 y 0.04 z 0.12\n"
            + f"velocity all set 0 0 0\nvelocity {moves} set 0 0 {speed} units box\n"
            + "run 0"
        )
        before = fluid(lmp, "rho")[0]
        lmp.command("run 400")
        change[density] = fluid(lmp, "rho")[0] / before
    assert change["summation"] > 1.15
    assert change["continuity"] == pytest.approx(change["summation"], rel=1e-4)


@pytest.mark.parametrize("newton", ["on", "off"])
def test_what_the_mesh_gets_is_the_opposite(newton):
    """Forces and torques of water and sheet add up to nothing."""
    lmp = instance()
    script = SLAB.format(
        wall=MESH.format(pin=""),
        sheet=SHEET.format(spacing=0.2, areal=2.0),
        density="summation",
        scheme="constant",
        steps=0,
        mass=0.13,
    )
    lmp.commands_string(f"newton {newton}\n" + script)
    x, f = by_id(lmp, "x"), by_id(lmp, "f")
    on_sheet = f[by_id(lmp, "type") == 2]
    assert on_sheet[:, 2].sum() < -100
    assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()
    # friction acts between the particle and its foot, at some distance: only pressure is central
    torque = np.cross(x, f).sum(axis=0)
    assert np.abs(torque[2]) < 1e-2 * np.abs(np.cross(x, f)).sum()


def test_what_is_filled_ends_at_the_border():
    """One particle above the sheet, which ends at 0.7, and beyond."""
    support, z = 0.15, 0.02

    def rho(x, z=z):
        lmp = mesh()
        lmp.commands_string(f"group one id 1\nset group one x {x} y 0 z {z}\nrun 0")
        return by_id(lmp, "rho")[0]

    alone = rho(0.9, 0.5)
    for x in (0.5, 0.58, 0.66, 0.69):
        seen = covered(min(0.7 - x, support), support)
        gamma = 1 - covered(z, support) * (1 - seen)
        assert rho(x) == pytest.approx(alone / gamma, rel=1e-6), x
    for x, z in ((0.71, 0.02), (0.72, 0.0), (0.86, 0.02)):
        assert rho(x, z) == alone, (x, z)


# Water all around the border of a sheet, between two layers of particles, and the same without.
HEM = SLAB.replace("-0.3 0.3 -0.3 0.3 0 0.3 units", "-0.3 0.3 -0.3 0.3 -0.3 0.3 units").replace(
    "displace_atoms all random 0.01 0.01 0.01 5 units box", ""
)
HALF = "create_cloth 2 2.0 center -0.4 0 0 size 0.8 1.4 spacing 0.1 pattern square group cloth"


def hem(sheet="", wall="", moved=0.0, right=0.3):
    lmp = instance()
    lmp.commands_string(
        HEM.replace("-0.3 0.3 -0.3 0.3 -0.3", f"-0.3 {right} -0.3 0.3 -0.3").format(
            wall=wall,
            sheet=sheet,
            density="summation",
            scheme="constant",
            steps=0,
            mass=0.13,
        )
    )
    if moved:
        lmp.commands_string(f"displace_atoms cloth move {moved} 0 0 units box\nrun 0")
    return lmp


@pytest.mark.parametrize("moved", [-0.02, 0.0, 0.01, 0.04])
def test_water_around_a_border_has_the_density_of_water(moved):
    """What is hidden is filled, and no more: but for the grid of the lattice."""
    fixes = MESH.format(pin="pin cloth").replace("sides no", "sides yes")
    sheet, none = hem(HALF, fixes, moved), hem()
    x = fluid(sheet, "x")
    change = fluid(sheet, "rho") / fluid(none, "rho") - 1
    inner = np.abs(x[:, 1:]).max(axis=1) < 0.1
    far, near = inner & (np.abs(x[:, 0] + 0.2) < 0.03), inner & (np.abs(x[:, 0] - moved) < 0.1)
    assert 1e-3 < np.abs(change[far]).max() < 0.03
    assert np.abs(change[near]).max() < 0.06


def test_a_border_at_a_plane_wall():
    """Water in the corner has the density that it has at the wall without the sheet."""
    walls = "fix side fluid wall/sph xhi 0"
    fixes = MESH.format(pin="pin cloth").replace("sides no", "sides yes")
    sheet, none = hem(HALF, fixes + "\n" + walls, right=0), hem(wall=walls, right=0)
    x = fluid(sheet, "x")
    near = (np.abs(x[:, 1:]).max(axis=1) < 0.1) & (np.abs(x[:, 0] + 0.05) < 0.03)
    assert near.sum() > 8
    change = fluid(sheet, "rho") / fluid(none, "rho") - 1
    assert np.abs(change[near]).max() < 0.06


def test_a_mesh_behind_another_one_is_not_counted_again():
    """Two sheets, one right under the other: the water sees the upper one only."""
    sheet = SHEET.format(spacing=0.1, areal=2.0)
    below = sheet.replace("spacing 0.1", "spacing 0.1 center 0 0 -0.02").replace("cloth", "under")
    below = below.replace("create_under", "create_cloth")
    fixes = MESH.format(pin="pin cloth")
    one = mesh()
    both = slab(
        "fix low under pbd/cloth pin under\n" + fixes.replace("cloth/contact", "cloth/contact"),
        sheet + "\n" + below,
    )
    np.testing.assert_allclose(fluid(both, "rho"), fluid(one, "rho"), rtol=1e-12)


def test_light_wet_cloth_shortens_the_step():
    light, heavy = (mesh(areal=a, pin="", scheme="global max 1", steps=20) for a in (0.01, 1e3))
    assert light.extract_fix("step", 0, 0) < 0.3 * heavy.extract_fix("step", 0, 0)


def test_a_mesh_that_comes_near_shortens_the_step():
    """By the speed of each foot on the sheet, which turns, towards the particle above it."""
    support, relative = 0.15, 0.2
    off = "velocity 0 force 0 acoustic 0 viscous 0 density 0"
    lmp = mesh(pin="", scheme=f"global {off} max 1e3 relative {relative}")
    lmp.commands_string("velocity cloth ramp vz -6 12 x -0.7 0.7 units box\nrun 0")
    kind, x, v = (by_id(lmp, name) for name in ("type", "x", "v"))
    water, sheet = kind == 1, kind == 2
    x, v, slope = x[water], v[water], np.ptp(v[sheet, 2]) / np.ptp(x[sheet, 0])
    apart = x[:, None] - x[None]
    r = np.linalg.norm(apart, axis=2) + np.diag(np.full(len(x), np.inf))
    closing = -((v[:, None] - v[None]) * apart).sum(axis=2) / r
    of_water = np.where(r < support, closing, 0).max(axis=1)
    of_sheet = np.where(x[:, 2] < support, 3 + slope * x[:, 0] - v[:, 2], 0)
    assert (of_sheet > of_water).sum() > 100 and (of_sheet < 0).sum() > 10
    expected = relative * support / np.maximum(of_water, of_sheet)
    np.testing.assert_allclose(own_steps(lmp)[water], expected, rtol=1e-9)
    assert lmp.extract_fix("step", 0, 0) == pytest.approx(expected.min(), rel=1e-9)


def test_momentum_of_a_free_sheet():
    lmp = instance()
    lmp.commands_string(
        FREE_SHEET.replace("pbd/cloth", "pbd/cloth solver gs")
        .replace("3 3 boundary", "3 3 none")
        .replace("cloth/contact 0.03", "cloth/contact 0.03 wall yes\ncomm_modify cutoff 0.3")
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
        ("wall maybe", "wall is 'maybe': use no or yes"),
        ("wall yes", "vertex .* is of type 2, a boundary type.*pair_coeff 2 2 none"),
    ],
)
def test_errors(wall, words):
    script = SLAB.format(
        wall=MESH.format(pin="pin cloth").replace("wall yes", wall),
        sheet=SHEET.format(spacing=0.2, areal=2.0),
        density="summation",
        scheme="constant",
        steps=0,
        mass=0.13,
    )
    with pytest.raises(Exception, match=words):
        instance().commands_string(script.replace("pair_coeff 2 2 none", "pair_coeff 2 2 boundary"))


def two_waters(scheme):
    """Coarse water on a sheet, and elsewhere finer water, whose steps are shorter."""
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-0.6 0.6 -0.6 0.6 -0.5 1.2", 3)
        + sheet(2, 0.2, "0.9 0.9", 0.1)
        + "region rim block -0.44 0.44 -0.44 0.44 INF INF side out units box\n"
        + "group rim region rim\ngroup pins intersect rim cloth\n"
        + lattice()
        + filled("pool", "-0.3 0.3 -0.3 0.3 0 0.2")
        + lattice(0.0125)
        + filled("fine", "-0.05 0.05 -0.05 0.05 -0.443 -0.4", 3)
        + f"mass 1 0.125\nmass 2 1\nmass 3 {1.02 * 1000 * 0.0125**3}\ngroup fluid type 1 3\n"
        + sph_tait(
            "1 1 fluid 1000 c0 20", "3 3 fluid 1000 c0 20 support 0.025", "2 2 none", support=0.1
        )
        + cloth_styles()
        + neighbor(0.03, cutoff=1.2)
        + gravity()
        + """timestep 4e-3
        fix walls all wall/sph xlo -0.35 xhi 0.35 ylo -0.35 yhi 0.35 zlo -0.45
        fix step fluid sph/integrate global gain 1 velocity 0 force 0 acoustic 0.5
        fix sheet cloth pbd/cloth pin pins
        fix contact fluid cloth/contact 0.025 wall yes
        """
        + f"run_style sph/adaptive {scheme}\nrun 0 post no"
    )
    return lmp


def test_a_wet_vertex_keeps_its_limit_while_the_water_beside_it_is_inactive():
    lmp = two_waters("block")
    place = by_id(lmp, "x")
    wet = (by_id(lmp, "type") == 2) & (np.abs(place[:, :2]).max(axis=1) < 0.2)
    active = []
    for _ in range(12):
        assert np.all(own_steps(lmp)[wet] <= 0.5 * 0.05 / 20 * (1 + 1e-9))
        active.append(lmp.extract_fix("step", 0, 1, 1))
        lmp.command("run 1 pre no post no")
    lmp.close()
    assert min(active) < 0.8


def test_water_presses_on_a_mesh_while_it_is_inactive():
    """With individual steps; compared with an evaluation of all particles in the same places."""
    lmp = two_waters("individual")
    vertex = by_id(lmp, "type") == 2
    while lmp.extract_fix("step", 0, 1, 1) > 0.2:
        lmp.command("run 1 post no")
    found = by_id(lmp, "f")[vertex, 2].sum()
    lmp.command("run_style sph/adaptive global")
    lmp.command("run 0 post no")
    expected = by_id(lmp, "f")[vertex, 2].sum()
    lmp.close()
    assert expected < -1000
    assert abs(found / expected - 1) < 0.1
