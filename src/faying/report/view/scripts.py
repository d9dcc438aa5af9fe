"""The scripts of a page: three.js, whose licence goes with it, and those that use it."""

from functools import cache
from importlib.resources import files

OWN = (
    "tables.js",
    "unpack.js",
    "colours.js",
    "map.js",
    "motion.js",
    "chart.js",
    "stage.js",
    "view.js",
)


@cache
def three() -> str:
    """Return the part of three.js that the view uses, its licence before it."""
    return f"/*! three.js\n{_text('three.LICENSE.txt')}*/\n{_text('three.min.js')}"


@cache
def own() -> str:
    """Return the scripts of the page, which share a scope of their own."""
    return '(() => {\n"use strict";\n' + "\n".join(map(_text, OWN)) + "})();"


def _text(name: str) -> str:
    return files("faying.report.view").joinpath(name).read_text(encoding="utf-8")
