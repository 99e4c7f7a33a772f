"""A sheet on springs that bears a column of water is plucked, from light to heavy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from sphcloth.references.added_mass_piston import Piston
from sphcloth.validation import cloth, compare, schemes
from sphcloth.validation.case import Case, Parameter, Quantity, Value
from sphcloth.validation.common import REST_DENSITY, numerics
from sphcloth.validation.refinement import order_quantities, three
from sphcloth.validation.runner import Run, Runner

# time in which the water settles on the sheet, which is held, and rate of its damping: h/c0, c0/h
SETTLE, DAMPING = 40.0, 0.45
# largest acceleration after the pluck, in g: the water must stay on the sheet
PLUCK = 0.1
# share of the layers in the coarse run
COARSE = 0.5
FRAMES = 10

PARAMETERS = (
    Parameter("lightest", 0.01, "kg/m^2", "least mass of the sheet", 1e-3, 1e5),
    Parameter("heaviest", 1e4, "kg/m^2", "largest mass of the sheet", 1e-3, 1e5),
    Parameter("runs", 4, "1", "number of masses", 1, 20),
    Parameter("stiffness", 1e6, "N/m^3", "of the springs, per area", 1e3, 1e9),
    Parameter("height", 0.5, "m", "of the water", 1e-2, 10.0),
    REST_DENSITY,
    Parameter("gravity", 9.81, "m/s^2", "acceleration g, of the water", 1e-2, 1e3),
    Parameter("sound", 5.0, "sqrt(k_A h/rho0)", "speed of sound at rest c0", 2.0, 100.0),
    Parameter("layers", 20, "1", "particles over the height", 12, 100, quick=12),
    Parameter("across", 8, "1", "particles and vertices over the periodic width", 8, 50),
    Parameter("periods", 6.0, "T", "time of the free motion", 3.0, 1000.0, quick=4.0),
    Parameter(
        "coupling",
        "contact",
        "1",
        "of water and sheet",
        choices=("contact", "wall", "pressure", "both"),
    ),
    Parameter(
        "wall",
        "extrapolate",
        "1",
        "pressure of the vertices",
        choices=("extrapolate", "mirror", "own"),
    ),
    Parameter("thickness", 0.2, "spacing", "gap that contact keeps", 0.01, 0.5),
    Parameter("aside", 0.2, "spacing", "water at the start aside of the diagonals", 0.0, 0.5),
    cloth.ITERATIONS,
    Parameter("solver", "substeps", "1", "what the iterations are", choices=cloth.SOLVERS),
    Parameter("direction", "start", "1", "of the projection", choices=cloth.DIRECTIONS),
    Parameter("refined", 1.0, "1", "time step over that of the fluid", 1e-4, 2.0),
    *numerics(alpha=0.5, courant=0.5, support=3.0, disorder=0.0, density="continuity"),
)

QUANTITIES = (
    Quantity("period", "1", "relative error of the period, the worst", 0.02, 0.02),
    Quantity("growth", "1", "largest growth of the amplitude in a period", 1e-3, 1e-3),
    Quantity("passed_through", "1", "water particles below the sheet", 0.0, 0.0),
    Quantity("period_lightest", "1", "relative error of the period of the lightest sheet"),
    Quantity("period_heaviest", "1", "relative error of the period of the heaviest sheet"),
    Quantity("loss", "1", "largest loss of amplitude in a period"),
    Quantity("scatter", "1", "largest rms distance from a damped oscillation over the amplitude"),
    Quantity("flatness", "spacing", "largest rms height of vertices over their mean"),
    Quantity("compressibility", "1", "largest share of it in the reference's period"),
    Quantity("step", "1", "least time step over that of the fluid"),
    *order_quantities("of the period of the lightest sheet"),
)


@dataclass(frozen=True)
class Swing:
    """A damped oscillation that was fitted to the height of the sheet.

    Attributes:
        period: s.
        loss: of amplitude in a period, relative; negative if it grows.
        scatter: rms distance from the fit over the amplitude.
        curve: time since the pluck, height and fit, shape (3, N).
    """

    period: float
    loss: float
    scatter: float
    curve: NDArray[np.float64]

    @classmethod
    def of(cls, time: NDArray, height: NDArray, frequency: float) -> Swing:
        """Fit an oscillation whose angular frequency is roughly known."""

        def model(t: NDArray, *p: float) -> NDArray:
            turned = p[0] * np.cos(p[3] * t) + p[1] * np.sin(p[3] * t)
            return np.exp(-p[2] * t) * turned + p[4] + p[5] * t

        guess = (0.0, float(np.min(height)), 0.0, frequency, float(np.mean(height)), 0.0)
        try:
            found, _ = curve_fit(model, time, height, guess)
        except RuntimeError:
            return cls(math.nan, math.nan, math.nan, np.array([time, height, height]))
        fitted = model(time, *found)
        period = 2 * math.pi / abs(found[3])
        loss = -math.expm1(-found[2] * period)
        scatter = compare.rms(height - fitted) / float(np.hypot(*found[:2]))
        return cls(period, loss, scatter, np.array([time, height, fitted]))


def measure(values: Mapping[str, Value], runner: Runner) -> dict[str, float]:
    """Pluck sheets of several masses, and the lightest one at two coarser resolutions."""
    masses = np.geomspace(values["lightest"], values["heaviest"], values["runs"])
    pistons = [_piston(values, float(mass)) for mass in masses]
    layers = values["layers"]
    runs = [_run(piston, values, runner, f"{piston.areal:g}", layers) for piston in pistons]
    swings = [_swing(run, piston) for run, piston in zip(runs, pistons, strict=True)]
    fewer = {label: n for label, n in three(layers, COARSE).items() if label != "fine"}
    coarse = [_swing(_run(pistons[0], values, runner, *each), pistons[0]) for each in fewer.items()]
    errors = [swing.period / p.period - 1 for swing, p in zip(swings, pistons, strict=True)]
    losses = [swing.loss for swing in swings]
    _plot(pistons, swings, runner.picture)
    return {
        "period": _worst(errors),
        "growth": max(0.0, -min(losses)) if np.all(np.isfinite(losses)) else math.nan,
        "passed_through": sum(_below(run) for run in runs),
        "period_lightest": errors[0],
        "period_heaviest": errors[-1],
        "loss": max(losses),
        "scatter": max(swing.scatter for swing in swings),
        "flatness": max(_flatness(run) for run in runs) * layers / values["height"],
        "compressibility": max(p.period / p.rigid_period - 1 for p in pistons),
        "step": min(_least_step(run, pistons[0], values) for run in runs),
        **compare.orders(
            [*(swing.period / pistons[0].period - 1 for swing in coarse), errors[0]],
            [*fewer.values(), layers],
        ),
    }


def _piston(values: Mapping[str, Value], mass: float) -> Piston:
    names = ("stiffness", "height", "rho0")
    stiffness, height, rho0 = (values[name] for name in names)
    sound = values["sound"] * math.sqrt(stiffness * height / rho0)
    return Piston(mass, stiffness, height, rho0, sound)


def _run(
    piston: Piston, values: Mapping[str, Value], runner: Runner, label: str, layers: int
) -> Run:
    """Run the script with so many layers."""
    dropped = ("lightest", "heaviest", "runs", "periods", "sound")
    shared = {name: values[name] for name in values if name not in dropped}
    t_settle = SETTLE * piston.height / piston.sound
    t_end, clock = schemes.clock(
        values, t_settle + values["periods"] * piston.period, FRAMES, t_settle, every="10"
    )
    return runner.run(
        label,
        t_end,
        shared
        | clock
        | {
            "areal": piston.areal,
            "sound": piston.sound,
            "layers": layers,
            # pressure keeps the water off by about the reach of a layer, contact by the thickness
            "gap": values["thickness"]
            if values["coupling"] == "contact"
            else values["support"] / 3 + 0.5,
            "pluck": PLUCK * values["gravity"] / piston.frequency,
            "damping": DAMPING * piston.sound / piston.height,
        },
    )


def _swing(run: Run, piston: Piston) -> Swing:
    """Return the motion of the sheet since it was let go."""
    time = run.thermo["Time"]
    start = run.trajectory.times[0]
    free = time > start * (1 + 1e-9)
    return Swing.of(time[free] - start, run.thermo["v_z"][free], piston.frequency)


def _worst(errors: list[float]) -> float:
    return max(errors, key=abs) if np.all(np.isfinite(errors)) else math.nan


def _below(run: Run) -> int:
    """Return how many water particles are below the lowest vertex in the end."""
    frame = run.trajectory[-1]
    sheet = np.min(frame.positions[frame.types == 2, 2])
    return int(np.sum(frame.positions[frame.types == 1, 2] < sheet))


def _flatness(run: Run) -> float:
    """Return the largest rms height of vertices over their mean, m."""
    heights = [frame.positions[frame.types == 2, 2] for frame in run.trajectory]
    return max(float(np.std(height)) for height in heights)


def _least_step(run: Run, piston: Piston, values: Mapping[str, Value]) -> float:
    """Return the least time step after the settling over that of the fluid alone."""
    time, step = run.thermo["Time"], run.thermo["Dt"]
    of_fluid = 0.5 * values["courant"] * values["support"] * piston.height / values["layers"]
    free = time > SETTLE * piston.height / piston.sound
    return float(np.min(step[free])) / (of_fluid / piston.sound)


def _plot(pistons: list[Piston], swings: list[Swing], path: Path) -> None:
    """Draw height over time for each mass, and the periods over the mass."""
    figure, (motion, period) = compare.panels(2)
    for piston, swing in zip(pistons, swings, strict=True):
        time, height, fitted = swing.curve
        shown = time < 6 * piston.period
        scale = float(np.max(np.abs(height)))
        label = f"{piston.areal:g} kg/m^2"
        motion.plot(time[shown] / piston.period, height[shown] / scale, lw=1, label=label)
        motion.plot(time[shown] / piston.period, fitted[shown] / scale, ":", color="k", lw=0.8)
    motion.set(xlabel="time / T of the reference", ylabel="height / largest")
    motion.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, fontsize="small")
    masses = np.geomspace(0.5 * pistons[0].areal, 2 * pistons[-1].areal, 100)
    first = pistons[0]
    fixed = (first.stiffness, first.height, first.rho0, first.sound)
    curve = [Piston(float(mass), *fixed) for mass in masses]
    period.loglog(masses, [p.period for p in curve], "k-", lw=0.8, label="reference")
    period.loglog(masses, [p.rigid_period for p in curve], "k:", lw=0.8, label="without sound")
    found = [swing.period for swing in swings]
    period.loglog([p.areal for p in pistons], found, "o", label="SPH and cloth")
    period.set(xlabel="mass of the sheet (kg/m^2)", ylabel="period (s)")
    period.legend()
    compare.save(figure, path)


CASE = Case(
    "added-mass-piston",
    "period of a sheet on springs under water: a rod on a spring",
    PARAMETERS,
    QUANTITIES,
    measure,
    Path(__file__).parent,
)
