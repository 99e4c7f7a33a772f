"""bond_style pbd, dihedral_style pbd and fix pbd/cloth."""

import numpy as np
import pytest
from cloth_scenes import BOX, cloth, styles
from harness import by_id, instance
from scenes import gravity, header

# as the paper has it: iterations in a step, along the present directions
PAPER = "solver gs direction current"


def free_fall(t, steps=None):
    """Exact, or in semi-implicit Euler steps: z = -g dt^2 n (n + 1) / 2."""
    return -0.5 * 9.81 * t**2 * (1 + (1 / steps if steps else 0))


@pytest.mark.parametrize("iterations", [1, 20])
@pytest.mark.parametrize("k", [0.0, 0.3, 1.0])
@pytest.mark.parametrize(("solver", "steps"), [(PAPER, 50), ("", None)])
def test_unpinned_cloth_falls_freely_at_any_stiffness(k, iterations, solver, steps):
    lmp = cloth("run 50", k=k, bend=k, fix=f"{solver} iterations {iterations} damping 5")
    z = by_id(lmp, "x")[:, 2]
    assert z == pytest.approx(np.full_like(z, free_fall(0.05, steps)), rel=1e-9)


def test_pinned_cloth_sags_less_the_stiffer_it_is():
    """The paper's figure 3 in small: k = 0, 0.3 and 1."""
    sag, n_pins = [], 40
    for k in (0.0, 0.3, 1.0):
        lmp = cloth(
            "run 300",
            k=k,
            options="pin rim pins",
            fix=f"{PAPER} pin pins iterations 5",
            regions="region rim block -0.45 0.45 -0.45 0.45 INF INF side out\n",
        )
        z = by_id(lmp, "x")[:, 2]
        assert np.isfinite(z).all() and (z == 0).sum() == n_pins
        sag.append(-z.min())
        if k == 0.0:  # the pins hold nothing but themselves
            pinned = lmp.extract_fix("sheet", 0, 1, 2)
            assert pinned == pytest.approx(9.81 * 2.0 * n_pins / 121, rel=1e-6)
    assert sag[0] == pytest.approx(-free_fall(0.3, 300), rel=1e-9)
    assert 0.3 * sag[0] > sag[1] > 2 * sag[2] > 0


PAIR = """
atom_modify sort 0 0
create_atoms 1 single 0 0 0
create_atoms 1 single 0 0 -1
mass 1 {mass}
group pins id 1
create_bonds single/bond 1 1 2
"""


def one_edge(k, iterations, extra, mass=0.1, fix=""):
    lmp = instance()
    lmp.commands_string(
        header()
        + BOX
        + PAIR.format(mass=mass)
        + styles(k, cutoff=1.5)
        + gravity()
        + f"fix sheet all pbd/cloth iterations {iterations} pin pins {fix}\n"
        + extra
    )
    return lmp


@pytest.mark.parametrize("order", ["forward", "symmetric"])
@pytest.mark.parametrize("iterations", [1, 2, 5, 20])
def test_k_of_one_edge_does_not_depend_on_the_iterations(iterations, order):
    """After one step the stretch is (1 - k) of free fall, equation (9)."""
    lmp = one_edge(0.3, iterations, "timestep 0.01\nrun 1", fix=f"{PAPER} order {order}")
    stretch = -1.0 - by_id(lmp, "x")[1, 2]
    assert stretch == pytest.approx(0.7 * 9.81e-4, rel=1e-9)


@pytest.mark.parametrize("fix", [PAPER, "solver substeps direction current"])
def test_with_a_reference_k_is_a_spring_that_does_not_depend_on_the_step(fix):
    """What hangs is stretched by (1 - k')/k' g h^2 in one sweep, h being the (sub)step there."""
    iterations, step = (1, 0.01) if fix == PAPER else (4, 0.04)
    k = -np.expm1(np.log1p(-0.3) / iterations)
    expected = 9.81 * (step / iterations) ** 2 * (1 - k) / k
    for cut in (1, 4, 0.5):
        run_it = f"timestep {step / cut}\nrun {int(2000 * cut)}"
        lmp = one_edge(0.3, iterations, run_it, fix=f"{fix} reference {step}")
        assert -1.0 - by_id(lmp, "x")[1, 2] == pytest.approx(expected, rel=1e-6)
        without = one_edge(0.3, iterations, run_it, fix=fix)
        assert -1.0 - by_id(without, "x")[1, 2] == pytest.approx(expected / cut**2, rel=1e-6)


def test_pin_force_carries_what_hangs():
    lmp = one_edge(1.0, 5, "timestep 0.001\nrun 300")
    assert by_id(lmp, "x")[1, 2] == pytest.approx(-1.0, abs=1e-12)
    assert lmp.extract_fix("sheet", 0, 1, 2) == pytest.approx(2 * 0.1 * 9.81, rel=1e-9)
    assert abs(lmp.extract_fix("sheet", 0, 1, 3)) < 1e-12  # strain


def test_pendulum_swings_with_its_period():
    """Small swings of one rigid link: half a period turns the displacement round."""
    lmp = one_edge(1.0, 5, "")
    half = np.pi * np.sqrt(1.0 / 9.81)
    lmp.command("set atom 2 x 0.02")
    lmp.command(f"timestep {half / 2000}")
    lmp.command("run 2000")
    assert by_id(lmp, "x")[1, 0] == pytest.approx(-0.02, rel=0.01)


def momenta(lmp):
    """Linear and angular momentum of equal masses, over the mass of one."""
    x, v = by_id(lmp, "x"), by_id(lmp, "v")
    return v.sum(axis=0), np.cross(x, v).sum(axis=0)


def test_free_cloth_keeps_momentum():
    lmp = cloth(
        "unfix gravity\nvelocity all create 1e22 777 loop geom\n"
        "displace_atoms all random 0.01 0.01 0.01 55 units box\nrun 0",
        bend=0.5,
        fix="damping 20",
    )
    before = momenta(lmp)[0]
    lmp.command("run 50")
    after = momenta(lmp)[0]
    assert np.abs(after - before).max() < 1e-12 * np.abs(by_id(lmp, "v")).sum()


def lost_spin(dt, steps, fix):
    """Share of the angular momentum that a turning sheet loses."""
    lmp = cloth(
        "unfix gravity\nvariable vx atom -5*y\nvariable vy atom 5*x\n"
        f"velocity all set v_vx v_vy 0\ntimestep {dt}\nrun 0",
        fix=fix,
    )
    before = momenta(lmp)[1][2]
    lmp.command(f"run {steps}")
    return abs(momenta(lmp)[1][2] / before - 1)


def test_spinning_cloth_keeps_its_spin():
    """Along the directions of the start to round-off, else what is lost falls with the step."""
    lost = [lost_spin(2e-3, 50, PAPER), lost_spin(1e-3, 100, PAPER)]
    assert lost[1] < 0.6 * lost[0] < 0.01
    assert lost_spin(2e-3, 50, "") < 1e-12 < 1e-3 * lost[0]


def test_damping_decays_stretching_at_its_rate_and_leaves_the_fall():
    lmp = one_edge(
        1e-9, 1, f"unfix sheet\nfix sheet all pbd/cloth {PAPER} iterations 1 damping 30\n"
    )
    lmp.commands_string("velocity all ramp vz -0.1 0.1 z -1 0 units box\ntimestep 1e-3\nrun 50")
    v = by_id(lmp, "v")[:, 2]
    assert v[0] - v[1] == pytest.approx(0.2 * np.exp(-30 * 0.05), rel=1e-4)
    assert v.mean() == pytest.approx(-9.81 * 0.05, rel=1e-9)


def test_cloth_that_crosses_the_periodic_border_moves_like_one_that_does_not():
    shapes = []
    for center, left in (([0, 0, 0], "INF -0.45"), ([2, 1.9, 1.95], "1.4 1.55")):
        lmp = cloth(
            "run 60",
            bend=0.2,
            options=f"center {' '.join(map(str, center))} pin left pins",
            fix="pin pins",
            regions=f"region left block {left} INF INF INF INF\n",
        )
        boxes = np.array([lmp.decode_image_flags(int(i)) for i in by_id(lmp, "image")])
        shapes.append(by_id(lmp, "x") + 4.0 * boxes - np.array(center))
    assert np.ptp(shapes[0][:, 2]) > 0.01
    np.testing.assert_allclose(shapes[1], shapes[0], atol=1e-10)


def test_cloth_that_crosses_a_face_that_moves_feels_nothing_of_it():
    """It turns as it does elsewhere: 1.6e-7 m apart, since LAMMPS moves images a step late."""
    shapes = []
    for center in (0, 2):
        lmp = cloth(
            "unfix gravity\nfix grow all deform 1 x vel 0.8 remap v\n"
            "velocity all ramp vz -2 2 y -0.5 0.5 units box\n"
            "velocity all set 1 NULL NULL units box\nrun 100",
            bend=0.2,
            options=f"center {center} 0 0",
        )
        shapes.append(by_id(lmp, "x")[:, 1:])
    assert np.ptp(shapes[0][:, 1]) > 0.3
    np.testing.assert_allclose(shapes[1], shapes[0], atol=1e-6)


def test_another_solver_goes_on_from_a_restart_file(tmp_path):
    """There is no half-kick correction yet: the sheet falls on."""
    path = tmp_path / "x.restart"
    cloth(f"run 100\nwrite_restart {path}", fix="solver gs")
    lmp = instance()
    lmp.commands_string(
        f"read_restart {path}\n{styles()}{gravity()}"
        "fix sheet cloth pbd/cloth solver substeps\nrun 100"
    )
    assert by_id(lmp, "x")[:, 2] == pytest.approx(np.full(121, -0.5 * 9.81 * 0.2**2), rel=0.02)


def test_pins_move_as_variables_say():
    """An equal-style one of 0.3 + t m/s, a number, and an atom-style one."""
    lmp = one_edge(
        "1.0",
        10,
        "unfix sheet\nvariable u equal 0.3+time\nvariable w atom -0.1*id\n"
        "fix sheet all pbd/cloth pin pins velocity v_u 0.2 v_w\ntimestep 1e-3\nrun 100",
    )
    moved = by_id(lmp, "x")[0]
    assert moved == pytest.approx([0.3 * 0.1 + 0.5 * 0.1**2, 0.02, -0.01], rel=0.02)
    assert by_id(lmp, "v")[0] == pytest.approx([0.4, 0.2, -0.1], rel=0.01)


def test_pins_follow_a_compute():
    """Half of the speed of the other vertex, which falls, in steps without output too."""
    lmp = one_edge(
        "0",
        1,
        "unfix sheet\ngroup free id 2\ncompute falls free reduce ave vz\n"
        "variable w equal 0.5*c_falls\nfix sheet all pbd/cloth pin pins velocity 0 0 v_w\n"
        "timestep 1e-3\nthermo 1000\nrun 1",
    )
    for _ in range(2):
        lmp.command("run 5 pre no post no")
        pinned, free = by_id(lmp, "v")[:, 2]
        assert pinned == pytest.approx(0.5 * (free + 9.81e-3), rel=1e-9)


@pytest.mark.parametrize(
    ("variable", "what"),
    [
        ("equal exp(1000*(step>2))", "velocity"),
        ("atom exp(1000*(step>2)*(id==1))", "velocity of atom 1"),
    ],
)
def test_a_velocity_that_is_no_number_is_said(variable, what):
    lmp = one_edge("1.0", 10, f"unfix sheet\nvariable w {variable}\n")
    lmp.command("fix sheet all pbd/cloth pin pins velocity 0 0 v_w")
    with pytest.raises(Exception, match=rf"{what} is 'inf' at step 3: correct variable w"):
        lmp.command("run 5")


def test_rest_shape_from_a_property():
    """The cloth starts stretched by 10 % and returns to the rest positions it was given."""
    lmp = instance()
    lmp.commands_string(
        header()
        + BOX
        + "fix rest all property/atom d2_rest 3\n"
        + "create_cloth 1 2.0 size 1.0 1.0 spacing 0.1 group cloth\n"
        + "variable x atom x\nvariable y atom y\n"
        + "set group all d2_rest[1] v_x d2_rest[2] v_y d2_rest[3] 0\n"
        + "displace_atoms all ramp x -0.05 0.05 x -0.5 0.5 units box\n"
        + styles()
        + "fix sheet cloth pbd/cloth rest d2_rest damping 100\ntimestep 1e-3\nrun 300"
    )
    assert lmp.extract_fix("sheet", 0, 1, 3) < 1e-6
    assert np.ptp(by_id(lmp, "x")[:, 2]) == 0


def hanging(coefficient, extra, iterations=10, fix=""):
    """A mass of 0.1 kg on a vertical edge of 1 m, at rest after damping."""
    lmp = one_edge(coefficient, iterations, f"{extra}\ntimestep 0.01\n", fix=fix)
    lmp.command("run 2000")
    return -1.0 - by_id(lmp, "x")[1, 2], lmp


@pytest.mark.parametrize("solver", ["gs", "jacobi", "substeps"])
@pytest.mark.parametrize("direction", ["current", "start"])
@pytest.mark.parametrize("iterations", [1, 100])
def test_a_compliant_edge_stretches_by_the_weight(solver, direction, iterations):
    """100 N/m under 0.981 N: 9.81 mm, whatever the solver does."""
    stretch, lmp = hanging(
        "compliance 0.01", "", iterations, f"solver {solver} direction {direction} damping 2"
    )
    assert stretch == pytest.approx(9.81e-3, rel=1e-9)
    assert lmp.extract_fix("sheet", 0, 1, 6) == pytest.approx(0.5 * 100 * stretch**2, rel=1e-8)
    if solver != "jacobi":
        assert lmp.extract_fix("sheet", 0, 1, 4) < 1e-12


@pytest.mark.parametrize(
    ("iterations", "stretch"), [(1, 8.8e-3), (2, 4.2e-3), (5, 1.4e-3), (20, 0.14e-3)]
)
def test_plain_stiffness_is_no_compliance(iterations, stretch):
    """k' = 0.1 in every iteration: another material at every count."""
    k = 1 - 0.9**iterations
    found, _ = hanging(f"{k:.17g}", "", iterations, f"{PAPER} damping 2")
    assert found == pytest.approx(stretch, rel=0.04)


@pytest.mark.parametrize(("compress", "height"), [(0, 0), (0.25, 4), (1, 1)])
def test_stiffness_in_compression(compress, height):
    """The mass stands on the edge: it shortens by 1/compress of what it would hang, or falls."""
    damping = "damping 2" if compress else ""
    lmp = one_edge(f"compliance 0.01 compress {compress}", 50, "", fix=damping)
    lmp.commands_string("unfix gravity\nfix gravity all gravity 9.81 vector 0 0 1\ntimestep 0.01")
    lmp.command("run 30" if compress == 0 else "run 2000")
    rise = 1.0 + by_id(lmp, "x")[1, 2]
    if compress == 0:
        assert rise == pytest.approx(-free_fall(0.3), rel=1e-9)
    else:
        assert rise == pytest.approx(9.81e-3 * height, rel=1e-9)


def test_a_strain_limit_holds_what_a_soft_edge_would_not():
    stretch, _ = hanging("compliance 1 limit 0.05", "", 20, "damping 2")
    assert stretch == pytest.approx(0.05, rel=1e-9)
    stretch, _ = hanging("compliance 0.01 limit 0.05", "", 20, "damping 2")
    assert stretch == pytest.approx(9.81e-3, rel=1e-9)
    stretch, _ = hanging("0 limit 0.05", "", 20, "damping 2")
    assert stretch == pytest.approx(0.05, rel=1e-9)


def test_an_edge_without_rest_length_closes():
    lmp = one_edge("1 rest zero", 5, "unfix gravity\ntimestep 1e-3\nrun 5")
    assert np.abs(by_id(lmp, "x")[1]).max() < 1e-12


def test_direction_of_the_start_is_second_order():
    """Half a swing of a rigid link by a large angle, against the smallest step."""
    ends = {}
    for direction in ("current", "start"):
        for steps in (200, 400, 6400):
            lmp = one_edge(1.0, 1, "", fix=f"direction {direction}")
            lmp.commands_string(f"set atom 2 x 1.0 z 0.0\ntimestep {0.8 / steps}\nrun {steps}")
            ends[direction, steps] = by_id(lmp, "x")[1]
    exact = ends["start", 6400]
    error = {key: np.linalg.norm(x - exact) for key, x in ends.items()}
    assert 1.8 < error["current", 200] / error["current", 400] < 2.3
    assert 3.5 < error["start", 200] / error["start", 400] < 4.5
    assert error["start", 200] < 0.02 * error["current", 200]


def test_a_folded_sheet_with_flat_hinges_unfolds():
    fold = (
        "variable z atom abs(x)\nset group all z v_z\n"
        "unfix sheet\nfix sheet cloth pbd/cloth iterations 20 damping 20\nunfix gravity\n"
    )
    heights = {}
    for rest in ("model", "flat"):
        lmp = cloth(fold + "run 0", bend=1.0)
        lmp.commands_string(f"dihedral_coeff * 0.1 rest {rest}\nrun 300")
        heights[rest] = np.ptp(by_id(lmp, "x")[:, 2])
    assert heights["model"] == pytest.approx(0.5, rel=1e-9)
    assert heights["flat"] < 0.4


@pytest.mark.parametrize("solver", ["gs", "jacobi", "substeps"])
@pytest.mark.parametrize("direction", ["current", "start"])
def test_every_solver_keeps_momentum(solver, direction):
    lmp = cloth(
        "unfix gravity\nvelocity all create 1e22 777 loop geom\n"
        "displace_atoms all random 0.01 0.01 0.01 55 units box\nrun 0",
        k="compliance 1e-4 compress 0.5 limit 0.1",
        bend="compliance 10",
        fix=f"solver {solver} direction {direction}",
    )
    before = momenta(lmp)[0]
    lmp.command("run 50")
    after = momenta(lmp)[0]
    assert np.isfinite(after).all()
    assert np.abs(after - before).max() < 1e-12 * np.abs(by_id(lmp, "v")).sum()


def test_a_tolerance_stops_the_sweeps():
    """One step of a crumpled sheet: the smaller the tolerance, the more sweeps, up to it."""
    used = []
    for tolerance in (1e-2, 3e-3, 1e-3):
        lmp = cloth(
            "displace_atoms all random 0.01 0.01 0.01 55 units box\nrun 1",
            fix=f"{PAPER} iterations 2000 tolerance {tolerance}",
        )
        used.append(lmp.extract_fix("sheet", 0, 1, 5))
        assert lmp.extract_fix("sheet", 0, 1, 4) < tolerance
        assert lmp.extract_fix("sheet", 0, 1, 3) < 1.01 * tolerance
    assert 1 < used[0] < used[1] < used[2] < 2000


@pytest.mark.parametrize("solver", ["gs", "jacobi", "substeps"])
def test_stiffer_solvers_at_equal_cost(solver):
    """A sheet held at one edge falls as a sheet, at every stiffness: no growth, no explosion."""
    lmp = cloth(
        "run 100",
        k="compliance 1e-5",
        options="pin left pins",
        fix=f"pin pins iterations 10 solver {solver}",
        regions="region left block INF -0.45 INF INF INF INF\n",
    )
    x = by_id(lmp, "x")
    assert np.isfinite(x).all() and np.linalg.norm(by_id(lmp, "v"), axis=1).max() < 2.0
    assert x[:, 2].min() == pytest.approx(free_fall(0.1), rel=0.15)


@pytest.mark.parametrize("solver", ["gs", "jacobi", "substeps"])
@pytest.mark.parametrize("direction", ["current", "start"])
def test_springs_of_other_fixes_neither_feed_nor_damp(solver, direction):
    """A free sheet that springs hold as a whole, omega dt = 1.2: swings alike for 270 periods."""
    lmp = cloth(
        "unfix gravity\nfix back all spring/self 250\ndisplace_atoms all move 0.3 0 0\n"
        "timestep 0.01",
        fix=f"solver {solver} direction {direction}",
    )
    far = []
    for _ in range(200):
        lmp.command("run 7 post no")
        far.append(abs(by_id(lmp, "x")[:, 0].mean()))
    assert max(far[-80:]) == pytest.approx(max(far[:80]), rel=1e-2)


def kinetic(lmp):
    """Kinetic energy of equal masses, over the mass of one."""
    return 0.5 * np.sum(by_id(lmp, "v") ** 2)


def test_there_and_back_a_crumpled_sheet_gains_nothing():
    """Rigid edges without hinges: with sweeps one way the energy of substeps grew 80 times."""
    lmp = cloth(
        "unfix gravity\nvelocity all create 1e18 777 loop geom\nrun 100", fix="order symmetric"
    )
    before = kinetic(lmp)
    lmp.command("run 1000")
    assert kinetic(lmp) < before


@pytest.mark.parametrize("solver", ["gs", "substeps"])
def test_pins_that_move_carry_the_cloth_along(solver):
    """Pins at constant speed: after damping all moves with them, in substeps too."""
    lmp = one_edge(
        "1.0",
        10,
        "unfix sheet\nunfix gravity\nfix pull pins move linear 0.3 0 0\n"
        f"fix sheet all pbd/cloth iterations 10 solver {solver} pin pins\n"
        "velocity all set 0.3 0 0\ntimestep 0.01\nrun 100",
    )
    np.testing.assert_allclose(by_id(lmp, "x"), [[0.3, 0, 0], [0.3, 0, -1]], atol=1e-9)
    np.testing.assert_allclose(by_id(lmp, "v")[1], [0.3, 0, 0], atol=1e-9)


RING = """
region box prism 0 1 -0.5 0.5 -0.5 0.5 {tilt} 0 0
create_box 1 box bond/types 2 angle/types 1 dihedral/types 1 extra/bond/per/atom 8 &
  extra/angle/per/atom 8 extra/dihedral/per/atom 16
mass 1 1
"""
MEASURED = "compute edge all pbd/local ring edge rest length\nrun 0"


@pytest.mark.parametrize("tilt", [0, 0.3])
@pytest.mark.parametrize("restart", [False, True])
def test_rest_lengths_across_a_periodic_face_do_not_follow_the_box(tilt, restart, tmp_path):
    """Ten atoms, 0.1 apart around a periodic box whose side becomes 1.2 between two runs."""
    lmp = instance()
    settings = styles(0, cutoff=0.3) + "fix ring all pbd/cloth\n"
    ring = "".join(f"create_atoms 1 single {0.1 * n + 0.05 + tilt / 2} 0 0\n" for n in range(10))
    ring += "".join(f"create_bonds single/bond 1 {n} {n % 10 + 1}\n" for n in range(1, 11))
    lmp.commands_string(header() + RING.format(tilt=tilt) + ring + settings + "run 1")
    lmp.command("change_box all x final 0 1.2 remap units box")
    if restart:
        lmp.command(f"write_restart {tmp_path / 'ring'}")
        lmp = instance()
        lmp.command(f"read_restart {tmp_path / 'ring'}")
        lmp.commands_string(settings)
    lmp.commands_string(MEASURED)
    rest, length = np.array(lmp.numpy.extract_compute("edge", 2, 2)).T
    np.testing.assert_allclose(rest, 0.1, rtol=1e-12)
    np.testing.assert_allclose(length, 0.12, rtol=1e-12)


def string_under_tension(dt, direction):
    """Largest deflection of a taut string after 2000 steps, of a tenth of a millimeter at first.

    20 links of 0.055 m and 1 g under 50 N: m l / T allows 1.05 ms along old directions.
    """
    links = range(1, 21)
    lmp = instance()
    lmp.commands_string(
        header()
        + BOX
        + "create_atoms 1 single -0.5 0 0\n"
        + "".join(f"create_atoms 1 single {-0.5 + 0.05 * n} 0 0\n" for n in links)
        + "mass 1 1e-3\ngroup pins id 1 21\n"
        + "".join(f"create_bonds single/bond 1 {n} {n + 1}\n" for n in links)
        + styles("compliance 1e-4", cutoff=0.6)
        + f"fix sheet all pbd/cloth solver gs iterations 50 direction {direction} pin pins\n"
        + "displace_atoms all ramp x -0.05 0.05 x -0.5 0.5 units box\n"
        + f"displace_atoms all random 1e-4 1e-4 1e-4 7 units box\ntimestep {dt}\nrun 2000"
    )
    return np.abs(by_id(lmp, "x")[:, 1:]).max()


@pytest.mark.parametrize("dt", [5e-4, 1.2e-3, 1e-2])
def test_a_taut_string_is_stable_along_the_directions_of_the_start(dt):
    assert string_under_tension(dt, "start") < 2e-4
