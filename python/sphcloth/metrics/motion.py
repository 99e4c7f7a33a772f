"""Energy, momentum and outer forces of any atoms, from their masses, places and velocities."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sphcloth.arguments import numbers
from sphcloth.errors import UserError
from sphcloth.trajectory import Frame, successive

Array = NDArray[np.float64]
NO_GRAVITY = (0.0, 0.0, 0.0)


def masses(frame: Frame, by_type: Mapping[int, float] | None = None) -> Array:
    """Return the mass of each atom, shape (N,).

    Args:
        frame: its column ``mass`` is used if it has one.
        by_type: atom type -> mass, as :func:`sphcloth.mesh.read_masses` reads it from a data file.

    Raises:
        UserError: the dump has no column ``mass``, and a type has no mass; or a mass that is
            negative or not finite.
    """
    if "mass" in frame.columns:
        return _mass("mass", frame.columns["mass"])
    types, number = np.unique(frame.types, return_inverse=True)
    absent = [int(kind) for kind in types if kind not in (by_type or {})]
    if absent:
        raise UserError(
            f"no mass of type {absent[0]}: add 'mass' to 'dump custom', or give by_type, "
            "such as read_masses(DATA)"
        )
    return np.array([_mass(f"mass of type {kind}", by_type[kind], {()}) for kind in types])[number]


def masses_of(frame: Frame, mass: float | Mapping[int, float]) -> Array:
    """Return the mass of each atom, shape (N,): the column ``mass`` if there is one, or as given.

    Raises:
        UserError: a type without a mass, or a mass that is negative or not finite.
    """
    if isinstance(mass, Mapping) or "mass" in frame.columns:
        return masses(frame, mass if isinstance(mass, Mapping) else None)
    return _weights(frame, mass)


def kinetic_energy(frame: Frame, mass: ArrayLike) -> float:
    """Return sum m v^2 / 2; masses of shape (N,), or one for all.

    Raises:
        UserError: a mass that is negative or not finite, as in all sums over masses.
    """
    return float(0.5 * np.sum(_weights(frame, mass) * np.sum(frame.velocities**2, axis=1)))


def potential_energy(frame: Frame, mass: ArrayLike, gravity: Sequence[float]) -> float:
    """Return -sum m g . x, which is 0 at the origin.

    Args:
        frame: positions are those of the dump: unwrapped only where nothing crossed a boundary.
        mass: shape (N,), or one for all.
        gravity: acceleration, three components, such as (0, 0, -9.81).

    Raises:
        UserError: other than three components, or masses as for the kinetic energy.
    """
    fallen = frame.positions @ _vector("gravity", gravity)
    return -float(np.sum(_weights(frame, mass) * fallen))


def momentum(frame: Frame, mass: ArrayLike) -> Array:
    """Return sum m v, shape (3,); masses of shape (N,), or one for all."""
    return _weights(frame, mass) @ frame.velocities


def angular_momentum(frame: Frame, mass: ArrayLike, about: Sequence[float] = (0, 0, 0)) -> Array:
    """Return sum m (x - about) x v, shape (3,); masses of shape (N,), or one for all."""
    arms = frame.positions - _vector("about", about)
    return _weights(frame, mass) @ np.cross(arms, frame.velocities)


def outer_force(
    frames: Iterable[Frame], mass: float | Mapping[int, float], gravity: Sequence[float]
) -> Array:
    """Return the mean force on all atoms beyond gravity between frames, shape (frames - 1, 3).

    It is what pins, walls and floors do to the scene: the change of momentum over time less the
    weight, and needs nothing that a style reports. Over an interval in which nothing is created or
    deleted.

    Args:
        frames: with their times and the same atoms in all.
        mass: of every atom, or by type; a column ``mass`` in the dump goes before both.
        gravity: acceleration, three components.

    Raises:
        UserError: no times, steps that go back, atoms that come or go, fewer than two frames, or
            masses or gravity as for the potential energy.
    """
    gravity, forces = _vector("gravity", gravity), []
    for before, after in successive(frames, "outer_force"):
        if not np.array_equal(before.ids, after.ids):
            raise UserError(
                f"outer_force: atoms came or went between steps {before.step} and {after.step}"
            )
        if not after.time > before.time:
            raise UserError("outer_force: frames need times: Trajectory(DUMP, LOG)")
        each = masses_of(after, mass)
        change = momentum(after, each) - momentum(before, each)
        weight = np.sum(each) * gravity
        forces.append(change / (after.time - before.time) - weight)
    if not forces:
        raise UserError("outer_force: forces are found between frames: there is only one")
    return np.array(forces)


def _weights(frame: Frame, mass: ArrayLike) -> Array:
    """Return one mass for each atom; UserError if there are more or fewer, or one is none."""
    mass = _mass("mass", mass)
    if mass.shape not in ((), (len(frame),)):
        raise UserError(f"{mass.size} masses for {len(frame)} atoms: give one for each, or one")
    return np.broadcast_to(mass, len(frame))


def _mass(what: str, mass: ArrayLike, shapes: Collection[tuple[int, ...]] | None = None) -> Array:
    """Return masses as float64, of which some may be 0; UserError if they are none."""
    return numbers(what, mass, "it must be finite and not negative", low=0.0, shapes=shapes)


def _vector(what: str, values: Sequence[float]) -> Array:
    return numbers(what, values, "three components such as (0, 0, -9.81)", shapes={(3,)})
