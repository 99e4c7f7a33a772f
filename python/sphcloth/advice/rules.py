"""What a scene needs, from what a probe has measured: each rule finds one thing or nothing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from sphcloth.advice.commands import Fix, Fluid
from sphcloth.advice.evidence import Evidence
from sphcloth.advice.unused import Finding
from sphcloth.fix_values import LIMITS, set_by

# a limit that sets most of the steps is worth a word
MOSTLY = 0.5
# a share of the particles this small that sets the step for all is better stepped by itself
FEW = 0.05
# speed of sound over the largest speed: compression of about a hundredth
MACH = 10.0
# factors by which the speed of sound may miss that in both directions without a word
TOO_STIFF, TOO_SOFT = 1.5, 0.8
# compression from which on that is more than a formality
SOFT = 0.02
# steps between two list builds that are neither too few nor too many, and the ones aimed at
OFTEN, SELDOM, BETWEEN = 5, 60, 15
# skin over support: what was measured to be best lies between (docs/evidence/speed.md)
LEAST_SKIN, MOST_SKIN = 0.1, 1.2
# constant steps over smoothing length / speed of sound: short ones, and stability
USUAL, STABLE = 0.5, 1.6

# coefficient of a limit by sound to try, where the script gives one: runs are stable up to 1.6
LOUDER = "0.8"
# how much more compression a longer step may bring
MORE_COMPRESSION = 1.2
# share of the cost below which a saving is worth a word
WORTH = 0.9


@dataclass(frozen=True)
class Trial:
    """A second probe that shows whether an advice holds.

    Attributes:
        before: commands before each run.
        edits: style of a fix -> what to append to it.
        judge: takes the probe and the second one; returns what it showed, and whether it helped.
    """

    judge: Callable[[Evidence, Evidence], tuple[str, bool]]
    before: tuple[str, ...] = ()
    edits: Mapping[str, str] = field(default_factory=dict)


Proposal = tuple[Finding, Trial | None]


def facts(run: Evidence) -> list[Finding]:
    """Return what was measured, whether or not there is anything to change."""
    return [*_steps(run), *_speeds(run), *_builds(run), *_strains(run)]


def _steps(run: Evidence) -> Iterator[Finding]:
    steps = run.commands.steps_by_limit
    how = f"set by {set_by(steps)}" if steps else "constant"
    yield Finding("time step", f"mean {run.mean_step:.3g}, {how}")


def _speeds(run: Evidence) -> Iterator[Finding]:
    for kind, fluid in run.commands.fluids.items():
        fastest = max(run.largest("c_advise_fast") or 0.0, 0.0)
        densest = run.largest(run.commands.stepper.output("compression")) or 0.0
        yield Finding(
            f"sound, type {kind}",
            f"c0 = {fluid.sound:.3g}, largest speed {fastest:.3g} (v/c0 = "
            f"{fastest / fluid.sound:.2g}), largest compression {densest:.2%}",
        )


def _builds(run: Evidence) -> Iterator[Finding]:
    builds, words = _total(run, "v_advise_builds"), run.commands.neighbor
    skin = f"skin {float(words[0]):.3g}" if words else "the default skin"
    often = f"built every {run.steps / builds:.3g} steps" if builds else "never built again"
    yield Finding("neighbor lists", f"{often}, {skin}")


def _strains(run: Evidence) -> Iterator[Finding]:
    for fix in run.commands.styled("pbd/cloth"):
        strain = run.largest(fix.output("strain")) or 0.0
        kind = "substeps" if is_substeps(fix) else "sweeps"
        yield Finding(f"cloth {fix.id}", f"largest strain {strain:.2%}, {sweeps(fix)} {kind}")


def needs(run: Evidence, speed: float | None, stretch: float) -> list[Proposal]:
    """Return all findings of a probe, each with the trial that it has to pass.

    Args:
        run: the probe.
        speed: largest speed that the user expects, beside the one measured.
        stretch: strain of an edge that the user accepts.
    """
    plain = [*_constant(run), *_sound(run, speed), *_skin(run)]
    return [*_limit(run), *((finding, None) for finding in plain), *_stretch(run, stretch)]


def _limit(run: Evidence) -> Iterator[Proposal]:
    """The limit that sets most steps, and how many particles it comes from."""
    stepper, by_limit = run.commands.stepper, run.commands.steps_by_limit
    total = sum(by_limit.values())
    if not total:
        return
    name, steps = max(by_limit.items(), key=lambda each: each[1])
    if steps < MOSTLY * total:
        return
    measured, shared = f"{name} set {steps} of {total} steps", _limited(run, stepper, name)
    atoms, scheme = run.largest("v_advise_atoms") or 0.0, run.commands.run_style[1:2]
    if shared is not None:
        measured += f", tightest for {shared:.3g} of {atoms:.0f} particles"
    if name == "max":
        higher = f"max {2 * run.largest('v_advise_dt'):.3g}"
        yield Finding("time step", measured, stepper.extended(higher)), _longer(higher)
    elif shared and shared < FEW * atoms and scheme != ("block",):
        block = "run_style sph/adaptive block"
        yield Finding("time step", measured, block), Trial(_saves_updates, before=(block,))
    elif name in ("acoustic", "wetted"):
        # without a coefficient the step is as long as is stable
        now = float(stepper.value(name, stepper.value("acoustic", LOUDER)))
        louder = f"{name} {LOUDER}"
        if now < float(LOUDER):
            yield Finding("time step", measured, stepper.extended(louder)), _longer(louder)


def _limited(run: Evidence, stepper: Fix, name: str) -> float | None:
    """Return the mean number of particles whose tightest limit it is, while it sets the step.

    None for ``max``, which no particle is near, and for limits of vertices, one for each cloth.
    """
    if name not in LIMITS or name in ("wetted", "cloth", "max"):
        return None
    column = run.columns.get(stepper.output(f"particles/{name}"), np.empty(0))
    number = 1 + LIMITS.index(name)
    chosen = run.columns.get(stepper.output("limit"), np.empty(0)) == number
    return float(np.mean(column[chosen])) if np.any(chosen) else None


def _longer(keywords: str) -> Trial:
    """Return the trial of keywords of fix sph/integrate that are to make steps longer."""

    def judge(run: Evidence, again: Evidence) -> tuple[str, bool]:
        further = again.mean_step / run.mean_step
        name = run.commands.stepper.output("compression")
        # the second probe goes further: only what both have seen is compared
        before, after = (
            each.largest(name, min(run.time, again.time)) or 0.0 for each in (run, again)
        )
        measured = f"with {keywords} steps are {further:.2f} times as long"
        helps = further > 1 / WORTH and after <= MORE_COMPRESSION * before
        return f"{measured}, largest compression {after:.2%} instead of {before:.2%}", helps

    return Trial(judge, edits={"sph/integrate": keywords})


def _saves_updates(run: Evidence, again: Evidence) -> tuple[str, bool]:
    """Compare the particle updates for the same time."""
    name = run.commands.stepper.output("updates")
    share = again.last(name) / again.duration / (run.last(name) / run.duration)
    return f"with block steps {share:.0%} of the particle updates", share < WORTH


def _constant(run: Evidence) -> Iterator[Finding]:
    """A constant step beside the one that sound allows."""
    commands = run.commands
    is_constant = (
        commands.stepper.arguments[:1] == ("constant",) or "constant" in commands.run_style
    )
    step = run.largest("v_advise_dt")
    if not is_constant or not commands.fluids or not step:
        return
    allowed = min(fluid.support / 2 / fluid.sound for fluid in commands.fluids.values())
    share = step / allowed
    measured = f"constant step {step:.3g} is {share:.2g} h_s/c0; {USUAL:g} is accurate"
    if share < USUAL / 2:
        yield Finding("time step", measured, f"timestep {USUAL * allowed:.2g}")
    if share > STABLE:
        yield Finding(
            "time step", f"{measured}, {STABLE:g} is the limit", f"timestep {allowed:.2g}"
        )


def _sound(run: Evidence, expected: float | None) -> Iterator[Finding]:
    """The speed of sound against ten times the largest speed."""
    stepper = run.commands.stepper
    fluids = [each for each in run.commands.fluids.values() if not each.follows]
    speed = run.largest("c_advise_fast")
    if not fluids or not speed or speed <= 0:
        return
    fluid = min(fluids, key=lambda each: each.sound)
    fastest = max(speed, expected or 0.0)
    densest = run.largest(stepper.output("compression")) or 0.0
    measured = (
        f"c0 = {fluid.sound:.3g}, largest speed {speed:.3g}, "
        f"v/c0 = {speed / fluid.sound:.2g}, largest compression {densest:.1%}"
    )
    if expected:
        measured += f"; {expected:g} expected"
    # compression that is not of speed, as by depth, needs its own stiffness
    wanted = max(MACH * fastest, fluid.sound * math.sqrt(densest * MACH))
    is_soft = densest > SOFT or expected is not None
    if is_soft and wanted > fluid.sound / TOO_SOFT and fastest > fluid.sound / MACH / TOO_SOFT:
        yield Finding("sound", measured, _coefficient(fluid, MACH * fastest))
    # a scene that goes on may get faster than what the probe saw
    if wanted < fluid.sound / TOO_STIFF and (run.whole or expected):
        faster = f": steps longer by {fluid.sound / wanted:.2g} where sound sets them"
        yield Finding("sound", measured + faster, _coefficient(fluid, wanted))


def _coefficient(fluid: Fluid, sound: float) -> str:
    """Return the command that gives the fluid another speed of sound."""
    words, kept = list(fluid.words), []
    while words:
        word = words.pop(0)
        if word in ("k", "c0"):
            words = words[1:]
        elif word == "fluctuation":
            words = words[2:]
        else:
            kept.append(word)
    return f"pair_coeff {' '.join([*kept[:4], 'c0', f'{sound:.3g}', *kept[4:]])}"


def _skin(run: Evidence) -> Iterator[Finding]:
    """How often neighbor lists are built."""
    builds = _total(run, "v_advise_builds")
    words, fluids = run.commands.neighbor, run.commands.fluids.values()
    if not words or not builds or not fluids:
        return
    skin, support = float(words[0]), max(fluid.support for fluid in fluids)
    between = run.steps / builds
    measured = f"skin {skin:.3g} ({skin / support:.2g} H): lists built every {between:.3g} steps"
    better = skin * BETWEEN / between
    better = min(max(better, LEAST_SKIN * support), MOST_SKIN * support)
    is_off = (between < OFTEN and better > skin * 1.2) or (between > SELDOM and better < skin / 1.2)
    if is_off:
        yield Finding("neighbor lists", measured, f"neighbor {better:.2g} bin")


def _total(run: Evidence, name: str) -> float:
    """Return the sum over all runs of a counter that starts anew in each."""
    values = run.columns.get(name, np.empty(0))
    ends = np.flatnonzero(np.diff(values) < 0)
    return float(values[ends].sum() + values[-1]) if len(values) else 0.0


def _stretch(run: Evidence, wanted: float) -> Iterator[Proposal]:
    """The strain of rigid edges, which shorter substeps or more sweeps take away."""
    if not all(_is_rigid(words) for words in run.commands.bonds.values()):
        return
    for fix in run.commands.styled("pbd/cloth"):
        name = fix.output("strain")
        strain = run.largest(name)
        if strain is None or strain <= wanted:
            continue
        now, better = _remedy(fix, strain, wanted)
        measured = f"an edge is drawn by {strain:.2%} with {now}, {wanted:.2%} wanted"

        def judge(
            _: Evidence, again: Evidence, name: str = name, more: str = better, was: float = strain
        ) -> tuple[str, bool]:
            left = again.largest(name)
            return f"{left:.2%} with {more}", left < (was + wanted) / 2

        trial = Trial(judge, edits={"pbd/cloth": better})
        yield Finding("stretch", measured, fix.extended(better)), trial


def _remedy(fix: Fix, strain: float, wanted: float) -> tuple[str, str]:
    """Return what bounds the strain, and keywords that bring it down to one that is wanted."""
    if is_substeps(fix) and "iterations" not in fix.arguments:
        allowed = float(fix.value("strain", "0.01"))
        return f"strain {allowed:.2g}", f"strain {allowed * wanted / strain:.2g}"
    kind = "substeps" if is_substeps(fix) else "sweeps"
    return f"{sweeps(fix)} {kind}", f"iterations {more_sweeps(fix, strain, wanted)}"


def sweeps(fix: Fix) -> int:
    """Return the iterations of a fix pbd/cloth."""
    return int(fix.value("iterations", "10"))


def is_substeps(fix: Fix) -> bool:
    """Tell whether they are substeps."""
    usual = "gs" if {"attach", "tolerance"} & set(fix.arguments) else "substeps"
    return fix.value("solver", usual) == "substeps"


def more_sweeps(fix: Fix, strain: float, wanted: float) -> int:
    """Return how many iterations bring a strain down to one that is wanted.

    What a sweep leaves acts as a spring of stiffness m / h^2, h being the substep; sweeps of one
    step bring the error down in proportion.
    """
    power = 0.5 if is_substeps(fix) else 1.0
    return math.ceil(sweeps(fix) * (strain / wanted) ** power)


def _is_rigid(words: tuple[str, ...]) -> bool:
    return (words[:1] == ("compliance",) and float(words[1]) == 0) or words[:1] in (
        ("1",),
        ("1.0",),
    )
