"""What is known of a figure once it is a file."""

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True)
class FigureEntry:
    """One figure of a report.

    Attributes
    ----------
    path
        The PNG file.
    title
        What it shows, in a few words.
    caption
        How to read it, with the numbers that matter.
    section
        ``"model"``, ``"preload"``, ``"convergence"``, ``"beyond"`` or the name of a load case.
    """

    path: Path
    title: str
    caption: str
    section: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawn:
    """A figure before it is saved.

    Attributes
    ----------
    figure
    stem
        Of its file name.
    title, caption, section
        As in :class:`FigureEntry`.
    """

    figure: Figure
    stem: str
    title: str
    caption: str
    section: str
