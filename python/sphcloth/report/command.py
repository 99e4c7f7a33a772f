"""``sphcloth report``: collect, pack and write."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sphcloth.errors import UserError
from sphcloth.report.collect import Findings, collect
from sphcloth.report.page import page
from sphcloth.report.viewer import Packed, pack
from sphcloth.results import prepare_file


def report(
    folders: Sequence[Path], out: Path, title: str, viewers: int, console: Console
) -> Findings:
    """Write one page of all results in some folders.

    Args:
        folders: to look through, with the folders in them.
        out: the page; an earlier one goes.
        title: its title.
        viewers: how many trajectories it shows at most; each is up to a few megabytes.
        console: where the progress appears.

    Returns:
        What was found; ``skipped`` names what could not be read.

    Raises:
        UserError: a folder that is none, nothing to show, or a file that cannot be written.
    """
    prepare_file(out, "--out", "HTML")
    with console.status("collecting"):
        found = collect(folders)
        shown = _packed(found, viewers)
        if not shown and not any(found.results.values()):
            reasons = "; ".join(f"{path}: {reason}" for path, reason in found.skipped)
            raise UserError(f"nothing to show: {reasons}")
        text = page(found, shown, title)
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}") from None
    counts = [f"{len(each)} {kind}" for kind, each in found.results.items() if each]
    if found.trajectories:
        counts.append(f"{len(shown)} of {len(found.trajectories)} trajectories")
    size = out.stat().st_size / 1e6
    told = f"{out}: {', '.join(counts)}, {size:.1f} MB"
    console.print(told, markup=False, highlight=False, soft_wrap=True)
    for path, reason in found.skipped:
        console.print(f"left out: {path}: {reason}", markup=False, style="yellow", soft_wrap=True)
    return found


def _packed(found: Findings, viewers: int) -> list[Packed]:
    """Return the newest trajectories, scenes with a data file first; notes what is unreadable."""

    def rank(dump: Path) -> tuple[bool, float]:
        return dump.with_suffix(".data").is_file(), dump.stat().st_mtime

    shown = []
    for dump in sorted(found.trajectories, key=rank, reverse=True):
        if len(shown) == viewers:
            break
        try:
            shown.append(pack(dump))
        except UserError as error:
            found.skipped.append((dump, str(error)))
    return shown
