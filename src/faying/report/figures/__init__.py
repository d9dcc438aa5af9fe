"""Pictures of models and results: functions that take data and Axes, and a catalogue of all."""

from faying.joint.picture import plot_model
from faying.report.figures.catalogue import write_figures
from faying.report.figures.entry import FigureEntry
from faying.report.figures.error import plot_convergence, plot_error
from faying.report.figures.gap import plot_gap, plot_states
from faying.report.figures.preload import plot_sticking, plot_tightening
from faying.report.figures.pressure import plot_pressure
from faying.report.figures.response import (
    plot_displacement,
    plot_error_over_time,
    plot_peak_pressure,
)

__all__ = [
    "FigureEntry",
    "plot_convergence",
    "plot_displacement",
    "plot_error",
    "plot_error_over_time",
    "plot_gap",
    "plot_model",
    "plot_peak_pressure",
    "plot_pressure",
    "plot_states",
    "plot_sticking",
    "plot_tightening",
    "write_figures",
]
