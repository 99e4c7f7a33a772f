"""Reference solutions of the cases with cloth, against known numbers and limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import j0

from sphcloth.references import folded_chain, light_cloth, stiffness
from sphcloth.references.cantilever import HeavyElastica
from sphcloth.references.catenary import HangingPolygon
from sphcloth.references.chain import LinkedPendulum
from sphcloth.references.hanging_chain import HangingChain
from sphcloth.references.pendulum import pendulum_period
from sphcloth.references.rest_angle import hinge_angles
from sphcloth.references.terminal_velocity import FallingSheet
from sphcloth.references.wind_pendulum import WindPendulum
from sphcloth.references.xpbd_oscillator import Oscillator
from sphcloth.validation import cloth

G = 9.81


# hanging-chain


def test_stretch_and_support_of_the_hanging_chain() -> None:
    chain = HangingChain(20, 0.05, 0.05, 1e-3, G)
    assert chain.stretch == pytest.approx(0.103005, rel=1e-12)
    assert chain.heights[-1] == pytest.approx(-1.103005, rel=1e-12)
    assert chain.heights[0] == pytest.approx(-0.05981, rel=1e-12)
    assert chain.support == pytest.approx(G, rel=1e-12)


def test_one_bond_of_100_newtons_per_metre_stretches_by_its_weight() -> None:
    bond = HangingChain(1, 0.1, 1.0, 1e-2, G)
    assert bond.stretch == pytest.approx(9.81e-3)
    assert bond.slowest == pytest.approx(math.sqrt(100 / 0.1))


def test_slowest_motion_of_a_chain_of_springs_is_an_eigenvalue() -> None:
    chain, n = HangingChain(7, 0.2, 1.0, 3e-3, G), 7
    stiffness_matrix = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiffness_matrix[-1, -1] = 1
    lowest = np.linalg.eigvalsh(stiffness_matrix / (3e-3 * 0.2))[0]
    assert chain.slowest == pytest.approx(math.sqrt(lowest), rel=1e-12)


# catenary


def test_sag_of_the_polygon() -> None:
    polygon = HangingPolygon(20, 1.0, 0.6, 0.05, G)
    assert polygon.sag == pytest.approx(0.363452616, abs=5e-10)
    assert polygon.pull / (20 * 0.05 * G) == pytest.approx(0.163102600716, rel=1e-10)
    links = np.linalg.norm(np.diff(polygon.joints, axis=0), axis=1)
    np.testing.assert_allclose(links, 0.05, rtol=1e-12)
    np.testing.assert_allclose(polygon.joints[-1], [0.3, 0], atol=1e-12)


def test_polygon_of_many_links_is_the_catenary() -> None:
    # span = 2 a asinh(L / 2a); sag = sqrt(L^2/4 + a^2) - a
    a = HangingPolygon(4000, 1.0, 0.6, 1.0, G).pull / (4000 * G)
    assert 2 * a * math.asinh(0.5 / a) == pytest.approx(0.6, rel=1e-6)
    sag = HangingPolygon(4000, 1.0, 0.6, 1.0, G).sag
    assert sag == pytest.approx(math.hypot(0.5, a) - a, rel=1e-6)


def test_elastic_polygon_balances_and_has_an_odd_number_of_links() -> None:
    polygon = HangingPolygon(21, 1.3, 0.7, 0.03, 4.0, 2e-3)
    steps = np.diff(polygon.joints, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    pulls = ((lengths - 1.3 / 21) / 2e-3 / lengths)[:, None] * steps
    weights = np.diff(pulls, axis=0)
    np.testing.assert_allclose(weights[:, 0], 0, atol=1e-10)
    np.testing.assert_allclose(weights[:, 1], 0.03 * 4.0, rtol=1e-10)


# pendulum and the chain of links


@pytest.mark.parametrize(("degrees", "known"), [(10, 2.009893), (90, 2.367842), (170, 4.893524)])
def test_period_of_the_simple_pendulum(degrees: float, known: float) -> None:
    assert pendulum_period(1.0, G, math.radians(degrees)) == pytest.approx(known, abs=5e-7)


def test_a_single_link_swings_with_its_period() -> None:
    length, angle = 0.7, 2.0
    pendulum = LinkedPendulum.uniform(1, length, angle, 3.0)
    after = pendulum.positions(pendulum_period(length, 3.0, angle))[0]
    np.testing.assert_allclose(after, pendulum.positions(0.0)[0], atol=1e-8)


def test_two_links_obey_newton() -> None:
    """Positions with unequal links and masses against accelerations from tensions."""
    lengths, masses = (0.4, 0.9), (0.3, 1.1)
    pendulum = LinkedPendulum(lengths, masses, (0.5, 1.7), G)

    def slope(_: float, state: np.ndarray) -> np.ndarray:
        x, v = state[:4].reshape(2, 2), state[4:].reshape(2, 2)
        links = np.array([x[0], x[1] - x[0]])
        rates = np.array([v[0], v[1] - v[0]])
        units = links / np.array(lengths)[:, None]
        # tensions T from d^2 |link|^2 / dt^2 = 0
        pull = np.array(
            [[-units[0] / masses[0], units[1] / masses[0]], [0 * units[0], -units[1] / masses[1]]]
        )
        gravity = np.array([[0, -G], [0, -G]])
        relative = np.array([pull[0], pull[1] - pull[0]])
        matrix = np.einsum("id,ijd->ij", units, relative)
        fall = np.array([gravity[0], gravity[1] - gravity[0]])
        right = -np.sum(units * fall, axis=1) - np.sum(rates**2, axis=1) / np.array(lengths)
        tensions = np.linalg.solve(matrix, right)
        return np.concatenate(
            [v.ravel(), (gravity + np.einsum("j,ijd->id", tensions, pull)).ravel()]
        )

    start = np.concatenate([pendulum.positions(0.0).ravel(), np.zeros(4)])
    newton = solve_ivp(slope, (0, 1), start, "DOP853", rtol=1e-11, atol=1e-12).y[:4, -1]
    np.testing.assert_allclose(pendulum.positions(1.0).ravel(), newton, atol=1e-7)


def test_energy_of_a_chain_is_kept_and_a_level_one_falls_freely_at_first() -> None:
    chain = LinkedPendulum.uniform(3, 1.0, math.pi / 2, G)
    assert abs(chain.energy_drift(1.5)) < 1e-9
    np.testing.assert_allclose(chain.accelerations(), [[0, -G]] * 3, atol=1e-12)


def test_small_swings_of_a_long_chain_are_those_of_a_rope() -> None:
    """The lowest mode of a hanging rope is J0(2 omega sqrt(s / g)), s from the free end."""
    links, omega, small = 60, 2.404825557695773 / 2 * math.sqrt(G), 1e-4
    s = 1 - np.arange(links + 1) / links
    shape = small * j0(2 * omega * np.sqrt(s / G))
    chain = LinkedPendulum([1 / links] * links, [1.0] * links, np.diff(shape) * links, G)
    quarter = math.pi / 2 / omega
    tip = chain.positions(np.array([0.0, quarter]))[:, -1, 0]
    assert abs(tip[1]) < 0.03 * abs(tip[0])


# folded-chain


def test_time_of_the_fall_of_a_folded_chain() -> None:
    assert folded_chain.fall_over_free_fall() == pytest.approx(0.847213, abs=5e-7)
    assert folded_chain.free_fall(2.0, 4.0) == 1.0


def test_a_folded_chain_of_more_links_falls_more_like_one_of_no_thickness() -> None:
    free = folded_chain.free_fall(1.0, G)
    excess = [
        folded_chain.time_of_fall(folded_chain.folded(links, 1.0, G)) / free - 0.847213
        for links in (11, 21, 41)
    ]
    assert 0.1 > excess[0] > 1.5 * excess[1] > 2.5 * excess[2] > 0


# cantilever


@pytest.mark.parametrize(("gamma", "drop"), [(1, 0.123471), (5, 0.495905), (10, 0.700200)])
def test_drop_of_the_heavy_elastica(gamma: float, drop: float) -> None:
    assert HeavyElastica(gamma).drop == pytest.approx(drop, abs=5e-7)


def test_limits_of_the_heavy_elastica() -> None:
    assert HeavyElastica(1e-3).drop == pytest.approx(1e-3 / 8, rel=1e-6)
    assert HeavyElastica(100.0).drop == pytest.approx(0.9375239, abs=1e-6)
    s = np.linspace(0, 1, 2001)
    path = HeavyElastica(20.0).shape(s)
    assert np.sum(np.hypot(*np.diff(path, axis=1))) == pytest.approx(1, rel=1e-6)


# xpbd-oscillator


def test_oscillator_of_implicit_euler() -> None:
    oscillator = Oscillator(1.0, 1e-3, 1 / 60)
    motion = oscillator.motion(0.5, np.arange(6))
    known = [0.5, 0.3913043478, 0.2211720227, 0.03994411112, -0.1105699308, -0.2043265873]
    np.testing.assert_allclose(motion, known, atol=5e-10)
    assert abs(oscillator.eigenvalue) == pytest.approx(1 / math.sqrt(1 + 1000 / 3600))


def test_oscillator_is_the_recurrence_of_its_step_and_tends_to_the_exact_one() -> None:
    oscillator, x, v = Oscillator(0.3, 2e-2, 0.01), 1.0, 0.0
    square, h = oscillator.omega**2, oscillator.step
    for _ in range(20):
        v = (v - h * square * x) / (1 + h**2 * square)
        x += h * v
    assert oscillator.motion(1.0, np.array([20]))[0] == pytest.approx(x, rel=1e-13)
    fine, steps = Oscillator(0.3, 2e-2, 1e-6), np.array([10_000, 100_000])
    np.testing.assert_allclose(fine.motion(1.0, steps), fine.exact(1.0, steps), atol=1e-5)


# rest-angle


@pytest.mark.parametrize("degrees", [-150.0, -90.0, -1e-7, 0.0, 30.0, 150.0, 179.0])
def test_angle_of_a_hinge(degrees: float) -> None:
    angle = math.radians(degrees)
    wing = [math.cos(angle), 0.3, -math.sin(angle)]
    corners = np.array([[[-1, 0.2, 0], [0, -0.5, 0], [0, 0.5, 0], wing]])
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    assert hinge_angles(corners)[0] == pytest.approx(angle, abs=1e-14)
    assert hinge_angles(2 + corners @ turn.T)[0] == pytest.approx(angle, abs=1e-14)


# light-cloth and stiffness


def test_a_sheet_held_at_one_edge_falls_freely_far_from_it() -> None:
    assert light_cloth.lowest(20, 1.0, G, 0.2) == pytest.approx(-0.5 * G * 0.2**2, rel=1e-9)
    late = light_cloth.falling_sheet(20, 1.0, G).positions(0.6)[:, 1]
    assert -0.99 < late.min() < -0.5


def test_steps_of_a_free_vertex_and_of_one_on_an_edge() -> None:
    v = z = 0.0
    for _ in range(30):
        v -= G * 0.01
        z += v * 0.01
    assert stiffness.free_fall(G, 0.01, 30) == pytest.approx(-z, rel=1e-12)
    assert stiffness.first_stretch(0.0, G, 0.01) == stiffness.free_fall(G, 0.01, 1)
    assert stiffness.free_fall(G, 0.01, 30, 0.5) == pytest.approx(0.5 * G * 0.3**2, rel=1e-12)
    assert stiffness.first_stretch(1.0, G, 0.01) == 0


# steps


@pytest.mark.parametrize(
    ("time", "largest", "frames"), [(1.0, 1e-3, 10), (0.37, 1 / 60, 10), (0.01, 0.1, 4)]
)
def test_steps_end_at_the_time_and_are_not_too_large(
    time: float, largest: float, frames: int
) -> None:
    steps = cloth.stepping(time, largest, frames)
    assert steps["dt"] <= largest * (1 + 1e-9)
    assert steps["dt"] * steps["every"] * frames == pytest.approx(time, rel=1e-12)


@pytest.mark.parametrize(("time", "largest"), [(1.0, 2e-3), (2.486, 1e-3), (1.0, 0.02), (0.01, 1)])
def test_frames_near_a_number_leave_the_step_as_it_is(time: float, largest: float) -> None:
    frames = cloth.frames_near(time, largest, 200)
    assert frames <= 400
    step = cloth.stepping(time, largest, frames)["dt"]
    assert min(time, largest) * 0.99 < step <= largest * (1 + 1e-9)


# wind-pendulum and terminal-velocity


def test_drag_balances_weight_at_the_angle_of_the_wind_pendulum() -> None:
    sheet = WindPendulum(4.0, 0.2, 1.2, 1.17, 0.05, G)
    across = 0.5 * 1.2 * 1.17 * (4.0 * math.cos(sheet.angle)) ** 2
    assert across == pytest.approx(0.2 * G * math.sin(sheet.angle), rel=1e-12)
    # with the pull along the sheet all forces balance
    pull = sheet.pressure - [0.0, 0.2 * G]
    assert pull @ [math.cos(sheet.angle), math.sin(sheet.angle)] == pytest.approx(0, abs=1e-12)
    gale = WindPendulum(1e3, 0.2, 1.2, 1.17, 0.0, G)
    assert math.degrees(gale.angle) == pytest.approx(90, abs=0.2)


def test_a_plate_swings_to_its_angle_at_rest() -> None:
    sheet = WindPendulum(4.0, 0.2, 1.2, 1.17, 0.0, G)
    angles = sheet.swing(0.5, np.linspace(0, 5, 6))
    assert angles[-1] == pytest.approx(sheet.angle, rel=1e-6)
    # at first m/2 L theta'' = rho/2 C_n A/2 U^2 (1/3 + 2/3)
    early = sheet.swing(0.5, np.array([0.0, 1e-3]))[-1]
    turn = 0.5 * 1.2 * 1.17 * 16.0 / 0.2 / 0.5
    assert early == pytest.approx(0.5 * turn * 1e-6, rel=0.05)


def test_a_sheet_falls_freely_at_first_and_evenly_at_last() -> None:
    sheet = FallingSheet(0.2, 1.2, 1.17, G)
    assert sheet.terminal**2 == pytest.approx(2 * 0.2 * G / (1.2 * 1.17))
    times = np.array([1e-3, 10.0, 11.0])
    assert sheet.fall(times)[0] == pytest.approx(0.5 * G * 1e-6, rel=1e-4)
    assert np.diff(sheet.fall(times))[1] == pytest.approx(sheet.terminal, rel=1e-9)
    h = 1e-5
    slope = (sheet.fall(times[:1] + h) - sheet.fall(times[:1] - h)) / (2 * h)
    assert slope == pytest.approx(sheet.velocity(times[:1]), rel=1e-6)
