"""fix sph/shift: crowded particles part, and nothing else happens."""

import math

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import (
    FLUID,
    MAKE_FLOW,
    box,
    cloth_box,
    filled,
    final_dump,
    header,
    jitter,
    lattice,
    neighbor,
    no_other_bonds,
    sph_tait,
    stiffness,
)

DX, H = 0.05, 0.15

# fluid in a periodic square, or between whatever `edges` says; one step moves nothing but shifts
SCENE = (
    header("{boundary}", FLUID, dimension=2)
    + box("{box}", 2)
    + "mass * {mass}\n"
    + lattice(dimension=2)
    + filled("water", "{water}")
    + "{more}\n"
    + jitter("{disorder}", 4711, dimension=2)
    + "group fluid type 1\nvelocity all set 0.3 0.4 0 units box\nset group all sph/rho 1000.0\n"
    + sph_tait("1 1 fluid 1000.0 c0 10", "2 2 boundary", support=0.15, options="tension yes {pair}")
    + neighbor(0.025)
    + """timestep 1e-3
{walls}
fix shift {group} sph/shift {shift}
thermo_modify norm no
"""
)
DEFAULTS = {
    "boundary": "p p p",
    "box": "0 1 0 1 -0.025 0.025",
    "water": "INF INF INF INF INF INF",
    "mass": 2.5,
    "more": "",
    "disorder": 0.0,
    "pair": "",
    "walls": "",
    "group": "fluid",
    "shift": "",
}


def scene(**changes):
    """Start LAMMPS and return it with the positions before any step."""
    lmp = instance()
    lmp.commands_string(SCENE.format(**DEFAULTS | changes) + "run 0")
    return lmp, by_id(lmp, "x")


def shift_once(**changes):
    """Positions, and what one step added to them; nothing else moves, since no fix integrates."""
    lmp, before = scene(**changes)
    lmp.command("run 1")
    moved = by_id(lmp, "x") - before
    return lmp, before, moved - np.rint(moved)


# ---------------------------------------------------------------------- what it does


def test_a_lattice_stays():
    lmp, _, moved = shift_once()
    assert np.abs(moved).max() < 1e-15
    assert lmp.extract_fix("shift", 0, 0) < 1e-14
    assert lmp.extract_fix("shift", 0, 1, 1) == 400
    assert lmp.extract_fix("shift", 0, 1, 2) == 0


def test_shift_is_that_of_the_formula():
    """Against sums over all pairs of the periodic square, written here anew."""
    strength, clumping = 0.7, 0.35
    lmp, x = scene(disorder=0.01, shift=f"strength {strength} clumping {clumping} max 1.0")
    rho = by_id(lmp, "rho")
    lmp.command("run 1")
    moved = by_id(lmp, "x") - x
    r = x[:, None, :2] - x[None, :, :2]
    r -= np.rint(r)
    q = np.sqrt(np.sum(r**2, axis=2)) / H
    np.fill_diagonal(q, 2.0)  # not its own neighbor

    def shape(q):
        return np.where(q < 1, (1 - np.minimum(q, 1)) ** 4 * (1 + 4 * q), 0)

    slope = np.where(q < 1, -20 * (1 - np.minimum(q, 1)) ** 3, 0)
    volume = 2.5 / rho
    weight = 1 + clumping * (shape(q) / shape(DX / H)) ** 4
    gradient = 7 / (math.pi * H**4) * np.sum((volume * weight * slope)[..., None] * r, axis=1)
    expected = -strength * H * 0.5 * 1e-3 * gradient
    np.testing.assert_allclose(moved[:, :2], expected, atol=1e-14)
    assert np.all(moved[:, 2] == 0)
    length = np.linalg.norm(moved, axis=1)
    assert lmp.extract_fix("shift", 0, 0) == pytest.approx(length.max() / DX, rel=1e-9)
    assert lmp.extract_fix("shift", 0, 1, 0) == pytest.approx(length.sum(), rel=1e-9)


@pytest.mark.parametrize("pair", ["", "density continuity", "kernel quintic"])
def test_a_disturbed_lattice_becomes_regular(pair):
    lmp, _ = scene(disorder=0.01, pair=pair)
    spread = []
    for _ in range(2):
        x = by_id(lmp, "x")[:, :2]
        r = x[:, None] - x[None]
        r -= np.rint(r)
        distance = np.sqrt(np.sum(r**2, axis=2)) + 9 * np.eye(len(x))
        q = np.minimum(distance, H) / H
        spread.append((np.sum((1 - q) ** 4 * (1 + 4 * q), axis=1).std(), distance.min()))
        lmp.command("run 300")
    assert spread[1][0] < 0.3 * spread[0][0]
    assert spread[1][1] > 1.1 * spread[0][1]


def test_velocities_are_left_alone_unless_corrected():
    lmp, _ = scene(disorder=0.01)
    lmp.commands_string("variable u atom 0.2*y\nvelocity all set v_u 0 0 units box\nrun 0")
    before = by_id(lmp, "v")
    lmp.command("run 20")
    np.testing.assert_array_equal(by_id(lmp, "v"), before)

    # in u = (a y, b x) the correction is exact to the accuracy of the gradient
    lmp, x = scene(disorder=0.01, shift="correct yes", box="0 1 0 1 -0.025 0.025")
    lmp.commands_string("variable u atom 0.2*y\nvelocity all set v_u 0 0 units box\nrun 0")
    before = by_id(lmp, "v")
    lmp.command("run 1")
    moved, change = by_id(lmp, "x") - x, by_id(lmp, "v") - before
    inside = np.all((x[:, :2] > 0.2) & (x[:, :2] < 0.8), axis=1)
    error = change[inside, 0] - 0.2 * moved[inside, 1]
    assert np.abs(error).max() < 0.15 * np.abs(0.2 * moved[inside, 1]).max()
    assert np.abs(change[inside, 1]).max() < 1e-15


def test_speed_own_and_none():
    """Particles at rest are not shifted with `speed own`; faster ones in proportion."""
    lmp, x = scene(disorder=0.01, shift="speed own max 1.0")
    lmp.commands_string("group half id <= 200\nvelocity half set 0 0 0 units box\nrun 1")
    moved = by_id(lmp, "x") - x
    assert np.all(moved[:200] == 0)
    assert np.abs(moved[200:]).max() > 0
    lmp, x = scene(disorder=0.01)
    lmp.commands_string("velocity all set 0 0 0\nrun 1")
    np.testing.assert_array_equal(by_id(lmp, "x"), x)


def test_max_cuts_and_is_counted():
    lmp, _, free = shift_once(disorder=0.01, shift="strength 50 max 1.0")
    assert lmp.extract_fix("shift", 0, 1, 3) == 0
    lmp, _, cut = shift_once(disorder=0.01, shift="strength 50 max 0.02")
    length, limit = np.linalg.norm(free, axis=1), 0.02 * DX
    expected = free * np.minimum(1, limit / length)[:, None]
    np.testing.assert_allclose(cut, expected, atol=1e-14)
    assert lmp.extract_fix("shift", 0, 1, 3) == np.sum(length > limit) > 0
    assert lmp.extract_fix("shift", 0, 0) == pytest.approx(0.02, rel=1e-9)


def test_only_the_group_is_shifted():
    _, x, moved = shift_once(
        disorder=0.01,
        more="region low block 0 1 0 0.5 -1 1 units box\ngroup low region low",
        group="low",
    )
    assert np.all(moved[x[:, 1] > 0.52] == 0)
    assert np.any(moved[x[:, 1] < 0.48] != 0)


# ---------------------------------------------------------------------- free surfaces, walls, cloth


@pytest.mark.parametrize("ratio", [2, 3, 4])
@pytest.mark.parametrize("disorder", [0.0, 0.005])
def test_nothing_moves_within_a_support_of_a_free_surface(ratio, disorder):
    lmp, x, moved = shift_once(
        boundary="p f p",
        water="INF INF 0.2 0.8 INF INF",
        box="0 1 -0.5 1.5 -0.025 0.025",
        disorder=disorder,
        walls=f"pair_style sph/tait {ratio * DX} tension yes\npair_coeff 1 1 fluid 1000 c0 10\n"
        "pair_coeff 2 2 boundary",
    )
    depth = np.minimum(x[:, 1] - 0.2, 0.8 - x[:, 1])
    assert np.all(moved[depth < (ratio - 0.5) * DX] == 0)
    if disorder and ratio < 4:
        assert np.all(np.any(moved[depth > (ratio + 1.5) * DX] != 0, axis=1))
    assert lmp.extract_fix("shift", 0, 1, 2) > 0


def test_a_lone_particle_and_a_pair_stay():
    for others in ("", "create_atoms 1 single 0.51 0.5 0"):
        _, _, moved = shift_once(
            water="2 3 2 3 INF INF", more=f"create_atoms 1 single 0.5 0.5 0\n{others}"
        )
        assert np.all(moved == 0)


def test_wall_particles_count():
    """Layers of wall that go on with the lattice: no free surface, and no push."""
    steps = np.arange(-2, 3)
    q = np.minimum(np.hypot(steps[:, None], steps[None]) * DX / H, 1)
    volume = 1 / (7 / (math.pi * H**2) * np.sum((1 - q) ** 4 * (1 + 4 * q)))
    lmp, _, moved = shift_once(
        water="INF INF 0.3 0.6 INF INF",
        mass=1000 * volume,
        walls=f"pair_coeff 2 2 boundary volume {volume}",
        more="region rest block INF INF 0.3 0.6 INF INF units box side out\n"
        "create_atoms 2 region rest",
    )
    assert lmp.extract_fix("shift", 0, 1, 2) == 0
    assert lmp.extract_fix("shift", 0, 1, 1) == 120
    assert np.abs(moved).max() < 1e-12 * DX
    # without them the same rows are at a free surface
    lmp, _, _ = shift_once(water="INF INF 0.3 0.6 INF INF")
    assert lmp.extract_fix("shift", 0, 1, 2) == 120


@pytest.mark.parametrize(
    ("role", "contact", "shifted"),
    [
        ("boundary", None, False),
        ("boundary", "sides no", False),
        ("none", "", False),
        ("none", "wall yes", False),
        ("none", "sides no wall yes", True),
        ("none", "sides no", True),
        ("none", None, True),
    ],
)
def test_nothing_moves_beside_a_sheet_that_the_fluid_feels(role, contact, shifted):
    lmp = instance()
    lmp.commands_string(
        header("p p p", "hybrid sph molecular")
        + cloth_box("0 0.6 0 0.6 0 0.6")
        + "mass * 0.125\n"
        + lattice()
        + filled("water", "INF INF INF INF INF INF")
        + "group water type 1\n"
        + jitter(0.005, 4711, "water")
        + "create_cloth 2 1.0 center 0.31 0.31 0.3 size 0.4 0.4 spacing 0.05 group cloth\n"
        + sph_tait("1 1 fluid 1000 c0 10", f"2 2 {role}", options="tension yes")
        + stiffness("1.0", "0.0")
        + no_other_bonds()
        + neighbor(0.05)
        + "timestep 1e-3\nvelocity water set 0.3 0.4 0 units box\n"
        + "fix sheet cloth pbd/cloth pin cloth\n"
        + ("" if contact is None else f"fix contact water cloth/contact 0.01 {contact}\n")
        + "fix shift water sph/shift\nrun 0\n"
    )
    water = by_id(lmp, "type") == 1
    x = by_id(lmp, "x")[water]
    lmp.command("run 1")
    moved = np.any(by_id(lmp, "x")[water] != x, axis=1)
    beside = np.all(np.abs(x - [0.31, 0.31, 0.3]) < [0.2, 0.2, 0.05], axis=1)
    assert np.sum(beside) > 100
    assert np.all(moved[beside] == shifted)


def test_plane_walls_count():
    """A particle beside a plane at half a spacing has its share of fluid behind the plane."""
    tank = {"boundary": "p f p", "box": "0 1 -0.5 1.5 -0.025 0.025"}
    tank |= {"water": "INF INF 0.2 0.8 INF INF", "shift": "clumping 0 strength 1"}
    lmp, _, _ = shift_once(**tank, walls="")
    assert lmp.extract_fix("shift", 0, 1, 2) > 0
    lmp, _, moved = shift_once(**tank, walls="fix wall fluid wall/sph ylo 0.2 yhi 0.8")
    assert lmp.extract_fix("shift", 0, 1, 2) == 0
    # the gradient of the wall cancels that of the fluid to the error of the lattice; without it
    # a particle in the plane is shifted by U dt w, w = 14/(3 pi) for this kernel
    assert np.abs(moved).max() < 0.1 * 0.5e-3 * 14 / (3 * math.pi)
    np.testing.assert_allclose(np.sum(moved, axis=0), 0, atol=1e-12)


def test_a_particle_too_near_a_plane_wall_is_shifted_off():
    tank = {"boundary": "p f p", "box": "0 1 -0.5 1.5 -0.025 0.025"}
    tank |= {"water": "INF INF 0.2 0.8 INF INF", "shift": "clumping 0"}
    near, far = (
        shift_once(**tank, walls=f"fix wall fluid wall/sph ylo {low} yhi 0.8")[1:]
        for low in (0.215, 0.185)
    )
    lowest = near[0][:, 1] < 0.25
    assert np.all(near[1][lowest, 1] > 0)
    assert np.all(far[1][lowest, 1] < 0)


# ---------------------------------------------------------------------- ranks, restart, steps

FLOW = (
    "variable steps index 60\nvariable dump index end.txt\n{start}\ncomm_modify vel yes\n"
    + neighbor(0.02)
    + """timestep 1e-3
{style}
fix shift all sph/shift strength 2 correct {correct}
fix step all sph/integrate global max 2e-3
fix flat all enforce2d
"""
)
READ = (
    header(atoms=FLUID, dimension=2)
    + "read_data flow.data\n"
    + sph_tait(
        "1 1 fluid 1000.0 c0 10 nu 1e-3", support=0.15, options="tension yes density {density}"
    )
)
WRITE = final_dump()


def flow(restart=False, density="summation", correct="yes", style=""):
    start = "read_restart mid.restart" if restart else READ.format(density=density)
    return FLOW.format(start=start, correct=correct, style=style)


@pytest.mark.parametrize("density", ["summation", "continuity"])
def test_ranks_and_run_style(tmp_path, density):
    """A tilted periodic box, on 1, 2 and 4 ranks, under both run styles."""
    run(write(tmp_path, MAKE_FLOW, "in.make"))
    end = "run ${steps}\n" + WRITE
    verlet = write(tmp_path, flow(density=density) + end, "in.verlet")
    adaptive = flow(density=density).replace("fix flat", "run_style sph/adaptive global\nfix flat")
    adaptive = write(tmp_path, adaptive + end, "in.adaptive")
    run(verlet, dump="one.txt")
    one = last_frame(tmp_path / "one.txt")
    for ranks, script in ((2, verlet), (4, verlet), (1, adaptive), (2, adaptive)):
        run(script, ranks=ranks, dump="other.txt")
        assert np.abs(last_frame(tmp_path / "other.txt") - one).max() < 1e-10
    bare = flow(density=density).replace("strength 2", "strength 0") + end
    run(write(tmp_path, bare, "in.bare"), dump="bare.txt")
    assert np.abs(last_frame(tmp_path / "bare.txt") - one).max() > 1e-4


def test_a_surface_on_another_rank(tmp_path):
    """The surface is within reach of particles behind the cut between two ranks."""
    region = "region water block INF INF INF 0.58 INF INF units box\ncreate_atoms 1 region water"
    run(write(tmp_path, MAKE_FLOW.replace("create_atoms 1 box", region), "in.make"))
    script = flow() + "run 60\nprint 'left $(f_shift[3]:%.0f)'\n" + WRITE
    cut = script.replace("read_data", "processors 1 2 1\nread_data")
    printed = run(write(tmp_path, script, "in.one"), dump="one.txt")
    assert int(printed.rsplit("left ", 1)[1].split()[0]) > 80
    run(write(tmp_path, cut, "in.cut"), ranks=2, dump="cut.txt")
    one, two = (last_frame(tmp_path / f"{name}.txt") for name in ("one", "cut"))
    assert np.abs(one - two).max() < 1e-10


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("density", ["summation", "continuity"])
def test_restart_continues_to_the_last_bit(tmp_path, ranks, density):
    run(write(tmp_path, MAKE_FLOW, "in.make"), ranks=ranks)
    # no thermo output may hide what the fix counts
    end = "run 40\nprint 'moved $(f_shift[1]:%.17g)'\n" + WRITE
    first = "run 30\nwrite_restart mid.restart\n"
    whole = run(
        write(tmp_path, flow(density=density) + first + end, "in.whole"),
        ranks=ranks,
        dump="whole.txt",
    )
    again = run(
        write(tmp_path, flow(restart=True) + end, "in.again"), ranks=ranks, dump="again.txt"
    )
    np.testing.assert_array_equal(
        last_frame(tmp_path / "again.txt"), last_frame(tmp_path / "whole.txt")
    )
    moved = [float(out.rsplit("moved ", 1)[1].split()[0]) for out in (whole, again)]
    assert moved[0] == pytest.approx(moved[1], rel=1e-12)
    assert moved[0] > 0


def test_split_runs_are_one_run(tmp_path):
    run(write(tmp_path, MAKE_FLOW, "in.make"))
    run(write(tmp_path, flow() + "run 60\n" + WRITE, "in.whole"), dump="whole.txt")
    run(write(tmp_path, flow() + "run 25\nrun 35\n" + WRITE, "in.split"), dump="split.txt")
    whole, split = (last_frame(tmp_path / f"{name}.txt") for name in ("whole", "split"))
    assert np.abs(whole - split).max() < 1e-10


def test_momentum_of_the_flow_is_kept(tmp_path):
    run(write(tmp_path, MAKE_FLOW, "in.make"))
    run(write(tmp_path, flow(correct="no") + WRITE, "in.start"), dump="start.txt")
    run(write(tmp_path, flow(correct="no") + "run 60\n" + WRITE, "in.end"), dump="end.txt")
    before, after = (
        last_frame(tmp_path / f"{name}.txt")[:, 4:].sum(axis=0) for name in ("start", "end")
    )
    np.testing.assert_allclose(after, before, atol=1e-11)
