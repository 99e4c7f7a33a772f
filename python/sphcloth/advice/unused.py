"""What is switched on in a scene and was never needed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sphcloth.advice.commands import Fix, appended
from sphcloth.advice.evidence import Evidence
from sphcloth.fix_values import LIMITS

# limits of fix sph/integrate that can be switched off, with the value that is their default
DEFAULTS = {"velocity": "0.15", "force": "0.2", "density": "0.1"}
OPTIONAL = ("relative", "cloth", "fluctuation")
# arguments of fix wall/sph: faces and their positions come first
FACES = ("xlo", "xhi", "ylo", "yhi", "zlo", "zhi")


@dataclass(frozen=True)
class Finding:
    """One thing that a run has shown.

    Attributes:
        topic: what it is about, in a word or two.
        measured: what was measured, with the number.
        line: what to type; None if there is nothing to change.
    """

    topic: str
    measured: str
    line: str | None = None


def unused(run: Evidence) -> list[Finding]:
    """Return what the scene could leave out, as far as its columns can tell."""
    return [*_limits(run), *_contact(run), *_walls(run), *_drains(run)]


def _limits(run: Evidence) -> Iterator[Finding]:
    """Limits that set no step and were no particle's tightest."""
    stepper, set_by = run.commands.stepper, run.commands.steps_by_limit
    if stepper is None or not sum(set_by.values()):
        return
    # accuracy stands for all of the defaults, and allows none of them beside it
    defaults = {} if "accuracy" in stepper.arguments else DEFAULTS
    off = [name for name in defaults if _is_on(stepper, name, defaults[name])]
    off += [name for name in OPTIONAL if _is_on(stepper, name, "0")]
    off = [name for name in off if not set_by.get(name) and not _particles(run, stepper, name)]
    if off:
        keywords = " ".join(f"{name} 0" for name in off)
        total = sum(set_by.values())
        yield Finding(
            f"limit{'s' * (len(off) > 1)} {', '.join(off)}",
            f"set none of {total} steps",
            f"{stepper.line} {appended(stepper.style, _without(stepper, off), keywords)}",
        )


def _is_on(stepper: Fix, limit: str, default: str) -> bool:
    return float(stepper.value(limit, default)) != 0


def _particles(run: Evidence, stepper: Fix, limit: str) -> float:
    """Return the largest number of particles whose own tightest limit it was; 0 if not logged."""
    return run.largest(stepper.output(f"particles/{limit}")) or 0 if limit in LIMITS else 0


def _without(stepper: Fix, keywords: list[str]) -> list[str]:
    """Return the arguments of the fix less some keywords and their values."""
    words, kept = list(stepper.arguments), []
    while words:
        word = words.pop(0)
        if word in keywords:
            words.pop(0)
        else:
            kept.append(word)
    return kept


def _contact(run: Evidence) -> Iterator[Finding]:
    for fix in run.commands.styled("cloth/contact"):
        projected, stopped = (run.largest(fix.output(name)) for name in ("contacts", "stops"))
        # with wall yes it is the wall of the water as well
        if projected == 0 and not stopped and fix.value("wall", "no") == "no":
            yield Finding("contact", "contacts = 0: nothing met the cloth", f"# {fix.line}")


def _walls(run: Evidence) -> Iterator[Finding]:
    for fix in run.commands.styled("wall/sph"):
        faces = [word for word in fix.arguments[: _faces_end(fix)] if word in FACES]
        pushes = [_push(run, fix, place) for place in range(len(faces))]
        idle = [face for face, push in zip(faces, pushes, strict=True) if push == 0]
        if idle:
            is_left = len(idle) < len(faces)
            line = f"{fix.line} {_without_faces(fix, idle)}" if is_left else f"# {fix.line}"
            yield Finding(f"wall {', '.join(idle)}", "its force was 0 all the time", line)


def _faces_end(fix: Fix) -> int:
    """Return where the faces of fix wall/sph end and its keywords begin."""
    words = fix.arguments
    return next((n for n, word in enumerate(words) if n % 2 == 0 and word not in FACES), len(words))


def _without_faces(fix: Fix, idle: list[str]) -> str:
    """Return the arguments of fix wall/sph less some faces and their velocities."""
    words, kept = list(fix.arguments), []
    while words:
        word = words.pop(0)
        if word == "velocity" and words[0] in idle:
            words = words[4:]
        elif word in idle:
            words = words[1:]
        else:
            kept.append(word)
    return " ".join(kept)


def _push(run: Evidence, fix: Fix, place: int) -> float | None:
    """Return the largest part of the force on a wall; None if it was not logged."""
    parts = [run.columns.get(f"f_{fix.id}[{3 * place + axis}]") for axis in (1, 2, 3)]
    if any(part is None for part in parts):
        return None
    return max(float(abs(part).max(initial=0.0)) for part in parts)


def _drains(run: Evidence) -> Iterator[Finding]:
    for fix in run.commands.styled("sph/drain"):
        if run.last(f"f_{fix.id}") == 0:
            yield Finding("drain", f"f_{fix.id} = 0: nothing flowed off", f"# {fix.line}")
