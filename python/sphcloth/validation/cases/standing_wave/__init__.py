"""The period of a standing wave, in two dimensions, periodic along the wave."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from sphcloth.errors import UserError
from sphcloth.references.standing_wave import StandingWave
from sphcloth.validation import compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import (
    GRAVITY,
    REST_DENSITY,
    SURFACE,
    WALL,
    lattice_density,
    numerics,
)
from sphcloth.validation.refinement import Refinement, order_quantities, three
from sphcloth.validation.runner import Run, Runner

# rate of the damping while the water settles, in c0 / H
DAMPING = 0.64
# share of the layers of the coarse run
COARSE = 2 / 3

FRAMES = 200

PARAMETERS = (
    Parameter("depth", 1.0, "m", "undisturbed depth H", 1e-3, 100.0),
    Parameter("length", 2.0, "m", "wavelength", 1e-3, 1000.0),
    REST_DENSITY,
    GRAVITY,
    Parameter("sound", 10.0, "sqrt(g H)", "speed of sound at rest c0", 5.0, 100.0),
    Parameter("steepness", 0.14, "1", "k A of the start, A the amplitude", 0.01, 0.3),
    Parameter("layers", 60, "1", "particles over the depth", 12, 400, quick=32),
    Parameter("settle", 3.0, "sqrt(H/g)", "time of damping before the wave", 1.0, 100.0),
    Parameter("periods", 3.0, "T", "time of the wave", 1.0, 100.0, quick=2.0),
    WALL,
    SURFACE,
    *numerics(alpha=0.1, courant=0.5, density="continuity"),
)

QUANTITIES = (
    Quantity("period", "1", "relative error of the period", 0.01, 0.01),
    Quantity("period_measured", "s", "the period itself, without the damping"),
    Quantity("period_reference", "s", "linear theory"),
    Quantity("second_order", "1", "relative change of the period by this steepness, in theory"),
    Quantity("viscous", "1", "relative change of the period by this viscosity, in theory"),
    Quantity("damping", "1/s", "rate at which the amplitude falls"),
    Quantity("residual", "1", "rms of what the damped cosine leaves over the first amplitude"),
    *order_quantities("of the period"),
)


@dataclass(frozen=True)
class Oscillation:
    """A damped cosine, s exp(-d t) cos(w t + phase), fitted to the first mode.

    Attributes:
        times: since the start of the wave, s.
        strength: strength of the mode at these times, m/s.
        fit: s (m/s), d (1/s), w (rad/s) and the phase.
    """

    times: NDArray[np.float64]
    strength: NDArray[np.float64]
    fit: NDArray[np.float64]

    @property
    def period(self) -> float:
        """Period without the damping, s."""
        return 2 * math.pi / math.hypot(self.fit[1], self.fit[2])

    @property
    def residual(self) -> float:
        """Rms of what the fit leaves, over the strength at the start."""
        left = self.strength - _damped_cosine(self.times, *self.fit)
        return compare.rms(left) / abs(float(self.strength[0]))


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Run three resolutions and compare their periods with linear theory."""
    wave = StandingWave(values["depth"], values["length"], values["gravity"])
    layers = three(values["layers"], COARSE)
    refined = Refinement.of(partial(_run, wave, values, runner), layers)
    seen = [_oscillation(run, wave) for run in refined.runs]
    errors = [each.period / wave.period - 1 for each in seen]
    _plot(wave, refined.labeled(seen), runner.picture)
    return {
        "period": errors[-1],
        "period_measured": seen[-1].period,
        "period_reference": wave.period,
        "second_order": wave.second_order(values["steepness"] / wave.number),
        "viscous": wave.viscous(_viscosity(values)),
        "damping": seen[-1].fit[1],
        "residual": seen[-1].residual,
        **refined.orders(errors),
    }


def _run(
    wave: StandingWave, values: Mapping[str, Value], runner: Runner, label: str, layers: int
) -> Run:
    """Run the script with so many layers over the depth."""
    columns = _columns(values, layers)
    sound = values["sound"] * math.sqrt(values["gravity"] * values["depth"])
    t_settle = values["settle"] * math.sqrt(values["depth"] / values["gravity"])
    width, height = wave.length / columns, wave.depth / layers
    derived = ("sound", "steepness", "settle", "periods")
    shared = {name: value for name, value in values.items() if name not in derived}
    t_end, clock = schemes.clock(
        values, t_settle + values["periods"] * wave.period, FRAMES, t_settle
    )
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "layers": layers,
            "columns": columns,
            "sound": sound,
            "lattice": lattice_density(values, height / width),
            "base": math.ceil(values["support"]) + 1,
            "damping": DAMPING * sound / values["depth"],
            "surge": values["steepness"] / wave.number * 2 * math.pi / wave.period,
        },
    )


def _viscosity(values: Mapping[str, Value]) -> float:
    """Return the kinematic viscosity that alpha is, in m^2/s; half of the pairs approach."""
    smoothing = values["support"] * values["depth"] / values["layers"] / 2
    sound = values["sound"] * math.sqrt(values["gravity"] * values["depth"])
    return values["alpha"] * sound * smoothing / (4 * (2 + 2))


def _columns(values: Mapping[str, Value], layers: int) -> int:
    """Return the number of particles over the length that makes the cells most nearly square."""
    columns = round(layers * values["length"] / values["depth"])
    least = 2 * math.ceil(values["support"]) + 1
    if columns < least:
        raise UserError(
            f"length {values['length']:g} has {columns} particles, fewer than {least}: "
            "raise layers or length"
        )
    return columns


def _oscillation(run: Run, wave: StandingWave) -> Oscillation:
    """Project the velocities of every frame on the first mode and fit a damped cosine."""
    times = run.trajectory.times - run.trajectory.times[0]
    strength = []
    for frame in run.trajectory:
        mode = wave.mode(frame.positions)
        strength.append(np.sum(mode * frame.velocities[:, :2]) / np.sum(mode * mode))
    start = strength[0], 0.0, 2 * math.pi / wave.period, 0.0
    fit, _ = curve_fit(_damped_cosine, times, strength, p0=start)
    return Oscillation(times, np.array(strength), fit)


def _damped_cosine(
    t: NDArray, strength: float, damping: float, rate: float, phase: float
) -> NDArray[np.float64]:
    return strength * np.exp(-damping * t) * np.cos(rate * t + phase)


def _plot(wave: StandingWave, seen: Mapping[str, Oscillation], path: Path) -> None:
    """Draw the strength of the mode over time in each run, beside linear theory."""
    figure, (axes,) = compare.panels(1)
    for label, each in seen.items():
        axes.plot(each.times / wave.period, each.strength / each.strength[0], label=label)
    phase = np.linspace(0, each.times[-1] / wave.period, 400)
    axes.plot(phase, np.cos(2 * math.pi * phase), "k--", lw=0.8, label="linear, without friction")
    axes.set(xlabel="time / period of linear theory", ylabel="strength of the first mode")
    axes.legend(loc="lower left")
    compare.save(figure, path)


CASE = Case(
    "standing-wave",
    "period of a standing wave: linear theory",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
