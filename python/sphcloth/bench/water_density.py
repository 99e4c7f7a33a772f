"""The density of water from the positions of its particles, by whatever code.

One kernel for all codes, wider than theirs: a Wendland C2 kernel of three spacings, with which a
cubic lattice sums to 1.003 of its mass per volume. Only particles inside the water count: around
those, points at 2.5 spacings in 26 directions each have a particle within 1.1 spacings.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sphcloth.errors import UserError

SUPPORT = 3.0  # spacings
PROBE, GAP = 2.5, 1.1  # spacings
TAIL = 0.99  # quantile

_STEPS = np.array(
    [step for step in itertools.product((-1, 0, 1), repeat=3) if any(step)], dtype=float
)
_STEPS = _STEPS[np.argsort(np.abs(_STEPS).sum(axis=1), kind="stable")]  # along the axes first
DIRECTIONS = _STEPS / np.linalg.norm(_STEPS, axis=1)[:, None]


def densities(x: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return the density of each particle over that of one particle per cubed spacing."""
    reach = SUPPORT * spacing
    pairs = cKDTree(x).query_pairs(reach, output_type="ndarray")
    q = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) / reach
    shape = (1 - q) ** 4 * (1 + 4 * q)
    total = 1.0 + sum(np.bincount(pairs[:, k], shape, len(x)) for k in (0, 1))
    return 21 / (2 * np.pi * SUPPORT**3) * total


def inside(x: NDArray[np.float64], spacing: float) -> NDArray[np.bool_]:
    """Tell which particles have water all around."""
    tree = cKDTree(x)
    found = np.ones(len(x), dtype=bool)
    for direction in DIRECTIONS:
        left = np.flatnonzero(found)
        probes = x[left] + PROBE * spacing * direction
        nearest, _ = tree.query(probes, distance_upper_bound=GAP * spacing)
        found[left] = np.isfinite(nearest)
    return found


@dataclass(frozen=True)
class DensityError:
    """Deviation from the rest density, over all particles inside in all frames."""

    mean: float  # of the magnitude
    tail: float  # 99th percentile of the magnitude
    bias: float  # mean with its sign
    samples: int


def density_error(frames: Iterable[NDArray[np.float64]], spacing: float) -> DensityError:
    """Measure the error of a run.

    Raises:
        UserError: no particle of any frame is inside the water.
    """
    found = [densities(x, spacing)[inside(x, spacing)] - 1.0 for x in frames]
    errors = np.concatenate(found) if found else np.empty(0)
    if not len(errors):
        raise UserError("no particle is inside the water: take more particles, --across 15 or more")
    size = np.abs(errors)
    return DensityError(
        mean=float(size.mean()),
        tail=float(np.quantile(size, TAIL)),
        bias=float(errors.mean()),
        samples=len(errors),
    )
