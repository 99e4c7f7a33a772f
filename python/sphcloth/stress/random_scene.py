"""Scenes drawn at random: water, a sheet, how they meet, walls, steps, units.

A scene is drawn in SI, in lengths of its spacing, and written in any system of units. It stays
within what the pages of the styles say can be stable: viscosity where a boundary extrapolates or
mirrors the pressure, hinges on free sheets, constant steps below the limits of the adaptive ones.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, fields
from typing import Any

from sphcloth.stress.case import SCHEMES
from sphcloth.stress.unit_systems import UNITS

GRAVITY = 9.81
KERNELS = {"wendland/c2": 2.0, "wendland/c4": 2.5, "cubic": 2.0, "quintic": 3.0}
PRESSURES = ("extrapolate", "mirror", "own")


@dataclass(frozen=True)
class RandomScene:
    """What was drawn; lengths in m, all else in SI.

    Attributes:
        seed: of the draw.
        units, newton, ranks, boundary, tilt: of the run and its box.
        spacing, support, kernel, precision, density, tension: of the fluid's sums.
        water: drop, block, two fluids, two resolutions or jet.
        size: cells of a block along each side.
        rest_density, c0, alpha, nu: of the first and the second fluid.
        velocity: of the water.
        start: height of the lowest water over the sheet.
        sheet: none, rectangle or disc; with areal mass, side, edge length, pattern and slope.
        pins: none, corners or rim.
        edge, hinge: coefficients, ``k VALUE`` or ``compliance VALUE``.
        solver: keywords of fix pbd/cloth.
        coupling: boundary, none or wall; with the pressure of a boundary.
        contact: whether nothing may pass.
        thickness, friction, restitution: of contact.
        meets: thickness with which the sheet meets itself, 0 where it does not.
        walls, plate, gravity, shift: whether there are.
        scheme: of the step; whether LAMMPS's own run style does it.
        dt: constant step, or the ceiling.
        time, steps: where the run ends.
        skin: of LAMMPS's lists.
    """

    seed: int
    units: str
    newton: str
    ranks: int
    boundary: str
    tilt: float
    spacing: float
    support: float
    kernel: str
    precision: str
    density: str
    tension: str
    water: str
    size: tuple[int, int, int]
    rest_density: tuple[float, float]
    c0: tuple[float, float]
    alpha: float
    nu: float
    velocity: tuple[float, float, float]
    start: float
    sheet: str
    areal: float
    side: float
    edge_length: float
    pattern: str
    slope: float
    pins: str
    edge: tuple[str, float]
    hinge: tuple[str, float]
    solver: str
    iterations: int
    order: str
    direction: str
    reference: bool
    damping: float
    coupling: str
    pressure: str
    contact: bool
    thickness: float
    meets: float
    friction: float
    restitution: float
    walls: bool
    plate: bool
    gravity: bool
    shift: bool
    scheme: str
    verlet: bool
    dt: float
    time: float
    steps: int
    skin: float

    @property
    def is_closed(self) -> bool:
        """Whether nothing outside acts on water and sheet, and none of them leaves."""
        held = self.gravity or self.walls or self.plate or self.pins != "none"
        return not held and self.water != "jet"

    @property
    def has_mesh(self) -> bool:
        """Whether there are triangles."""
        return self.sheet != "none" or self.plate

    @property
    def speed(self) -> float:
        """Of the water."""
        return math.hypot(*self.velocity)

    @property
    def opening(self) -> float:
        """Height of that of a jet: so far above the sheet that no water backs up into it."""
        return self.start + 6 * self.spacing

    def told(self) -> str:
        """Return what was drawn, in a line."""
        return ", ".join(f"{f.name} {_short(getattr(self, f.name))}" for f in fields(self))


def _short(value: object) -> str:
    if isinstance(value, tuple):
        return "(" + " ".join(_short(one) for one in value) + ")"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


# ---- drawing ------------------------------------------------------------------------------------


def draw(seed: int, scheme: str | None = None) -> RandomScene:
    """Return the scene of a seed.

    Args:
        seed: of the draw.
        scheme: of the step; None: it is drawn, too. Water, sheet and surroundings are the same with
            each, the length of the step and how densities are found are drawn for it.
    """
    r = random.Random(seed)
    s: dict[str, Any] = {"seed": seed}
    s["units"] = r.choices(list(UNITS), [6, 2, 2, 2, 2])[0]
    s["newton"] = r.choice(("on", "off"))
    s["ranks"] = r.choices((1, 2), (9, 1))[0]
    s["spacing"] = r.choice((0.02, 0.05, 0.1))
    s["kernel"] = r.choice(list(KERNELS))
    s["support"] = s["spacing"] * (KERNELS[s["kernel"]] + r.choice((0, 0, 0.3)))
    s["precision"] = r.choice(("double", "double", "mixed"))
    s["tension"] = r.choices(("no", "yes"), (9, 1))[0]
    s["skin"] = s["spacing"] * r.uniform(0.3, 1.0)
    _draw_sheet(r, s)
    _draw_surroundings(r, s)
    _draw_water(r, s)
    if r.random() < 0.2:
        # nothing acts from outside
        s |= {"gravity": False, "walls": False, "plate": False, "pins": "none"}
        s["water"] = "block" if s["water"] == "jet" else s["water"]
    _draw_steps(r, s, scheme)
    if s["scheme"] == "block" and not s["shift"] and r.random() < 0.3:
        s["density"] = "continuity"
    return RandomScene(**s)


def _draw_sheet(r: random.Random, s: dict[str, Any]) -> None:
    dx = s["spacing"]
    s["sheet"] = r.choices(("none", "rectangle", "disc"), (2, 8, 2))[0]
    s["areal"] = 10 ** r.uniform(-1, 1.3)
    s["side"] = dx * r.uniform(8, 12)
    s["coupling"] = r.choice(("boundary", "boundary", "none", "wall"))
    s["pressure"] = r.choice(PRESSURES)
    s["contact"] = s["coupling"] != "boundary" or r.random() < 0.8
    s["edge_length"] = dx * r.uniform(0.9, 1.1 if s["coupling"] == "boundary" else 2.5)
    s["pattern"] = r.choice(("square", "diagonal", "equilateral"))
    s["slope"] = r.choice((0, 0, 0, r.uniform(-0.5, 0.5))) if s["sheet"] == "rectangle" else 0
    kinds = ["none", "corners", "rim"] if s["sheet"] == "rectangle" else ["none", "rim"]
    s["pins"] = r.choice(kinds) if s["sheet"] != "none" and not s["slope"] else "none"
    if s["slope"]:
        s["pins"] = r.choice(("none", "corners"))
    s["solver"] = r.choice(("gs", "jacobi", "substeps", "substeps"))
    s["iterations"] = r.choice((1, 2, 5, 10, 20, 40))
    s["order"] = "forward"
    if s["solver"] != "jacobi":
        s["order"] = r.choice(("forward", "forward", "symmetric"))
    s["direction"] = r.choice(("current", "start"))
    # a draw of its own, so that the others stay what they are
    if random.Random(f"{s['seed']} default solver").random() < 0.5:
        s |= {"solver": "substeps", "iterations": 0, "order": "forward", "direction": "start"}
    s["damping"] = r.choice((0.0, r.uniform(0, 10)))
    modulus = 10 ** r.uniform(2, 5)  # N/m
    s["edge"] = r.choice((("k", 1.0), ("k", r.uniform(0.1, 1)), ("compliance", 1 / modulus)))
    stiff = ("k", r.choice((0.02, 0.1, 0.5, 1.0)))
    rigidity = 10 ** r.uniform(-5, -1) * modulus * dx**2  # N m
    s["hinge"] = r.choice((stiff, ("compliance", 1 / rigidity)))
    # stiff hinges that contradict each other pull soft edges apart
    if s["edge"] != ("k", 1.0) and s["hinge"][0] == "k":
        s["hinge"] = ("k", min(s["hinge"][1], 0.1))
    s["reference"] = r.random() < 0.5
    s["thickness"] = dx * r.uniform(0.05, 0.3)
    # draws of its own, so that the others stay what they are
    meeting = random.Random(f"{s['seed']} meets")
    meets = s["contact"] and meeting.random() < 0.5
    s["meets"] = s["edge_length"] * meeting.uniform(0.1, 0.4) if meets else 0.0
    s["friction"] = r.choice((0.0, 0.0, r.uniform(0, 1)))
    s["restitution"] = r.choice((0.0, 0.0, r.uniform(0, 1)))


def _draw_surroundings(r: random.Random, s: dict[str, Any]) -> None:
    s["gravity"] = r.random() < 0.7
    held = s["sheet"] == "none" or s["pins"] == "rim"
    s["boundary"] = r.choice(("f f f", "p p f", "p p p"))
    # in a box that is periodic along z weight has no floor
    if s["gravity"] and s["boundary"] == "p p p":
        s["boundary"] = "p p f"
    s["walls"] = s["boundary"] == "f f f" and held and r.random() < 0.6
    s["plate"] = r.random() < (0.3 if s["sheet"] != "none" else 0.5)
    s["tilt"] = r.choice((0.0, s["spacing"] * r.uniform(-6, 6))) if "p" in s["boundary"] else 0.0


def _draw_water(r: random.Random, s: dict[str, Any]) -> None:
    dx = s["spacing"]
    kinds = ["drop", "block", "two fluids", "two resolutions", "jet"]
    # a jet needs an end of the box where it leaves, and bursts where its surface is under tension
    no_jet = s["boundary"] == "p p p" or s["tension"] == "yes"
    s["water"] = r.choice(kinds[:4] if no_jet else kinds)
    s["size"] = tuple(r.randint(3, 6) for _ in range(3))
    speed = math.sqrt(GRAVITY * 20 * dx) * r.uniform(0.3, 1.5)
    aside = r.choice((0.0, r.uniform(0, 0.8)))
    around = r.uniform(0, 2 * math.pi)
    s["velocity"] = (
        speed * aside * math.cos(around),
        speed * aside * math.sin(around),
        -speed * math.sqrt(1 - aside**2),
    )
    slowest = 5 * speed if s["walls"] else r.choice((1.5, 5, 5, 5)) * speed
    first = slowest * r.uniform(1, 3)
    s["c0"] = (first, first * r.choice((1.0, r.uniform(0.7, 1.5))))
    dense = r.choice((1000.0, r.uniform(500, 3000)))
    s["rest_density"] = (dense, dense * r.choice((1.0, r.uniform(0.3, 3.0))))
    if s["water"] != "two fluids":
        s["rest_density"], s["c0"] = (dense, dense), (first, first)
    free = s["sheet"] == "none" or s["coupling"] != "boundary" or s["pressure"] == "own"
    s["alpha"] = r.choice(((0.0, 0.1) if free else (0.1, 0.1)) + (r.uniform(0.05, 0.5),))
    s["nu"] = r.choice((0.0, 10 ** r.uniform(-4, -1) * first * dx))
    s["shift"] = r.random() < 0.1
    reach = 0.5 * dx if s["coupling"] == "none" else s["support"] * r.uniform(0.5, 1.0)
    top = abs(math.sin(s["slope"])) * s["side"] / 2 if s["sheet"] != "none" else 0
    s["start"] = top + reach + s["thickness"] + dx * r.choice((0, r.uniform(0, 2)))


def _draw_steps(r: random.Random, s: dict[str, Any], scheme: str | None) -> None:
    drawn = r.choice(SCHEMES)
    s["scheme"] = scheme or drawn
    s["verlet"] = s["scheme"] in ("constant", "global") and r.random() < 0.5
    s["density"] = "summation"
    if s["scheme"] in ("constant", "global") and r.random() < 0.3:
        s["density"] = "continuity"
    h = s["support"] / 2
    speed, c0 = math.hypot(*s["velocity"]), max(s["c0"])
    light = 1.0
    if s["sheet"] != "none" and s["coupling"] != "none":
        # the sheet must not be so light that no constant step would bring the water there
        wet = 0.5 * max(s["rest_density"]) * s["support"]
        s["areal"] = max(s["areal"], wet / 100)
        light = max(1.0, wet / s["areal"])
    nu = s["nu"] + s["alpha"] * c0 * h / 10
    # what is stopped at once is compressed by its Mach number, and sound is faster there
    sound = c0 * (1 + speed / c0) ** 3 * math.sqrt(light)
    falls = speed + math.sqrt(2 * GRAVITY * 20 * s["spacing"])
    limits = [0.5 * h / sound, 0.2 * h / falls, 0.05 * math.sqrt(2 * h / GRAVITY)]
    if nu:
        limits.append(0.2 * h * h / (nu * light))
    ahead = 8 if s["water"] == "jet" else 3
    flight = (s["start"] + ahead * s["spacing"]) / -s["velocity"][2]
    s["time"] = flight * r.uniform(1.0, 2.5)
    if s["scheme"] == "constant":
        s["dt"] = min(limits) * r.uniform(0.4, 1.0)
    else:
        s["dt"] = 0.5 * h / c0 * r.uniform(0.5, 4.0)
    if s["density"] == "summation" and r.random() < 0.4:
        s["density"] = "calibrated"
    s["steps"] = 300
