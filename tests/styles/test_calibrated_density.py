"""pair_style sph/tait ... density calibrated: lattices and walls whose pressure is right."""

import numpy as np
import pytest
from harness import by_id, instance
from reference_sph import C0, RHO0
from scenes import (
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    header,
    jitter,
    lattice,
    neighbor,
    periodic_water,
    sph_tait,
)

DX = 0.05
MASS = RHO0 * DX**3


def periodic(density, dimension=3, kernel="wendland/c2", spacing=DX, coeff=f"spacing {DX}"):
    """A lattice of ``spacing`` with the mass of one of DX, periodic."""
    lmp = instance()
    lmp.commands_string(
        periodic_water(
            spacing, f"{RHO0} c0 {C0} {coeff}", f"kernel {kernel} density {density}", dimension
        )
        + """compute state all sph/atom pressure
compute mean all reduce ave c_state
compute pairs all pressure NULL pair
thermo_style custom step c_mean c_pairs
run 0
"""
    )
    return lmp


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kernel", ["wendland/c2", "wendland/c4", "cubic", "quintic"])
def test_a_lattice_of_mass_per_volume_has_the_rest_density(kernel, dimension):
    lmp = periodic("calibrated", dimension, kernel)
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)
    assert lmp.extract_atom("mass")[1] == pytest.approx(RHO0 * DX**dimension, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_stress_of_a_compressed_lattice_is_the_pressure_of_its_particles(dimension):
    off = {}
    for density in ("summation", "calibrated"):
        lmp = periodic(density, dimension, spacing=0.99 * DX)
        mean, pairs = (lmp.extract_compute(name, 0, 0) for name in ("mean", "pairs"))
        off[density] = pairs / mean - 1
        exact = C0**2 * RHO0 / 7 * (0.99 ** (-7 * dimension) - 1)
        if density == "calibrated":
            assert mean == pytest.approx(exact, rel=0.03)
    assert abs(off["calibrated"]) < 0.01
    assert off["summation"] < -0.07


def test_the_spacing_follows_from_the_mass_of_the_type():
    by_spacing = periodic("calibrated", spacing=0.98 * DX)
    by_mass = periodic("calibrated", spacing=0.98 * DX, coeff=f"\nmass 1 {MASS}")
    np.testing.assert_allclose(by_id(by_mass, "rho"), by_id(by_spacing, "rho"), rtol=1e-12)
    np.testing.assert_allclose(by_id(by_mass, "rho"), RHO0 * 0.98**-3, rtol=2e-3)


def tank(faces, extra="", options="density calibrated", support=0.1, cells=6, by=0.0):
    """A cube of water that fills the space between plane walls, the other faces far away."""
    side = cells * DX
    walls = " ".join(f"{face} {side if face[1:] == 'hi' else 0}" for face in faces.split())
    lmp = instance()
    lmp.commands_string(
        header("f f f", FLUID)
        + box("-1 1 -1 1 -1 1")
        + lattice(DX)
        + filled("water", f"0 {side} 0 {side} 0 {side}")
        + (jitter(by, 7) if by else "")
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0} spacing {DX}", support=support, options=options)
        + neighbor(0.02)
        + f"fix wall all wall/sph {walls} {extra}\nrun 0\n"
    )
    return lmp


@pytest.mark.parametrize("support", [0.1, 0.12, 0.15, 0.2])
def test_layers_at_a_wall_have_the_density_of_the_others(support):
    lmp = tank("zlo", support=support, cells=12)
    x, rho = by_id(lmp, "x"), by_id(lmp, "rho")
    inside = np.all((x[:, :2] > support) & (x[:, :2] < 0.6 - support), axis=1)
    inside &= x[:, 2] < 0.6 - support
    assert inside.sum() > 50
    np.testing.assert_allclose(rho[inside], RHO0, rtol=6e-4)


def test_edges_and_corners_of_walls():
    lmp = tank("xlo xhi ylo yhi zlo zhi")
    x, rho = by_id(lmp, "x"), by_id(lmp, "rho")
    at_wall = ((x < DX) | (x > 5 * DX)).sum(axis=1)
    assert [np.sum(at_wall == n) for n in range(4)] == [64, 96, 48, 8]
    for n, limit in enumerate((1e-6, 1e-6, 4e-3, 0.02)):
        np.testing.assert_allclose(rho[at_wall == n], RHO0, rtol=limit)


def energy(lmp):
    lmp.command("run 0 post no")
    return lmp.get_thermo("pe")


@pytest.mark.parametrize("options", ["density calibrated", "density calibrated tension yes"])
def test_forces_beside_walls_are_the_gradient_of_the_energy(options):
    """In a corner of two walls, compressed; the energy is that of the particles alone."""
    lmp = tank("xlo ylo zlo xhi yhi zhi", options=options, cells=4, by=0.012)
    lmp.commands_string("thermo_style custom step pe\nthermo_modify norm no\nrun 0")
    force = by_id(lmp, "f").copy()
    h = 1e-6
    for atom in (1, 6, 22, 40, 64):
        for axis in range(3):
            shift = ["0", "0", "0"]
            shift[axis] = str(h)
            lmp.commands_string(
                f"group one id {atom}\ndisplace_atoms one move {' '.join(shift)} units box"
            )
            more = energy(lmp)
            shift[axis] = str(-2 * h)
            lmp.command(f"displace_atoms one move {' '.join(shift)} units box")
            less = energy(lmp)
            shift[axis] = str(h)
            lmp.commands_string(
                f"displace_atoms one move {' '.join(shift)} units box\ngroup one delete"
            )
            slope = (more - less) / (2 * h)
            assert -slope == pytest.approx(force[atom - 1, axis], abs=2e-5 * np.abs(force).max())


def test_rate_of_the_density_is_that_of_the_density():
    lmp = tank("xlo ylo zlo", cells=4, by=0.01)
    lmp.commands_string(
        "velocity all ramp vx -1 1 x 0 0.2 units box\nfix step all sph/integrate global\nrun 0"
    )
    rate, x, v = by_id(lmp, "drho").copy(), by_id(lmp, "x"), by_id(lmp, "v")
    assert np.abs(rate).max() > 100
    h = 1e-7
    found = []
    for sign in (1, -1):
        for i, place in enumerate(x + sign * h * v):
            lmp.command(f"set atom {i + 1} x {place[0]:.17g} y {place[1]:.17g} z {place[2]:.17g}")
        lmp.command("run 0")
        found.append(by_id(lmp, "rho").copy())
    np.testing.assert_allclose(
        rate, (found[0] - found[1]) / (2 * h), rtol=1e-4, atol=1e-5 * np.abs(rate).max()
    )


def test_a_mesh_with_wall_completes_a_lattice_as_a_plane_does():
    lmp = instance()
    lmp.commands_string(
        header("f f f")
        + cloth_box("-1 1 -1 1 -0.5 1")
        + lattice()
        + "mass 2 1\n"
        + filled("slab", "-0.3 0.3 -0.3 0.3 0 0.3")
        + "group fluid type 1\n"
        + "create_cloth 2 2 size 1.4 1.4 spacing 0.1 pattern square group cloth\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} spacing {DX}", "2 2 none", options="density calibrated"
        )
        + cloth_styles()
        + neighbor(0.03, cutoff=1.2)
        + """fix step fluid sph/integrate constant
fix sheet cloth pbd/cloth pin cloth
fix contact fluid cloth/contact 1e-3 sides no wall yes
run 0
"""
    )
    x, rho, kind = (by_id(lmp, name) for name in ("x", "rho", "type"))
    inside = (kind == 1) & np.all(np.abs(x[:, :2]) < 0.19, axis=1) & (x[:, 2] < 0.19)
    assert inside.sum() == 8 * 8 * 4
    np.testing.assert_allclose(rho[inside], RHO0, rtol=1e-6)


def test_a_wall_of_boundary_particles_completes_a_lattice():
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.4 0 0.4 -0.3 0.6", types=2)
        + lattice()
        + filled("water", "INF INF INF INF 0 0.4")
        + filled("wall", "INF INF INF INF -0.2 0", kind=2)
        + "mass 2 1\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} spacing {DX}", "2 2 boundary", options="density calibrated"
        )
        + neighbor(0.03)
        + "run 0\n"
    )
    x, rho, kind = (by_id(lmp, name) for name in ("x", "rho", "type"))
    inside = (kind == 1) & (x[:, 2] < 0.3)
    # volumes at the open side of the wall are larger
    np.testing.assert_allclose(rho[inside & (x[:, 2] > DX)], RHO0, rtol=1e-6)
    np.testing.assert_allclose(rho[inside], RHO0, rtol=0.014)


def test_energy_of_water_that_falls_into_a_corner():
    """Undamped, with walls, from one lattice to another: no energy from nothing."""
    lmp = tank("xlo ylo zlo xhi yhi", cells=6)
    lmp.commands_string("""
        fix gravity all gravity 9.81 vector 0.3 0.2 -1
        fix_modify gravity energy yes
        fix_modify wall energy yes
        fix step all sph/integrate constant
        timestep 2e-4
        thermo_style custom step etotal ke
        thermo_modify norm no
        run 0""")
    before = lmp.get_thermo("etotal")
    lmp.command("run 1500")
    scale = 216 * MASS * 9.81 * 0.3
    assert lmp.get_thermo("ke") > 1e-4 * scale
    assert lmp.get_thermo("etotal") - before == pytest.approx(0.0, abs=2e-3 * scale)


@pytest.mark.parametrize("scheme", ["constant", "global", "individual", "block"])
def test_a_column_at_rest_in_a_tank_has_the_pressure_of_its_depth(scheme):
    lmp = instance()
    lmp.commands_string(
        header("p p f", FLUID)
        + box("0 0.3 0 0.3 -0.3 1.1")
        + lattice()
        + filled("water", "INF INF INF INF 0 0.6")
        + sph_tait(f"1 1 fluid {RHO0} c0 25 spacing {DX} alpha 0.3", options="density calibrated")
        + neighbor(0.02)
        + f"""timestep 5e-4
fix wall all wall/sph zlo 0
fix gravity all gravity 9.81 vector 0 0 -1
fix step all sph/integrate {"constant" if scheme == "constant" else "global"} max 2e-3
run_style sph/adaptive {scheme}
fix calm all viscous $(20*mass(all)/count(all))
variable late equal time>=1.5
fix stop all halt 1 v_late >= 1 error continue message no
run 20000
"""
    )
    z, rho = by_id(lmp, "x")[:, 2], by_id(lmp, "rho")
    pressure = 25**2 * RHO0 / 7 * ((rho / RHO0) ** 7 - 1)
    order = np.argsort(z).reshape(12, 36)
    layers = pressure[order].mean(axis=1)[:9]
    # what alternates from layer to layer leaves the mean of two
    error = layers - RHO0 * 9.81 * DX * (12 - 0.5 - np.arange(9))
    assert np.abs(error[:-1] + error[1:]).max() < 0.02 * RHO0 * 9.81 * 0.6 * 2


# ---------------------------------------------------------------------- wrong input


def test_particles_with_masses_of_their_own_need_a_spacing():
    script = (
        header(atoms=FLUID)
        + box("0 0.4 0 0.4 0 0.4")
        + lattice()
        + "create_atoms 1 box\nfix mass all property/atom rmass ghost yes\n"
        + f"set type 1 mass {MASS}\n"
    )
    coeff = f"1 1 fluid {RHO0} c0 {C0}"
    end = neighbor(0.02) + "run 0\n"
    lmp = instance()
    with pytest.raises(Exception, match=r"density is 'calibrated'.*type 1.*add 'spacing DX'"):
        lmp.commands_string(script + sph_tait(coeff, options="density calibrated") + end)
    lmp = instance()
    lmp.commands_string(
        script + sph_tait(f"{coeff} spacing {DX}", options="density calibrated") + end
    )
    np.testing.assert_allclose(by_id(lmp, "rho"), RHO0, rtol=1e-12)


def test_a_support_without_neighbors_behind_the_first_is_refused():
    with pytest.raises(Exception, match=r"spacing of type 1 is '0.05' with a support of 0.07.*"):
        tank("zlo", support=0.07)
    with pytest.raises(Exception, match=r"spacing of type 1 is '0.10*2?' with a support of 0.1"):
        periodic("calibrated", coeff=f"\nmass 1 {8 * MASS}")
