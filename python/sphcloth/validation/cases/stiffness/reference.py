"""What position-based dynamics does to a sheet without stiffness, and to a single edge.

With k = 0 nothing holds the sheet inside its pins: after n steps it has fallen by
g dt^2 n (n + 1) / 2 (semi-implicit Euler). A mass that hangs on a single edge and is let go falls
by (1 - k) g dt^2 in the first step: equation (9), k' = 1 - (1 - k)^(1/n), makes this the same for
any number n of iterations.
"""

from __future__ import annotations


def free_fall(gravity: float, step: float, steps: int) -> float:
    """Return how far a free vertex falls in some steps, m."""
    return gravity * step**2 * steps * (steps + 1) / 2


def first_stretch(k: float, gravity: float, step: float) -> float:
    """Return by how much a single edge under a mass is longer after one step, m."""
    return (1 - k) * gravity * step**2
