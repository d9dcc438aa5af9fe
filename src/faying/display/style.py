"""Colours and texts that all pictures share."""

from textwrap import fill

# Perceptually uniform.
PRESSURE_MAP = "viridis"
BODY_COLOURS = ("#8FB3D9", "#E3C08D", "#A8CDA0", "#C9B2D6", "#D9A9A0", "#B5B5B5")
BOLT_COLOUR = "#B2182B"
INTERFACE_COLOUR = "#111111"

LINE = 66
"""Characters of a title that the narrowest figure holds."""


def heading(text: str) -> str:
    """Return the title of a figure, broken so that long names of users stay in the picture."""
    return plain("\n".join(fill(line, LINE) for line in text.splitlines()))


def plain(text: str) -> str:
    """Return text that matplotlib shows as it is: names may hold dollar signs."""
    return text.replace("$", r"\$")
