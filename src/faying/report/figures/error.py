"""Where reduced models get the pressure wrong (as Fig. 15.6)."""

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from faying._typing import Vector
from faying.display.quantities import ROUND_OFF, percent, place
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.response import COUNTS
from faying.report.figures.surface_map import draw_map, map_panels
from faying.report.style import ERROR_MAP, label
from faying.study.results.values import CaseResult, InterfaceRecord, MethodResult, Results
from faying.units import Units

SHOWN = ("jim-a", "jim-b", "compliance")


def plot_error(
    record: InterfaceRecord, error: Vector, axes: Axes, units: Units, *, largest: float
) -> Axes:
    """Draw a signed relative pressure error, Eq. (15.31), at the contact points in percent.

    Parameters
    ----------
    error : (n_point,)
        As a fraction.
    largest
        End of the colour scale, symmetric about zero, as a fraction.
    """
    axes.xaxis.set_major_locator(MaxNLocator(5))
    limits = (-100 * largest, 100 * largest)
    text = "pressure error [%]"
    return draw_map(record, 100 * error, axes, units, colours=ERROR_MAP, limits=limits, label=text)


def available(sizes: Mapping[int, MethodResult], count: int) -> int | None:
    """Return the wanted number of joint modes, else the largest there is; None of none."""
    if count in sizes:
        return count
    return max(sizes, default=None)


def shown_methods(case: CaseResult) -> Iterator[tuple[str, MethodResult]]:
    """Yield the methods whose maps are drawn, each with its joint mode count of Fig. 15.6."""
    chosen = [name for name in SHOWN if name in case.methods] or list(case.methods)[:3]
    for name in chosen:
        count = available(case.methods[name], COUNTS[1])
        if count is not None:
            yield name, case.methods[name][count]


def errs(case: CaseResult) -> bool:
    """Say whether a method that is drawn errs by more than round-off."""
    return any(result.accuracy.max_relative_error > ROUND_OFF for _, result in shown_methods(case))


def error_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the errors of a static case: one column per method, one row per interface.

    Returns
    -------
    Drawn or None
        None where there is no method or no reference pressure.
    """
    methods = list(shown_methods(case))
    reference = case.reference.pressure
    top = float(reference.max(initial=0.0))
    if not methods or top <= 0:
        return None
    units, records = results.unit_set, results.interfaces
    errors = [(result.response.pressure - reference) / top for _, result in methods]
    worst = max(float(np.abs(error).max()) for error in errors)
    # Round-off in full colours looks like errors, and one bad point would blanch all other maps.
    largest = min(max(worst, 0.01), 1.0)
    width, room = max(5.4 * len(methods), 7.0), 0.3 * len(records)
    figure, grid = map_panels(records.values(), len(methods), width, room)
    notes = []
    for column, ((name, result), error) in enumerate(zip(methods, errors, strict=True)):
        title = label(name, result.joint_modes)
        for row, (interface, record) in enumerate(records.items()):
            point_errors, axes = error[slice(*record.slice)], grid[row, column]
            plot_error(record, point_errors, axes, units, largest=largest)
            note = _described(record, point_errors, units)
            prefix = f"{interface}: " if len(records) > 1 else ""
            axes.set_title(plain(f"{title}\n{prefix}{note}"), loc="left")
            notes.append(f"{title}: {prefix}{note}")
    compared = f"relative pressure error against the {case.reference_model}"
    figure.suptitle(heading(f"{case.name}: {compared}"))
    caption = (
        f"Relative pressure error (p − p_ref) / max p_ref, Eq. (15.31), in {case.name} (as "
        "Fig. 15.6). Colours are values at the contact points, not averages; red is too high, "
        "blue too low; all panels share one scale, which ends between 1 % and 100 %, so a white "
        "panel is a good one. "
        f"{'. '.join(notes)}."
    )
    return Drawn(
        figure=figure,
        stem="error",
        title=f"{case.name}: relative pressure error",
        caption=caption,
        section=case.name,
    )


def _described(record: InterfaceRecord, error: Vector, units: Units) -> str:
    if not len(error):
        return "no contact points"
    worst = int(np.abs(error).argmax())
    size = float(np.ptp(record.points, axis=0).max())
    if abs(error[worst]) < ROUND_OFF:
        return f"max |error| {percent(abs(error[worst]))}"
    where = place(record.points[worst], units.length, size)
    return f"max |error| {percent(abs(error[worst]))} at {where}"
