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
        ``"model"``, ``"preload"``, ``"convergence"`` or the name of a load case.
    stem
        Which picture it is, as ``"pressure"``.
    wide
        Whether it is too wide to be read when it is shrunk to the width of a phone.
    """

    path: Path
    title: str
    caption: str
    section: str
    stem: str
    wide: bool = False


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
