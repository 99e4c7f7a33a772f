"""fix wall/sph against quadrature of the kernel, invariants, and exact flows."""

import math
from itertools import pairwise

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, filled, header, jitter, lattice, neighbor, sph_tait
from scenes import box as a_box
from wall_scenes import C0, GAMMA, KERNELS, RHO0, H, channel

NU = 1e-2


def behind(kernel, dim, delta, term):
    """Integral of ``term(q, z)`` over the half-space z > delta, in units of H, by Gauss's rule.

    Spherical shells around the particle, from one kink of the kernel to the next.
    """
    nodes, weights = np.polynomial.legendre.leggauss(80)
    kinks = [max(delta, q) for q in KERNELS[kernel][3]]
    total = 0.0
    for low, high in pairwise(kinks):
        # q = low + (high-low) s^2 takes away the root at q = delta
        s = 0.5 * (nodes + 1)
        q = low + (high - low) * s**2
        dq = (high - low) * s * weights
        for qi, dqi in zip(q, dq, strict=True):
            half = math.acos(min(1.0, delta / qi))  # the cap reaches to this angle
            angle = 0.5 * half * (nodes + 1)
            area = 2 * qi if dim == 2 else 2 * math.pi * qi**2 * np.sin(angle)
            total += dqi * np.sum(0.5 * half * weights * area * term(qi, qi * np.cos(angle)))
    return total


def half_space(kernel, dim, d):
    """Lambda, its slope over the distance, and the integral of Morris's term, friction."""
    norm, shape, slope, _ = KERNELS[kernel]
    c, delta = norm[dim], d / H
    lam = behind(kernel, dim, delta, lambda q, z: c * shape(q) * np.ones_like(z))
    push = behind(kernel, dim, delta, lambda q, z: c * slope(q) * z) / H
    drag = behind(kernel, dim, delta, lambda q, z: -c * slope(q) * (1 + (z - delta) / delta))
    return lam, push, drag / H**2


def tait(rho):
    return C0**2 * RHO0 / GAMMA * ((rho / RHO0) ** GAMMA - 1)


def particle(place, wall, dim=3, setting="", velocity="0 0 0", mass=None, more="run 0", **box):
    """One fluid particle beside walls in a box from -1 to 1 with fixed faces."""
    boundary = box.get("boundary", "f f f" if dim == 3 else "f f p")
    mass = mass or 1.5 * RHO0 * (H / 2) ** dim
    depth = "-1 1" if dim == 3 else "-0.05 0.05"
    lmp = instance()
    lmp.commands_string(
        header(boundary, FLUID, units=box.get("units", "si"), dimension=dim)
        + a_box(f"-1 1 -1 1 {depth}")
        + f"""
        mass 1 {mass}
        create_atoms 1 single {place} units box
        set type 1 vx {velocity.split()[0]} vy {velocity.split()[1]} vz {velocity.split()[2]}
        """
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0} nu {NU}", support=H, options=setting)
        + neighbor(0.02)
        + f"thermo_modify norm no\nfix wall all wall/sph {wall}\n{more}\n"
    )
    return lmp


def place_at(face, d, dim):
    """Coordinates of a particle at distance d from a wall at 0.2, and the direction off the wall"""
    axis, sign = "xyz".index(face[0]), 1 if face[1:] == "lo" else -1
    x = np.zeros(3)
    x[axis] = 0.2 + sign * d
    return " ".join(map(str, x)), axis, sign


# ---------------------------------------------------------------------- one particle


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("d", [0.014, 0.043, 0.055, 0.09])
def test_density_force_and_friction_against_quadrature(kernel, dim, d):
    u = [0.3, -0.2, 0.1 if dim == 3 else 0.0]
    for face in ("xlo", "xhi", "ylo", "yhi", "zlo", "zhi")[: 2 * dim]:
        place, axis, sign = place_at(face, d, dim)
        velocity = " ".join(map(str, u))
        setting = f"kernel {kernel} tension yes"
        lmp = particle(place, f"{face} 0.2", dim, setting, velocity)
        norm, shape, _, _ = KERNELS[kernel]
        mass = 1.5 * RHO0 * (H / 2) ** dim
        lam, slope, drag = half_space(kernel, dim, d)
        rho = mass * norm[dim] / H**dim * float(shape(np.float64(0.0))) + RHO0 * lam
        force = -mass * 2 * NU * RHO0 / rho * drag * np.array(u)
        force[axis] = -sign * mass * tait(rho) / rho**2 * RHO0 * slope
        np.testing.assert_allclose(by_id(lmp, "rho"), rho, rtol=1e-9)
        np.testing.assert_allclose(by_id(lmp, "f")[0], force, rtol=1e-6)
        np.testing.assert_allclose(by_id(lmp, "drho"), RHO0 * slope * sign * u[axis], rtol=1e-6)
        reaction = [lmp.extract_fix("wall", 0, 1, k) for k in range(3)]
        np.testing.assert_allclose(reaction, -by_id(lmp, "f")[0], rtol=1e-14)


def test_out_of_reach_and_in_the_plane():
    far = particle("0.2 0 0", "xlo 0.1")
    assert np.all(by_id(far, "f") == 0)
    alone = by_id(far, "rho")[0]
    plane = particle("0.1 0 0", "xlo 0.1")
    assert by_id(plane, "rho")[0] == pytest.approx(alone + 0.5 * RHO0, rel=1e-13)
    behind_it = particle("0.06 0 0", "xlo 0.1")
    mirror = particle("0.14 0 0", "xlo 0.1")
    both = by_id(behind_it, "rho")[0] + by_id(mirror, "rho")[0]
    assert both == pytest.approx(2 * alone + RHO0, rel=1e-13)
    assert by_id(behind_it, "f")[0, 0] > by_id(mirror, "f")[0, 0]


@pytest.mark.parametrize(("dx", "dy"), [(0.0, 0.0), (0.02, 0.05), (0.05, 0.05), (0.04, 0.11)])
def test_edge_of_two_walls(dx, dy):
    """The product of two walls against the exact three quadrants behind them."""
    lmp = particle(f"{dx} {dy} 0", "xlo 0 ylo 0", dim=2)
    norm, shape, _, _ = KERNELS["wendland/c2"]
    n = 800
    x = (np.arange(n) + 0.5) / n * 2 - 1
    q = np.hypot(x[:, None], x[None])
    outside = (x[:, None] * H < -dx) | (x[None] * H < -dy)
    exact = norm[2] * np.sum(np.where((q < 1) & outside, shape(np.minimum(q, 1)), 0)) * (2 / n) ** 2
    own = 1.5 / 4 * RHO0 * norm[2]
    assert (by_id(lmp, "rho")[0] - own) / RHO0 == pytest.approx(exact, abs=1.5e-3)


def test_units_are_those_of_the_script():
    si = particle("0.03 0 0", "xlo 0", velocity="-0.1 0.2 0")
    real = particle("0.03 0 0", "xlo 0", velocity="-0.1 0.2 0", units="real")
    ftm2v = 4184e-7  # (kcal/mol/Angstrom)/(g/mol) in Angstrom/fs^2
    np.testing.assert_allclose(by_id(real, "f") * ftm2v, by_id(si, "f"), rtol=2e-4)


def test_only_the_group_meets_the_wall():
    more = "group vacant empty\nunfix wall\nfix wall vacant wall/sph xlo 0\nrun 0"
    lmp = particle("0.03 0 0", "xlo 0", more=more)
    assert np.all(by_id(lmp, "f") == 0)


def test_slip_and_the_speed_of_the_wall():
    at = {"place": "0.03 0 0", "velocity": "0 0.2 0.1"}
    assert np.all(by_id(particle(wall="xlo 0 slip yes", **at), "f")[0, 1:] == 0)
    rest = by_id(particle(wall="xlo 0", **at), "f")[0]
    moving = particle("0.03 0 0", "xlo 0 velocity xlo 0 -0.2 -0.1")
    np.testing.assert_allclose(by_id(moving, "f")[0], rest, rtol=1e-13)
    along = particle(wall="xlo 0 velocity xlo 0 0.2 0.1", **at)
    assert np.all(by_id(along, "f")[0, 1:] == 0)


def test_an_inactive_particle_is_left_alone():
    more = "fix step all sph/integrate constant\ntimestep 1e-5\nrun 0"
    lmp = particle("0.03 0 0", "xlo 0", more=more, velocity="-1 0 0")
    before = by_id(lmp, "rho")[0]
    lmp.numpy.extract_fix("step", 1, 2)[0, 2] = 0.0
    lmp.command("run 5 pre no")
    assert by_id(lmp, "rho")[0] == before


@pytest.mark.parametrize("walls", ["xlo 0", "xlo 0 ylo 0", "xlo 0 ylo 0 zlo 0"])
def test_what_several_walls_fill_is_counted_once(walls):
    """A lattice half a spacing from its walls is too dense, but not because of the corner."""
    spacing, n = H / 2, len(walls.split()) // 2
    norm, shape, *_ = KERNELS["wendland/c2"]
    lattice = np.stack(np.meshgrid(*[spacing * np.arange(-2, 3)] * 3), -1).reshape(-1, 3)
    at = norm[3] / H**3 * shape(np.minimum(1, np.linalg.norm(lattice, axis=1) / H))
    seen = at[(lattice[:, :n] >= 0).all(axis=1)].sum() / at.sum()
    lmp = particle(
        "0.525 0.525 0.525",
        walls,
        mass=RHO0 / at.sum(),
        more=f"""
        lattice sc {spacing} origin 0.5 0.5 0.5
        region water block 0 0.3 0 0.3 0 0.3 units box
        create_atoms 1 region water
        set atom 1 x 0.9 y 0.9 z 0.9
        run 0""",
    )
    where = [0.025 if d < n else 0.125 for d in range(3)]
    here = np.linalg.norm(by_id(lmp, "x") - where, axis=1).argmin()
    joint = 1 - (1 - half_space("wendland/c2", 3, spacing / 2)[0]) ** n
    assert by_id(lmp, "rho")[here] == pytest.approx(RHO0 * (seen + joint), rel=1e-6)
    # the integral of the kernel over what is behind the planes
    m = 160
    cells = [
        np.linspace(-0.25 if d < n else -1, 1, m, endpoint=False) + (1.25 if d < n else 2) / m / 2
        for d in range(3)
    ]
    q = np.sqrt(sum(c**2 for c in np.meshgrid(*cells, indexing="ij", sparse=True)))
    inside = norm[3] * shape(np.minimum(1, q)).sum() * 1.25**n * 2 ** (3 - n) / m**3
    assert -1e-4 < 1 - inside - joint < 3.2e-3


# ---------------------------------------------------------------------- moving walls


def test_drho_is_the_rate_of_the_density():
    """A particle that flies beside a wall that a variable moves, and one beside a wall at rest."""
    dt = 1e-6
    for wall in ("xhi v_place", "xhi 0.1"):
        moves = "variable place equal 0.1-3.0*time\nfix fly all nve/noforce\n"
        more = f"timestep {dt}\n{moves}run 1"
        lmp = particle("0.06 0 0", wall, velocity="0.8 0 0", more=more)
        rho = [by_id(lmp, "rho")[0]]
        lmp.command("run 1")
        drho = by_id(lmp, "drho")[0]
        lmp.command("run 1")
        rho.append(by_id(lmp, "rho")[0])
        assert drho == pytest.approx((rho[1] - rho[0]) / (2 * dt), rel=1e-4)
        assert drho > 0


def test_piston():
    """A slow piston compresses by 4 %: both walls carry the pressure that the fluid has."""
    lmp, lx, ly = channel(
        "ylo 0 yhi v_place slip yes",
        alpha=1.0,
        size=(8, 40),
        extra="""
        variable place equal v_ly*(1-0.04*ramp(0,1)^2*(3-2*ramp(0,1)))
        timestep 2e-4
        fix step all sph/integrate constant
        run 4000
        variable place equal v_ly*0.96
        fix mean all ave/time 1 2000 2000 f_wall[2] f_wall[5]
        run 4000""",
    )
    bottom, top = (lmp.extract_fix("mean", 0, 1, k) / lx for k in range(2))
    y, rho = by_id(lmp, "x")[:, 1], by_id(lmp, "rho")
    inside = (y > H) & (y < 0.96 * ly - H)
    assert tait(rho[inside]).mean() > 0.5 * C0**2 * RHO0 * 0.04
    assert top == pytest.approx(-bottom, rel=5e-3)
    assert top == pytest.approx(tait(rho[inside]).mean(), rel=2e-2)


def test_work_of_a_piston():
    """What the piston gives is what the fluid's energy gains (no viscosity)."""
    lmp, _, ly = channel(
        "ylo 0 yhi v_place slip yes",
        size=(8, 9),
        extra="""
        variable place equal v_ly*(1-0.5*time)
        thermo_style custom step pe ke etotal
        fix_modify wall energy yes
        timestep 5e-5
        fix move all nve
        run 0 post no""",
    )
    energy, force = [lmp.get_thermo("etotal")], [lmp.extract_fix("wall", 0, 1, 4)]
    for _ in range(400):
        lmp.command("run 1 pre no post no")
        force.append(lmp.extract_fix("wall", 0, 1, 4))
        energy.append(lmp.get_thermo("etotal"))
    path = -ly * 0.5 * 5e-5
    work = -path * np.sum(0.5 * (np.array(force[1:]) + force[:-1]))
    assert work > energy[0]
    assert energy[-1] - energy[0] == pytest.approx(work, rel=2e-3)


# ---------------------------------------------------------------------- invariants

SHAKEN = (
    header("f f f", FLUID)
    + a_box("-0.1 0.5 -0.1 0.5 -0.1 0.6")
    + "mass 1 0.125\n"
    + lattice()
    + filled("water", "0 0.4 0 0.4 0 0.4")
    + jitter(0.01, 77)
    + "velocity all set 1 -2 -1 units box\n"
    + sph_tait(f"1 1 fluid {RHO0} c0 {C0} nu {NU} alpha 0.1", support=H)
    + neighbor(0.03)
    + """timestep 1e-3
variable lid equal 0.45-0.4*time
fix wall all wall/sph xlo 0 xhi 0.4 ylo 0 yhi 0.4 zlo 0 zhi v_lid velocity zlo 1 0.5 0
fix step all sph/integrate global
thermo_modify norm no
"""
)


def test_the_walls_get_what_the_fluid_gives():
    lmp = instance()
    lmp.commands_string(SHAKEN + "run 40")
    on_fluid = by_id(lmp, "f").sum(axis=0)
    on_walls = np.array([lmp.extract_fix("wall", 0, 1, k) for k in range(18)]).reshape(6, 3)
    np.testing.assert_allclose(on_walls.sum(axis=0), -on_fluid, rtol=1e-10)
    assert np.abs(on_walls).min(axis=0).max() > 0  # every wall is touched in every direction
    # each wall is pushed out of the fluid
    outwards = on_walls[np.arange(6), np.arange(6) // 2] * [-1, 1, -1, 1, -1, 1]
    assert np.all(outwards > 0)


def bounce(dt):
    """Largest change of the energy while a block of 2-D water falls on the wall and bounces."""
    lmp = instance()
    lmp.commands_string(
        header("p f p", FLUID, dimension=2)
        + a_box("-1 1 -0.2 1 -0.05 0.05")
        + "lattice sq 0.05 origin 0.5 0.27 0\n"
        + filled("drop", "-0.1 0.1 0.1 0.3 INF INF")
        + "mass 1 2.1\n"
        + jitter(0.01, 77, dimension=2)
        + "velocity all set 0 -3 0 units box\n"
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0}", support=H, options="tension yes")
        + neighbor(0.03)
        + f"""
        fix move all nve
        fix wall all wall/sph ylo 0
        fix_modify wall energy yes
        thermo_modify norm no
        thermo_style custom step pe ke etotal
        timestep {dt}
        run 0"""
    )
    energy, force = [lmp.get_thermo("etotal")], 0.0
    for _ in range(40):
        lmp.command(f"run {round(1e-3 / dt)} post no")
        energy.append(lmp.get_thermo("etotal"))
        force = min(force, lmp.extract_fix("wall", 0, 1, 1))
    assert force < -1e3  # it did meet the wall
    return np.abs(np.array(energy) - energy[0]).max() / energy[0]


def test_energy_is_kept_to_second_order():
    coarse, fine = bounce(2e-4), bounce(1e-4)
    assert coarse < 1e-2
    assert coarse / fine == pytest.approx(4.0, abs=1.0)


def test_virial_is_the_derivative_of_the_energy():
    """The box shrinks in y with its content and the walls at its edges; pressure along y."""
    lmp, lx, ly = channel("ylo EDGE yhi EDGE slip yes", size=(8, 9))
    dx = H / 3
    lmp.commands_string(f"""
        mass 1 {1.1 * RHO0 * dx**2}
        change_box all y final -0.003 {ly} units box
        displace_atoms all random {0.2 * dx} {0.1 * dx} 0 5 units box
        fix_modify wall virial yes
        velocity all set 0 0 0
        thermo_style custom pe pyy
        run 0""")
    pressure, size, energy = lmp.get_thermo("pyy"), 1e-5, []
    for scale in (1 + size, (1 - size) / (1 + size)):
        lmp.command(f"change_box all y scale {scale} remap")
        lmp.command("run 0")
        energy.append(lmp.get_thermo("pe"))
    area = lx * (ly + 0.003)
    assert pressure == pytest.approx(-(energy[0] - energy[1]) / (2 * size * area), rel=1e-4)
    lmp.command("fix_modify wall virial no")
    lmp.command("run 0")
    assert lmp.get_thermo("pyy") < 0.97 * pressure


# ---------------------------------------------------------------------- nothing passes


@pytest.mark.parametrize("ratio", [2.0, 3.0])
@pytest.mark.parametrize("speed", [0.1, 0.5, 0.95])
@pytest.mark.parametrize("what", ["region drop", "single 0 0.1 0.3 units box"])
def test_what_is_slower_than_sound_is_turned_back(what, speed, ratio):
    """A drop, and a lone particle, whose own density would not stop it."""
    dx = H / ratio
    lmp = instance()
    lmp.commands_string(
        header("f f f", FLUID)
        + a_box("-4 4 -4 4 -0.3 4")
        + f"mass 1 {RHO0 * dx**3}\nlattice sc {dx} origin 0.31 0.12 0.17\n"
        + f"region drop sphere 0 0 0.2 0.1 units box\ncreate_atoms 1 {what}\n"
        + f"velocity all set 0 0 {-speed * C0} units box\n"
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0}", support=H)
        + neighbor(0.03)
        + "timestep 1e-3\nfix step all sph/integrate global\n"
        + "fix wall all wall/sph zlo 0\nrun 0 post no\n"
    )
    lowest, start = math.inf, lmp.get_natoms()
    for _ in range(round(20 + 40 / speed)):
        lmp.command("run 1 pre no post no")
        lowest = min(lowest, by_id(lmp, "x")[:, 2].min())
    assert lmp.get_natoms() == start
    # what is pushed from behind gets deeper than its own speed carries it
    assert -H * (0.5 if speed < 0.9 else 1.0) < lowest < 0.5 * H
    assert by_id(lmp, "v")[:, 2].mean() > 0


def test_a_particle_far_behind_the_wall_is_an_error():
    with pytest.raises(Exception, match=r"fix wall wall/sph: particle 1 is behind the wall xlo"):
        particle("-0.11 0 0", "xlo 0")


# ---------------------------------------------------------------------- errors

BOX = (
    header("{boundary}", FLUID, dimension="{dim}")
    + "region box {box}\ncreate_box 1 box\nmass 1 0.1\n"
    + sph_tait("1 1 fluid 1000 c0 20", support=H)
)


def box(dim=3, boundary="f f f", box="block -1 1 -1 1 -1 1"):
    if dim == 2:
        boundary, box = "f f p", "block -1 1 -1 1 -0.05 0.05"
    return BOX.format(dim=dim, boundary=boundary, box=box)


WALL = "fix wall all wall/sph "
PRISM = "prism -1 1 -1 1 -1 1 "
ERRORS = {
    "no face": (box() + WALL, r"fix wall wall/sph: face is missing"),
    "no such face": (box() + WALL + "left 0", r"face is 'left'.*xlo, xhi"),
    "face twice": (box() + WALL + "xlo 0 xlo 0.5", r"face is 'xlo': give each face once"),
    "no position": (box() + WALL + "xlo", r"position of xlo is missing"),
    "position": (box() + WALL + "xlo edge", r"position of xlo is 'edge': give a finite number"),
    "z in 2-D": (box(2) + WALL + "ylo 0 zlo 0", r"face is 'zlo'.*2-D"),
    "keyword": (
        box() + WALL + "xlo 0 friction 3",
        r"unknown keyword 'friction'.*slip, pressure, velocity",
    ),
    "face behind a keyword": (box() + WALL + "xlo 0 slip no ylo 0", r"'ylo'.*before the keywords"),
    "slip": (box() + WALL + "xlo 0 slip half", r"slip is 'half': use yes or no"),
    "velocity of no wall": (box() + WALL + "xlo 0 velocity ylo 1 0 0", r"'ylo'.*face with a wall"),
    "velocity short": (box() + WALL + "xlo 0 velocity xlo 0 1", r"velocity of xlo is missing"),
    "velocity across": (
        box() + WALL + "xlo 0 velocity xlo 1 0 0",
        r"across the wall is '1.*give 0",
    ),
    "velocity in z": (box(2) + WALL + "xlo 0 velocity xlo 0 0 1", r"in z is '1.*2-D"),
    "no variable": (
        box() + WALL + "xlo v_place\nrun 0",
        r"'v_place': define an equal-style variable",
    ),
    "variable style": (
        box() + "variable place atom x\n" + WALL + "xlo v_place\nrun 0",
        r"'v_place': define an equal-style variable",
    ),
    "variable not finite": (
        box() + "variable place equal exp(1e9)\n" + WALL + "xlo v_place\nrun 0",
        r"position of xlo is 'inf'.*correct variable place",
    ),
    "periodic": (
        box(boundary="p f f") + WALL + "xlo 0\nrun 0",
        r"xlo is a wall across a periodic dimension.*boundary f",
    ),
    "shrink-wrapped edge": (
        box(boundary="f s f") + WALL + "ylo EDGE\nrun 0",
        r"'EDGE', which follows the particles.*boundary f",
    ),
    "no pair style": (
        box().replace("sph/tait 0.1", "zero 0.1").replace("fluid 1000 c0 20", "")
        + WALL
        + "xlo 0\nrun 0",
        r"pair_style zero has no density.*sph/tait",
    ),
    "second fix": (
        box() + WALL + "xlo 0\nfix more all wall/sph ylo 0\nrun 0",
        r"another fix wall/sph: give all faces to one",
    ),
    "tilted x": (
        box(boundary="f p p", box=PRISM + "0.2 0 0") + WALL + "xlo 0\nrun 0",
        r"face of the box at xlo is tilted.*0",
    ),
    "tilted y": (
        box(boundary="p f p", box=PRISM + "0 0 0.2") + WALL + "yhi 0\nrun 0",
        r"face of the box at yhi is tilted",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors(name):
    script, message = ERRORS[name]
    lmp = instance()
    with pytest.raises(Exception, match=message):
        lmp.commands_string(script)


def test_a_box_that_is_tilted_along_the_wall_is_fine():
    lmp = instance()
    # z faces stay level, x and y are periodic and slanted
    lmp.commands_string(box(boundary="p p f", box=PRISM + "0.3 0 0") + WALL + "zlo 0\nrun 0")
