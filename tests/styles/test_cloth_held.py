"""Vertices that something else moves, and what is known of a cloth at its vertices and edges."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import cloth_box, final_dump, gravity, header, no_other_bonds, stiffness

# what a restart file does not hold
UNSAVED = (
    "pair_style zero 0.3\npair_coeff * *\n"
    + no_other_bonds()
    + "comm_modify cutoff 0.6\nneigh_modify every 1 delay 0 check yes\ntimestep 1e-3\n"
)
HELD = stiffness() + UNSAVED
# a sheet that hangs from its top; the bar is its bottom row, of a type and a mass of its own
SHEET = (
    header()
    + cloth_box("-2 2 -2 2 -2 2")
    + """region top block INF INF INF INF 0.45 INF
create_cloth 1 2.0 size 1.0 0.4 spacing 0.1 axes 1 0 0 0 0 1 center 0 0 0.3 group cloth &
  pin top pins
region bottom block INF INF INF INF INF 0.15
group bar region bottom
set group bar type 2
mass 2 {mass}
"""
    + HELD
)
GRAVITY = gravity()
G = 9.81


def sheet(extra="", mass=0.1):
    lmp = instance()
    lmp.commands_string(SHEET.format(mass=mass) + extra)
    return lmp


def masses(lmp):
    return lmp.numpy.extract_atom("mass")[by_id(lmp, "type")]


def momentum(lmp):
    return (masses(lmp)[:, None] * by_id(lmp, "v")).sum(axis=0)


def compute(lmp, name):
    """Per-atom data of a compute, by ID."""
    owned = lmp.extract_setting("nlocal")
    order = np.argsort(lmp.numpy.extract_atom("id")[:owned])
    return np.array(lmp.numpy.extract_compute(name, 1, 2)[:owned])[order]


def test_vertices_that_are_pinned_in_flight_stop():
    """They were free when the fix was defined; a pin that the user moves keeps its velocity."""
    fall = (
        "region corner block INF -0.45 INF INF 0.45 INF\ngroup pins clear\n"
        "group pins region corner\nfix s cloth pbd/cloth pin pins {moves}\nrun 50\n"
    )
    catch = "region now block INF INF INF INF 0.3 INF\ngroup pins region now\n"
    for moves, velocity in (("", 0.0), ("velocity 0.5 0 0", 0.5)):
        with sheet(GRAVITY + fall.format(moves=moves)) as lmp:
            assert np.median(by_id(lmp, "v")[:, 2]) < -0.2
            lmp.commands_string(catch + "run 0")
            pinned = by_id(lmp, "x")[:, 2] > 0.3
            start = by_id(lmp, "x")[pinned]
            lmp.command("run 20")
            moved, v = by_id(lmp, "x")[pinned] - start, by_id(lmp, "v")[pinned]
        assert 10 < pinned.sum() < len(pinned)
        np.testing.assert_array_equal(v, np.tile([velocity, 0.0, 0.0], (len(v), 1)))
        np.testing.assert_allclose(moved, v * 20e-3, atol=1e-12)


# ---------------------------------------------------------------------- rigid bodies

BODY = "fix body bar rigid single\nfix s cloth pbd/cloth solver gs iterations 30 attach bar "


def test_a_rigid_bar_hangs_on_the_sheet():
    """At rest the pins carry everything, and the sheet pulls the bar up by its weight."""
    lmp = sheet(GRAVITY + BODY + "pin pins damping 10\ncompute f all pbd/atom s fx fy fz\nrun 1500")
    kind, force = by_id(lmp, "type"), compute(lmp, "f")
    top = by_id(lmp, "x")[:, 2] > 0.499
    weight = masses(lmp) * G
    assert top.sum() == 11 and (kind == 2).sum() == 11
    assert force[kind == 2, 2].sum() == pytest.approx(-weight[kind == 2].sum(), rel=1e-6)
    assert force[top, 2].sum() == pytest.approx(weight.sum(), rel=1e-5)
    # all holders together: what neither pins nor bar is
    assert lmp.extract_fix("s", 0, 1, 2) == pytest.approx(weight[kind == 1].sum(), rel=1e-6)
    assert np.abs(force[~top & (kind == 1)]).max() == 0


@pytest.mark.parametrize("mass", [1e-4, 0.1, 100.0])
def test_a_bar_of_any_mass_on_a_free_sheet_keeps_momentum(mass):
    """Body and sheet share what they give, half a kick of it is under way."""
    lmp = sheet(BODY + "\ncompute f all pbd/atom s fx fy fz\nvelocity bar set 1 2 3\nrun 0", mass)
    before = momentum(lmp)
    lmp.command("run 500")
    under_way = 0.5e-3 * compute(lmp, "f").sum(axis=0)
    # at 1 m a position is rounded by 2e-16 m, a velocity by 2e-13 m/s in each step
    scale = (masses(lmp)[:, None] * np.maximum(np.abs(by_id(lmp, "v")), 1.0)).sum()
    assert np.abs(momentum(lmp) - under_way - before).max() < 1e-12 * scale
    assert np.abs(by_id(lmp, "v")).max() < 10


def test_attached_vertices_move_as_if_they_were_cloth():
    """Integrated by fix nve they swing as the same masses in the sheet do, to first order."""
    difference = []
    for dt in (2e-3, 5e-4):
        ends = []
        for attach in (True, False):
            fix = "fix s cloth pbd/cloth solver gs iterations 20 pin pins "
            fix = f"fix body bar nve\n{fix} attach bar\n" if attach else fix + "\n"
            lmp = sheet(GRAVITY + fix + f"velocity bar set NULL 1 NULL\ntimestep {dt}\n")
            lmp.command(f"run {round(0.4 / dt)}")
            ends.append(by_id(lmp, "x"))
        difference.append(np.abs(ends[0] - ends[1]).max())
    assert np.ptp(ends[1][:, 1]) > 0.05
    assert difference[1] < 0.4 * difference[0] < 1e-3


SWING = """fix body bar nve
fix s cloth pbd/cloth solver gs pin pins attach bar
compute f all pbd/atom s fx fy fz strain curvature area nx ny nz
"""
PARALLEL = (
    SHEET.format(mass=0.05)
    + GRAVITY
    + SWING
    + """compute e all pbd/local s edge id1 id2 strain
compute least all reduce min c_e[3] inputs local
compute most all reduce max c_e[3] inputs local
velocity bar set NULL 2 NULL
thermo_style custom step c_least c_most
{run}
"""
    + final_dump("x y z vx vy vz c_f[*]", "{dump}")
)

AGAIN = (
    "read_restart mid.restart\n"
    + UNSAVED
    + GRAVITY
    + SWING
    + "run 70\n"
    + final_dump("x y z vx vy vz c_f[*]", "again.txt")
)


@pytest.fixture(scope="module")
def swing(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swing")
    script = PARALLEL.format(run="run 30\nwrite_restart mid.restart\nrun 70", dump="one.txt")
    run(write(folder, script))
    return folder


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks(swing, ranks):
    script = PARALLEL.format(run="run 100", dump=f"{ranks}.txt")
    out = run(write(swing, script, f"in.{ranks}"), ranks=ranks)
    one, many = last_frame(swing / "one.txt"), last_frame(swing / f"{ranks}.txt")
    assert np.abs(one[:, 7:10]).max() > 0.1
    assert np.abs(one[:, 10]).max() > 1e-4
    np.testing.assert_allclose(many, one, atol=1e-9)
    assert "ERROR" not in out


@pytest.mark.parametrize("ranks", [1, 2])
def test_restart_continues_to_the_last_bit(swing, ranks):
    if ranks == 2:
        script = PARALLEL.format(run="run 30\nwrite_restart mid.restart\nrun 70", dump="one.txt")
        run(write(swing, script), ranks=2)
    run(write(swing, AGAIN, "in.again"), ranks=ranks)
    assert np.array_equal(last_frame(swing / "again.txt"), last_frame(swing / "one.txt"))


def test_the_order_of_the_fixes_does_not_matter():
    cloth, body = "fix s cloth pbd/cloth solver gs attach bar\n", "fix body bar rigid single\n"
    ends = []
    for fixes in (cloth + body, body + cloth):
        lmp = sheet(GRAVITY + fixes + "velocity bar set 1 2 3\nrun 20")
        ends.append(by_id(lmp, "x"))
    assert np.array_equal(*ends)


@pytest.mark.parametrize(
    ("commands", "words"),
    [
        ("fix s cloth pbd/cloth attach gone", "attach group is 'gone'.*group command"),
        ("group no empty\nfix s cloth pbd/cloth attach no", "attach group is 'no'.*no vertex"),
        (BODY + "solver substeps", "solver is 'substeps'.*solver gs"),
        (BODY + "pin bar", "in the group of pin and in that of attach"),
        (BODY + "attach pins", "attach group is 'pins': bar is .*'group ID union bar pins'"),
        (BODY + "pin pins pin all", "pin group is 'all': pins is .*'group ID union pins all'"),
    ],
)
def test_errors_of_held_vertices(commands, words):
    with pytest.raises(Exception, match=words):
        sheet(commands)


# ---------------------------------------------------------------------- what can be printed


@pytest.mark.parametrize("fix", ["solver gs iterations 50", "solver substeps direction start"])
def test_forces_of_pins_add_up_to_that_of_all(fix):
    """While the sheet swings: the force on a pin is that of its own constraints."""
    lmp = sheet(
        GRAVITY
        + f"fix s cloth pbd/cloth {fix} pin pins\ncompute f all pbd/atom s fx fy fz\n"
        + "velocity bar set NULL 1 NULL\nrun 150"
    )
    force = compute(lmp, "f")
    held = np.abs(force).max(axis=1) > 0
    assert held.sum() == 11
    total = [lmp.extract_fix("s", 0, 1, n) for n in range(3)]
    np.testing.assert_allclose(force.sum(axis=0), total, atol=2e-3 * np.abs(total).max())


def test_force_of_a_single_pin_is_that_of_all():
    lmp = sheet(
        GRAVITY
        + "group one id 1\nfix s cloth pbd/cloth solver gs iterations 1000 pin one damping 50\n"
        + "compute f all pbd/atom s fx fy fz\nrun 100"
    )
    total = [lmp.extract_fix("s", 0, 1, n) for n in range(3)]
    np.testing.assert_allclose(compute(lmp, "f")[0], total, atol=2e-4 * np.abs(total).max())


CURVED = """
variable R equal {radius}
variable x atom v_R*sin(x/v_R)
variable z atom v_R*cos(x/v_R)-v_R
fix s cloth pbd/cloth
"""


@pytest.mark.parametrize("radius", [0.5, 2.0])
def test_a_rolled_sheet_has_the_curvature_of_its_cylinder(radius):
    """Mean curvature 1/2R, hinges along the axis 1/R, normals outwards, area kept."""
    lmp = instance()
    box = SHEET[: SHEET.index("create_cloth")]
    lmp.commands_string(
        box
        + "create_cloth 1 2.0 size 1.0 1.0 spacing 0.05 group cloth\nmass 2 1\n"
        + HELD
        + CURVED.format(radius=radius)
        + "set group all z v_z x v_x\n"
        + "compute p all pbd/atom s curvature area nx ny nz strain\n"
        + "compute h all pbd/local s hinge id1 id2 id3 id4 angle curvature\n"
        + "compute e all pbd/local s edge id1 id2 length rest strain type\nrun 0"
    )
    x, place = by_id(lmp, "x"), compute(lmp, "p")
    angle = np.arctan2(x[:, 0], x[:, 2] + radius)
    inner = (np.abs(angle) * radius < 0.44) & (np.abs(x[:, 1]) < 0.44)
    side = np.sign((place[:, 2] * np.sin(angle) + place[:, 4] * np.cos(angle))[0])
    assert place[inner, 0] * side == pytest.approx(np.full(inner.sum(), 0.5 / radius), rel=2e-3)
    outwards = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    assert np.abs(side * place[inner, 2:5] - outwards[inner]).max() < 1e-3
    assert place[:, 1].sum() == pytest.approx(1.0, rel=1e-3)

    ids = np.array(lmp.numpy.extract_compute("h", 2, 2))
    ends = x[ids[:, 1:3].astype(int) - 1]
    axial = np.ptp(ends[:, :, 0], axis=1) < 1e-9
    assert np.abs(ids[axial, 5]) == pytest.approx(np.full(axial.sum(), 1.5 / radius), rel=2e-3)
    edges = np.array(lmp.numpy.extract_compute("e", 2, 2))
    length = np.linalg.norm(np.subtract(*x[edges[:, :2].astype(int).T - 1]), axis=1)
    np.testing.assert_allclose(edges[:, 2], length, atol=1e-12)
    np.testing.assert_allclose(edges[:, 4], edges[:, 2] / edges[:, 3] - 1, atol=1e-12)
    assert len(edges) == lmp.extract_global("nbonds")
    assert place[:, 5].min() == pytest.approx(edges[:, 4].min())


@pytest.mark.parametrize(
    ("commands", "words"),
    [
        ("compute p all pbd/atom", "ID of a fix pbd/cloth is missing"),
        ("compute p all pbd/atom gone strain", "no fix pbd/cloth with the ID 'gone'"),
        ("compute p all pbd/atom s color", "keyword is 'color'.*strain"),
        ("compute p all pbd/local s vertex strain", "kind is 'vertex'.*edge or hinge"),
        ("compute p all pbd/local s edge angle", "keyword is 'angle'.*strain"),
        ("compute p all pbd/local s hinge", "keyword is missing"),
    ],
)
def test_errors_of_the_computes(commands, words):
    with pytest.raises(Exception, match=words):
        sheet("fix s cloth pbd/cloth\n" + commands)
