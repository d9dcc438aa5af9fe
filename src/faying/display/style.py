"""Colours and texts that all pictures share."""

from textwrap import fill

# Perceptually uniform.
PRESSURE_MAP = "viridis"
BODY_COLOURS = ("#8FB3D9", "#E3C08D", "#A8CDA0", "#C9B2D6", "#D9A9A0", "#B5B5B5")
BOLT_COLOUR = "#B2182B"
INTERFACE_COLOUR = "#111111"

LINE = 66
"""Characters per line of a title that fit the narrowest figure."""


def heading(text: str) -> str:
    """Return the title of a figure, wrapped so that long names stay in the picture."""
    return plain("\n".join(fill(line, LINE) for line in text.splitlines()))


def plain(text: str) -> str:
    """Return text with dollar signs escaped, which matplotlib takes for mathematics."""
    return text.replace("$", r"\$")
