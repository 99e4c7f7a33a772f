"""Cloth far from any use: its motion stays finite and keeps momentum, or an error names it.

SPHCLOTH_EXAMPLES=5000 looks at as many random cloths in each test that draws them.
"""

import os
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

EPS = np.finfo(float).eps


def examples(n, phases=tuple(Phase)):
    """The same examples in every run of the suite."""
    return settings(
        max_examples=int(os.environ.get("SPHCLOTH_EXAMPLES", n)),
        phases=phases,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )


# ---- a cloth as data ----------------------------------------------------------------------------


@dataclass
class Cloth:
    """Vertices with a mass each, bonds and hinges with their types, and what the fix is told."""

    x: np.ndarray
    rest: np.ndarray
    v: np.ndarray
    mass: np.ndarray
    bonds: list[tuple[int, int, int]]  # two vertices from 0, type
    hinges: list[tuple[int, int, int, int, int]]
    bond_coeffs: list[str]
    hinge_coeffs: list[str] = field(default_factory=lambda: ["0", "0"])
    options: str = "solver gs direction current"
    dt: float = 1e-3
    steps: int = 3
    pins: list[int] = field(default_factory=list)
    box: float = 0.0  # edge of a periodic box around the origin; 0: none, the box follows

    def data(self):
        """A data file: every vertex is of a type of its own, so that it has a mass of its own."""
        n = len(self.x)
        half = 0.5 * self.box or 2 * np.abs(self.x).max() + 1
        folded = self.x - self.box * np.floor(self.x / self.box + 0.5) if self.box else self.x
        image = np.rint((self.x - folded) / self.box).astype(int) if self.box else 0 * self.x
        image = image.astype(int)
        at_most = max(8, 2 * len(self.bonds), 4 * len(self.hinges))
        lines = ["cloth", "", f"{n} atoms", f"{len(self.bonds)} bonds"]
        lines += [f"{len(self.hinges)} dihedrals", f"{n} atom types"]
        lines += [f"{len(self.bond_coeffs)} bond types", f"{len(self.hinge_coeffs)} dihedral types"]
        lines += [f"{at_most} extra bond per atom", f"{at_most} extra dihedral per atom"]
        lines += [f"{-half:.17g} {half:.17g} {d}lo {d}hi" for d in "xyz"]

        def section(name, rows, numbered=True):
            if len(rows):
                lines.extend(["", name, ""])
            for k, row in enumerate(rows):
                words = [f"{w:.17g}" if isinstance(w, float) else str(w) for w in row]
                lines.append(" ".join(([str(k + 1)] if numbered else []) + words))

        section("Masses", [(float(m),) for m in self.mass])
        section(
            "Atoms # molecular",
            [(1, k + 1, *map(float, folded[k]), *image[k]) for k in range(n)],
        )
        section("Velocities", [tuple(map(float, u)) for u in self.v])
        section("rest", [tuple(map(float, r)) for r in self.rest])
        section("Bonds", [(t, i + 1, j + 1) for i, j, t in self.bonds])
        section("Dihedrals", [(t, a + 1, b + 1, c + 1, d + 1) for a, b, c, d, t in self.hinges])
        return "\n".join(lines) + "\n"

    def script(self, newton="on"):
        """Commands up to and without the run; the data file is cloth.data."""
        boundary = "p p p" if self.box else "s s s"
        lines = [f"newton {newton}", "units si", "atom_style molecular", "atom_modify map yes"]
        lines += ["atom_modify sort 0 0", f"boundary {boundary}", "comm_modify vel yes"]
        lines += ["special_bonds lj/coul 1 1 1", "fix rest all property/atom d2_rest 3"]
        lines += ["read_data ${data} fix rest NULL rest", "bond_style pbd"]
        lines += [f"bond_coeff {t} {c}" for t, c in enumerate(self.bond_coeffs, 1)]
        if self.hinges:
            lines += ["dihedral_style pbd"]
            lines += [f"dihedral_coeff {t} {c}" for t, c in enumerate(self.hinge_coeffs, 1)]
        lines += [f"comm_modify cutoff {0.5 * self.box or 1}", "neighbor 0.1 nsq"]
        # no list is renewed, since LAMMPS loses atoms that are further out than digits last
        lines += ["neigh_modify every 1000000 delay 0 check no", f"timestep {self.dt:.17g}"]
        pin = ""
        if self.pins:
            lines += [f"group pins id {' '.join(str(k + 1) for k in self.pins)}"]
            pin = "pin pins"
        lines += [f"fix sheet all pbd/cloth {self.options} rest d2_rest {pin}", "run 0"]
        return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all examples."""
    return tmp_path_factory.mktemp("extremes")


def start(cloth, folder, newton="on"):
    """The cloth in LAMMPS, before its first step."""
    path = folder / "cloth.data"
    path.write_text(cloth.data())
    lmp = instance()
    lmp.command(f"variable data index {path}")
    lmp.commands_string(cloth.script(newton))
    return lmp


def unwrapped(lmp, box=0.0):
    """Positions as if there were no periodic box."""
    x = by_id(lmp, "x")
    if not box:
        return x
    return x + box * np.array([lmp.decode_image_flags(int(i)) for i in by_id(lmp, "image")])


def motion(cloth, folder, newton="on"):
    """Positions and velocities at the start and after every step."""
    lmp = start(cloth, folder, newton)
    seen = [(unwrapped(lmp, cloth.box), by_id(lmp, "v"))]
    for _ in range(cloth.steps):
        lmp.command("run 1 pre no post no")
        seen.append((unwrapped(lmp, cloth.box), by_id(lmp, "v")))
    output = [lmp.extract_fix("sheet", 0, 1, k) for k in range(7)]
    return np.array([x for x, _ in seen]), np.array([v for _, v in seen]), output


# ---- cloths drawn at random ---------------------------------------------------------------------

FEW = st.integers(-3, 3)


@st.composite
def points(draw, n):
    """Points that coincide, lie on lines and in planes, or nearly so, or far away."""
    grid = np.array(draw(st.lists(st.tuples(FEW, FEW, FEW), min_size=n, max_size=n)), float)
    noise = np.random.default_rng(draw(st.integers(0, 99))).uniform(-1, 1, (n, 3))
    noise *= draw(st.sampled_from([0.0, 1e-170, 1e-155, 1e-100, 1e-15, 1e-8, 1e-4, 0.3]))
    stretch = draw(st.sampled_from([1.0, 1.0, 1.0, 1e-3, 1e3]))
    one = draw(st.integers(0, n - 1))
    x = 0.25 * grid + noise
    x[one] *= stretch
    return x


def members(n, k):
    return st.lists(st.integers(0, n - 1), min_size=k, max_size=k, unique=True)


TIMES = st.sampled_from([1e-6, 1e-3, 0.02, 1.0])
POWERS = st.floats(-3, 3)
STIFFNESS = st.sampled_from([0.0, 1e-12, 0.3, 0.999, 1.0])
COMPLIANCE = st.sampled_from([0.0, 1e-12, 1e-4, 1.0, 1e3, 1e300])


@st.composite
def bond_coeff(draw):
    if draw(st.booleans()):
        compliance = draw(COMPLIANCE)
        shares = [0.0, 0.3, 1.0] if compliance > 0 else [0.0, 1.0]
        text = f"compliance {compliance}"
    else:
        text, shares = f"{draw(STIFFNESS)}", [0.0, 1.0]
    if draw(st.booleans()):
        text += f" compress {draw(st.sampled_from(shares))}"
    if draw(st.booleans()):
        text += f" limit {draw(st.sampled_from([0.0, 0.05, 2.0]))}"
    return text + draw(st.sampled_from(["", "", " rest zero"]))


@st.composite
def hinge_coeff(draw):
    text = f"compliance {draw(COMPLIANCE)}" if draw(st.booleans()) else f"{draw(STIFFNESS)}"
    return text + draw(st.sampled_from(["", " rest flat"]))


@st.composite
def options(draw, directions=("current", "start")):
    return (
        f"solver {draw(st.sampled_from(['gs', 'jacobi', 'substeps']))} "
        f"direction {draw(st.sampled_from(directions))} "
        f"iterations {draw(st.sampled_from([1, 2, 7, 50]))} "
        f"damping {draw(st.sampled_from([0.0, 0.0, 1.0, 1e4]))}"
    )


@st.composite
def cloths(draw, pinned=False):
    n = draw(st.integers(2, 8))
    x = draw(points(n))
    rest = draw(points(n)) + 0.1 if draw(st.booleans()) else x + 0.1
    types = st.integers(1, 2)
    bonds = draw(st.lists(st.tuples(members(n, 2), types), min_size=1, max_size=12))
    hinges = draw(
        st.lists(st.tuples(members(n, 4 if n > 3 else n), types), max_size=6 if n > 3 else 0)
    )
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    return Cloth(
        x=x,
        rest=rest,
        v=rng.uniform(-1, 1, (n, 3)) * draw(st.sampled_from([0.0, 1.0, 1e3])),
        mass=np.array(draw(st.lists(POWERS.map(lambda e: 10**e), min_size=n, max_size=n))),
        bonds=[(*b, t) for b, t in bonds],
        hinges=[(*h, t) for h, t in hinges],
        bond_coeffs=[draw(bond_coeff()), draw(bond_coeff())],
        hinge_coeffs=[draw(hinge_coeff()), draw(hinge_coeff())],
        options=draw(options()),
        dt=draw(TIMES),
        steps=draw(st.integers(1, 5)),
        pins=sorted(draw(st.sets(st.integers(0, n - 1), min_size=1))) if pinned else [],
    )


def round_off(cloth, x, v):
    """What the sum of the momenta can lose.

    Velocities are differences of positions over the (small) step, and a position is rounded by up
    to EPS/2 |x| whenever a constraint moves it: a heavy vertex far away loses that times m/dt.
    Nothing is lost beyond that, however light its partners are.
    """
    busy = np.zeros(len(cloth.x), int)
    for *vertices, _ in cloth.bonds:
        busy[vertices] += 3  # an edge is up to three constraints
    for *vertices, _ in cloth.hinges:
        busy[vertices] += 1
    iterations = int(cloth.options.split("iterations ")[1].split()[0])
    roundings = cloth.steps * iterations * (2 + busy.max())
    dt = cloth.dt / (iterations if "substeps" in cloth.options else 1)
    size = np.linalg.norm(x, axis=2).max(axis=0) + dt * np.linalg.norm(v, axis=2).max(axis=0)
    return 0.5 * EPS * roundings * (cloth.mass * size).sum() / dt


def finite_motion(cloth, folder):
    """The motion, without the few cloths that end with the error which says why."""
    try:
        x, v, output = motion(cloth, folder)
    except Exception as error:
        assume("flew apart" not in str(error))
        raise
    assert np.isfinite(x).all() and np.isfinite(v).all() and np.isfinite(output).all()
    return x, v


@examples(600)
@given(cloth=cloths())
def test_free_cloth_stays_finite_and_keeps_momentum(folder, cloth):
    x, v = finite_motion(cloth, folder)
    momentum = np.einsum("i,tid->td", cloth.mass, v)
    scale = np.einsum("i,ti->t", cloth.mass, np.linalg.norm(v, axis=2)).max()
    changed = np.linalg.norm(momentum - momentum[0], axis=1).max()
    assert changed <= max(1e-12 * scale, round_off(cloth, x, v))


@examples(150)
@given(cloth=cloths(pinned=True))
def test_pins_stay_to_the_last_bit(folder, cloth):
    x, v = finite_motion(cloth, folder)
    assert (x[:, cloth.pins] == x[0, cloth.pins]).all()
    assert (v[:, cloth.pins] == 0).all()


# ---- gentle cloths: what holds beyond that ------------------------------------------------------


@st.composite
def gentle_cloths(draw, hinges=0, directions=("current", "start")):
    """Edges of half a meter or more that move by little in a step, at every mass and stiffness."""
    n = draw(st.integers(4, 8))
    grid = draw(st.lists(st.tuples(FEW, FEW, FEW), min_size=n, max_size=n, unique=True))
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    x = 0.5 * np.array(grid) + rng.uniform(-0.02, 0.02, (n, 3))
    types = st.integers(1, 2)
    bonds = draw(st.lists(st.tuples(members(n, 2), types), min_size=1, max_size=12))
    bends = draw(st.lists(st.tuples(members(n, 4), types), min_size=hinges, max_size=hinges))
    dt = draw(st.sampled_from([1e-3, 0.02, 1.0]))
    plain = bond_coeff().map(lambda text: text.replace(" rest zero", ""))
    return Cloth(
        x=x,
        rest=x + rng.uniform(-0.002, 0.002, (n, 3)),
        v=rng.uniform(-0.01, 0.01, (n, 3)) / dt,
        mass=np.array(draw(st.lists(POWERS.map(lambda e: 10**e), min_size=n, max_size=n))),
        bonds=[(*b, t) for b, t in bonds],
        hinges=[(*h, t) for h, t in bends],
        bond_coeffs=[draw(plain), draw(plain)],
        hinge_coeffs=[draw(hinge_coeff()), draw(hinge_coeff())],
        options=draw(options(directions)),
        dt=dt,
    )


@examples(150)
@given(cloth=gentle_cloths(directions=["start"]))
def test_edges_along_their_start_keep_angular_momentum(folder, cloth):
    """A step changes sum m x_start x v, and what edges give is along their x_start.

    With `direction current` and for hinges the change is of first order in the step.
    """
    x, v = finite_motion(cloth, folder)
    spin = np.einsum("i,tid->td", cloth.mass, np.cross(x, v))
    changed = np.linalg.norm(spin - spin[0], axis=1).max()
    # the lever of all roundings is at most the size of the cloth
    assert changed <= np.linalg.norm(x, axis=2).max() * round_off(cloth, x, v)


def moved_to(cloth, center, box):
    return replace(cloth, x=cloth.x + center, rest=cloth.rest + center, box=box)


@examples(60)
@given(cloth=gentle_cloths(), center=st.tuples(*3 * [st.sampled_from([0.0, 4.0, 3.3])]))
def test_a_periodic_border_changes_nothing(folder, cloth, center):
    x, v = finite_motion(cloth, folder)
    there, v_there = finite_motion(moved_to(cloth, np.array(center), 8.0), folder)
    assert np.abs(there - center - x).max() < 1e-9
    assert np.abs(v_there - v).max() < 1e-9 / cloth.dt


@examples(60)
@given(cloth=cloths())
def test_newton_off_is_newton_on_to_the_last_bit(folder, cloth):
    x, v = finite_motion(cloth, folder)
    x_off, v_off, _ = motion(cloth, folder, newton="off")
    assert (x_off == x).all() and (v_off == v).all()


END = """
run STEPS
write_dump all custom end.txt id x y z vx vy vz modify sort id format float %.17g
"""


@examples(8, [Phase.generate])  # each starts two programs: no search for a simpler failure
@given(cloth=gentle_cloths(hinges=4), newton=st.sampled_from(["on", "off"]))
def test_two_ranks_are_one_to_the_last_bit(folder, cloth, newton):
    """Without periodic images no number is shifted, so that not even round-off differs."""
    (folder / "cloth.data").write_text(cloth.data())
    script = cloth.script(newton).replace("cutoff 1\n", "cutoff 20\n") + END
    script = write(folder, script.replace("STEPS", str(cloth.steps)))
    ends = []
    for ranks in (1, 2):
        run(script, ranks, data="cloth.data")
        ends.append(last_frame(folder / "end.txt"))
    assert (ends[0] == ends[1]).all() and np.isfinite(ends[0]).all()


# ---- every extreme by its name ------------------------------------------------------------------

SQUARE = [[0.2, 1, 0], [0, 0, 0], [1, 0, 0], [0.4, -1, 0]]  # wing, edge, edge, wing
FREE_HINGE = {"hinges": [(0, 1, 2, 3, 1)], "bond_coeffs": ["0"], "bonds": [(1, 2, 1)]}


def one_cloth(x, rest=None, **more):
    x = np.array(x, float)
    rest = x if rest is None else np.array(rest, float)
    plain = {"bonds": [(0, 1, 1)], "hinges": [], "bond_coeffs": ["1"], "hinge_coeffs": ["1"]}
    plain |= {"options": "solver gs direction current iterations 20", "dt": 0.01}
    return Cloth(x, rest + 7, 0 * x, np.ones(len(x)), **(plain | more))


@pytest.mark.parametrize("coefficient", ["1", "compliance 1e-3 compress 0.5 limit 0.1"])
def test_ends_that_coincide_stay_until_they_are_parted(folder, coefficient):
    """They have no direction to be pushed apart in."""
    cloth = one_cloth([[1, 2, 3]] * 2, [[0, 0, 0], [1, 0, 0]], bond_coeffs=[coefficient])
    x, v, _ = motion(cloth, folder)
    assert (x == [1, 2, 3]).all() and (v == 0).all()


def test_one_edge_without_rest_length_closes_to_a_point(folder):
    x, _, output = motion(one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0]] * 2), folder)
    assert np.abs(x[-1, 0] - x[-1, 1]).max() < 4 * EPS
    assert output[4] < 4 * EPS  # nothing has a size: the residual is a length


def test_one_edge_is_a_cloth(folder):
    x, _, _ = motion(one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]]), folder)
    assert x[1, :, 0] == pytest.approx([-0.5, 1.5], abs=4 * EPS)
    assert (x[1:, :, 1:] == 0).all()


@pytest.mark.parametrize("text", ["compliance 1e300", "compliance 1e10 compress 1e-310"])
def test_a_compliance_beyond_all_measure_does_nothing(folder, text):
    """Over the time step squared, and over the share in compression, it would be infinite."""
    pair = [[1, 1, 1], [2, 1, 1]], [[0, 0, 0], [2, 0, 0]]
    x, _, _ = motion(one_cloth(*pair, bond_coeffs=[text], dt=1e-6), folder)
    assert (x == x[0]).all()


HEIGHTS = {"sliver": 1e-9, "on the edge": 0.0, "denormal": 1e-310}


@pytest.mark.parametrize("height", HEIGHTS.values(), ids=HEIGHTS)
def test_a_triangle_without_a_normal_has_no_hinge(folder, height):
    wing = [[0.2, height, 0], *SQUARE[1:]]
    bent = [[0.2, 0.8, 0.5], *SQUARE[1:]]
    x, _, _ = motion(one_cloth(wing, bent, **FREE_HINGE), folder)
    assert (x == x[0]).all()


def test_a_rest_shape_without_an_angle_is_flat(folder):
    flat = motion(one_cloth([[0.2, 0.8, 0.5], *SQUARE[1:]], SQUARE, **FREE_HINGE), folder)[0]
    none = [[0.2, 0, 0], *SQUARE[1:]]
    x, _, _ = motion(one_cloth([[0.2, 0.8, 0.5], *SQUARE[1:]], none, **FREE_HINGE), folder)
    assert (x == flat).all() and (x[1] != x[0]).any()


POSES = {
    "flat": SQUARE,
    "folded": [[0.2, 1, 0], [0, 0, 0], [1, 0, 0], [0.4, 1, 0]],
    "nearly folded": [[0.2, 1, 1e-9], [0, 0, 0], [1, 0, 0], [0.4, 1, 0]],
    "inverted": [[0.2, 1, 1], [0, 0, 0], [1, 0, 0], [0.4, -1, 0]],
}


@pytest.mark.parametrize("pose", POSES)
def test_a_hinge_finds_its_angle_from_everywhere(folder, pose):
    """From flat, from both sides of folded and from the wrong side, with edges that hold."""
    rest = [[0.2, 1, -1], *SQUARE[1:]]
    edges = [(0, 1, 1), (0, 2, 1), (1, 2, 1), (1, 3, 1), (2, 3, 1)]
    cloth = one_cloth(POSES[pose], rest, **(FREE_HINGE | {"bonds": edges}), steps=100)
    cloth.bond_coeffs = ["compliance 1e-6"]
    cloth.options = "solver gs direction current iterations 200 damping 50"
    _, _, output = motion(cloth, folder)
    assert output[4] < 1e-3


def test_both_ends_pinned(folder):
    cloth = one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]], pins=[0, 1])
    x, _, output = motion(cloth, folder)
    assert (x == x[0]).all()
    assert output[3] == output[4] == 0  # a length that is the user's


def test_pieces_do_not_know_of_each_other(folder):
    piece = np.array([[0.2, 1, 0.7], *SQUARE[1:]])
    alone, _, _ = motion(one_cloth(piece, SQUARE, **FREE_HINGE), folder)
    cloth = one_cloth(
        [*piece, *piece, [9, 9, 9]],
        [*SQUARE, *SQUARE, [9, 9, 9]],
        bonds=[(1, 2, 1), (5, 6, 1)],
        bond_coeffs=["0"],
        hinges=[(0, 1, 2, 3, 1), (4, 5, 6, 7, 1)],
    )
    x, _, _ = motion(cloth, folder)
    assert (x[1] != x[0]).any()
    assert (x[:, :4] == alone).all() and (x[:, 4:8] == alone).all()
    assert (x[:, 8] == 9).all()  # no bond, no force: it stays


def test_a_bond_that_is_written_twice_is_one(folder):
    pair = [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]]
    once, _, _ = motion(one_cloth(*pair, bond_coeffs=["0.5"]), folder)
    twice = one_cloth(*pair, bond_coeffs=["0.5"], bonds=[(0, 1, 1), (1, 0, 1), (0, 1, 1)])
    assert (motion(twice, folder)[0] == once).all()


@pytest.mark.parametrize("bonds", [[(0, 1, 1), (0, 1, 2)], [(0, 1, 2), (1, 0, 1)]])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_bonds_of_two_types_between_the_same_vertices_both_act(folder, bonds, newton):
    """A spring and a limit of the strain, in any order."""
    cloth = one_cloth(
        [[0, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [1, 0, 0]],
        bonds=bonds,
        bond_coeffs=["compliance 1e3", "0 limit 0.5"],
        steps=1,
    )
    x, _, _ = motion(cloth, folder, newton)
    assert x[1, 1, 0] - x[1, 0, 0] == pytest.approx(1.5, rel=1e-6)


def test_three_triangles_at_one_edge_rest(folder):
    """Each pair of them is a hinge, and none wants anything at rest."""
    x = [[0.5, 1, 0], [0, 0, 0], [1, 0, 0], [0.5, -0.5, 0.9], [0.5, -0.5, -0.9]]
    hinges = [(0, 1, 2, 3, 1), (3, 1, 2, 4, 1), (4, 1, 2, 0, 1)]
    seen, _, _ = motion(one_cloth(x, bonds=[(1, 2, 1)], hinges=hinges), folder)
    assert np.abs(seen - seen[0]).max() < 100 * EPS


def no_mass(cloth, folder):
    lmp = start(cloth, folder)
    lmp.commands_string("fix mass all property/atom rmass ghost yes\nrun 0")


def lost_rest(cloth, folder, fix="again"):
    lmp = start(cloth, folder)
    lmp.command(f"write_restart {folder}/x.restart")
    lmp = instance()
    lmp.commands_string(
        f"atom_modify map yes\nread_restart {folder}/x.restart\ncomm_modify vel yes\n"
        f"fix {fix} all property/atom d2_rest 3\nfix anew all pbd/cloth rest d2_rest\nrun 0"
    )


ENDS = {
    "no mass": (no_mass, {}, r"vertex 2 has no mass: give it one with 'set group all mass'"),
    "one vertex": (start, {"bonds": [], "x": [[0, 0, 0]]}, r"group all has no bonds"),
    "rest positions not filled": (lost_rest, {}, r"'d2_rest' is 0 everywhere: .* by the fix ID"),
    "rest position of NaN": (
        start,
        {"rest": [[0, 0, 0], [0, np.nan, 0]]},
        r"vertex 2 has no rest position",
    ),
    "hinges that contradict each other": (
        motion,
        {
            "x": [*SQUARE[:3], [0.4, -1, 0.3]],
            "rest": [*SQUARE[:3], [0.4, -0.3, -0.8]],
            "hinges": [(0, 1, 2, 3, 1), (3, 1, 2, 0, 2)],
            "bond_coeffs": ["0"],
            "hinge_coeffs": ["1", "1 rest flat"],
            "options": "solver gs direction current iterations 100",
            "steps": 100,
        },
        r"flew apart in step \d+: hinges may contradict",
    ),
}


@pytest.mark.parametrize(("act", "more", "message"), ENDS.values(), ids=ENDS)
def test_ends_with_an_error_that_names_it(folder, act, more, message):
    cloth = one_cloth(**({"x": [[0, 0, 0], [1, 0, 0]]} | more))
    with pytest.raises(Exception, match=r"fix \w+ pbd/cloth: .*" + message):
        act(cloth, folder)


@pytest.mark.parametrize(
    ("more", "message"),
    [({"bonds": [(0, 0, 1)]}, "Bonds"), ({"hinges": [(0, 1, 2, 0, 1)]}, "Dihedrals")],
)
def test_a_vertex_twice_in_a_bond_or_hinge_is_refused_by_lammps(folder, more, message):
    with pytest.raises(Exception, match=f"Invalid atom ID in {message} section"):
        start(one_cloth(SQUARE, **more), folder)


def test_rest_positions_that_are_found_again_after_a_restart(folder):
    """Otherwise the error above would prove nothing."""
    lost_rest(one_cloth([[0, 0, 0], [1, 0, 0]]), folder, fix="rest")
