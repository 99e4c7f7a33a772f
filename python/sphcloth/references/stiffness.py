"""What position-based dynamics does to a sheet without stiffness, and to a single edge.

With k = 0 nothing holds the sheet inside its pins. Velocities belong to the middle of steps, so
after n steps of full kicks it has fallen by g dt^2 n (n + 1) / 2; if the first kick is a half one,
by g (n dt)^2 / 2. A mass that hangs on a single edge and is let go falls by (1 - k) g dt^2 in the
first step, or half of that: equation (9), k' = 1 - (1 - k)^(1/n), makes this the same for any
number n of iterations.
"""

from __future__ import annotations


def free_fall(gravity: float, step: float, steps: int, first_kick: float = 1.0) -> float:
    """Return how far a free vertex falls in some steps, m.

    Args:
        gravity: m/s^2.
        step: time step, s.
        steps: number of steps.
        first_kick: share of gravity in the first one.
    """
    return gravity * step**2 * (steps * (steps + 1) / 2 - (1 - first_kick) * steps)


def first_stretch(k: float, gravity: float, step: float, first_kick: float = 1.0) -> float:
    """Return by how much a single edge under a mass is longer after one step, m."""
    return (1 - k) * free_fall(gravity, step, 1, first_kick)
