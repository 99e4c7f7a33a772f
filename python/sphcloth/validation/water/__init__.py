"""Small scenes of water: two lattices that meet, corners, bounces, and energy by scheme.

``python -m sphcloth.validation.water resolutions --out FOLDER`` lets coarse and fine water come to
rest beside each other; ``... corner`` finds the density in a corner of plane walls, ``... bounce``
how deep water gets behind one, ``... impact`` the energy with which single particles leave it,
``... drops`` the energy that colliding drops lose or gain with each scheme of the time step, and
``... rest`` what a speed of sound that follows the flow saves. Each prints a table.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from rich.console import Console

from sphcloth.results import Value, points_table, write_json
from sphcloth.validation.runner import Runner

FOLDER = Path(__file__).parent

# in.resolutions: support over spacing and kernel, and its numbers
BORDERS = ((2, "wendland/c2"), (3, "wendland/c2"), (4, "wendland/c2"), (4, "wendland/c4"))
SIDE, SPACING, SOUND, STEPS = 1.0, 0.05, 10.0, 2000
RHO0 = 1000.0

CORNERS = ((2, 0.5), (2, 0.6), (3, 0.5), (3, 0.6))
WALLS = (1, 2, 3)

SPEEDS = (0.5, 0.95)
BOUNCES = (("particle", "global"), ("particle", "constant"), ("drop", "global"))
REACH, OF_SOUND = 0.1, 20.0

# of in.bounce with the default limits and others: artificial viscosity, more limits, speeds over
# that of sound, each times some factors: other steps meet the wall
IMPACTS = ((0.1, ""), (0.1, "velocity 0.2"), (0.05, ""), (0.0, ""), (0.0, "stability 0.5"))
IMPACT_SPEEDS = (0.01, 0.05, 0.15, 0.4)
FACTORS = (0.94, 0.97, 1.0, 1.03, 1.06)
CEILING = 0.01  # s, longer than the limits

# speeds of sound of in.rest, and its time in s
FLUIDS = ("c0 30", "c0 follow 5 30", "c0 12")
REST_TIME = 8.0

# schemes of in.drops, and what each is given: a step in s, or limits
DROPS: tuple[tuple[str, dict[str, Value]], ...] = (
    *(("constant", {"dt": dt}) for dt in (2e-4, 4e-4, 6e-4)),
    *(("global", {"limits": f"acoustic {share}"}) for share in (0.25, 0.5)),
    ("individual", {"limits": "acoustic 0.25"}),
    ("block", {"limits": "acoustic 0.25 ratio 2"}),
    *(("block", {"limits": f"acoustic {share} ratio 4"}) for share in (0.25, 0.5)),
)
MEET = 0.12

Points = list[dict[str, Value]]


def border(runner: Runner, support: int, kernel: str) -> dict[str, Value]:
    """Return densities along the border of two lattices, at the start and at rest.

    Densities are over the rest density; those at rest less that of the bulk.
    """
    step = 0.4 * support * SPACING / 4 / SOUND
    label = f"{support}_{kernel.replace('/', '_')}"
    given = {"support": support, "kernel": kernel, "dt": step}
    run = runner.run(label, STEPS * step, given)
    first, last = run.trajectory[0], run.trajectory[-1]
    x = last.positions[:, 0]
    near = np.minimum(np.abs(x - SIDE / 2), np.minimum(x, SIDE - x)) < support * SPACING
    start, density = (frame.columns["rho"] / RHO0 for frame in (first, last))
    bulk = float(density[~near].mean())
    masses = RHO0 * np.where(first.types == 1, SPACING, SPACING / 2) ** 2
    force = np.hypot(first.columns["fx"], first.columns["fy"]) / masses
    return {
        "support / spacing": support,
        "kernel": kernel,
        "least at the start": float(start.min()) - 1,
        "largest at the start": float(start.max()) - 1,
        "acceleration dx/c0^2": float(force.max()) * SPACING / SOUND**2,
        "least at rest": float(density[near].min()) - bulk,
        "largest at rest": float(density[near].max()) - bulk,
        "bulk": bulk - 1,
        "rms speed / c0": float(np.sqrt(np.mean(last.velocities**2) * 3)) / SOUND,
    }


def corner(runner: Runner, support: int, distance: float) -> dict[str, Value]:
    """Return the density over the rest density of a particle beside one, two and three walls."""
    found: dict[str, Value] = {"support / spacing": support, "distance / spacing": distance}
    for walls in WALLS:
        given = {"walls": walls, "distance": distance, "support": support}
        frame = runner.run(f"{support}_{distance}_{walls}", 0.0, given).trajectory[0]
        nearest = int(np.argmin(frame.positions[:, :walls].sum(axis=1)))
        found[f"{walls} wall{'s' * (walls > 1)}"] = float(frame.columns["rho"][nearest]) / RHO0
    return found


def bounce(runner: Runner, what: str, scheme: str, support: int, speed: float) -> dict[str, Value]:
    """Return how deep water gets behind a wall, over the support, and the energy it leaves with."""
    given = {"what": what, "scheme": scheme, "support": support, "speed": speed}
    end = (3 + 4 * speed) * REACH / (speed * OF_SOUND)
    run = runner.run(f"{what}_{scheme}_{support}_{speed}", end, given)
    energy = run.thermo["c_motion"]
    return {
        "what": what,
        "scheme": scheme,
        "support / spacing": support,
        "particles": int(run.thermo["Atoms"][0]),
        "speed / c0": speed,
        "deepest / support": float(run.thermo["c_low"].min()) / REACH,
        "kinetic energy after / before": float(energy[-1] / energy[0]),
    }


def rest(runner: Runner, density: str, fluid: str) -> dict[str, Value]:
    """Return what water needs that collapses and comes to rest, and where it lies in the end."""
    given = {"density": density, "fluid": fluid}
    run = runner.run(f"{density}_{fluid.replace(' ', '_')}", REST_TIME, given)
    log, late = run.thermo, run.thermo["Time"] > 0.8 * REST_TIME
    return {
        "density": density,
        "speed of sound": fluid,
        "steps": int(log["Step"][-1]),
        "loop time, s": float(log["v_spent"][-1]),
        "sound at the end, m/s": float(log["v_sound"][-1]),
        "largest compression, late": float(log["v_compression"][late].max()),
        "center of mass, m": float(log["v_height"][late].mean()),
        "work, J": float(log["v_work"][-1]),
    }


def impact(runner: Runner, density: str, alpha: float, limits: str) -> dict[str, Value]:
    """Return the energy with which particles leave a wall over that with which they came."""
    setting = f"{density}_{alpha}_{limits.replace(' ', '_')}"
    row: dict[str, Value] = {"density": density, "alpha": alpha, "limits": limits or "default"}
    for speed in IMPACT_SPEEDS:
        left = []
        for factor in FACTORS:
            given = {"density": density, "alpha": alpha, "limits": limits, "ceiling": CEILING}
            end = 5 * REACH / (speed * OF_SOUND)
            given["speed"] = speed * factor
            run = runner.run(f"{setting}_{speed}_{factor}", end, given)
            left.append(run.thermo["c_motion"][-1] / run.thermo["c_motion"][0])
        row[f"{speed} c0: mean"], row[f"{speed} c0: largest"] = map(
            float, (np.mean(left), max(left))
        )
    return row


def drops(runner: Runner, scheme: str, given: Mapping[str, Value]) -> dict[str, Value]:
    """Return the updates and the change of the total energy of two drops that collide."""
    setting = " ".join(map(str, given.values()))
    run = runner.run(f"{scheme}_{setting.replace(' ', '_')}", MEET, {"scheme": scheme, **given})
    energy = run.thermo["TotEng"]
    return {
        "scheme": scheme,
        "setting": setting,
        "steps": int(run.thermo["Step"][-1]),
        "particle updates": float(run.thermo["v_updates"][-1]),
        "change of the energy": float(energy[-1] / energy[0]) - 1,
    }


STUDIES: Mapping[str, Callable[[Runner], Points]] = {
    "resolutions": lambda runner: [border(runner, *each) for each in BORDERS],
    "corner": lambda runner: [corner(runner, *each) for each in CORNERS],
    "bounce": lambda runner: [
        bounce(runner, what, scheme, support, speed)
        for what, scheme in BOUNCES
        for support in (2, 3)
        for speed in SPEEDS
    ],
    "impact": lambda runner: [
        impact(runner, density, *each)
        for density in ("summation", "calibrated")
        for each in IMPACTS
    ],
    "rest": lambda runner: [
        rest(runner, density, fluid)
        for density in ("summation", "calibrated", "continuity")
        for fluid in FLUIDS
    ],
    "drops": lambda runner: [drops(runner, scheme, given) for scheme, given in DROPS],
}


def study(name: str, out: Path, console: Console) -> Points:
    """Run one study and write its points to a folder."""
    script = "bounce" if name == "impact" else name
    points = STUDIES[name](Runner(FOLDER / f"in.{script}", out / name, 1, console))
    write_json(out / f"{name}.json", points)
    return points


def main() -> None:
    """Run the study that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("study", choices=tuple(STUDIES))
    parser.add_argument("--out", type=Path, default=Path("water"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print(points_table(study(options.study, options.out, Console(stderr=True))))
