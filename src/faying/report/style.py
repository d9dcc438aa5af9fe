"""House style of the figures: a fixed colour per method, units on every axis."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.layout_engine import ConstrainedLayoutEngine

from faying._typing import Mask
from faying.digits import DECK_DIGITS
from faying.files.atomic import replacing
from faying.reduction.methods import METHODS

RC: Any = {  # matplotlib types the keys as one long Literal
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.labelsize": 10,
    "figure.titlesize": 12,
    "legend.fontsize": 9,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}

REFERENCE = "#000000"
OTHER_COLOUR = "#7F7F7F"

# White at zero, with blue and red of equal weight.
ERROR_MAP = "RdBu_r"
GAP_MAP = "Purples"
SLIP_MAP = "magma_r"
OPEN_COLOUR = "#E4E4E4"

SMALLEST_DRAWN = DECK_DIGITS
"""Share of the largest value below which values count as round-off in figures."""

DPI = 150


@contextmanager
def house_style() -> Iterator[None]:
    """Use the house style within a ``with`` statement; restore the previous one after it."""
    with mpl.rc_context(RC):
        yield


def new_figure(width: float, height: float) -> Figure:
    """Return a figure of a size in inches without a window."""
    layout = ConstrainedLayoutEngine(h_pad=0.1, w_pad=0.12)
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: Path) -> tuple[int, int]:
    """Save a figure as PNG without empty margins, atomically; return width and height."""
    canvas: Any = FigureCanvasAgg(figure)  # untyped methods
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    inked: Mask = pixels[..., :3].min(axis=-1) < 250
    rows, columns = (_extent(inked.max(axis=axis)) for axis in (1, 0))
    with replacing(path) as temporary:
        imsave(temporary, pixels[rows, columns], format="png", dpi=DPI)
    return columns.stop - columns.start, rows.stop - rows.start


def _extent(inked: Mask) -> slice:
    """Return the range of lines with ink, plus a margin."""
    lines = np.flatnonzero(inked)
    if not len(lines):
        return slice(0, len(inked))
    margin = 18
    return slice(max(int(lines[0]) - margin, 0), min(int(lines[-1]) + 1 + margin, len(inked)))


def colour(method: str) -> str:
    """Return the colour of a method."""
    return METHODS[method].colour if method in METHODS else OTHER_COLOUR


def marker(method: str) -> str:
    """Return the marker of a method."""
    return METHODS[method].marker if method in METHODS else "x"


def label(method: str, joint_modes: int) -> str:
    """Return the label of a method with a number of joint modes."""
    if not joint_modes:
        return method
    return f"{method}, {joint_modes} joint mode{'s' if joint_modes > 1 else ''}"
