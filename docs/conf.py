"""The documentation as a site: ``sphinx-build -W docs site`` (docs/decisions/0029-docs-site.md)."""

import inspect
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

import faying as fy

HERE = Path(__file__).parent

project = "faying"
version = release = fy.__version__
copyright = "the authors of faying; MIT licence"  # noqa: A001  Sphinx reads this name
root_doc = "contents"
exclude_patterns = ["_site", "images/*.py"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
napoleon_use_ivar = True
napoleon_google_docstring = False
autodoc_typehints = "none"  # shapes and units of the docstrings say more than aliases of arrays
html_theme = "furo"
html_title = "faying"
html_static_path: list[str] = []
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
    "sources": "Where models come from",
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


def _entry(name: str) -> list[str]:
    found: Any = getattr(fy, name)
    if inspect.isclass(found):
        return [f".. autoclass:: faying.{name}", "   :members:"]
    return [f".. autofunction:: faying.{name}"]


def _write(path: Path, lines: list[str]) -> None:
    """Write a page if it changed, for Sphinx builds anew what is newer."""
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Let the pages of the reference be written before Sphinx looks for pages."""
    for language in ("csv", "nastran"):
        app.add_lexer(language, TextLexer)
    app.connect("builder-inited", write_reference, priority=1)
