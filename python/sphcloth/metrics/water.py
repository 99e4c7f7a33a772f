"""Density, volume and front of the water in a frame."""

from __future__ import annotations

from typing import Literal

import numpy as np

from sphcloth.arguments import POSITIVE, numbers
from sphcloth.errors import UserError
from sphcloth.mesh import ClothMesh
from sphcloth.metrics.passages import above_sheet
from sphcloth.trajectory import Frame


def density_deviation(frame: Frame, rest_density: float, fluid_type: int = 1) -> float:
    """Return the largest abs(rho - rho0) / rho0 of the fluid particles in a frame.

    Particles at a free surface count as well; the thermo output of the fluid style leaves them
    out.

    Raises:
        UserError: the dump has no column ``rho``, or a density at rest that is not above 0.
    """
    density = frame.select(fluid_type).vectors("rho")[:, 0]
    rest_density = _positive("rest_density", rest_density)
    return float(np.max(np.abs(density / rest_density - 1), initial=0.0))


def compressed_share(
    frame: Frame, rest_density: float, fluid_type: int = 1, *, above: float = 0.01
) -> float:
    """Return the share of the water in a frame that is denser than at rest by more than ``above``.

    What :func:`density_deviation` finds may be that of a single particle in a splash. NaN where
    there is no water.

    Raises:
        UserError: the dump has no column ``rho``, or a density at rest that is not above 0.
    """
    density = frame.select(fluid_type).vectors("rho")[:, 0]
    rest_density = _positive("rest_density", rest_density)
    if not len(density):
        return float("nan")
    above = float(numbers("above", above, "it must be one number", shapes={()}))
    return float(np.mean(density > (1 + above) * rest_density))


def front(
    frame: Frame,
    axis: Literal["x", "y", "z"] = "x",
    *,
    lowest: bool = False,
    fluid_type: int = 1,
    spray: float = 0.0,
) -> float:
    """Return how far the water reaches along an axis, in the units of the script.

    Args:
        frame: with the fluid particles.
        axis: ``x``, ``y`` or ``z``.
        lowest: the other way: the smallest coordinate.
        fluid_type: atom type of the water.
        spray: share of the particles that may be farther, from 0 to below 1; single drops ahead of
            the rest do not count then.

    Raises:
        UserError: no particle of the type, or a share that is none.
    """
    if not 0 <= spray < 1:
        raise UserError(f"front: spray = {spray:g}: it must be from 0 to below 1")
    places = frame.select(fluid_type).vectors(axis)[:, 0]
    if not len(places):
        raise UserError(f"front: no particle of type {fluid_type} at step {frame.step}")
    return float(np.quantile(places, spray if lowest else 1 - spray))


def held_volume(
    mesh: ClothMesh, frame: Frame, particle_volume: float, fluid_type: int = 1
) -> float:
    """Return the volume of the water that has the sheet vertically below it.

    Args:
        mesh: the sheet.
        frame: with its vertices and the fluid particles.
        particle_volume: of one particle at rest, mass over rest density
            (:attr:`sphcloth.roles.Roles.volume`).
        fluid_type: atom type of the water.

    Raises:
        UserError: a volume that is not above 0.
    """
    particle_volume = _positive("particle_volume", particle_volume)
    return particle_volume * int(np.count_nonzero(above_sheet(mesh, frame, fluid_type)))


def _positive(what: str, value: float) -> float:
    return float(numbers(what, value, "it must be above 0", low=POSITIVE, shapes={()}))
