"""Matplotlib axes for quick plots, and coloured areas on them."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from faying._typing import Matrix, Vector
from faying.display.style import PRESSURE_MAP


def new_axes(*, projection: str | None = None, size: tuple[float, float] = (7.0, 4.5)) -> Any:
    """Return the axes of a new pyplot figure, which shows in windows and notebooks."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=size, layout="constrained")
    return figure.add_subplot(projection=projection)


def draw_areas(axes: Axes, places: Matrix, areas: Vector, values: Vector, label: str) -> Axes:
    """Draw values at points of a plane (n, 2), each as a square with the area of the point."""
    half = np.sqrt(areas)[:, None, None] / 2
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    squares = PolyCollection(
        list(places[:, None] + half * corners), array=values, cmap=PRESSURE_MAP, edgecolors="face"
    )
    axes.add_collection(squares)
    axes.autoscale_view()
    axes.set_aspect("equal")
    figure = axes.get_figure(root=True)
    if figure is not None:
        figure.colorbar(squares, ax=axes, label=label, location="bottom", shrink=0.6)
    return axes
