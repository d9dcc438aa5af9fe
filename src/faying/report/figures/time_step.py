"""Whether the time step resolves the peak pressure (design §5)."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from faying.report.figures.entry import Drawn
from faying.report.figures.response import peak_pressure
from faying.report.quantities import percent, quantity
from faying.report.style import METHOD_COLOURS, REFERENCE, heading, new_figure
from faying.study.results import CaseResult, Results
from faying.units import Units, units_of


@dataclass(frozen=True, kw_only=True)
class StepCheck:
    """The largest pressure with the study's time step and with half of it.

    Attributes
    ----------
    step : [time]
    peak, half_peak : [force/length²]
    largest_difference : [force/length²]
        Of the two largest pressures over the points, over all instants of the study's step.
    """

    step: float
    peak: float
    half_peak: float
    largest_difference: float

    @property
    def change(self) -> float:
        """Change of the largest pressure as a fraction of the one at the study's step."""
        return self.half_peak / self.peak - 1.0 if self.peak > 0 else 0.0

    @property
    def difference(self) -> float:
        """Largest difference at one instant as a fraction of the peak."""
        return self.largest_difference / self.peak if self.peak > 0 else 0.0


def step_check(case: CaseResult) -> StepCheck | None:
    """Return the time-step check of a transient case; None where it was not run."""
    if case.half_step is None or case.half_step_times is None:
        return None
    if case.times is None or len(case.times) < 2:
        return None
    exact, half = peak_pressure(case.reference), peak_pressure(case.half_step)
    at_steps = np.interp(case.times, case.half_step_times, half)
    return StepCheck(
        step=float(case.times[1] - case.times[0]),
        peak=float(exact.max()),
        half_peak=float(half.max()),
        largest_difference=float(np.abs(at_steps - exact).max()),
    )


def plot_step_check(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the largest pressure over time with the full and with half the time step."""
    if case.times is not None:
        exact = peak_pressure(case.reference)
        axes.plot(case.times, exact, color=REFERENCE, label="study's time step, full model")
    if case.half_step is not None and case.half_step_times is not None:
        half = peak_pressure(case.half_step)
        shade = METHOD_COLOURS["jim-a"]
        axes.plot(case.half_step_times, half, color=shade, lw=1.2, label="half the time step")
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(f"time [{units.time}]")
    axes.set_ylabel(f"max pressure [{units.pressure}]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    return axes


def time_step_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the time-step check of a transient case; None where it was not run."""
    check = step_check(case)
    if check is None:
        return None
    units = units_of(results.units)
    figure = new_figure(9.0, 3.8)
    plot_step_check(case, figure.add_subplot(), units)
    change, differs = percent(check.change), percent(check.difference)
    verdict = f"peak pressure changes by {change}, pressure at one instant by up to {differs}"
    figure.suptitle(heading(f"{case.name}, half the time step: {verdict}"))
    response = case.half_step
    swing = 0.0
    if response is not None:
        swing = max((_largest_change(case, name) for name in response.displacements), default=0.0)
    caption = (
        f"Time-step check of {case.name}: largest pressure {quantity(check.peak, units.pressure)} "
        f"at a step of {quantity(check.step, units.time)}, "
        f"{quantity(check.half_peak, units.pressure)} at half of it ({change}); at one instant "
        f"the two differ by up to {quantity(check.largest_difference, units.pressure)} "
        f"({differs} of the peak); the largest boundary displacement changes by {percent(swing)}. "
        "Errors of the methods compare models at the same step and do not contain this."
    )
    return Drawn(
        figure=figure,
        stem="time-step",
        title=f"{case.name}: time-step check",
        caption=caption,
        section=case.name,
    )


def _largest_change(case: CaseResult, boundary: str) -> float:
    """Relative change of the largest translation of a boundary."""
    keep = [i for i, name in enumerate(case.components[boundary]) if name.startswith("u")]
    if case.half_step is None or not keep:
        return 0.0
    largest = [
        float(np.abs(response.displacements[boundary][..., keep]).max(initial=0.0))
        for response in (case.reference, case.half_step)
    ]
    return abs(largest[1] / largest[0] - 1.0) if largest[0] > 0 else 0.0
