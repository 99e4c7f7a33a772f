"""Which vertices are held: conditions on coordinates, a box, the border, or vertex numbers."""

from __future__ import annotations

import operator
import re

import numpy as np
from numpy.typing import NDArray

from sphcloth.errors import UserError
from sphcloth.meshing.surface import Surface

FORMS = (
    "use a condition as 'z>0.9' or 'z>0.9 and x<=0', 'box XLO XHI YLO YHI ZLO ZHI', 'border', or "
    "'ids 1,4,10-20'"
)
_COMPARE = {">": operator.gt, "<": operator.lt, ">=": operator.ge, "<=": operator.le}
_CONDITION = re.compile(r"\s*([xyz])\s*(<=|>=|<|>)\s*(\S+)\s*")


def select_vertices(surface: Surface, selection: str) -> NDArray[np.bool_]:
    """Return which vertices a selection names, shape (V,).

    Args:
        surface: positions in the coordinates of the scene.
        selection: ``z>0.9 and x<=0``, ``box XLO XHI YLO YHI ZLO ZHI``, ``border`` for the edges
            with one triangle, or ``ids 1,4,10-20`` with atom IDs from 1.

    Raises:
        UserError: none of these forms, or no vertex is selected.
    """
    words = selection.split()
    if words[:1] == ["border"] and len(words) == 1:
        chosen = _are_members(surface, surface.boundary_edges)
    elif words[:1] == ["ids"] and len(words) > 1:
        chosen = _are_members(surface, _ids(" ".join(words[1:]), len(surface.vertices)) - 1)
    elif words[:1] == ["box"]:
        chosen = _inside(surface, words[1:], selection)
    else:
        chosen = _meet_conditions(surface, selection)
    if not chosen.any():
        low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
        raise UserError(
            f"--pin '{selection}' selects no vertex: they lie between "
            "({:g}, {:g}, {:g}) and ({:g}, {:g}, {:g})".format(*low, *high)
        )
    return chosen


def _are_members(surface: Surface, members: NDArray[np.int64]) -> NDArray[np.bool_]:
    chosen = np.zeros(len(surface.vertices), bool)
    chosen[members] = True
    return chosen


def _ids(text: str, largest: int) -> NDArray[np.int64]:
    """Return the numbers of a list as ``1,4,10-20``; UserError if one does not exist."""
    ids: list[NDArray[np.int64]] = []
    for item in re.split(r"[,\s]+", text.strip(" ,")):
        found = re.fullmatch(r"(\d+)(?:-(\d+))?", item)
        if not found:
            raise UserError(f"--pin ids: '{item}' is no number or range: {FORMS}")
        first, last = int(found[1]), int(found[2] or found[1])
        if not 1 <= first <= last <= largest:
            raise UserError(f"--pin ids: {item} is not within the vertices 1 to {largest}")
        ids.append(np.arange(first, last + 1))
    return np.concatenate(ids)


def _inside(surface: Surface, words: list[str], selection: str) -> NDArray[np.bool_]:
    bounds = np.array([_number(word, selection) for word in words])
    if len(bounds) != 6 or np.any(bounds[::2] > bounds[1::2]):
        raise UserError(f"--pin '{selection}': a box is XLO XHI YLO YHI ZLO ZHI, low before high")
    within = (surface.vertices >= bounds[::2]) & (surface.vertices <= bounds[1::2])
    return within.all(axis=1)


def _meet_conditions(surface: Surface, selection: str) -> NDArray[np.bool_]:
    chosen = np.ones(len(surface.vertices), bool)
    for condition in re.split(r"\band\b|&+", selection):
        found = _CONDITION.fullmatch(condition)
        if not found:
            raise UserError(f"--pin '{selection}' is not understood: {FORMS}")
        axis, comparison, bound = found.groups()
        values = surface.vertices[:, "xyz".index(axis)]
        chosen &= _COMPARE[comparison](values, _number(bound, selection))
    return chosen


def _number(word: str, selection: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise UserError(f"--pin '{selection}': '{word}' is no number: {FORMS}") from None
