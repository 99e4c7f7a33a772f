"""What hits a plane wall: the artificial viscosity across it, and no energy from nothing."""

import math

import numpy as np
import pytest
from harness import by_id, instance
from scenes import FLUID, box, filled, header, lattice, neighbor, sph_tait
from wall_scenes import C0, KERNELS, RHO0, H

ALPHA = 0.1


def at_plane(walls, velocity, alpha=ALPHA, dim=3, kernel="wendland/c2", place="0 0 0"):
    """A lone particle beside plane walls, without friction along them; its force and the rest."""
    mass = RHO0 * (H / 2) ** dim
    lmp = instance()
    lmp.commands_string(
        header("f f f" if dim == 3 else "f f p", FLUID, dimension=dim)
        + box(f"-1 1 -1 1 {'-1 1' if dim == 3 else '-0.05 0.05'}")
        + f"mass 1 {mass}\ncreate_atoms 1 single {place} units box\n"
        + f"velocity all set {velocity} units box\n"
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0} alpha {alpha}", support=H, options=f"kernel {kernel}")
        + neighbor(0.02)
        + f"thermo_modify norm no\nfix wall all wall/sph {walls}\nrun 0\n"
    )
    return lmp, mass


def integral(kernel, dim, delta):
    """Of |F| z^2/(r^2 + 0.01 h_s^2) over the half-space, times H^2, by the midpoint rule."""
    norm, _, slope, _ = KERNELS[kernel]
    z = delta + (1 - delta) * (np.arange(2000) + 0.5) / 2000
    t = (np.arange(1500) + 0.5) / 1500
    z, t = np.meshgrid(z, t, indexing="ij")
    q = np.sqrt(z**2 + t**2)
    inside = q < 1
    ring = 2 * math.pi * t if dim == 3 else 2.0
    terms = -norm[dim] * slope(np.where(inside, q, 0.5)) * z**2 / (q**2 + 0.0025) * ring
    return (terms * inside).sum() * (1 - delta) / 2000 / 1500


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("d", [0.02, 0.05, 0.08])
def test_the_force_on_what_approaches_is_the_integral_over_the_half_space(kernel, dim, d):
    u = 0.7
    lmp, mass = at_plane(f"xlo {-d}", f"{-u} 0.3 0", dim=dim, kernel=kernel)
    rest, _ = at_plane(f"xlo {-d}", "0 0.3 0", dim=dim, kernel=kernel)
    rho = by_id(lmp, "rho")[0]
    rate = ALPHA * C0 * H / 2 * RHO0 / rho * integral(kernel, dim, d / H) / H**2
    force = by_id(lmp, "f")[0] - by_id(rest, "f")[0]
    np.testing.assert_allclose(force, [mass * rate * u, 0, 0], rtol=3e-3, atol=1e-12)
    reaction = [lmp.extract_fix("wall", 0, 1, k) for k in range(3)]
    np.testing.assert_allclose(reaction, -by_id(lmp, "f")[0], rtol=1e-13)


def test_it_is_that_of_layers_of_boundary_particles():
    """As many in the support as the sum needs to be near the integral."""
    d, n = 0.05, 10
    dx = H / n
    lmp = instance()
    lmp.commands_string(
        header("f f f", FLUID)
        + box("-1 1 -1 1 -1 1", 2)
        + f"mass * {RHO0 * (H / 2) ** 3}\n"
        + f"lattice sc {dx} origin 0.5 0.5 0.5\n"
        + filled("behind", f"{-d - H} {-d} {-H} {H} {-H} {H}", kind=2)
        + "create_atoms 1 single 0 0 0 units box\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} alpha {ALPHA}",
            f"2 2 boundary volume {dx**3} pressure own",
            support=H,
        )
        + neighbor(0.02)
        + "set type 1 vx -0.7\nrun 0\n"
    )
    plane, _ = at_plane(f"xlo {-d}", "-0.7 0 0")
    force = [by_id(each, "f")[by_id(each, "type") == 1][0] for each in (lmp, plane)]
    np.testing.assert_allclose(*force, rtol=0.02, atol=0.02 * force[0][0])


@pytest.mark.parametrize("velocity", ["0.7 0 0", "0 0.7 0.7"])
def test_what_leaves_or_slides_along_is_not_slowed(velocity):
    lmp, _ = at_plane("xlo -0.05", velocity)
    inviscid, _ = at_plane("xlo -0.05", velocity, alpha=0)
    np.testing.assert_array_equal(by_id(lmp, "f"), by_id(inviscid, "f"))


def test_a_wall_that_comes_is_approached_by_what_rests():
    walls = "variable at equal -0.05+0.7*time\nfix wall all wall/sph xlo v_at"
    lmp, _ = at_plane("xlo -0.05", "0 0 0")
    lmp.commands_string(f"timestep 1e-6\nunfix wall\n{walls}\nrun 1")
    moving, _ = at_plane("xlo -0.05", "-0.7 0 0")
    np.testing.assert_allclose(by_id(lmp, "f")[0, 0], by_id(moving, "f")[0, 0], rtol=1e-4)


def bounced(speed, phase, density, alpha, dim, floor):
    """Kinetic energy of what leaves a floor over that of what hits it, with the default limits."""
    dx = H / 2
    side = 3 * H
    lmp = instance()
    lmp.commands_string(
        header("p p f" if dim == 3 else "p f p", FLUID, dimension=dim)
        + (
            box(f"-{side} {side} -{side} {side} -0.6 4", 2)
            if dim == 3
            else box(f"-{side} {side} -0.6 4 -0.05 0.05", 2)
        )
        + f"mass 2 1\nlattice {'sc' if dim == 3 else 'sq'} {dx} origin 0.5 0.5 "
        + ("0.5\n" if dim == 3 else "0\n")
        + f"create_atoms 1 single {'0.01 0.02' if dim == 3 else '0.01'} "
        + f"{0.3 + phase * dx} {'0 ' if dim == 2 else ''}units box\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} alpha {alpha} spacing {dx}",
            "2 2 none",
            support=H,
            options=f"density {density}",
        )
        + neighbor(0.03)
        + f"velocity all set 0 {f'0 {-speed}' if dim == 3 else f'{-speed} 0'} units box\n"
        + "timestep 2e-3\nfix step all sph/integrate global\n"
        + f"fix floor all wall/sph {'z' if dim == 3 else 'y'}lo 0 {floor}\n"
        + ("fix flat all enforce2d\n" if dim == 2 else "")
        + "run 0 post no\n"
    )
    up = dim - 1
    for _ in range(400):
        lmp.command("run 5 pre no post no")
        if by_id(lmp, "v")[0, up] > 0 and by_id(lmp, "x")[0, up] > 1.05 * H:
            break
        if lmp.extract_global("atime") > 1.5 / speed:  # it rests on the floor
            break
    return float((by_id(lmp, "v") ** 2).sum() / speed**2)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("density", ["summation", "calibrated"])
@pytest.mark.parametrize("floor", ["pressure own", "pressure mirror"])
def test_a_particle_leaves_a_wall_with_less_than_it_came_with(density, dim, floor):
    """At a hundredth, a twentieth, a fifth and two fifths of the speed of sound."""
    for speed in (0.01, 0.05, 0.2, 0.4):
        left = [bounced(speed * C0, p, density, ALPHA, dim, floor) for p in np.linspace(0, 1, 5)]
        assert max(left) < 1.0, (speed, left)


def test_a_wall_does_not_slow_water_at_rest():
    """The same forces to the last bit as without artificial viscosity."""
    forces = []
    for alpha in (0.0, ALPHA):
        lmp = instance()
        lmp.commands_string(
            header("f f f", FLUID)
            + box("-1 1 -1 1 -1 1")
            + lattice(0.05)
            + filled("water", "0 0.3 0 0.3 0 0.3")
            + sph_tait(f"1 1 fluid {RHO0} c0 {C0} alpha {alpha} spacing 0.05", support=H)
            + neighbor(0.02)
            + "fix wall all wall/sph xlo 0 ylo 0 zlo 0\nrun 0\n"
        )
        forces.append(by_id(lmp, "f"))
    np.testing.assert_array_equal(*forces)
