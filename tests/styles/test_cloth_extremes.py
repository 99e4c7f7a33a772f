"""Cloth far from any use: its motion stays finite and keeps momentum, or an error names it.

SPHCLOTH_EXAMPLES=5000 looks at as many random cloths in each test that draws them.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from cloth_data import EPS, Cloth, motion
from harness import last_frame, run, write
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st


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


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all examples."""
    return tmp_path_factory.mktemp("extremes")


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


@examples(300)
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
