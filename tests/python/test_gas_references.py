"""Reference solutions of the cases with gas, against known numbers, balances and limits."""

from __future__ import annotations

import numpy as np
import pytest

from sphcloth.errors import UserError
from sphcloth.references.balloon import BreathingShell
from sphcloth.references.bulge import Bulge
from sphcloth.references.hencky import PressurizedMembrane, PressurizedNet


def test_a_bulge_is_an_arc_of_its_length_and_tension() -> None:
    for bulge in (Bulge(1.0, 1.2, 100.0), Bulge(2.0, 2.0, 50.0, 3e3), Bulge(1.0, 1.8, 7.0)):
        x, z = bulge.shape(4001)
        length = np.hypot(np.diff(x), np.diff(z)).sum()
        assert length == pytest.approx(bulge.length * (1 + bulge.tension / bulge.stiffness))
        assert x[-1] - x[0] == pytest.approx(bulge.span)
        assert z.max() == pytest.approx(bulge.height)
        assert np.trapezoid(z, x) == pytest.approx(bulge.area, rel=1e-5)
        # along the axis the tension at both edges carries the pressure on the span
        lift = 2 * bulge.tension * np.sin(bulge.half_angle)
        assert lift == pytest.approx(bulge.pressure * bulge.span)
    with pytest.raises(UserError, match="must be longer than the span"):
        Bulge(1.0, 1.0, 100.0)


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_a_shell_breathes_with_its_period_and_keeps_its_energy(exponent: float) -> None:
    slow = BreathingShell(0.1, 0.2, 1e5, exponent, 1e-3)
    times = np.linspace(0, slow.small_period, 9)
    swing = slow.volumes(times) / slow.volume - 1
    assert swing[[0, 4, 8]] == pytest.approx([0, 0, 0], abs=1e-3 * swing.max())
    omega = 2 * np.pi / slow.small_period
    assert swing[2] == pytest.approx(3 * 1e-3 / (omega * 0.1), rel=1e-4)
    fast = BreathingShell(0.1, 0.2, 1e5, exponent, 20.0)
    widest = fast.volumes(np.linspace(0, fast.small_period, 2001)).max()
    ratio = widest / fast.volume
    work = np.log(ratio) if exponent == 1 else (1 - ratio ** (1 - exponent)) / (exponent - 1)
    turned = 1e5 * fast.volume * (ratio - 1 - work)
    assert turned == pytest.approx(0.5 * fast.mass * 20.0**2, rel=1e-6)


def test_a_pressurized_membrane_is_henckys_fichters_and_that_of_a_net() -> None:
    """Hencky's series for Poisson's ratio 0.3: w = 0.6534, N = 0.4310 in powers of p a / E."""
    for load in (1e-6, 1e-3):
        flat = PressurizedMembrane(2.0, load * 50 / 2.0, 50.0, 0.3, turns=False)
        assert flat.height == pytest.approx(0.6534 * 2.0 * load ** (1 / 3), rel=1e-4)
        assert flat.middle_force == pytest.approx(0.4310 * 50 * load ** (2 / 3), rel=3e-4)
    small = PressurizedMembrane(1.0, 1e-6, 1.0), PressurizedMembrane(1.0, 1e-6, 1.0, turns=False)
    net = PressurizedNet(1.0, 1e-6, 1.0)
    assert small[0].height == pytest.approx(small[1].height, rel=1e-3)
    assert net.height == pytest.approx(small[0].height, rel=1e-3)
    assert net.deflection([0.0, 0.5]) == pytest.approx(small[0].deflection([0.0, 0.5]), rel=1e-3)
    assert small[0].volume == pytest.approx(small[1].volume, rel=1e-3)
