"""The extremes, by name: what a scene is told, and what must happen."""

from __future__ import annotations

from sphcloth.stress.case import (
    CLOTH,
    SPACING,
    WATER,
    Case,
    center_stays,
    column,
    compressed_by,
    momentum,
    nothing_crosses,
    nothing_lost,
    speed_below,
    stays_where_it_is,
    strain_below,
)

C0 = 20.0
PARTICLE = 1000 * SPACING**3 / 1.03384
# every style names itself in its errors
NAMED = r"(fix \w+ |pair_style )(sph|pbd|cloth|wall)/\w+: "
# the longest step of the scenes: one toward an output time may exceed it by round-off
LONGEST = 2e-3 * (1 + 1e-8)
ON_SHEET = (nothing_crosses, nothing_lost)
FREE = {"hold": "nothing", "gravity": 0}
ALONE = {"cloth": "no", "gravity": 0}


def all_cases() -> dict[str, Case]:
    """Return name -> case."""
    found = [
        *_cloth(),
        *_impacts(),
        *_shapes(),
        *_steps(),
        *_water(),
        *_few(),
        *_boxes(),
        *_wrong(),
    ]
    return {case.name: case for case in found}


def _cloth() -> list[Case]:
    """Stiffness, sweeps, masses."""
    sheet = [
        Case("stiffness-0", "edges and hinges that do nothing: finite, nothing crosses", "sheet",
             ON_SHEET, {"stretch": 0, "bend": 0}),
        Case("stiffness-1", "edges and hinges without give: finite, nothing crosses", "sheet",
             ON_SHEET, {"stretch": 1, "bend": 1}),
        Case("sweeps-1", "one sweep: finite, nothing crosses", "sheet", ON_SHEET, {"sweeps": 1}),
        Case("sweeps-1000", "a thousand sweeps: edges within 0.1 % at 3e-4 s, nothing crosses",
             "sheet", (*ON_SHEET, strain_below(1e-3, 3e-4)), {"sweeps": 1000},
             {"time": 0.005, "every": 1}),
    ]  # fmt: skip
    free = [
        Case(
            f"mass-ratio-{ratio:g}",
            f"a vertex of {ratio:g} times a particle's mass: momentum kept, nothing crosses",
            "sheet",
            (*ON_SHEET, momentum(1e-11)),
            FREE | {"areal": ratio * PARTICLE / SPACING**2, "fixed": dt, "height": 0.11, "vz": -2},
            {"time": 0.03},
        )
        for ratio, dt in ((1e-3, 3e-5), (1e-1, 2e-4), (1.0, 3e-4), (1e3, 3e-4))
    ]
    return sheet + free


def _impacts() -> list[Case]:
    """Water meets a sheet at up to three times the speed of sound."""
    found = []
    for mach in (0.1, 0.5, 1, 3):
        speed = mach * C0
        time = {"fixed": min(3e-4, 0.2 * SPACING / speed), "time": 0.2 / speed, "every": 6}
        for way, velocity in (
            ("normal", {"vx": 0, "vz": -speed}),
            ("grazing", {"vx": 0.98 * speed, "vz": -0.2 * speed}),
        ):
            found.append(
                Case(
                    f"impact-{mach:g}-{way}",
                    f"{way} at {mach:g} c0: nothing crosses, finite",
                    "sheet",
                    (nothing_crosses,),
                    velocity | time,
                )
            )
    return found


def _shapes() -> list[Case]:
    """Two triangles in poses that have no normal, no angle or no length."""
    poses = {
        "flat-hinge": ("flat", "a hinge at 0 degrees"),
        "folded-hinge": ("folded", "a hinge at 180 degrees"),
        "sliver": ("sliver", "a triangle of height 1e-9"),
        "zero-edge": ("closed", "an edge without length"),
        "both-ends-pinned": ("pinned", "an edge between two pins"),
    }
    return [
        Case(name, f"{what}: finite, nothing lost", "shapes", (nothing_lost,), {"pose": pose})
        for name, (pose, what) in poses.items()
    ]


def _steps() -> list[Case]:
    """Steps that are too long, and a great many.

    Water that falls through the height h = 0.4 m has sqrt(2 g h) = 2.8 m/s, its front on the ground
    2 sqrt(g h) = 4 m/s (Ritter). Stopped at once it is compressed by its speed over c0: 0.085.
    """
    stepped = ("global", "individual", "block")
    return [
        Case("long-ceiling", "c0 33, max 5e-3 s: stability allows water at rest 2.8e-3 s", "dam",
             (nothing_lost, column("Dt", 0, 2.8e-3), compressed_by(0.085), speed_below(4.0)),
             schemes=stepped, same=None),
        Case("long-floor", "a floor of ten times that: the run ends and names the limit", "dam", (),
             {"limits": "max 0.02 min 0.0075"}, schemes=stepped,
             error=r"fix step sph/integrate: the \w+ limit of particle \d+ asks for .* below min"),
        Case("long-clamped", "clamped at that floor: counted, or a named end", "dam",
             (column("v_clamped", 1, 1e9, last=True),),
             {"limits": "max 0.02 min 0.0075 below clamp", "every": 1}, schemes=stepped,
             or_error=NAMED, same=None),
        Case("long-step", "a constant step of ten times that: the run ends and names the cause",
             "dam", (), {"dt": 0.0075, "time": 1.0}, schemes=("constant",), error=NAMED),
        Case("million-steps", "a particle on a small sheet for a million steps: it rests there",
             "sheet", (nothing_crosses, nothing_lost, speed_below(2.0)),
             {"water": "one", "side": 0.2, "time": 1e9, "steps": 1_000_000, "every": 10_000},
             {"steps": 10_000, "every": 100}, schemes=("constant",), ranks=(1,)),
    ]  # fmt: skip


def _water() -> list[Case]:
    """Water alone."""
    return [
        Case("coincident", "every particle twice at one place: momentum kept, or a named end",
             "sheet", (nothing_lost, momentum(1e-12)),
             ALONE | {"twins": "yes", "fixed": 1e-4, "dt": 1e-4, "time": 0.01},
             or_error=NAMED, same=None),
        Case("at-rest", "v = 0, a = 0: the longest step, nothing moves beyond round-off", "sheet",
             (stays_where_it_is(within=1e-15), column("Dt", 3e-4, LONGEST)),
             FREE | {"vz": 0, "height": 0.2}),
        Case("creeping", "Re = 1e-3: finite, slower than free fall", "dam",
             (nothing_lost, speed_below(0.01)),
             {"nu": 600, "alpha": 0, "dt": 8e-7, "time": 8e-4, "every": 100},
             {"time": 1e-4}),
    ]  # fmt: skip


def _few() -> list[Case]:
    """One of each, none of each, and ranks without any."""
    return [
        Case("one-particle", "it falls on a sheet and stays above", "sheet", ON_SHEET,
             {"water": "one", "time": 0.2}),
        Case("one-particle-alone", "it flies with its momentum", "sheet",
             (nothing_lost, momentum(1e-15)), ALONE | {"water": "one"}),
        Case("one-link", "it takes its length, its center stays", "link",
             (nothing_lost, center_stays(1e-12), column("v_strain", 0, 1e-12, last=True))),
        Case("no-fluid", "a sheet hangs", "sheet", (nothing_lost,), {"water": "none"}),
        Case("no-cloth", "water falls out of the box and is drained", "sheet",
             (column("Atoms", 0, 0, last=True),), {"cloth": "no", "vz": -5, "time": 0.4}),
        Case("pinned-sheet", "all vertices are pins: they stay to the last bit", "sheet",
             (*ON_SHEET, stays_where_it_is(CLOTH)), {"hold": "all"}),
        Case("empty-ranks", "all atoms on one rank: as on one", "sheet", ON_SHEET,
             {"all_on_one": "yes", "cut": "* 1 1"}),
        Case("thin-slices", "a rank for each slice of the sheet: as on one", "sheet", ON_SHEET,
             {"cut": "* 1 1"}),
    ]  # fmt: skip


def _boxes() -> list[Case]:
    """Cloth and water go through periodic faces."""
    checks = (nothing_crosses, nothing_lost, momentum(1e-10))
    return [
        Case("periodic", "a sheet and water through the faces: nothing crosses, momentum kept",
             "drift", checks),
        Case("tilted", "the same in a tilted box", "drift", checks, {"tilt": 0.2}),
        Case("deforming", "the same in a box that grows by three fifths", "drift", checks,
             {"stretch": 2.0}),
    ]  # fmt: skip


def _wrong() -> list[Case]:
    """NaN on purpose."""
    return [
        Case("nan-in-cloth", "an infinite force on a vertex: the run ends and names the style",
             "sheet", (), {"nan": 20, "nan_on": 1}, error=NAMED),
        Case("nan-in-water", "an infinite force on a particle: the run ends and names the style",
             "sheet", (), {"nan": 20, "nan_on": 180}, error=NAMED),
    ]  # fmt: skip


__all__ = ["NAMED", "WATER", "all_cases"]
