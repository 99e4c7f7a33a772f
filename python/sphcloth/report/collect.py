"""Finds results in folders: JSON of the other commands, their pictures, and trajectories."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sphcloth.errors import UserError
from sphcloth.results import SUMMARY_PICTURES

# what a result must have to be one of its kind, and the type of each
KINDS = {
    "validation": {"case": str, "metrics": dict, "passed": bool},
    "tradeoff": {"scene": str, "points": list, "best": dict, "quantities": list},
    "advice": {"script": str, "facts": list, "needs": list, "unused": list},
    "run": {"steps": int, "pictures": list, "versions": dict, "passed": bool},
    "bench": {"bench": str},
}
# a result is text; what is larger is none
LARGEST = 20_000_000


@dataclass(frozen=True)
class Result:
    """One JSON file of a known kind, and the pictures that belong to it."""

    path: Path
    values: dict
    pictures: list[Path]


@dataclass
class Findings:
    """All that was found.

    Attributes:
        results: kind -> results, in the order of their paths.
        trajectories: dumps that can be shown.
        skipped: files that look like results and could not be read, each with the reason.
    """

    results: dict[str, list[Result]] = field(default_factory=lambda: {kind: [] for kind in KINDS})
    trajectories: list[Path] = field(default_factory=list)
    skipped: list[tuple[Path, str]] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to show."""
        return not self.trajectories and not any(self.results.values())


def collect(folders: Sequence[Path]) -> Findings:
    """Look through folders, and folders in them; a result that is there twice counts once.

    Raises:
        UserError: a folder that is none, or nothing found in any of them.
    """
    found = Findings()
    seen: set[str] = set()
    for folder in folders:
        if not folder.is_dir():
            raise UserError(f"no folder {folder}")
        for path in _files(folder, "*.json"):
            _add(path, found, seen)
        found.trajectories += [each for each in _files(folder, "*.lammpstrj")]
    if found.is_empty:
        places = ", ".join(str(folder) for folder in folders)
        raise UserError(
            f"no results in {places}: they come from sphcloth validate, tradeoff, bench --json, "
            "advise --json or run"
        )
    return found


def _files(folder: Path, pattern: str) -> Iterator[Path]:
    """Yield the files of a folder; links are not followed, so that nothing is met twice."""
    yield from sorted(
        path for path in folder.rglob(pattern) if path.is_file() and not path.is_symlink()
    )


def _add(path: Path, found: Findings, seen: set[str]) -> None:
    """Read a JSON file and file it under its kind, if it has one."""
    try:
        if path.stat().st_size > LARGEST:
            raise ValueError(f"larger than {LARGEST:,} bytes")
        text = path.read_text(encoding="utf-8")
        values = json.loads(text)
    except (OSError, ValueError, RecursionError) as error:
        found.skipped.append((path, f"{type(error).__name__}: {error}"))
        return
    kind = _kind(values)
    if kind and text not in seen:
        seen.add(text)
        found.results[kind].append(Result(path, values, _pictures(kind, path, values)))


def _kind(values: object) -> str | None:
    """Return the kind of a result, None for JSON of something else."""
    if not isinstance(values, dict):
        return None
    for kind, needed in KINDS.items():
        if all(isinstance(values.get(name), form) for name, form in needed.items()):
            return kind
    return None


def _pictures(kind: str, path: Path, values: dict) -> list[Path]:
    """Return the pictures beside a result that its command has drawn."""
    folder = path.parent
    names = {
        "validation": [f"{values.get('case')}.png"],
        "tradeoff": [
            f"{values.get('scene')}-{each.get('name')}.png"
            for each in values.get("quantities", [])
            if isinstance(each, dict)
        ],
        "run": list(SUMMARY_PICTURES),
    }
    # neither a name nor a link is a way out of the folder
    plain = [folder / name for name in names.get(kind, []) if Path(name).name == name]
    return [each for each in plain if each.is_file() and not each.is_symlink()]
