"""What cases with a pool at rest share: where its surface is."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

# width of the bins in which the surface is looked for, in spacings
BIN = 0.05


def surface_level(heights: NDArray[np.float64], layer: float, spacing: float) -> float:
    """Return the height of the surface: where half of the water of the inside is missing.

    It is NaN where no layer is half full.

    Args:
        heights: of the particles over a part of the bottom, of all frames, m.
        layer: particles of a layer of one spacing inside, over that part, in all frames.
        spacing: of the particles, m.
    """
    edges = np.arange(np.min(heights) - spacing, np.max(heights) + 2 * spacing, BIN * spacing)
    counts = np.convolve(np.histogram(heights, edges)[0], np.ones(round(1 / BIN)), "same")
    middle = (edges[:-1] + edges[1:]) / 2
    full = np.flatnonzero(counts >= layer / 2)
    if not full.size:
        return math.nan
    top = full[-1]
    share = (counts[top] - layer / 2) / (counts[top] - counts[top + 1])
    return float(middle[top] + share * BIN * spacing)
