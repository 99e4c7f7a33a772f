"""Links of the documentation lead somewhere, its words are of the field, its references exist."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from doc_pages import PAGES, ROOT, TUTORIAL

# functions that the walk-through of CONTRIBUTING lets the reader write
TO_BE_WRITTEN = ("project_areas", "material_of_area", "channel_of_area_color")
SOURCES = [
    path.read_text()
    for folder, kinds in (("src", "*.[hc]*"), ("python", "*.py"))
    for path in (ROOT / folder).rglob(kinds)
    if path.is_file()
]
CODE = "".join(SOURCES)


def anchors(page: Path) -> set[str]:
    """The anchors of a page's heads, as a forge makes them."""
    heads = re.findall(r"^#+ (.+)$", re.sub(r"```.*?```", "", page.read_text(), flags=re.S), re.M)
    plain = [re.sub(r"\[(.*?)\]\(.*?\)", r"\1", head).lower() for head in heads]
    return {re.sub(r"[^\w\- ]", "", head).replace(" ", "-") for head in plain}


def prose_of(page: Path) -> str:
    """A page or a notebook without its code."""
    if page == TUTORIAL:
        cells = json.loads(page.read_text())["cells"]
        return "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    return re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [*PAGES, TUTORIAL], ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    prose = prose_of(page)
    for target in re.findall(r"\]\(([^)\s]+)\)", prose):
        if re.match(r"\w+:", target):
            continue
        path, _, anchor = target.partition("#")
        goal = (page.parent / path) if path else page
        assert goal.exists(), target
        if anchor:
            assert anchor in anchors(goal), target
    for source in re.findall(r"`((?:\w+/)*\w+\.(?:h|cpp))`", prose):
        ours = [ROOT / source] if (ROOT / source).is_file() else [*(ROOT / "src").rglob(source)]
        ours += (ROOT / "tests/core").rglob(source)
        assert ours or source in ("fix_nve.cpp", "version.h"), source
    for function in re.findall(r"`(?:\w+::)?(\w+)\(\)`", prose):
        assert re.search(rf"\b{function}(<\w+>)?\(", CODE) or function in TO_BE_WRITTEN, function
    for name, member in re.findall(r"`(\w+)::(\w+)(?:\(\))?`", prose):
        assert is_member(name, member), f"{name}::{member}"


def is_member(name: str, member: str) -> bool:
    """Say whether a file that defines the class, struct or enumeration has the member's name."""
    defined = re.compile(rf"\b(?:class|struct)\s+{name}\b[^;{{]*\{{")
    return any(re.search(rf"\b{member}\b", text) for text in SOURCES if defined.search(text))


def test_members_are_looked_for_where_their_class_is_defined() -> None:
    assert is_member("PairTerms", "nu") and is_member("WallTable", "PIECES")
    assert not is_member("Particles", "amount") and not is_member("PairTerms", "PIECES")


# text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_long_page_begins_with_a_summary(page: Path) -> None:
    """Above 1500 words four or five lines, without a list, stand between the title and the rest."""
    text = page.read_text()
    if len(text.split()) > 1500 and page.name != "CHANGELOG.md":
        summary = re.match(r"# [^\n]+\n\n((?:\w|`)[^\n]+\n(?:[^\n#|*-][^\n]+\n){3,4})\n", text)
        assert summary, "no summary of four lines behind the title"


# British spelling, and particles as persons; not in code
REFUSED = re.compile(
    r"\b(?:neighbour\w*|colour\w*|behaviour\w*|centre[sd]?|metres?|grey|analyse[ds]?|licence"
    r"|modell(?:ed|ing)|normalis\w+|whoever|somebody|everybody|nobody)\b",
    re.IGNORECASE,
)


@pytest.mark.parametrize("page", [*PAGES, TUTORIAL], ids=lambda page: str(page.relative_to(ROOT)))
def test_words_are_american_and_of_the_field(page: Path) -> None:
    prose = re.sub(r"<!-- table.*?<!-- end -->", "", prose_of(page), flags=re.DOTALL)
    if page.name == "references.md":
        prose = re.sub(r"\*[^*\n]+\*", "", prose)  # titles are as they were published
    assert not REFUSED.findall(re.sub(r"`[^`\n]+`", "", prose))


HISTORY = re.compile(
    r"\b(?:earlier (?:version|run|definition)|previous version|(?:made|measured) before"
    r"|during development|formerly|not repeated|(?:an)?other days?|made by hand"
    r"|no command in the repository|today's|no longer (?!than|step)|was 1\.\d)",
    re.IGNORECASE,
)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_history_is_in_the_changelog_alone(page: Path) -> None:
    if page.name not in ("CHANGELOG.md", "CONTRIBUTING.md"):
        assert not HISTORY.findall(" ".join(page.read_text().split()))


def test_the_bibliography_and_its_page_agree() -> None:
    """Every key has a head on the page, with the same title and year."""
    entries = re.findall(
        r"^@\w+\{(\w+),\n(.*?)^\}", (ROOT / "docs/references.bib").read_text(), re.M | re.S
    )
    page = (ROOT / "docs/references.md").read_text()
    shown = dict(re.findall(r"^### (\w+)\n\n(.+)$", page, re.MULTILINE))
    assert [key for key, _ in entries] == list(shown)
    for key, fields in entries:
        title = re.search(r"title\s*=\s*\{(.*)\},?$", fields, re.MULTILINE)[1]
        assert re.sub("[{}]", "", title) in shown[key]
        year = re.search(r"year\s*=\s*\{(\d+)\}", fields)
        assert year is None or f"({year[1]})" in shown[key]
