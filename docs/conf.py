"""The documentation as a site: ``sphinx-build -W docs site`` (docs/decisions/0029-docs-site.md)."""

import inspect
import re
import sys
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

import faying as fy

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
import stored_groups  # noqa: E402  beside this file

project = "faying"
version = release = fy.__version__
copyright = "the authors of faying; MIT licence"  # noqa: A001  Sphinx reads this name
root_doc = "index"
exclude_patterns = ["_site", "images/*.py", "stored_groups.py"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # puts MathJax beside the pages
    "sphinx_gallery.gen_gallery",
]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
napoleon_use_ivar = True
napoleon_google_docstring = False
autodoc_typehints = "none"  # shapes and units of the docstrings say more than aliases of arrays
html_theme = "furo"
html_title = "faying"
html_static_path = ["_static"]
html_css_files = ["gallery.css"]
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": "/",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "capture_repr": (),
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
}

PACKAGES = {
    "readers": "Models of other programs",
    "sources": "Where models of studies come from",
    "model": "What a model is made of",
    "joint": "Models with their contact",
    "contact": "The contact problem",
    "reduction": "Bases and reduced models",
    "simulation": "Loads and solutions",
    "assessment": "What judges a solution or a joint",
    "export": "Results as they come",
    "linalg": "Linear algebra",
}
"""Packages with public names, in the order of the work, and what they are about."""


def write_reference(app: Sphinx) -> None:  # noqa: ARG001  Sphinx hands it over
    """Write one page per package with the docstrings of its public names."""
    folder = HERE / "api"
    folder.mkdir(exist_ok=True)
    pages: dict[str, list[str]] = {package: [] for package in PACKAGES}
    for name in fy.__all__:
        pages[getattr(fy, name).__module__.split(".")[1]].append(name)
    for package, names in pages.items():
        title = PACKAGES[package]
        lines = [title, "=" * len(title), ""]
        for name in sorted(names, key=str.lower):
            lines += [name, "-" * len(name), "", *_entry(name), ""]
        _write(folder / f"{package}.rst", lines)
    lines = ["Functions and classes", "=====================", "", ".. toctree::", ""]
    _write(folder / "index.rst", [*lines, *(f"   {package}" for package in PACKAGES)])
    _write(folder / "stored_groups.rst", stored_groups.page())


def _entry(name: str) -> list[str]:
    found: Any = getattr(fy, name)
    if inspect.isclass(found):
        return [f".. autoclass:: faying.{name}", "   :members:"]
    return [f".. autofunction:: faying.{name}"]


def words_of_pages() -> set[str]:
    """Names that code and code spans of pages and gallery hold."""
    pages = [*HERE.rglob("*.md"), *(HERE.parent / "examples").rglob("*.py")]
    code = r"```.*?^```|`[^`\n]+`"
    texts = [
        text if page.suffix == ".py" else " ".join(re.findall(code, text, re.DOTALL | re.MULTILINE))
        for page in pages
        for text in [page.read_text(encoding="utf-8")]
    ]
    return set(re.findall(r"\w+", " ".join(texts)))


WORDS = words_of_pages()


def without_internal_members(
    app: Sphinx,  # noqa: ARG001  as Sphinx calls it
    what: str,  # noqa: ARG001
    name: str,
    obj: object,  # noqa: ARG001
    skip: bool,
    options: object,  # noqa: ARG001
) -> bool:
    """Leave out members that no page uses: they are there for other packages of faying."""
    return skip or name not in WORDS


def with_links_to_pages(
    app: Sphinx,  # noqa: ARG001  as Sphinx calls it
    what: str,  # noqa: ARG001
    name: str,  # noqa: ARG001
    obj: object,  # noqa: ARG001
    options: object,  # noqa: ARG001
    lines: list[str],
) -> None:
    """Turn paths of pages in docstrings into links with the titles of the pages."""
    text = re.sub(r"(``|`)docs/\s*([\w/-]+)\.md\1", r":doc:`/\2`", "\n".join(lines))
    lines[:] = text.split("\n")


def _write(path: Path, lines: list[str]) -> None:
    """Write a page if it changed, for Sphinx builds anew what is newer."""
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Let the pages of the reference be written before Sphinx looks for pages."""
    app.connect("autodoc-skip-member", without_internal_members)
    app.connect("autodoc-process-docstring", with_links_to_pages)
    for language in ("csv", "nastran"):
        app.add_lexer(language, TextLexer)
    app.connect("builder-inited", write_reference, priority=1)
