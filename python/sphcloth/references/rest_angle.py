"""The angle of a hinge, from the directions of its two wings.

Each wing's direction is taken perpendicular to the edge. Flat is 0; the angle is positive where the
wings are folded towards the side from which wing a, the edge and wing b turn clockwise, which is
the sign of the hinge's rest shape in the script.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def hinge_angles(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of each hinge, rad, in (-pi, pi].

    Args:
        corners: wing a, edge 1, edge 2, wing b of each hinge, shape (H, 4, 3).
    """
    wing_a, edge_1, edge_2, wing_b = np.moveaxis(corners, 1, 0)
    edge = edge_2 - edge_1
    edge /= np.linalg.norm(edge, axis=1)[:, None]
    inwards = -_across(wing_a - edge_1, edge)
    outwards = _across(wing_b - edge_1, edge)
    turn = np.sum(np.cross(inwards, outwards) * edge, axis=1)
    return np.arctan2(turn, np.sum(inwards * outwards, axis=1))


def _across(arm: NDArray, edge: NDArray) -> NDArray:
    """Return the part of each arm that is perpendicular to the edge."""
    return arm - np.sum(arm * edge, axis=1)[:, None] * edge
