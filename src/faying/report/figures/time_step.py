"""Whether the time step resolves the pressures of a transient."""

from matplotlib.axes import Axes

from faying.display.quantities import percent, quantity
from faying.display.style import heading
from faying.report.figures.entry import Drawn
from faying.report.figures.response import peak_pressure
from faying.report.style import REFERENCE, colour, new_figure
from faying.study.judgement.step_check import step_check
from faying.study.results.values import CaseResult, Results
from faying.units import Units, units_of


def plot_step_check(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the largest pressure over time with both steps, and the largest change at a point."""
    if case.times is not None:
        exact = peak_pressure(case.reference)
        axes.plot(case.times, exact, color=REFERENCE, label="largest, study's time step")
    if case.half_step is not None and case.half_step_times is not None:
        half = peak_pressure(case.half_step)
        shade = colour("jim-a")
        axes.plot(case.half_step_times, half, color=shade, lw=1.2, label="largest, half of it")
    check = step_check(case)
    if check is not None:
        change = "largest change at a contact point"
        axes.plot(check.times, check.moved, color="0.35", ls=":", lw=1.2, label=change)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(f"time [{units.time}]")
    axes.set_ylabel(f"pressure [{units.pressure}]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3)
    return axes


def time_step_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the time-step check of a transient case; None where it was not run."""
    check = step_check(case)
    if check is None:
        return None
    units = units_of(results.units)
    figure = new_figure(9.0, 3.8)
    plot_step_check(case, figure.add_subplot(), units)
    largest, peak_change = percent(check.largest), percent(check.peak_change)
    verdict = f"pressures change by up to {largest} of the peak, the peak itself by {peak_change}"
    figure.suptitle(heading(f"{case.name}, {case.reference_model}, half the time step: {verdict}"))
    caption = (
        f"Time-step check of {case.name}, {case.reference_model} with both steps: largest pressure "
        f"{quantity(check.peak, units.pressure)} at a step of {quantity(check.step, units.time)}, "
        f"{quantity(check.half_peak, units.pressure)} at half of it ({peak_change}). Dotted: the "
        f"largest change of pressure at any contact point, at instants of both runs; it reaches "
        f"{quantity(float(check.moved.max()), units.pressure)} ({largest} of the peak) at "
        f"{quantity(check.instant, units.time)}. Root mean square over points and instants: "
        f"{percent(check.change.rms_relative_error)}; boundary displacements: "
        f"{percent(check.change.displacement_error)} of the largest. Errors of the methods compare "
        "models at the same step and do not contain this."
    )
    return Drawn(
        figure=figure,
        stem="time-step",
        title=f"{case.name}: time-step check",
        caption=caption,
        section=case.name,
    )
