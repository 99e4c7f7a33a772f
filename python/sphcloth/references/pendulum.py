"""The simple pendulum at any amplitude; chains of links are in :mod:`sphcloth.references.chain`.

T = 4 sqrt(L / g) K(sin^2(A / 2)) with the complete elliptic integral of the first kind.
"""

from __future__ import annotations

import math

from scipy.special import ellipk

from sphcloth.errors import UserError


def pendulum_period(length: float, gravity: float, amplitude: float) -> float:
    """Return the period in s.

    Args:
        length: m.
        gravity: acceleration, m/s^2.
        amplitude: largest angle from the vertical, rad, below pi.

    Raises:
        UserError: an amplitude of pi or more, at which a pendulum does not swing.
    """
    if not abs(amplitude) < math.pi:
        raise UserError(f"pendulum_period: amplitude = {amplitude:g}: it must be below pi")
    return 4 * math.sqrt(length / gravity) * float(ellipk(math.sin(amplitude / 2) ** 2))
