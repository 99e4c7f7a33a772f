"""Solutions that the cases with water are compared with: known numbers, equations and limits."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erfc

from sphcloth.errors import UserError
from sphcloth.references import dam_break
from sphcloth.references.couette import CouetteStart
from sphcloth.references.hydrostatic import TaitColumn
from sphcloth.references.jet import Jet
from sphcloth.references.lintearia import HeavyLintearia, Lintearia
from sphcloth.references.oscillating_drop import EllipticDrop
from sphcloth.references.pinned_weight import Load
from sphcloth.references.poiseuille import PoiseuilleStart
from sphcloth.references.standing_wave import StandingWave
from sphcloth.references.taylor_green import TaylorGreen
from sphcloth.validation import compare
from sphcloth.validation.cases.dam_break import Front
from sphcloth.validation.cases.oscillating_drop import Motion
from sphcloth.validation.cases.taylor_green import Decay
from sphcloth.validation.lattice import KERNELS, cubic_density_sum, density_sum


@pytest.mark.parametrize(("sound", "settlement"), [(10, 4.871e-3), (20, 1.242e-3)])
def test_settlement_of_the_tait_column(sound: float, settlement: float) -> None:
    column = TaitColumn(1.0, 1000.0, 9.81, sound * math.sqrt(9.81), 7.0)
    assert column.settlement == pytest.approx(settlement, abs=5e-7)
    assert column.level(0.01) < column.level(0.0) < 1.0


def test_tait_column_is_the_integral_of_its_density() -> None:
    column = TaitColumn(2.5, 870.0, 3.7, 25.0, 4.2)
    stiffness = 870.0 * 25.0**2 / 4.2

    def stretch(depth: float) -> float:
        return (1 + float(column.pressure(depth)) / stiffness) ** (-1 / 4.2)

    assert column.level(0.4) == pytest.approx(quad(stretch, 0.4, 2.5)[0], rel=1e-9)


def test_period_of_the_standing_wave() -> None:
    assert StandingWave(1.0, 2.0, 9.81).period == pytest.approx(1.133917, abs=1e-6)
    shallow = StandingWave(0.01, 2.0, 9.81)
    assert shallow.period == pytest.approx(2.0 / math.sqrt(9.81 * 0.01), rel=1e-3)


def test_viscosity_makes_the_period_of_a_standing_wave_longer() -> None:
    wave = StandingWave(1.0, 2.0, 9.81)
    assert wave.viscous(0.0) == 0
    assert wave.viscous(1e-6) == pytest.approx(0, abs=1e-8)
    # of small viscosities the first term is sqrt(2) (nu k^2/omega)^(3/2)
    share = 1e-3
    viscosity = share * 2 * math.pi / wave.period / wave.number**2
    assert wave.viscous(viscosity) == pytest.approx(math.sqrt(2) * share**1.5, rel=0.05)
    assert wave.viscous(4 * viscosity) > 7 * wave.viscous(viscosity)


def test_mode_of_the_standing_wave_is_incompressible_and_slips_along_the_bottom() -> None:
    wave, step = StandingWave(1.3, 2.1, 9.81), 1e-6
    at = np.array([[0.3, 0.7], [0.3 + step, 0.7], [0.3, 0.7 + step], [0.4, 0.0], [0.0, 1.3]])
    mode = wave.mode(at)
    assert (mode[1, 0] - mode[0, 0] + mode[2, 1] - mode[0, 1]) / step == pytest.approx(0, abs=1e-4)
    assert mode[3, 1] == 0
    assert mode[4, 1] == pytest.approx(1)


def test_elliptic_drop() -> None:
    drop = EllipticDrop(0.5, 1.0)
    assert drop.period == pytest.approx(4.567374, abs=1e-6)
    assert drop.largest == pytest.approx(math.sqrt(2), rel=1e-12)
    along_x, along_y = drop.semi_axes([0.182694952, drop.period / 4, 0.75 * drop.period])
    np.testing.assert_allclose(along_x, [1.09427566, math.sqrt(2), math.sqrt(0.5)], rtol=1e-8)
    np.testing.assert_allclose(along_x * along_y, 1, rtol=1e-12)


def test_a_hardly_strained_drop_has_the_period_of_small_oscillations() -> None:
    assert EllipticDrop(1e-3, 2.0).period == pytest.approx(math.pi / math.sqrt(2), rel=1e-5)


def test_times_of_the_drop_scale_with_its_field() -> None:
    assert EllipticDrop(1.5, 3.0).period == pytest.approx(EllipticDrop(0.5, 1.0).period / 3)


MORRIS_TIMES = (0.0225, 0.045, 0.1125, 0.225)


def test_poiseuille_flow_starts_like_that_of_morris() -> None:
    flow = PoiseuilleStart(1e-3, 1e-6, 1e-4)
    assert flow.fastest == pytest.approx(1.25e-5)
    middle = [float(flow.velocity(5e-4, t)) / flow.fastest for t in MORRIS_TIMES]
    assert middle == pytest.approx([0.178619, 0.338766, 0.659993, 0.887984], abs=5e-7)
    assert flow.velocity([0.0, 1e-3], 0.1) == pytest.approx(0, abs=1e-18)
    assert flow.drag(1000.0) == pytest.approx(1000.0 * 1e-4 * 1e-3 / 2)


def test_couette_flow_starts_like_that_of_morris() -> None:
    flow = CouetteStart(1e-3, 1e-6, 1.25e-5)
    middle = [float(flow.velocity(5e-4, t)) for t in MORRIS_TIMES]
    known = [2.302765682e-07, 1.194751641e-06, 3.628440987e-06, 5.386287273e-06]
    assert middle == pytest.approx(known, rel=1e-8)
    assert flow.velocity([0.0, 1e-3], 0.1) == pytest.approx([0, 1.25e-5], abs=1e-18)


def test_early_flow_under_a_sliding_plate_is_that_of_a_half_space() -> None:
    flow, t = CouetteStart(0.2, 3e-3, 1.7), 0.1
    y = np.linspace(0.1, 0.2, 6)
    stokes = 1.7 * erfc((0.2 - y) / (2 * math.sqrt(3e-3 * t)))
    np.testing.assert_allclose(flow.velocity(y, t), stokes, atol=1e-7)


@pytest.mark.parametrize("time", [1e-6, 1e-5, 1e-4, 1e-2, 0.0999, 0.1, 1.0])
def test_flows_between_plates_are_their_series_with_all_terms(time: float) -> None:
    """Times in gap^2 / nu; after 4000 terms nothing is left at the first of them."""
    y, n = np.linspace(0, 1, 41), np.arange(1, 4001)[:, np.newaxis]
    decay = np.sin(n * np.pi * y) * np.exp(-((n * np.pi) ** 2) * time)
    couette = y + np.sum(2 / (n * np.pi) * (-1.0) ** n * decay, axis=0)
    poiseuille = y * (1 - y) / 2 - np.sum((4 / (n * np.pi) ** 3 * decay)[::2], axis=0)
    gap, nu = 1e-3, 1e-6
    flow, driven = CouetteStart(gap, nu, 1.5), PoiseuilleStart(gap, nu, 0.7)
    t = time * gap**2 / nu
    np.testing.assert_allclose(flow.velocity(gap * y, t), 1.5 * couette, atol=1e-12)
    exact = 0.7 * gap**2 / nu * poiseuille
    np.testing.assert_allclose(driven.velocity(gap * y, t), exact, atol=1e-12 * driven.fastest)


def test_flows_between_plates_start_at_rest() -> None:
    y = np.linspace(0, 1e-3, 21)
    sliding = CouetteStart(1e-3, 1e-6, 1.5).velocity(y, 0.0)
    np.testing.assert_array_equal(sliding, np.append(np.zeros(20), 1.5))
    np.testing.assert_array_equal(PoiseuilleStart(1e-3, 1e-6, 0.7).velocity(y, 0.0), 0.0)


@pytest.mark.parametrize("flow", [CouetteStart(2.0, 0.3, 1.5), PoiseuilleStart(2.0, 0.3, 0.7)])
def test_flows_between_plates_obey_the_equation_of_motion(
    flow: CouetteStart | PoiseuilleStart,
) -> None:
    y, t, dy, dt = np.linspace(0.2, 1.8, 9), 0.6, 1e-3, 1e-4
    rate = (flow.velocity(y, t + dt) - flow.velocity(y, t - dt)) / (2 * dt)
    ends = flow.velocity(y + dy, t) + flow.velocity(y - dy, t)
    bend = (ends - 2 * flow.velocity(y, t)) / dy**2
    drive = getattr(flow, "drive", 0.0)
    np.testing.assert_allclose(rate, flow.nu * bend + drive, atol=1e-5)
    slope = float(flow.velocity(dy, 1e3)) / dy
    assert 1000.0 * flow.nu * slope == pytest.approx(flow.drag(1000.0), rel=1e-3)


@pytest.mark.parametrize(
    ("angle", "force", "sheets"),
    [
        (30, 200.0, (0.09330127, 0.00669873)),
        (45, 282.842712, (0.08535534, 0.01464466)),
        (60, 346.410162, (0.075, 0.025)),
        (90, 400.0, (0.05, 0.05)),
    ],
)
def test_force_and_sheets_of_the_jet(
    angle: float, force: float, sheets: tuple[float, float]
) -> None:
    jet = Jet(0.1, 2.0, angle, 1000.0)
    assert jet.force == pytest.approx(force, rel=1e-8)
    assert jet.sheets == pytest.approx(sheets, abs=1e-8)


def test_band_of_the_dam_break_experiments() -> None:
    assert dam_break.Column(0.05715, 9.81).time == pytest.approx(0.0539711, abs=1e-6)
    lower, upper = dam_break.band([1.219, 2.719])
    assert lower == pytest.approx([1.474, 3.003])
    assert upper == pytest.approx([1.505 + 0.387 * 0.066 / 0.384, 2.995 + 1.139 * 0.172 / 0.798])


def test_a_front_of_an_experiment_lies_in_the_band_after_its_shift() -> None:
    times = np.linspace(0, 3.3, 1001)
    martin_moyce = np.interp(times, *dam_break.MARTIN_MOYCE.T)
    assert np.max(np.abs(dam_break.outside(times, martin_moyce, 0.0))) < 1e-3
    upper = dam_break.band(times + 0.1)[1]
    assert np.max(np.abs(dam_break.outside(times, upper, 0.1))) < 1e-3
    assert dam_break.best_shift(times, upper) == pytest.approx(0.1, abs=0.01)
    ahead = dam_break.outside(times, 1.2 * dam_break.band(times)[1], 0.0)
    assert ahead == pytest.approx(0.2, abs=1e-3)
    assert dam_break.best_shift(times, 2 * upper) == pytest.approx(0.15, abs=1e-3)


def test_taylor_green_decays_and_is_incompressible() -> None:
    flow, step = TaylorGreen(100.0), 1e-6
    assert flow.rate == pytest.approx(0.789568, abs=1e-6)
    assert flow.time(math.exp(-2.0)) == pytest.approx(2 / flow.rate)
    at = np.array([[0.3, 0.7], [0.3 + step, 0.7], [0.3, 0.7 + step], [0.0, 0.25], [1.3, -0.3]])
    mode = flow.mode(at)
    assert (mode[1, 0] - mode[0, 0] + mode[2, 1] - mode[0, 1]) / step == pytest.approx(0, abs=1e-4)
    np.testing.assert_allclose(mode[3], [-1, 0], atol=1e-15)
    np.testing.assert_allclose(mode[4], mode[0], atol=1e-12)


def test_taylor_green_satisfies_the_heat_equation() -> None:
    """The nonlinear term is a gradient, so speeds decay as the Laplacian says."""
    flow, h, at = TaylorGreen(250.0), 1e-3, np.array([0.17, 0.41])
    around = flow.mode(at + h * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]))
    laplacian = (around[1:].sum(axis=0) - 4 * around[0]) / h**2
    np.testing.assert_allclose(laplacian / 250.0, -flow.rate * around[0], rtol=1e-4)


def test_an_exact_decay_has_the_exact_rate() -> None:
    times, flow = np.linspace(0, 2, 21), TaylorGreen(1000.0)
    speed = np.exp(-flow.rate * times)
    decay = Decay(times, speed, speed**2, speed, 0 * times)
    assert decay.rate(decay.largest) == pytest.approx(flow.rate, rel=1e-12)
    assert decay.rate(decay.energy) == pytest.approx(2 * flow.rate, rel=1e-12)


def test_the_front_of_a_dam_break_starts_at_1() -> None:
    column = dam_break.Column(0.1, 9.81)

    class Frames(list):
        times = np.array([1.0, 1.0 + 2 * column.time])

    frames = Frames(
        SimpleNamespace(positions=np.array([[x, 0, 0], [0.01, 0, 0]])) for x in (0.099, 0.2)
    )
    front = Front.of(SimpleNamespace(trajectory=frames), column)
    assert front.times == pytest.approx([0, 2])
    assert front.places == pytest.approx([1, 1 + 1.01])


def test_density_sum_is_that_of_the_plane() -> None:
    assert density_sum("wendland/c2", 4.0) == pytest.approx(1.00121, abs=1e-5)
    for kernel in KERNELS:
        assert density_sum(kernel, 20.0) == pytest.approx(1, abs=1e-4)
        stretched = density_sum(kernel, 12.0, 1.2)
        assert stretched == pytest.approx(1, abs=2e-3)


def test_density_sum_is_that_of_space() -> None:
    assert cubic_density_sum("wendland/c2", 2.0) == pytest.approx(1.0338, abs=1e-4)
    for kernel in KERNELS:
        assert cubic_density_sum(kernel, 10.0) == pytest.approx(1, abs=2e-3)


def test_an_exact_motion_has_no_error() -> None:
    drop = EllipticDrop(0.5, 1.0)
    times = np.linspace(0, 2.1 * drop.period, 106)
    motion = Motion(times, np.array(drop.semi_axes(times)), 1.0)
    assert np.max(np.abs(motion.errors(drop))) < 1e-12
    assert motion.period(drop, 2) == pytest.approx(drop.period, rel=1e-5)
    still = Motion(times, np.repeat([[1.001], [1.0]], 106, axis=1), 1.0)
    assert math.isnan(still.period(drop, 2))


def test_order_of_convergence() -> None:
    assert compare.order([-0.08, 0.02], [10, 20]) == pytest.approx(2)
    assert math.isnan(compare.order([0.1, 0.0], [10, 20]))


@pytest.mark.parametrize(
    ("span", "area", "tension", "depth", "sag", "angle"),
    [
        (0.9, 0.03, 290.761, 0.090287, 0.204022, 30.4034),
        (0.6, 0.08, 426.611, 0.229888, 0.360615, 66.8978),
    ],
)
def test_lintearia(
    span: float, area: float, tension: float, depth: float, sag: float, angle: float
) -> None:
    sheet = Lintearia(1.0, span, area, 1000.0, 9.81)
    assert sheet.tension == pytest.approx(tension, abs=5e-4)
    assert sheet.depth == pytest.approx(depth, abs=5e-7)
    assert sheet.sag == pytest.approx(sag, abs=5e-7)
    assert math.degrees(sheet.angle) == pytest.approx(angle, abs=5e-5)
    assert sheet.lift == pytest.approx(9810 * area / 2)
    ends = sheet.shape([-0.5, 0.0, 0.5])
    np.testing.assert_allclose(ends, [[-span / 2, sag], [0, 0], [span / 2, sag]], atol=5e-7)


def test_the_shape_of_the_lintearia_keeps_its_length_and_holds_the_area() -> None:
    sheet = Lintearia(2.0, 1.3, 0.25, 800.0, 3.0)
    points = sheet.shape(np.linspace(-1, 1, 20001))
    assert np.sum(np.linalg.norm(np.diff(points, axis=0), axis=1)) == pytest.approx(2, rel=1e-7)
    below = np.maximum(sheet.depth - points[:, 1], 0)
    assert np.trapezoid(below, points[:, 0]) == pytest.approx(0.25, rel=1e-6)


def test_a_sheet_that_weighs_nothing_is_the_limit_of_the_heavy_one() -> None:
    light = Lintearia(1.0, 0.6, 0.08, 1000.0, 9.81)
    heavy, arc = HeavyLintearia(light, 0.0), np.linspace(-0.5, 0.5, 11)
    np.testing.assert_allclose(heavy.shape(arc), light.shape(arc), atol=1e-8)
    np.testing.assert_allclose(heavy.pull(arc), light.tension, rtol=1e-7)


def test_a_heavy_sheet_with_little_water_is_a_catenary() -> None:
    heavy = HeavyLintearia(Lintearia(1.0, 0.6, 1e-3, 1000.0, 9.81), 100.0)
    # 2 a sinh(D / 2a) = L and sag = a (cosh(D / 2a) - 1)
    a = brentq(lambda a: 2 * a * math.sinh(0.3 / a) - 1.0, 0.1, 1.0)
    assert heavy.sag == pytest.approx(a * (math.cosh(0.3 / a) - 1), rel=5e-3)
    assert heavy.tension == pytest.approx(100.0 * 9.81 * a, rel=0.05)
    horizontal = heavy.tension - 9810 * heavy.depth**2 / 2
    assert heavy.pull(0.5) == pytest.approx(math.hypot(horizontal, heavy.lift), rel=1e-6)


def test_a_sheet_that_is_too_short_is_refused() -> None:
    with pytest.raises(UserError, match="cannot hold 1 m\\^2"):
        _ = Lintearia(1.0, 0.6, 1.0, 1000.0, 9.81).angle
    with pytest.raises(UserError, match="take L larger"):
        _ = Lintearia(1.0, 1.1, 0.01, 1000.0, 9.81).angle


def test_weight_on_the_pins() -> None:
    assert Load(2.0, 0.5, 0.01, 900.0, 10.0).weight == pytest.approx(110.0)


# the framework
