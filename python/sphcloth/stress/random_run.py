"""``sphcloth stress random``: scenes of consecutive seeds, what was wrong, and their scripts."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from sphcloth.errors import UserError
from sphcloth.stress.oracle import Evidence, complaints, nothing_crosses
from sphcloth.stress.random_scene import RandomScene, draw
from sphcloth.stress.random_script import script_of
from sphcloth.stress.runner import Verdict, run_script


def random_scenes(
    first: int, count: int, out: Path, console: Console, schemes: Sequence[str | None] = (None,)
) -> Iterator[Verdict]:
    """Run the scenes of so many seeds from the first; print those that fail, and keep their files.

    Args:
        first: the seed of the first scene; each scene depends on its seed, and the scheme, alone.
        count: how many.
        out: folder that keeps what the failed scenes wrote, each in ``random-SEED``, or
            ``random-SEED-SCHEME`` where the scheme is not drawn.
        console: where failures are told.
        schemes: with which each scene is run; None: with the one that is drawn.

    Raises:
        UserError: a seed below 0 or fewer than one scene.
    """
    if first < 0:
        raise UserError(f"--seed {first}: expected a whole number, 0 or above")
    if count < 1:
        raise UserError(f"--count {count}: expected a whole number above 0")
    with tempfile.TemporaryDirectory() as scratch:
        for seed in range(first, first + count):
            for scheme in schemes:
                name = "-".join(["random", str(seed), *([scheme] if scheme else [])])
                yield _run(draw(seed, scheme), name, Path(scratch), out, console)


def _run(scene: RandomScene, name: str, scratch: Path, out: Path, console: Console) -> Verdict:
    start = time.monotonic()
    script = scratch / f"in.{name}"
    script.write_text(script_of(scene), encoding="utf-8")
    outcome = run_script(script, scratch / name, {"every": 4}, scene.ranks)
    found = complaints(scene, outcome)
    if any("crossed" in one for one in found):
        # between frames a particle that rounds the border may seem to cross
        closely = run_script(script, scratch / f"{name}-closely", {"every": 1}, scene.ranks)
        found = [one for one in found if "crossed" not in one]
        found += nothing_crosses(Evidence(scene, closely))
    wall = time.monotonic() - start
    if found:
        shutil.copytree(scratch / name, out / name, dirs_exist_ok=True)
        told = f"seed {scene.seed}, {out / name}/in.{name}: {'; '.join(found)}"
        console.print(f"[red]breach[/] {escape(told)}", highlight=False, soft_wrap=True)
    shutil.rmtree(scratch / name, ignore_errors=True)
    return Verdict(name, scene.scheme, scene.ranks, found, outcome.error, wall)
