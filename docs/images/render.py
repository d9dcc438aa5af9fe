"""Draw the pictures of README and docs from a finished run of the default study.

``faying demo && python docs/images/render.py faying-demo`` writes cantilever.png and pressure.png
beside this file.
"""

import sys
from pathlib import Path

import numpy as np

import faying as fy
from faying.joint.picture import plot_model
from faying.report.figures.maps import plot_pressure
from faying.report.figures.surface_map import draw_map
from faying.report.style import ERROR_MAP, house_style, new_figure, save
from faying.study.results.store import read_results
from faying.study.results.values import Results

FOLDER = Path(__file__).parent
SHOWN = {"jim-a": 20, "jim-b": 20}


def cantilever() -> None:
    """Draw the default model with clamp, bolt and tip."""
    figure = new_figure(9.0, 7.0)
    axes = figure.add_subplot(projection="3d")
    plot_model(fy.lap_joint(), axes)
    axes.texts[-1].remove()  # the title; the pages have captions
    save(figure, FOLDER / "cantilever.png")


def pressure(results: Results) -> None:
    """Draw LC2: the full model's pressure, and the errors of the seed's methods."""
    case, record, units = results.cases["LC2"], results.interfaces["joint"], results.unit_set
    reference = case.reference.pressure
    figure = new_figure(14.0, 2.9)
    first, *others = figure.subplots(1, 1 + len(SHOWN))
    plot_pressure(record, reference, first, units)
    first.set_title(f"LC2: pressure, up to {reference.max():.0f} MPa")
    errors = {
        name: (case.methods[name][count].response.pressure - reference) / reference.max()
        for name, count in SHOWN.items()
    }
    for axes, (name, error) in zip(others, errors.items(), strict=True):
        largest = float(np.abs(error).max())
        limits, text = (-100 * largest, 100 * largest), "pressure error [%]"
        draw_map(record, 100 * error, axes, units, colours=ERROR_MAP, limits=limits, label=text)
        axes.set_title(f"{name}, {SHOWN[name]} modes: error up to {largest:.0%}")
    save(figure, FOLDER / "pressure.png")


def main() -> None:
    """Draw both."""
    with house_style():
        cantilever()
        pressure(read_results(Path(sys.argv[1]) / "results.h5"))


if __name__ == "__main__":
    main()
