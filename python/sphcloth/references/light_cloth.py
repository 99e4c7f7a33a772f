"""A light sheet, level at first, that is held at one edge and falls.

It has no bending stiffness and does not stretch, so it falls like the chain of links between its
rows of vertices (:mod:`sphcloth.references.chain`). What is far from the edge falls freely until
the pull of the edge arrives.
"""

from __future__ import annotations

import math

from sphcloth.references.chain import LinkedPendulum


def falling_sheet(rows: int, length: float, gravity: float) -> LinkedPendulum:
    """Return the chain of the rows' links, level at first."""
    return LinkedPendulum.uniform(rows - 1, length, math.pi / 2, gravity)


def lowest(rows: int, length: float, gravity: float, time: float) -> float:
    """Return the height of the lowest row after a time, m; the edge is at 0."""
    return float(falling_sheet(rows, length, gravity).positions(time)[:, 1].min())
