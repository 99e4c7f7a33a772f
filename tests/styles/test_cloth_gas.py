"""fix cloth/gas: volumes, pressures and forces of chambers, and that the gas keeps energy."""

import contextlib
import re

import numpy as np
import pytest
from gas_scenes import data, icosphere, volume
from harness import by_id, fail, instance, run, write

RADIUS, AREAL, AIR = 0.1, 0.1, 1e5
MASS = AREAL * 4 * np.pi * RADIUS**2
LAW = f"polytropic 1.4 {AIR} {AIR}"
# of the breathing of a light sphere
OMEGA = np.sqrt(1.4 * AIR * 3 / (AREAL * RADIUS))

START = """units si
atom_style molecular
atom_modify map yes
comm_modify vel yes cutoff 0.3
boundary {boundary}
newton {newton}
neighbor 0.02 bin
neigh_modify every 1 delay 0 check yes
pair_style zero 0.05
bond_style pbd
angle_style zero
read_data balloon.data
pair_coeff * *
bond_coeff * compliance 1e-2
angle_coeff *
timestep {dt}
"""
OUTPUT = """compute motion all ke
variable energy equal c_motion+f_gas-f_gas[4]
thermo_style custom step c_motion f_gas f_gas[1] f_gas[2] f_gas[3] f_gas[4] v_energy
"""


def script(gas=LAW, move="fix move all nve", dt=1e-5, boundary="s s s", newton="on"):
    return (
        START.format(dt=dt, boundary=boundary, newton=newton)
        + f"group pair id 1 2\nfix gas all cloth/gas {gas}\n{move}\n"
        + OUTPUT
    )


@pytest.fixture
def balloon(tmp_path, monkeypatch):
    """Start a run of a sphere of triangles, or of any mesh."""
    monkeypatch.chdir(tmp_path)

    def start(x=None, faces=None, level=1, v=None, box=None, tilt=None, **words):
        if x is None:
            x, faces = icosphere(level, RADIUS)
        data(tmp_path / "balloon.data", x, faces, MASS / len(x), box=box, tilt=tilt, v=v)
        lmp = instance()
        lmp.commands_string(script(**words))
        return lmp

    return start


def value(lmp, n=0):
    """f_gas[n], or f_gas."""
    return lmp.extract_fix("gas", 0, 1, n - 1) if n else lmp.extract_fix("gas", 0, 0)


def column(lmp, n, chamber=1):
    return lmp.extract_fix("gas", 0, 2, chamber - 1, n - 1)


def energies(lmp, steps):
    found = []
    for _ in range(steps):
        lmp.command("run 1 pre no post no")
        found.append(lmp.extract_variable("energy"))
    return np.array(found)


def test_the_force_is_the_gradient_of_the_volume(balloon):
    rng = np.random.default_rng(1)
    x, faces = icosphere(1, RADIUS)
    x = x + 0.01 * rng.standard_normal(x.shape)
    lmp = balloon(x, faces, gas="pressure 2000")
    lmp.command("run 0")
    assert value(lmp, 2) == pytest.approx(volume(x, faces), rel=1e-13)
    assert value(lmp) == pytest.approx(-2000 * volume(x, faces), rel=1e-13)
    force, h = by_id(lmp, "f"), 1e-6
    for i, d in ((0, 0), (7, 1), (30, 2)):
        moved = x.copy()
        moved[i, d] += h
        gained = volume(moved, faces)
        moved[i, d] -= 2 * h
        assert force[i, d] == pytest.approx(
            2000 * (gained - volume(moved, faces)) / (2 * h), rel=1e-6, abs=1e-7
        )
    assert np.abs(force.sum(axis=0)).max() < 1e-14 * np.abs(force).sum()


@pytest.mark.parametrize("gas", ["pressure 2000", "polytropic 1.4 4e5 1e5"])
def test_minimize_knows_the_gas(balloon, gas):
    """Its energy and the forces are those of a run, though neighbor lists have been made anew."""
    lmp = balloon(gas=gas, dt=1e-9)  # in longer steps the pressure is a mean
    lmp.commands_string("thermo_style custom pe\nfix_modify gas energy yes\nminimize 0 0 3 20")
    found, forces, radii = (
        lmp.get_thermo("pe"),
        by_id(lmp, "f"),
        np.linalg.norm(by_id(lmp, "x"), axis=1),
    )
    assert found == value(lmp)
    assert (radii > 1.3 * RADIUS).all()
    lmp.command("run 0")
    assert lmp.get_thermo("pe") == pytest.approx(found, rel=1e-12)
    of_air = AIR * RADIUS**2
    np.testing.assert_allclose(by_id(lmp, "f"), forces, rtol=0, atol=1e-12 * of_air)


def test_triangles_may_be_turned_any_way(balloon):
    rng = np.random.default_rng(2)
    x, faces = icosphere(1, RADIUS)
    faces = np.array(
        [np.roll(f, k) for f, k in zip(faces, rng.integers(0, 3, len(faces)), strict=True)]
    )
    for inward in (slice(None, None, 3), slice(None)):
        turned = faces.copy()
        turned[inward] = turned[inward, ::-1]
        lmp = balloon(x, rng.permutation(turned), gas="pressure 2000")
        lmp.command("run 0")
        assert value(lmp, 2) == pytest.approx(volume(x, faces), rel=1e-13)
        outward = (by_id(lmp, "f") * x).sum(axis=1)
        assert outward.min() > 0


@pytest.mark.parametrize("tilt", [None, (0.11, -0.07, 0.13)])
def test_a_chamber_may_lie_across_the_faces_of_a_periodic_box(balloon, tilt):
    x, faces = icosphere(1, RADIUS)
    alone = balloon(x, faces, gas="pressure 2000")
    alone.command("run 0")
    for center in ((0.03, 0.27, 0.01), (0.57, 0.001, 0.599)):
        lmp = balloon(
            x + center, faces, gas="pressure 2000", box=(0.6,) * 3, tilt=tilt, boundary="p p p"
        )
        lmp.command("run 0")
        assert value(lmp, 2) == pytest.approx(value(alone, 2), rel=1e-12)
        np.testing.assert_allclose(by_id(lmp, "f"), by_id(alone, "f"), atol=1e-12)
        lmp.command("set group all image 0 0 0")
        lmp.command("run 0")
        assert value(lmp, 2) == pytest.approx(value(alone, 2), rel=1e-12)


def test_a_periodic_tube_encloses_the_volume_of_a_period(balloon):
    n, rows, length = 12, 8, 0.6
    angle = 2 * np.pi * np.arange(n) / n
    x = np.array(
        [
            (0.3 + 0.1 * np.cos(a), 0.3 + 0.1 * np.sin(a), length * (k + 0.5) / rows)
            for k in range(rows)
            for a in angle
        ]
    )
    at = lambda k, i: (k % rows) * n + i % n  # noqa: E731
    faces = np.array(
        [
            t
            for k in range(rows)
            for i in range(n)
            for t in (
                (at(k, i), at(k, i + 1), at(k + 1, i)),
                (at(k + 1, i), at(k, i + 1), at(k + 1, i + 1)),
            )
        ]
    )
    lmp = balloon(x, faces, box=(length,) * 3, boundary="p p p")
    lmp.command("run 0")
    section = 0.5 * n * 0.1**2 * np.sin(2 * np.pi / n)
    assert value(lmp, 2) == pytest.approx(section * length, rel=1e-12)


@pytest.mark.parametrize("n", [1, 1.4, 3])
def test_the_gas_follows_its_law(balloon, n):
    x, faces = icosphere(1, RADIUS)
    lmp = balloon(x, faces, gas=f"polytropic {n} {1.2 * AIR} {AIR}", move="")
    lmp.command("run 0")
    first = volume(x, faces)
    assert value(lmp, 1) == pytest.approx(0.2 * AIR, rel=1e-12)
    assert value(lmp, 3) == pytest.approx(first, rel=1e-12)
    lmp.command("displace_atoms all ramp x -0.05 0.05 x -0.1 0.1 units box")
    lmp.command("run 0")
    now = value(lmp, 2)
    assert now == pytest.approx(1.5 * first)
    assert value(lmp, 1) == pytest.approx(1.2 * AIR * (first / now) ** n - AIR, rel=1e-12)
    work = 1.2 * AIR * first * (np.log(1.5) if n == 1 else (1 - 1.5 ** (1 - n)) / (n - 1))
    lmp.command("displace_atoms all ramp x 0.05 -0.05 x -0.15 0.15 units box")
    energy = value(lmp)
    lmp.command("run 0")
    assert value(lmp) - energy == pytest.approx(work - AIR * 0.5 * first, rel=1e-9)


def test_a_chamber_breathes_at_its_frequency_and_keeps_its_energy(balloon):
    """It is free but for its gas, and moves along the gradient of its volume."""
    x, faces = icosphere(1, RADIUS)
    still = balloon(x, faces, gas="pressure 1")
    still.command("run 0")
    gradient, mass = by_id(still, "f"), MASS / len(x)
    omega = np.sqrt(1.4 * AIR * (gradient**2).sum() / mass / volume(x, faces))
    lmp = balloon(x, faces, v=2.0 * gradient, dt=2 * np.pi / omega / 100)
    lmp.command("run 0")
    first, swing = value(lmp, 2), []
    before, kinetic = lmp.extract_variable("energy"), lmp.extract_compute("motion", 0, 0)
    for _ in range(200):
        lmp.command("run 1 pre no post no")
        swing.append(value(lmp, 2) - first)
        assert lmp.extract_variable("energy") - before == pytest.approx(0, abs=2e-3 * kinetic)
    expected = swing[24] * np.sin(2 * np.pi * np.arange(1, 201) / 100)
    np.testing.assert_allclose(swing, expected, rtol=0, atol=2e-3 * swing[24])


@pytest.mark.parametrize("steps_per_radian", [1, 0.1, 0.001])
@pytest.mark.parametrize(
    "move", ["fix move all nve", "fix move all pbd/cloth", "fix move all pbd/cloth solver gs"]
)
def test_long_steps_do_not_feed_the_breathing_of_a_light_balloon(balloon, steps_per_radian, move):
    x, faces = icosphere(1, RADIUS)
    dt = 1 / (steps_per_radian * OMEGA)
    lmp = balloon(x, faces, v=1e-3 * RADIUS / dt * x / RADIUS, dt=dt, move=move)
    lmp.command(f"bond_coeff 1 compliance {1e3 * dt**2 * len(x) / MASS}")
    lmp.command("run 0")
    before = lmp.extract_variable("energy")
    later = energies(lmp, 300)
    kinetic = 0.5e-6 * MASS * (RADIUS / dt) ** 2
    swing = kinetic * max(1, (OMEGA * dt) ** 2)  # of the first step, before the gas answers
    assert later.max() - before < swing
    assert later[-20:].max() - before < 0.1 * kinetic


def test_gas_flows_in(balloon):
    rate = 0.02 * 4 / 3 * np.pi * RADIUS**3 / 1e-3
    lmp = balloon(gas=f"{LAW} inflow {rate}", move="")
    lmp.command("run 0")
    first = value(lmp, 2)
    lmp.command("run 100")  # at rest: 0.02 of it come in 1e-3 s
    assert value(lmp, 3) == pytest.approx(first + rate * 1e-3, rel=1e-12)
    more = value(lmp, 3) / first
    assert value(lmp, 1) == pytest.approx(AIR * (more**1.4 - 1), rel=1e-9)
    assert value(lmp, 4) == pytest.approx(AIR * first * (more**1.4 - 1) / 0.4, rel=1e-9)
    lmp.command("variable rate equal 2*step")
    lmp.command(f"fix gas all cloth/gas {LAW} inflow v_rate")
    lmp.command("reset_timestep 0")
    lmp.command("run 4")
    assert value(lmp, 3) == pytest.approx(first + 2 * (1 + 2 + 3 + 4) * 1e-5, rel=1e-12)


def test_a_valve_keeps_the_pressure_and_a_burst_ends_it(balloon):
    rate = 0.2 * 4 / 3 * np.pi * RADIUS**3 / 1e-3
    for words, flow, excess in (("valve 5000", 1, 5000), ("burst 5000", 2, 0)):
        lmp = balloon(gas=f"{LAW} inflow {rate} {words}", move="")
        lmp.command("run 10")
        assert column(lmp, 6) == 0 and 0 < value(lmp, 1) < 5000
        lmp.command("run 90")
        assert column(lmp, 6) == flow and value(lmp, 6) == 1
        assert value(lmp, 1) == pytest.approx(excess)
        outward = (by_id(lmp, "f") * by_id(lmp, "x")).sum() / 3
        assert outward == pytest.approx(excess * value(lmp, 2), rel=1e-9)


def test_chambers_have_states_of_their_own(balloon):
    x, faces = icosphere(0, RADIUS)
    both = np.concatenate([x, 2 * x + [0.6, 0, 0]])
    lmp = balloon(both, np.concatenate([faces, faces + len(x)]), gas=LAW, move="")
    lmp.command("run 0")
    assert value(lmp, 5) == 2
    assert column(lmp, 2, 2) == pytest.approx(8 * column(lmp, 2, 1))
    lmp.command("group second id > 12")
    lmp.command("displace_atoms second ramp x -0.1 0.1 x 0.4 0.8 units box")
    lmp.command("run 0")
    assert column(lmp, 1, 1) == pytest.approx(0, abs=1e-6)
    assert column(lmp, 1, 2) == pytest.approx(AIR * (1.5**-1.4 - 1), rel=1e-9)
    assert value(lmp, 2) == pytest.approx(column(lmp, 2, 1) + column(lmp, 2, 2))


def with_other_ids(balloon, faces, x, between):
    """A balloon behind two other atoms, which go away."""
    lone = [[0.2, 0, 0], [-0.2, 0, 0]]
    lmp = balloon(np.vstack([lone, x]), faces + 2, gas=f"{LAW} inflow 0.01")
    lmp.commands_string(f"run 20\ndelete_atoms group pair compress no\n{between}\nrun 20")
    return [value(lmp, n) for n in range(7)]


def test_a_chamber_goes_on_where_ids_are_given_anew(balloon):
    x, faces = icosphere(1, RADIUS)
    expected = with_other_ids(balloon, faces, x, "")
    assert expected[1] > 10
    found = with_other_ids(balloon, faces, x, "reset_atoms id")
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_chambers_that_cannot_be_told_apart_are_an_error(balloon):
    x, faces = icosphere(0, RADIUS)
    both = np.concatenate([x, 2 * x + [0.6, 0, 0]]), np.concatenate([faces, faces + len(x)])
    with pytest.raises(Exception, match="the 2 chambers cannot be told apart: use 'reset_atoms"):
        with_other_ids(balloon, both[1], both[0], "reset_atoms id")


MOVES = pytest.mark.parametrize("move", ["fix move all nve", "fix move all pbd/cloth"])
CHANGES = ["displace_atoms all ramp {} -1e-3 1e-3", "velocity all ramp v{} -3 3"]


@MOVES
@pytest.mark.parametrize("what", CHANGES)
def test_where_vertices_are_changed_between_runs_the_gas_knows_no_speed_of_before(
    balloon, move, what
):
    """As behind minimize, where there have been no steps."""
    ends = []
    for between in ("", "minimize 0 0 0 0\n"):
        lmp = balloon(move=move, dt=1e-4)
        change = "".join(f"{what.format(d)} {d} -0.1 0.1 units box\n" for d in "xyz")
        lmp.commands_string(f"run 3\n{change}{between}run 1")
        ends.append(by_id(lmp, "v"))
    assert np.abs(ends[1]).max() > 1
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-9 * np.abs(ends[1]).max())


@MOVES
def test_where_nothing_is_changed_between_runs_the_gas_goes_on(balloon, move):
    ends = []
    for runs in ("run 6", "run 3\nrun 0\nrun 3"):
        lmp = balloon(move=move, dt=1e-4, v=icosphere(1, 50 * RADIUS)[0])
        lmp.commands_string(runs)
        ends.append(by_id(lmp, "v"))
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-11)


def test_a_hole_is_named_and_can_be_closed_by_a_lid(balloon, capfd):
    x, faces = icosphere(0, RADIUS)
    apex = 5
    open_mesh = np.array([f for f in faces if apex not in f])
    rim = sorted({i for f in faces if apex in f for i in f} - {apex})
    kept = np.delete(np.arange(12), apex)
    named = [int(np.flatnonzero(kept == i)[0]) + 1 for i in rim]
    renumbered = np.searchsorted(kept, open_mesh)
    with pytest.raises(
        Exception, match=r"fix gas cloth/gas: the mesh of atom 1 is open, 1 hole"
    ) as e:
        balloon(x[kept], renumbered)
    words = re.search(r"bounded by atoms((?: \d+)+)", str(e.value))[1]
    assert sorted(map(int, words.split())) == named
    lmp = balloon(x[kept], renumbered, gas=f"polytropic 1.4 {1.1 * AIR} {AIR} close yes")
    lmp.command("run 0")
    middle = x[rim].mean(axis=0)
    lid = [
        (i, j, 12)
        for i in rim
        for j in rim
        if any({i, j, apex} == set(f) for f in faces) and np.linalg.det([x[i], x[j], x[apex]]) > 0
    ]
    closed = np.concatenate([open_mesh, lid])
    assert value(lmp, 2) == pytest.approx(volume(np.vstack([x, middle]), closed), rel=1e-12)
    force = by_id(lmp, "f")
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()


def test_an_open_mesh_is_pushed_toward_a_side(balloon):
    x = np.array([(i, j, 0) for i in range(4) for j in range(4)], dtype=float) * 0.1
    faces = np.array(
        [
            t
            for i in range(3)
            for j in range(3)
            for a in [4 * i + j]
            for t in ((a, a + 4, a + 1), (a + 1, a + 4, a + 5))
        ]
    )
    for words, sign in (("", 1), (" toward 0 0 1", 1), (" toward 0 0.5 -1", -1)):
        lmp = balloon(x, faces, gas="pressure 300" + words)
        lmp.command("run 0")
        assert by_id(lmp, "f").sum(axis=0) == pytest.approx([0, 0, sign * 300 * 0.09])
        assert value(lmp, 2) == pytest.approx(0, abs=1e-15)


def test_a_pressure_may_be_a_variable(balloon):
    lmp = balloon(gas="pressure 0", move="")
    lmp.command("variable p equal 100*step")
    lmp.command("fix gas all cloth/gas pressure v_p")
    lmp.command("run 3")
    assert value(lmp, 1) == 300
    assert value(lmp) - value(lmp, 4) == pytest.approx(0, abs=1e-12)


ERRORS = [
    ("pressure -1", r"fix gas cloth/gas: pressure is '-1': give a number >= 0"),
    ("pressure", r"pressure is missing"),
    ("polytropic 0.9 1e5 1e5", r"exponent n is '0.9': give 1 for a gas"),
    ("polytropic 1.4 0 1e5", r"pressure p0 of the start is '0'"),
    ("polytropic 1.4 1e5 -1", r"ambient pressure is '-1'"),
    ("polytropic 1.4 1e5", r"ambient pressure is missing"),
    (LAW + " inflow -1", r"inflow is '-1': give a number >= 0"),
    (LAW + " inflow v_none", r"inflow is 'v_none': define an equal-style variable"),
    ("pressure v_none", r"pressure is 'v_none': define an equal-style variable"),
    ("polytropic 1.4 1.1e5 1e5 valve 5000", r"valve is '5000': the gas starts at p0 - ambient"),
    ("polytropic 1.4 1.1e5 1e5 burst 5000", r"burst is '5000': the gas starts at"),
    (LAW + " valve 100 burst 200", r"burst is '200': the valve keeps the pressure at 100"),
    ("pressure 1 valve 100", r"valve is '100': .* leave it out, or use 'polytropic'"),
    ("pressure 1 inflow v_rate", r"inflow is 'v_rate': gas at a constant pressure"),
    ("pressure 1 close yes", r"close is 'yes': holes"),
    ("pressure 1 toward 0 0 1", r"toward is '0 0 1': the mesh is closed"),
    ("pressure 1 toward 0 0 0", r"toward is '0 0 0': give the direction"),
    (LAW + " toward 0 0 1", r"toward is '0 0 1': polytropic gas pushes outward"),
    (LAW + " leak 1", r"unknown keyword 'leak': use one of inflow, valve"),
    ("vacuum", r"law is 'vacuum': use pressure or polytropic"),
]


@pytest.mark.parametrize(("words", "message"), ERRORS, ids=[words for words, _ in ERRORS])
def test_bad_input_is_named(balloon, words, message):
    with pytest.raises(Exception, match=message):
        balloon(gas=words, level=0).command("run 0")


def test_meshes_that_are_no_chambers_are_named(balloon):
    x, faces = icosphere(0, RADIUS)
    with pytest.raises(Exception, match="more than two triangles meet at the edge of atoms"):
        other = next(i for i in range(12) if i not in faces[0])
        balloon(x, np.vstack([faces, [faces[0][0], faces[0][1], other]]))
    with pytest.raises(Exception, match="no triangle has all its vertices in the group"):
        balloon(x, faces).command(f"fix few pair cloth/gas {LAW}")
    strip = np.array([(0, 1, 2), (1, 2, 3), (2, 3, 4), (3, 4, 0), (4, 0, 1)])
    with pytest.raises(Exception, match="the surface is one-sided"):
        balloon(x[:5], strip)


def test_a_collapse_ends_all_ranks(tmp_path):
    x, faces = icosphere(0, RADIUS)
    data(tmp_path / "balloon.data", x, faces, MASS / 12, box=None)
    text = script() + "run 5\ndisplace_atoms all ramp x 0.3 -0.3 x -0.1 0.1 units box\nrun 5\n"
    assert re.search(
        r"fix gas cloth/gas: the chamber of atom 1 has a volume of -.* in step \d+",
        fail(write(tmp_path, text), 2),
    )


@pytest.mark.parametrize("newton", ["on", "off"])
def test_ranks_make_no_difference(tmp_path, newton):
    """The box is cut through the balloon, and two of four ranks are empty."""
    x, faces = icosphere(1, RADIUS)
    ends = {}
    for ranks, cut in ((1, "* * *"), (2, "2 1 1"), (4, "1 1 4")):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        data(
            folder / "balloon.data",
            x + np.array([0.6, 0.3, 0.12]),
            faces,
            MASS / len(x),
            box=(0.6,) * 3,
            v=np.random.default_rng(3).standard_normal(x.shape),
        )
        text = script(
            f"polytropic 1.4 {1.05 * AIR} {AIR} inflow 0.1 valve 6000",
            dt=1e-4,
            move="fix move all pbd/cloth",
            boundary="p p p",
            newton=newton,
        )
        text += (
            "run 40\nprint '$(f_gas:%.17g) $(f_gas[1]:%.17g) $(f_gas[2]:%.17g) "
            "$(f_gas[4]:%.17g) $(v_energy:%.17g)' file out.txt\n"
        )
        run(write(folder, f"processors {cut}\n{text}"), ranks)
        ends[ranks] = np.loadtxt(folder / "out.txt")
    for ranks in (2, 4):
        np.testing.assert_allclose(ends[ranks], ends[1], rtol=1e-10)


def test_a_restart_goes_on(tmp_path, monkeypatch):
    """Gas that has flowed in, the history of the volume, and a burst."""
    monkeypatch.chdir(tmp_path)
    x, faces = icosphere(1, RADIUS)
    data(tmp_path / "balloon.data", x, faces, MASS / len(x), v=x)
    start, ends = START.format(dt=3e-4, boundary="s s s", newton="on"), []
    for steps, burst in ((10, 3000), (10, 20)):
        fixes = f"fix gas all cloth/gas {LAW} inflow 0.01 burst {burst}\nfix move all nve\n"
        with contextlib.closing(instance()) as lmp:
            lmp.commands_string(start + fixes + f"run {steps}\nwrite_restart half\nrun {steps}\n")
            ends.append((value(lmp, 3), value(lmp, 6), by_id(lmp, "v")))
        with contextlib.closing(instance()) as lmp:
            again = start[start.index("neighbor") :].replace("read_data balloon.data", "")
            again = re.sub(r"pair_style.*\n|bond_style.*\n|angle_style.*\n", "", again)
            lmp.commands_string("comm_modify vel yes cutoff 0.3\nread_restart half\n")
            lmp.commands_string(re.sub(r"(pair|bond|angle)_coeff.*\n|timestep.*\n", "", again))
            lmp.commands_string(
                "pair_style zero 0.05\npair_coeff * *\nbond_style pbd\nbond_coeff * compliance 1\n"
                f"angle_style zero\nangle_coeff *\ntimestep 3e-4\n{fixes}run {steps}\n"
            )
            np.testing.assert_allclose(by_id(lmp, "v"), ends[-1][2], rtol=0, atol=1e-12)
            assert value(lmp, 3) == pytest.approx(ends[-1][0], rel=1e-13)
            assert value(lmp, 6) == ends[-1][1]
    assert ends[0][1] == 0 and ends[1][1] == 1
