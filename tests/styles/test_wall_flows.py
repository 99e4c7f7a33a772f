"""fix wall/sph against exact flows: a column at rest, start-up between walls, slip."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from harness import by_id, instance, run, write
from scenes import FLUID, filled, gravity, header, lattice, neighbor, sph_tait
from scenes import box as a_box
from wall_scenes import C0, RHO0, H, channel


@pytest.mark.parametrize("dim", [2, 3])
def test_the_floor_carries_the_weight(dim):
    dx = 0.05
    up = "y" if dim == 2 else "z"
    lmp = instance()
    lmp.commands_string(
        header("p f p" if dim == 2 else "p p f", FLUID, dimension=dim)
        + a_box("0 0.2 -0.2 0.6 -0.025 0.025" if dim == 2 else "0 0.2 0 0.2 -0.2 0.6")
        + f"mass 1 {RHO0 * dx**dim}\n"
        + lattice(dx, dim)
        + filled("water", "INF INF 0 0.4 INF INF" if dim == 2 else "INF INF INF INF 0 0.4")
        + sph_tait(f"1 1 fluid {RHO0} c0 {C0} alpha 0.5", support=3 * dx)
        + neighbor(0.03)
        + "timestep 0.002\n"
        + gravity(vector="0 -1 0" if dim == 2 else "0 0 -1")
        + f"""
        fix step all sph/integrate global
        fix wall all wall/sph {up}lo 0
        fix mean all ave/time 1 1000 1000 f_wall[{dim}]
        run 4000"""
    )
    weight = by_id(lmp, "x").shape[0] * RHO0 * dx**dim * 9.81
    assert -lmp.extract_fix("mean", 0, 0) == pytest.approx(weight, rel=1e-3)
    height = by_id(lmp, "x")[:, dim - 1]
    # the layer may settle on the plane itself
    assert -0.1 * dx < height.min() < 0.5 * dx


L, NU_MORRIS, V0, BODY = 1e-3, 1e-6, 1.25e-5, 1e-4


def couette(y, t):
    u = V0 * y / L
    for n in range(1, 200):
        decay = math.exp(-NU_MORRIS * (n * math.pi / L) ** 2 * t)
        u = u + 2 * V0 / (n * math.pi) * (-1) ** n * np.sin(n * math.pi * y / L) * decay
    return u


def poiseuille(y, t):
    u = BODY / (2 * NU_MORRIS) * y * (L - y)
    for n in range(1, 200, 2):
        decay = math.exp(-NU_MORRIS * (n * math.pi / L) ** 2 * t)
        u = (
            u
            - 4
            * BODY
            * L**2
            / (NU_MORRIS * (n * math.pi) ** 3)
            * np.sin(n * math.pi * y / L)
            * decay
        )
    return u


@pytest.mark.parametrize(("exact", "limit"), [(couette, 0.005), (poiseuille, 0.01)])
def test_start_up_between_walls(exact, limit):
    """Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214, with 40 particles across."""
    dx = L / 40
    lid = f"velocity yhi {V0} 0 0" if exact is couette else ""
    drive = "" if exact is couette else f"fix drive all gravity {BODY} vector 1 0 0"
    lmp = instance()
    lmp.commands_string(
        header("p f p", FLUID, dimension=2)
        + a_box(f"0 {8 * dx} {-3 * dx} {L + 3 * dx} {-dx} {dx}")
        + lattice(dx, 2)
        + filled("water", f"INF INF 0 {L} INF INF")
        + f"mass 1 {RHO0 * dx**2}\n"
        + sph_tait(
            f"1 1 fluid {RHO0} c0 {20 * V0} nu {NU_MORRIS}",
            support=3 * dx,
            options="tension yes",
        )
        + neighbor(0.5 * dx)
        + f"""
        timestep 1
        fix step all sph/integrate global
        fix wall all wall/sph ylo 0 yhi {L} {lid}
        {drive}"""
    )
    for t in (0.0225, 0.045, 0.1125, 0.225, 1.0):
        lmp.commands_string(f"""
            variable reached equal time>={t}
            fix stop all halt 1 v_reached >= 1 error continue message no
            run 100000 post no
            unfix stop""")
        y, u = by_id(lmp, "x")[:, 1], by_id(lmp, "v")[:, 0]
        expected = exact(y, lmp.get_thermo("time"))
        assert np.linalg.norm(u - expected) < limit * np.linalg.norm(expected)


@pytest.mark.parametrize("flow", [{}, {"lid": 0.0, "drive": 1e-4}])
def test_drag_in_the_example(flow, tmp_path):
    """The plates take up what viscosity carries: the last line of the log of in.couette."""
    example = Path(__file__).parents[2] / "examples" / "couette" / "in.couette"
    script = write(tmp_path, example.read_text(), "in.couette")
    run(script, ranks=2, n=20, **flow)
    line = re.findall(r"^  - \[(.*)\]", (tmp_path / "log.lammps").read_text(), re.MULTILINE)[-1]
    time, _, lower, steady_lower, upper, steady_upper = map(float, line.strip(", ").split(",")[1:])
    assert time > 0.85  # all but 2e-4 of the transient is over
    assert lower == pytest.approx(steady_lower, rel=1e-2)
    assert upper == pytest.approx(steady_upper, rel=1e-2)


def test_slip_walls_leave_a_uniform_flow_alone():
    lmp, _, _ = channel(
        "ylo 0 yhi {ly} slip yes",
        extra="""
        pair_coeff 1 1 fluid 1000 c0 20 nu 0.01
        velocity all set 1 0 0 units box
        timestep 1e-4
        fix step all sph/integrate constant
        run 500""",
    )
    np.testing.assert_allclose(by_id(lmp, "v")[:, 0], 1.0, rtol=1e-12)


def test_a_moving_wall_has_its_velocity_after_a_restart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    walls = "ylo 0 yhi v_place"
    moves = (
        "variable place equal {ly}*(1-0.5*time)\ntimestep 1e-4\n"
        "fix step all sph/integrate constant\n"
    )
    lmp, _, ly = channel(walls, size=(8, 9), extra="variable place equal v_ly")
    lmp.commands_string(moves.format(ly=ly) + "run 20\nwrite_restart mid\nrun 0")
    again = instance()
    again.commands_string(
        f"comm_modify vel yes\nread_restart mid\n{neighbor(0.4 * H / 3)}"
        f"fix wall all wall/sph {walls.format(ly=ly)}\n{moves.format(ly=ly)}run 0"
    )
    assert np.abs(by_id(lmp, "drho")).max() > 0
    for _ in range(2):
        for name in ("drho", "rho", "x", "f"):
            assert np.array_equal(by_id(lmp, name), by_id(again, name)), name
        lmp.command("run 5")
        again.command("run 5")
