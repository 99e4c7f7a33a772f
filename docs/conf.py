"""The documentation as HTML: `make docs`.

The source folder is the root of the repository (`sphinx-build -c docs .`), so a link between docs,
examples and README means the same to Sphinx as it does on a forge. What plain Markdown cannot say,
the order of the pages and the reference of the modules, is added here.
"""

from __future__ import annotations

import html
import posixpath
import re
from importlib import metadata
from pathlib import Path

from latex2mathml.converter import convert

project = "SPHCLOTH"
author = "The SPHCLOTH developers"
copyright = author
release = metadata.version("sphcloth")

extensions = [
    "myst_nb",
    "sphinx.ext.apidoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]
root_doc = "docs/index"
include_patterns = [
    "*.md",
    "docs/**.md",
    "docs/*.ipynb",
    "examples/*/README.md",
    "build/reference/*.rst",
]
exclude_patterns = ["**/.*", "build/reference/modules.rst"]

html_theme = "furo"
html_title = "SPHCLOTH"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_copy_source = False
highlight_language = "none"

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300

# the reference: every module that is there
REFERENCE = "build/reference/sphcloth"
apidoc_modules = [
    {
        "path": "../python/sphcloth",
        "destination": posixpath.dirname(REFERENCE),
        "exclude_patterns": ["**/__main__.py", "**/examples/**"],
        "separate_modules": True,
        "module_first": True,
        "automodule_options": {"members", "show-inheritance"},
    }
]
autodoc_mock_imports = ["pypbd", "pysplishsplash"]
autodoc_member_order = "bysource"
suppress_warnings = ["ref.python"]  # classes of one name in several modules, such as Scene
napoleon_use_ivar = True  # attributes of dataclasses: in the docstring, not once more as members


def setup(app):
    """Connect the functions below."""
    app.connect("source-read", add_contents)
    app.connect("source-read", show_scripts)
    app.add_css_file("gallery.css")
    app.connect("build-finished", write_entrance)
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))


def add_contents(app, page: str, source: list[str]) -> None:
    """Make tables of contents of the lists of links: of the index by head, of python.md at all."""
    if page == root_doc:
        known: set[str] = set()
        for head, body in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", source[0], re.M | re.S):
            links = re.findall(r"\]\(([^)#:]+)\.(?:md|ipynb)[)#]", body)
            new = [link for link in dict.fromkeys(links) if link not in known]
            known.update(new)
            source[0] += contents(head, new)
    if page == "docs/howto/python":
        source[0] += contents("Modules", [posixpath.relpath(REFERENCE, posixpath.dirname(page))])


# the script of an example, as the index links to it
SCRIPT = r"\]\(\.\./(examples/\w+)/(in\.\w+|\w+\.py)\)"


def show_scripts(app, page: str, source: list[str]) -> None:
    """End the page of an example with its script, and let the pictures of the index lead there."""
    index = (Path(app.srcdir) / f"{root_doc}.md").read_text()
    scripts = dict(re.findall(SCRIPT, index))
    folder = posixpath.dirname(page)
    if page == root_doc:
        source[0] = re.sub(SCRIPT, r"](../\1/README.md#script)", source[0])
    elif folder in scripts:
        name = scripts[folder]
        source[0] += f"\n## Script\n\n```{{literalinclude}} {name}\n:caption: {name}\n```\n"


def contents(caption: str, pages: list[str]) -> str:
    """Return a table of contents that only the side bar shows."""
    return "\n".join(
        ["", "", "```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""]
    )


def write_entrance(app, failure: Exception | None) -> None:
    """Let the folder itself open at the index."""
    if failure is None and app.builder.format == "html":
        (Path(app.outdir) / "index.html").write_text(
            f'<!DOCTYPE html><meta http-equiv="refresh" content="0; url={root_doc}.html">\n'
        )


# Formulas become MathML, which browsers draw by themselves: no script, no fonts, no network.


def visit_inline(writer, node) -> None:
    """Write a formula of a line."""
    writer.body.append(mathml(node.astext(), "inline"))
    raise_skip()


def visit_block(writer, node) -> None:
    """Write a formula of its own; a wide one scrolls."""
    formula = mathml(node.astext(), "block")
    writer.body.append(f'<div style="overflow-x: auto; margin: 1em 0">{formula}</div>')
    raise_skip()


def mathml(latex: str, display: str) -> str:
    """Return a formula as MathML; an error if a command of it is unknown to the converter."""
    formula = convert(latex, display=display)
    unknown = re.findall(r">\\\w+<", formula)
    if unknown:
        raise ValueError(f"no MathML for {' '.join(unknown)} in {html.escape(latex)}")
    return formula


def raise_skip() -> None:
    """Tell docutils that the node is done."""
    from docutils.nodes import SkipNode

    raise SkipNode
