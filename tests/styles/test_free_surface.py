"""pair_style sph/tait ... surface yes: density sums that are completed at free surfaces."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from reference_sph import C0, RHO0
from scenes import (
    END,
    FLUID,
    box,
    cloth_box,
    cloth_styles,
    filled,
    header,
    jitter,
    lattice,
    neighbor,
    sheet,
    sph_tait,
)

DX = 0.05


def block(options="", dimension=3, spacing=DX, cells=5, by=0.0, floor="", more="", coeff=""):
    """A cube, or square, of water with free surfaces, with the mass of a lattice of DX."""
    side = f"0 {cells * DX}"
    depth = side if dimension == 3 else f"{-DX / 2} {DX / 2}"
    types = 2 if floor else 1
    lmp = instance()
    lmp.commands_string(
        header("f f f" if dimension == 3 else "f f p", FLUID, dimension=dimension)
        + box("-1 1 -1 1 " + ("-1 1" if dimension == 3 else depth), types)
        + lattice(spacing, dimension)
        + filled("water", f"{side} {side} {depth}")
        + (filled("floor", f"{side} -0.1 0 {depth}", 2) + "mass 2 1\n" if floor else "")
        + "group water_atoms type 1\n"
        + (jitter(by, 7, "water_atoms", dimension) if by else "")
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} spacing {DX} {coeff}",
            *([floor] if floor else []),
            support=0.12,
            options=f"surface yes {options}",
        )
        + neighbor(0.02)
        + more
        + "thermo_style custom step pe press\nthermo_modify norm no\nrun 0\n"
    )
    return lmp


@pytest.mark.parametrize("dimension", [2, 3])
def test_faces_have_the_density_of_the_inside(dimension):
    plain = block("surface no", dimension, cells=12)
    whole = block("", dimension, cells=12)
    x = by_id(whole, "x")
    along = x[:, 1 : 1 + dimension - 1]
    face = np.all((along > 0.15) & (along < 0.45), axis=1)  # of edges nothing is known
    assert np.abs(by_id(plain, "rho")[face] / RHO0 - 1).max() > 0.15
    np.testing.assert_allclose(by_id(whole, "rho")[face], RHO0, rtol=0.04)


def test_inside_nothing_changes():
    plain, whole = (block(f"surface {word}", cells=12) for word in ("no", "yes"))
    x = by_id(whole, "x")
    inside = np.all((x > 0.13) & (x < 0.47), axis=1)
    assert inside.any()
    np.testing.assert_allclose(by_id(whole, "rho")[inside], by_id(plain, "rho")[inside], rtol=1e-9)


@pytest.mark.parametrize("pressure", ["own", "mirror"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_at_a_wall_a_calibrated_lattice_is_complete(dimension, pressure):
    walls = f"fix wall all wall/sph xlo 0 pressure {pressure}\n"
    plain, whole = (
        block(f"surface {word} density calibrated", dimension, cells=12, more=walls)
        for word in ("no", "yes")
    )
    x = by_id(whole, "x")
    along = x[:, 1:dimension]
    at_wall = (x[:, 0] < 0.4) & np.all((along > 0.13) & (along < 0.47), axis=1)
    assert np.count_nonzero(x[at_wall, 0] < 0.03) > 5
    np.testing.assert_allclose(by_id(whole, "rho")[at_wall], RHO0, rtol=3e-4)
    np.testing.assert_allclose(
        by_id(whole, "rho")[at_wall], by_id(plain, "rho")[at_wall], rtol=3e-4
    )
    without = block("density calibrated", dimension, cells=12)
    assert np.abs(by_id(without, "rho")[at_wall] / RHO0 - 1).max() > 0.01


@pytest.mark.parametrize("options", ["", "density calibrated"])
def test_pressures_are_those_of_the_densities(options):
    more = "compute state all sph/atom pressure\n"
    lmp = block(f"tension yes {options}", by=0.006, more=more)
    found = lmp.numpy.extract_compute("state", 1, 1)[np.argsort(lmp.numpy.extract_atom("id"))]
    exact = C0**2 * RHO0 / 7 * ((by_id(lmp, "rho") / RHO0) ** 7 - 1)
    np.testing.assert_allclose(found, exact, rtol=1e-9)


def energy(lmp):
    lmp.command("run 0 post no")
    return lmp.get_thermo("pe")


# in a corner, and between two planes
CORNER = "fix wall all wall/sph xlo -0.02 ylo -0.015 zlo -0.022\n"
SLOT = "fix wall all wall/sph xlo -0.02 xhi 0.2 ylo -0.02\n"


@pytest.mark.parametrize("kernel", ["wendland/c2", "wendland/c4", "cubic", "quintic"])
@pytest.mark.parametrize(
    ("options", "dimension", "floor", "walls"),
    [
        ("", 3, "", ""),
        ("tension yes", 2, "", ""),
        ("density calibrated", 3, "", ""),
        ("", 2, f"2 2 boundary pressure own volume {DX**2}", ""),
        ("tension yes", 3, "", CORNER),
        ("density calibrated", 3, "", CORNER),
        ("density calibrated tension yes", 2, "", SLOT),
        ("", 2, f"2 2 boundary pressure own volume {DX**2}", SLOT),
    ],
)
def test_forces_are_the_gradient_of_the_energy(kernel, options, dimension, floor, walls):
    lmp = block(f"kernel {kernel} {options}", dimension, 0.93 * DX, 4, 0.006, floor, walls)
    water = lmp.numpy.extract_atom("type")[: lmp.get_natoms()] == 1
    force, tags = by_id(lmp, "f").copy(), np.sort(lmp.numpy.extract_atom("id")[: len(water)][water])
    largest, h = np.abs(force).max(), 1e-6
    assert largest > 0
    on_walls = np.zeros(3)
    for k in range(walls.count("lo") + walls.count("hi")):
        on_walls += [lmp.extract_fix("wall", 0, 1, 3 * k + d) for d in range(3)]
    np.testing.assert_allclose(force.sum(axis=0) + on_walls, 0, atol=1e-11 * largest)
    for atom in tags[:: max(1, len(tags) // 6)]:
        for axis in range(dimension):
            found = []
            for step in (h, -2 * h, h):
                shift = " ".join(str(step if a == axis else 0) for a in range(3))
                lmp.commands_string(
                    f"group one id {atom}\ndisplace_atoms one move {shift} units box\n"
                    "group one delete"
                )
                found.append(energy(lmp))
            slope = (found[0] - found[1]) / (2 * h)
            assert -slope == pytest.approx(force[atom - 1, axis], abs=3e-5 * largest)


def test_virial_is_the_derivative_of_the_energy_by_the_size():
    lmp = block("tension yes", 3, 0.93 * DX, 4, 0.006)
    lmp.commands_string(
        "compute virial all pressure NULL pair\nthermo_style custom step c_virial pe"
    )
    lmp.commands_string("thermo_modify norm no\nrun 0")
    work = lmp.extract_compute("virial", 0, 0) * 2.0**3 * 3
    x, h, found = by_id(lmp, "x").copy(), 1e-6, []
    for scale in (1 + h, 1 - h):
        for i, place in enumerate(scale * x):
            lmp.command(f"set atom {i + 1} x {place[0]:.17g} y {place[1]:.17g} z {place[2]:.17g}")
        found.append(energy(lmp))
    assert work == pytest.approx(-(found[0] - found[1]) / (2 * h), rel=1e-4)


def test_mixed_precision_finds_the_same_forces():
    double, mixed = (
        by_id(block(f"precision {word}", 3, 0.93 * DX, 4, 0.006), "f").copy()
        for word in ("double", "mixed")
    )
    np.testing.assert_allclose(mixed, double, atol=1e-5 * np.abs(double).max())


def test_a_drop_at_rest_keeps_its_momenta():
    lmp = block("", 2, 0.99 * DX, 6, 0.005, more="fix step all sph/integrate global\n")
    lmp.commands_string(f"timestep {0.2 * 0.06 / C0}\nrun_style sph/adaptive constant\nrun 400")
    x, v = by_id(lmp, "x"), by_id(lmp, "v")
    fastest = np.abs(v).max()
    assert fastest > 0
    np.testing.assert_allclose(v.sum(axis=0), 0, atol=1e-9 * fastest * len(v))
    spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum()
    assert spin == pytest.approx(0, abs=1e-9 * fastest * len(v))


# Two fluids of different density, spacing and support side by side on a floor, over a periodic
# border: heaps with faces, edges and corners that sink together.
MAKE_HEAPS = (
    header("p p f", FLUID)
    + box("0 0.5 0 0.3 -0.15 0.8", 3)
    + "mass 1 0.125\nmass 2 0.1512\nmass 3 1\n"
    + lattice()
    + filled("floor", "INF INF INF INF -0.1 0", 3)
    + filled("water", "0.1 0.3 0.05 0.25 0 0.2", 1)
    + lattice(0.06)
    + filled("oil", "0.3 0.481 0.06 0.241 0 0.24", 2)
    + "group fluids type 1 2\n"
    + jitter(0.006, 7, "fluids")
    + "displace_atoms fluids move 0.15 0.1 0.0 units box\nwrite_data heaps.data\n"
)
HEAPS_SETTINGS = neighbor(0.02) + "fix weight fluids gravity 9.81 vector 0 0 -1\n"
HEAPS = (
    "variable newton index on\nvariable scheme index global\nvariable steps index 60\n"
    "variable dump index end.txt\nnewton ${newton}\n"
    + header("p p f", FLUID)
    + "read_data heaps.data\ngroup fluids type 1 2\n"
    + sph_tait(
        "1 1 fluid 1000 c0 20 alpha 0.1",
        "2 2 fluid 700 c0 25 nu 1e-3 support 0.15",
        "3 3 boundary",
        support=0.12,
        options="surface yes density calibrated",
    )
    + "timestep 5e-4\n"
)
HEAPS_FIXES = (
    HEAPS_SETTINGS
    + "fix step fluids sph/integrate global\nfix lid fluids wall/sph zhi 0.25\n"
    + "run_style sph/adaptive ${scheme}\n"
)
HEAPS_AGAIN = (
    "variable steps index 30\nvariable scheme index global\nvariable dump index again.txt\n"
    "comm_modify vel yes\nread_restart mid.restart\n"
)


@pytest.fixture(scope="module")
def heaps(tmp_path_factory):
    folder = tmp_path_factory.mktemp("heaps")
    run(write(folder, MAKE_HEAPS, "in.make"))
    return folder


@pytest.mark.parametrize("scheme", ["global", "constant"])
def test_ranks(heaps, scheme):
    script = write(heaps, HEAPS + HEAPS_FIXES + END)
    run(script, dump="one.txt", scheme=scheme)
    one = last_frame(heaps / "one.txt")
    for ranks, newton in ((1, "off"), (2, "on"), (4, "on"), (2, "off")):
        run(script, ranks, dump="many.txt", newton=newton, scheme=scheme)
        assert np.abs(last_frame(heaps / "many.txt") - one).max() < 1e-10
    without = (HEAPS + HEAPS_FIXES + END).replace("surface yes", "")
    run(write(heaps, without, "in.without"), dump="without.txt", scheme=scheme)
    assert np.abs(last_frame(heaps / "without.txt") - one).max() > 1e-3


@pytest.mark.parametrize("scheme", ["global", "constant"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_restart_continues_to_the_last_bit(heaps, ranks, scheme):
    first = HEAPS + HEAPS_FIXES + "run 30\nwrite_restart mid.restart\n" + END
    run(write(heaps, first), ranks, dump="whole.txt", steps=30, scheme=scheme)
    run(write(heaps, HEAPS_AGAIN + HEAPS_FIXES + END), ranks, scheme=scheme)
    whole, again = (last_frame(heaps / f"{name}.txt") for name in ("whole", "again"))
    np.testing.assert_array_equal(again, whole)


@pytest.mark.parametrize("scheme", ["global", "constant"])
@pytest.mark.parametrize(
    ("boundary", "walls"),
    [
        ("s s p", ""),
        ("p s p", ""),
        ("s s p", "fix wall all wall/sph ylo -0.02\nfix_modify wall energy yes\n"),
    ],
)
def test_energy_and_momentum_of_undamped_drops(boundary, walls, scheme):
    """Of two fluids side by side, from disorder under pressure until they have come apart."""
    lmp = instance()
    lmp.commands_string(
        header(boundary, FLUID, dimension=2)
        + box("-0.2 0.4 -0.1 0.3 -0.025 0.025", 2)
        + lattice(0.98 * DX, 2)
        + filled("water", "-0.2 0.1 0 0.2 -0.02 0.02", 1)
        + filled("oil", "0.1 0.4 0 0.2 -0.02 0.02", 2)
        + jitter(0.004, 7, dimension=2)
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {C0} spacing {DX}",
            f"2 2 fluid 600 c0 {C0} spacing {DX} support 0.15",
            support=0.12,
            options="surface yes",
        )
        + neighbor(0.03)
        + f"timestep {0.05 * 0.06 / C0 if scheme == 'constant' else 1}\n"
        + f"fix step all sph/integrate global accuracy 2.5e-4\nrun_style sph/adaptive {scheme}\n"
        + walls
        + "thermo_style custom step etotal ke\nthermo_modify norm no\nrun 0\n"
    )
    start = lmp.get_thermo("etotal")
    lmp.command("run 600")
    assert lmp.get_thermo("ke") > 0.2 * start
    assert lmp.get_thermo("etotal") == pytest.approx(start, rel=3e-3)
    mass = np.take(lmp.numpy.extract_atom("mass"), by_id(lmp, "type")).reshape(-1, 1)
    momenta = (mass * by_id(lmp, "v"))[:, : 1 if walls else 3]
    np.testing.assert_allclose(momenta.sum(axis=0), 0, atol=1e-11 * np.abs(momenta).sum())


@pytest.mark.parametrize("pressure", ["own", "mirror"])
def test_steps_of_global_let_water_come_to_rest(pressure):
    """At a support of two spacings, where waves of the lattice are short for the kernel."""
    lmp = instance()
    lmp.commands_string(
        header("p f p", FLUID)
        + box("0 0.4 -0.2 1 0 0.4")
        + lattice(DX)
        + filled("water", f"INF INF 0 {10 * DX} INF INF")
        + jitter(0.005, 7)
        + sph_tait(
            f"1 1 fluid {RHO0} c0 20 spacing {DX} alpha 0.1",
            support=2 * DX,
            options="surface yes density calibrated",
        )
        + neighbor(0.02)
        + f"fix floor all wall/sph ylo 0 pressure {pressure}\n"
        + "fix weight all gravity 9.81 vector 0 -1 0\n"
        + "fix calm all viscous $(50*mass(all)/count(all))\n"
        + "timestep 1\nfix step all sph/integrate global\nrun_style sph/adaptive global\n"
        + "run 1500\nunfix calm\nrun 2500\n"
    )
    assert np.abs(by_id(lmp, "v")).max() < 0.005


@pytest.mark.parametrize(
    ("coeff", "more"),
    [
        ("alpha 0.1 switch 0.1", ""),
        ("alpha 0.1", "fix shift all sph/shift\n"),
    ],
)
def test_what_it_goes_with(coeff, more):
    """Momentum is exact with it."""
    lmp = block(
        "", 2, 0.96 * DX, 8, 0.004, coeff=coeff, more=f"fix step all sph/integrate global\n{more}"
    )
    lmp.commands_string("timestep 1\nrun_style sph/adaptive global\nrun 100")
    v = by_id(lmp, "v")
    assert np.abs(v).max() > 0
    np.testing.assert_allclose(v.sum(axis=0), 0, atol=1e-11 * np.abs(v).sum())


def test_rate_of_the_density_where_a_surface_stays():
    """A compression along the upper face, whose place does not change."""
    lmp = block("", 3, cells=8, more="fix step all sph/integrate global\n")
    lmp.commands_string(
        "variable u atom -(x-0.2)\nvariable w atom -(y-0.2)\nvelocity all set v_u v_w 0\nrun 0"
    )
    rate, x, v = (by_id(lmp, name).copy() for name in ("drho", "x", "v"))
    face = np.all((x[:, :2] > 0.13) & (x[:, :2] < 0.27), axis=1) & (x[:, 2] > 0.35)
    assert face.any()
    h, found = 1e-6, []
    for sign in (1, -1):
        for i, place in enumerate(x + sign * h * v):
            lmp.command(f"set atom {i + 1} x {place[0]:.17g} y {place[1]:.17g} z {place[2]:.17g}")
        lmp.command("run 0")
        found.append(by_id(lmp, "rho").copy())
    slope = (found[0] - found[1]) / (2 * h)
    np.testing.assert_allclose(rate[face], slope[face], rtol=0.15)


# ---------------------------------------------------------------------- wrong input

STEP = "fix step all sph/integrate global\n"


@pytest.mark.parametrize(
    ("options", "more", "words"),
    [
        ("density continuity", "", "surface is 'yes'.*'density continuity'.*leave out one of them"),
        *(
            (
                "",
                f"{STEP}run_style sph/adaptive {scheme}\n",
                "surface of pair_style sph/tait is 'yes'.*the scheme constant or global",
            )
            for scheme in ("block", "individual")
        ),
    ],
)
def test_what_it_does_not_go_with(options, more, words):
    with pytest.raises(Exception, match=words):
        block(options, more=more)


def test_a_mesh_that_is_a_wall_is_refused():
    lmp = instance()
    with pytest.raises(Exception, match=r"surface is 'yes'.*meshes with 'wall yes'.*'surface no'"):
        lmp.commands_string(
            header("f f f")
            + cloth_box("-1 1 -1 1 -0.5 1")
            + lattice()
            + "mass 2 1\n"
            + filled("slab", "-0.1 0.1 -0.1 0.1 0 0.1")
            + "group fluid type 1\n"
            + sheet(2, 2, "0.6 0.6", 0.1)
            + sph_tait("1 1 fluid 1000 c0 20 spacing 0.05", "2 2 none", options="surface yes")
            + cloth_styles()
            + neighbor(0.03, cutoff=1.2)
            + "fix step fluid sph/integrate constant\nfix sheet cloth pbd/cloth pin cloth\n"
            + "fix contact fluid cloth/contact 1e-3 sides no wall yes\nrun 0\n"
        )
