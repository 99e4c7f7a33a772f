"""Sheets with pores: what goes through, what it costs, and what must not matter."""

import numpy as np
import pytest
from harness import by_id, instance, run, write
from scenes import (
    cloth_box,
    filled,
    gravity,
    header,
    lattice,
    neighbor,
    no_other_bonds,
    sheet,
    sph_tait,
    stiffness,
)

from sphcloth.mesh import ClothMesh
from sphcloth.metrics import crossings
from sphcloth.trajectory import Trajectory

SPACING, RHO, G = 0.05, 1000.0, 4.0
MASS = RHO * SPACING**3


def channel(
    pores,
    *,
    mesh="plate",
    scheme="constant",
    solver="substeps",
    areal=1.0,
    speed=0.0,
    fluid="c0 10 alpha 0.2",
    density="summation",
    length=0.6,
    dt=2e-3,
    compliance=1e-5,
):
    """Water in a periodic channel, driven by its weight through a level sheet across it."""
    cells = 8
    width = cells * SPACING
    nodes = [(i, j) for j in range(cells) for i in range(cells)]

    def at(i, j):
        return 1 + i % cells + j % cells * cells

    lines = [header("p p p"), cloth_box(f"0 {width} 0 {width} {-length / 2} {length / 2}", 3)]
    lines += [f"mass 1 {MASS}\nmass 2*3 {areal * SPACING**2}\n"]
    for kind, z in ((2, 0.0), (3, 0.1)):  # the sheet, and the ends of its springs
        lines += [
            f"create_atoms {kind} single {i * SPACING} {j * SPACING} {z} units box\n"
            for i, j in nodes
        ]
    for i, j in nodes:
        a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
        lines += [f"create_bonds single/angle 1 {a} {b} {c} special no\n"]
        lines += [f"create_bonds single/angle 1 {a} {c} {d} special no\n"]
        if mesh != "plate":
            ends = (a + cells**2, b, d)
            lines += [f"create_bonds single/bond 1 {a} {e} special no\n" for e in ends]
    lines += [lattice(SPACING), filled("water", "INF INF INF INF INF INF")]
    lines += ["group water type 1\ngroup mesh type 2\ngroup held type 3\ngroup cloth type 2 3\n"]
    lines += [f"velocity water set 0 0 {-speed} units box\nset group all sph/rho {RHO}\n"]
    lines += [
        sph_tait(f"1 1 fluid {RHO} {fluid}", "2*3 2*3 none", options=f"density {density}")
        + f"bond_style pbd\nbond_coeff 1 compliance {compliance}\ndihedral_style zero\n"
        + "dihedral_coeff *\nangle_style zero\nangle_coeff *\n"
        + neighbor(0.03)
        + f"timestep {dt}\n"
        + gravity("water", g=G)
        + f"fix step water sph/integrate global max {2 * dt}\nrun_style sph/adaptive {scheme}\n"
    ]
    if mesh == "plate":
        lines += ["fix contact water cloth/contact 0.01 obstacle mesh\n"]
    else:
        held = "cloth" if mesh == "pinned" else "held"
        lines += [f"fix cloth cloth pbd/cloth solver {solver} pin {held}\n"]
        lines += ["fix contact water cloth/contact 0.01\n"]
    return "".join(lines) + f"fix pores water cloth/pores 1 {pores}\n", length


def flux(lmp):
    """Mean velocity over some passages of a row of particles, by displacements."""
    lmp.commands_string(
        "variable z equal xcm(water,z)\nvariable t equal time\nvariable sag equal -xcm(mesh,z)\n"
        "fix sag all ave/time 1 400 400 v_sag"
    )

    def now():
        return np.array([lmp.extract_variable(name, None, 0) for name in ("z", "t")])

    lmp.command("run 400")
    start = now()
    lmp.command("run 400")
    z, t = now() - start
    return -z / t


LAWS = {
    "darcy": ("darcy 8000", 8000.0, 0.0),
    "forchheimer": ("forchheimer 3e4", 0.0, 3e4),
    "both": ("darcy 3000 forchheimer 2e4", 3000.0, 2e4),
    "medium": ("medium 1e-7 0.01 0.5", RHO * 4e-5 * 0.01 / 1e-7, 0.5 * RHO * 0.01 / np.sqrt(1e-7)),
}


def exact(a, b, length):
    """The weight of the water is the pressure that the sheet takes."""
    head = RHO * G * length
    return head / a if b == 0 else (np.sqrt(a * a + 4 * b * head) - a) / (2 * b)


@pytest.mark.parametrize("law", LAWS)
def test_the_sheet_takes_the_pressure_of_its_law(law):
    words, a, b = LAWS[law]
    fluid = "c0 10 nu 4e-5" if law == "medium" else "c0 10 alpha 0.2"
    script, length = channel(words, fluid=fluid, speed=exact(a, b, 0.6))
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_pores[*]")
        assert flux(lmp) == pytest.approx(exact(a, b, length), rel=0.01)


@pytest.mark.parametrize("mesh", ["plate", "pinned", "springs"])
@pytest.mark.parametrize("scheme", ["constant", "global", "individual", "block"])
def test_any_mesh_and_scheme_has_that_flux(mesh, scheme):
    script, length = channel("darcy 8000", mesh=mesh, scheme=scheme, areal=0.05, speed=0.3)
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_pores[*]")
        found = flux(lmp)
    assert found == pytest.approx(exact(8000, 0, length), rel=0.01)


@pytest.mark.parametrize("others", ["water", "nothing"])
@pytest.mark.parametrize("mesh", ["plate", "pinned"])
def test_a_mesh_that_two_fixes_guard_has_its_pores_once(mesh, others):
    """Also where the second one guards it from nothing that is there."""
    script, length = channel("darcy 8000", mesh=mesh, speed=0.3)
    obstacle = " obstacle mesh" if mesh == "plate" else ""
    second = f"group nothing empty\nfix second {others} cloth/contact 0.01{obstacle} sides no\n"
    for place in ("fix contact", "fix pores"):
        with instance() as lmp:
            lmp.commands_string(script.replace(place, second + place, 1))
            lmp.command("thermo_style custom step f_pores[*]")
            assert flux(lmp) == pytest.approx(exact(8000, 0, length), rel=0.01)


@pytest.mark.parametrize("solver", ["gs iterations 20", "jacobi iterations 100", "substeps"])
@pytest.mark.parametrize("areal", [5.0, 50.0])
def test_nor_do_solver_and_mass_matter(solver, areal):
    script, length = channel(
        "darcy 8000", mesh="springs", solver=solver, areal=areal, speed=0.3, compliance=1e-4
    )
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_pores[*]")
        found = flux(lmp)
        z, sag = by_id(lmp, "x")[:64, 2], lmp.extract_fix("sag", 0, 0)
    assert found == pytest.approx(exact(8000, 0, length), rel=0.01)
    # the springs bear the weight of the water
    drawn = RHO * G * length * SPACING**2 * 1e-4
    assert sag == pytest.approx(drawn, rel=0.05)
    assert np.ptp(z) < 0.5 * drawn


def test_density_by_continuity_has_that_flux_too():
    script, length = channel("darcy 8000", density="continuity", speed=0.3)
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_pores[*]")
        assert flux(lmp) == pytest.approx(exact(8000, 0, length), rel=0.01)


WATER = "-0.2 0.2 -0.2 0.2 0.1 0.3"


def gauze(pores="darcy 500", *, types=1, areal=2.0, v=-3.0, contact="", free=False, density=""):
    """A sheet, pinned at its rim or free, of one triangle type, which a block of water meets."""
    pin = "" if free else " pin rim pins"
    return (
        header("p p p")
        + cloth_box("-1 1 -1 1 -1 1", 2).replace("angle/types 1", "angle/types 2")
        + f"mass * {MASS}\n"
        + "region rim block -0.39 0.39 -0.39 0.39 INF INF side out units box\n"
        + sheet(2, areal, "0.8 0.8", SPACING, f"center 0 0 0 group cloth{pin}")
        + lattice(SPACING)
        + filled("water", WATER)
        + "group water type 1\n"
        + f"velocity water set 0.3 -0.2 {v} units box\n"
        + sph_tait(f"1 1 fluid {RHO} c0 30 alpha 0.1", "2 2 none", options=density)
        + stiffness("1.0", "0.1")
        + f"set group cloth angle {types}\n"
        + no_other_bonds()
        + neighbor(0.03)
        + "timestep 5e-4\nfix step water sph/integrate global\n"
        + f"fix s cloth pbd/cloth{'' if free else ' pin pins'}\n"
        + f"fix contact water cloth/contact 0.01 {contact}\n"
        + f"fix pores water cloth/pores 1 {pores}\n"
    )


def motion(lmp):
    v, mass = by_id(lmp, "v"), lmp.numpy.extract_atom("mass")
    order = np.argsort(lmp.numpy.extract_atom("id")[: len(v)])
    m = mass[lmp.numpy.extract_atom("type")[order]]
    return (
        m @ v,
        0.5 * m @ np.sum(v**2, axis=1),
        np.sum(m[:, None] * np.cross(by_id(lmp, "x"), v), 0),
    )


@pytest.mark.parametrize("scheme", ["constant", "global", "individual", "block"])
def test_a_jet_through_a_free_sheet_keeps_momentum_and_loses_energy(scheme):
    with instance() as lmp:
        lmp.commands_string(
            gauze("darcy 100 forchheimer 300", areal=300.0, free=True)
            + f"run_style sph/adaptive {scheme}\n"
            + "thermo_style custom step pe f_pores[*] f_s[*]\nrun 0"
        )
        momentum, kinetic, _ = motion(lmp)
        lmp.command("run 250")
        after, left, _ = motion(lmp)
        through = lmp.extract_fix("pores", 0, 1, 4, 0)
        lost = lmp.extract_fix("pores", 0, 1, 6, 0)
    np.testing.assert_allclose(after, momentum, atol=1e-11 * np.abs(momentum).max())
    assert through > 150
    # some was and is in the compression of the water
    assert lost == pytest.approx(kinetic - left, rel=0.1)


def test_the_watertight_part_holds_what_the_porous_part_lets_through(tmp_path):
    """Triangles at x < 0 have pores: the passages are there, and nothing crossed elsewhere."""
    half = "region left block INF 0.001 INF INF INF INF units box\ngroup left region left\n"
    script = gauze(types=2).replace(
        "set group cloth angle 2\n",
        "set group cloth angle 2\n" + half + "group left intersect left cloth\n"
        "set group left angle 1\n",
    )
    with instance() as lmp:
        lmp.commands_string(
            script
            + f"dump d all custom 4 {tmp_path}/g.lammpstrj id type x y z vx vy vz\n"
            + "dump_modify d sort id\nthermo_style custom step f_pores[*]\nrun 300\n"
            + f"write_data {tmp_path}/g.data nofix nocoeff"
        )
        up, down = (lmp.extract_fix("pores", 0, 1, k, 0) for k in (3, 4))
    frames = Trajectory(tmp_path / "g.lammpstrj")
    mesh = ClothMesh.read(tmp_path / "g.data")
    all_of_it = crossings(mesh, frames, 1)
    tight = crossings(mesh.of_kinds([2]), frames, 1)
    assert tight.count == 0
    assert all_of_it.count > 30
    assert abs(len(all_of_it.ids) - (up + down)) <= 0.05 * (up + down)


def over_a_ridge(porous_on_both_sides):
    """Velocities of particles over a ridge along y, and of one beside it over the left slope."""
    along = [
        (x, round(-0.31 + 0.11 * k, 2)) for k, x in enumerate([-0.01, 0, 0.01, 0.02, -0.02, 0])
    ]
    particles = [(*at, 0.05) for at in along] + [(-0.25, 0.05, -0.06)]
    script = (
        header("f f f")
        + cloth_box("-1 1 -1 1 -1 1", 2).replace("angle/types 1", "angle/types 2")
        + "".join(f"create_atoms 1 single {x} {y} {z} units box\n" for x, y, z in particles)
        + sheet(2, 1.0, "0.8 0.8", 0.1, "center 0 0 0 group mesh")
        + "variable slope atom -0.5*abs(x)\nset group mesh z v_slope\n"
        + f"mass 1 {MASS}\nset group all sph/rho {RHO}\ngroup water type 1\n"
        + "velocity water set 0 0 -1 units box\n"
        + sph_tait(f"1 1 fluid {RHO} c0 30", "2 2 none")
        + stiffness()
        + "region right block -0.001 INF INF INF INF INF units box\ngroup right region right\n"
        + "group right intersect right mesh\n"
        + ("" if porous_on_both_sides else "set group right angle 2\n")
        + no_other_bonds()
        + neighbor(0.03)
        + "timestep 5e-4\nfix step water sph/integrate constant\n"
        + "fix contact water cloth/contact 0.005 obstacle mesh\n"
        + "fix pores water cloth/pores 1 darcy 500\nrun 4\n"
    )
    with instance() as lmp:
        lmp.commands_string(script)
        v = by_id(lmp, "v")[: len(particles)]
    return v[:-1], v[-1]


def test_beside_the_border_between_porous_and_watertight_triangles_is_no_drag():
    """Rounding would tell which of the two triangles at the edge is the nearest."""
    over, beside = over_a_ridge(porous_on_both_sides=False)
    assert beside[2] > -0.99
    np.testing.assert_array_equal(over, np.broadcast_to([0, 0, -1], over.shape))
    over, _ = over_a_ridge(porous_on_both_sides=True)
    assert (over[:, 2] > -0.99).all()


def test_what_is_not_in_the_group_does_not_pass():
    """Every second particle: the others stay on the sheet."""
    script = gauze().replace(
        "fix pores water",
        "variable odd atom id%2\ngroup odd variable odd\n"
        "group odd intersect odd water\nfix pores odd",
    )
    with instance() as lmp:
        lmp.commands_string(script + "thermo_style custom step f_pores[*]\nrun 200")
        ids = np.sort(lmp.numpy.extract_atom("id")[: lmp.extract_global("nlocal")])
        x, kinds = by_id(lmp, "x"), by_id(lmp, "type")
        z = x[:, 2] - x[kinds == 2, 2].mean()
    water = kinds == 1
    odd = ids % 2 == 1
    assert np.count_nonzero(z[water & odd] < -0.05) > 50
    assert z[water & ~odd].min() > -0.05


def test_porous_triangles_are_no_wall():
    with instance() as lmp:
        lmp.commands_string(
            gauze(contact="wall yes") + "thermo_style custom step f_pores[*]\nrun 200"
        )
        assert lmp.extract_fix("pores", 0, 1, 4, 0) > 100


@pytest.mark.parametrize("ranks", [2, 4])
def test_any_number_of_ranks_and_a_restart_give_the_same(tmp_path, ranks):
    script = gauze("darcy 500 screen 0.2 0.002") + (
        "processors 2 1 *\nthermo_style custom step f_pores[*]\nrun 100\n"
        "write_restart half.restart\nrun 60\n"
        "print '$(f_pores[5]:%.15g) $(f_pores[6]:%.15g) $(f_pores[7]:%.15g)' file out.txt\n"
    )
    script = script.replace("processors 2 1 *\n", "")
    results = []
    for each in (1, ranks):
        folder = tmp_path / str(each)
        folder.mkdir()
        run(write(folder, script), each)
        results.append(np.loadtxt(folder / "out.txt"))
    np.testing.assert_allclose(results[1], results[0], rtol=1e-8)


PERIOD = 2.0  # of the box of gauze()
DENSITIES = ["density summation", "density continuity"]


def one_by_one():
    across, up = SPACING * (np.arange(-4, 4) + 0.5), SPACING * (np.arange(2, 6) + 0.5)
    return "".join(
        f"create_atoms 1 single {x:.3f} {y:.3f} {z:.3f} units box\n"
        for z in up
        for y in across
        for x in across
    )


def drifting(density="density summation", *, frame=(0, 0, 0), moved=(0, 0, 0), wiggled=False):
    """The jet and a free sheet, or one that is moved to and fro, elsewhere or in a moving frame."""
    of_frame, by = (" ".join(map(str, vector)) for vector in (frame, moved))
    script = gauze("darcy 500 screen 0.2 0.002", free=True, density=density)
    script = script.replace("sph/integrate global", "sph/integrate constant")
    # their IDs do not depend on the number of ranks
    script = script.replace(filled("water", WATER), one_by_one())
    if wiggled:
        script = script.replace("fix s cloth pbd/cloth", "fix s cloth move wiggle 0 0 0.02 0.05")
        script = script.replace("cloth/contact 0.01", "cloth/contact 0.01 obstacle cloth")
    return script.replace(
        "timestep 5e-4\n",
        "displace_atoms water random 0.005 0.005 0.005 88 units box\n"
        f"displace_atoms all move {by} units box\nset group water sph/rho {RHO}\n"
        f"velocity all set {of_frame} sum yes units box\ntimestep 1e-3\n",
    )


def moved_by(folder, script, ranks=1, steps=60):
    """Positions, which are unwrapped, and velocities."""
    tell = "write_dump all custom end id xu yu zu vx vy vz modify sort id format float %.17g\n"
    folder.mkdir()
    run(write(folder, script + f"run {steps}\n" + tell), ranks)
    rows = np.loadtxt(folder / "end", skiprows=9)[:, 1:]
    return rows[:, :3], rows[:, 3:]


@pytest.mark.parametrize("wiggled", [False, True])
@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize(("ranks", "by"), [(2, (0, 0, 0)), (4, (0, 0, 0)), (1, (0.93, 1.04, 0.97))])
def test_ranks_and_periodic_faces_do_not_matter(tmp_path, wiggled, density, ranks, by):
    """Their ghosts know how fast vertices are, and where they are."""
    script = drifting(density, wiggled=wiggled)
    one = moved_by(tmp_path / "one", script)
    x, v = moved_by(tmp_path / "other", drifting(density, moved=by, wiggled=wiggled), ranks)
    offset = x - by - one[0]
    offset -= PERIOD * np.round(offset / PERIOD)
    np.testing.assert_allclose(offset, 0, atol=1e-11)
    np.testing.assert_allclose(v, one[1], rtol=0, atol=1e-9)


@pytest.mark.parametrize("density", DENSITIES)
def test_a_moving_frame_does_not_matter(tmp_path, density):
    """In it the sheet moves in a step, by much of the layer in which water feels it."""
    frame, steps = np.array([0.5, 0.2, 2.0]), 60
    x, v = moved_by(tmp_path / "at_rest", drifting(density), steps=steps)
    moving = moved_by(tmp_path / "moving", drifting(density, frame=frame), steps=steps)
    np.testing.assert_allclose(moving[0] - 1e-3 * steps * frame, x, rtol=0, atol=1e-11)
    np.testing.assert_allclose(moving[1] - frame, v, rtol=0, atol=1e-9)


ERRORS = [
    ("darcy -1", r"fix pores cloth/pores: darcy is '-1'.*>= 0"),
    ("forchheimer nan", r"forchheimer is 'nan'.*finite"),
    ("", r"the resistance is missing.*darcy"),
    ("medium 0 1 1", r"permeability of 'medium' is '0'.*> 0"),
    ("medium 1e-9 1e-3 0", r"'medium' takes the viscosity.*type 1 has none.*'nu'"),
    ("screen 0.6 0.01", r"solidity of 'screen' is '0.6'.*up to 0.4"),
    ("color red", r"unknown keyword 'color'.*darcy"),
]


@pytest.mark.parametrize(("words", "message"), ERRORS)
def test_bad_words_are_refused(words, message):
    with instance() as lmp, pytest.raises(Exception, match=message):
        lmp.commands_string(gauze(words) + "run 0")


def test_pores_need_a_mesh_contact_and_order(tmp_path):
    cases = {
        r"no triangle of a mesh .* has the type 2": gauze().replace(
            "cloth/pores 1", "cloth/pores 2"
        ),
        r"there is no fix cloth/contact before": gauze().replace(
            "fix contact water cloth/contact 0.01 \n", ""
        ),
        r"fix step sph/integrate moves its particles and is defined after it": gauze().replace(
            "fix step water sph/integrate global\n", ""
        )
        + "fix step water sph/integrate global\n",
        r"angle type of porous triangles is '3'": gauze().replace("cloth/pores 1", "cloth/pores 3"),
    }
    for message, script in cases.items():
        with instance() as lmp, pytest.raises(Exception, match=message):
            lmp.commands_string(script + "run 0")
