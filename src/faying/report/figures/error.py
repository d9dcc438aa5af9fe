"""Where reduced models get the pressure wrong (as Fig. 15.6), and how much by joint modes."""

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from faying._typing import Vector
from faying.display.quantities import ROUND_OFF, percent, place
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.response import MODE_COUNTS
from faying.report.figures.surface_map import draw_map, map_panels
from faying.report.methods import against
from faying.report.style import ERROR_MAP, SMALLEST_DRAWN, colour, label, marker, new_figure
from faying.study.results.values import CaseResult, InterfaceRecord, MethodResult, Results
from faying.units import Units

METHODS_SHOWN = ("jim-a", "jim-b", "compliance")


def plot_error(
    record: InterfaceRecord, error: Vector, axes: Axes, units: Units, *, largest: float
) -> Axes:
    """Draw a signed relative pressure error, Eq. (15.31), at the contact points in percent.

    Errors (n_point,) are fractions, and so is the largest, the end of the colour scale, symmetric
    about zero.
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
    chosen = [name for name in METHODS_SHOWN if name in case.methods] or list(case.methods)[:3]
    for name in chosen:
        count = available(case.methods[name], MODE_COUNTS[1])
        if count is not None:
            yield name, case.methods[name][count]


def errs(case: CaseResult) -> bool:
    """Say whether a method that is drawn errs by more than round-off."""
    return any(result.accuracy.max_relative_error > ROUND_OFF for _, result in shown_methods(case))


def error_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the errors of a static case: one column per method, one row per interface.

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


PAPER_ERROR = 0.05
"""The paper's verdict on method B at 20 modes: less than 5 %."""


def plot_convergence(case: CaseResult, axes: Axes) -> Axes:
    """Draw the largest relative pressure error of each method over its joint modes.

    Methods without joint modes are horizontal lines; errors below the floor of the picture are
    triangles on it.
    """
    counts = sorted({n for sizes in case.methods.values() for n in sizes if n > 0}) or [1]
    for rank, (name, sizes) in enumerate(case.methods.items()):
        sizes_tried = sorted(sizes)
        errors = [max(sizes[n].accuracy.max_relative_error, SMALLEST_DRAWN) for n in sizes_tried]
        percents = [100 * error for error in errors]
        if sizes_tried == [0]:
            axes.axhline(percents[0], color=colour(name), ls="--", label=plain(name))
        elif sizes_tried:
            axes.plot(
                sizes_tried, percents, color=colour(name), marker=marker(name), label=plain(name)
            )
        exact = [n for n in sizes_tried if sizes[n].accuracy.max_relative_error <= SMALLEST_DRAWN]
        below = [(n, 100 * SMALLEST_DRAWN) for n in exact]
        for n, level in below:
            # Nested, so that none hides the others.
            size = 4 + 3 * (len(case.methods) - 1 - rank)
            axes.plot(n or counts[0], level, "v", color=colour(name), ms=size, clip_on=False)
    axes.axhline(100 * PAPER_ERROR, color="0.6", lw=0.9, ls=":")
    axes.text(
        0.01,
        120 * PAPER_ERROR,
        "5 %",
        color="0.45",
        fontsize=8,
        transform=axes.get_yaxis_transform(),
    )
    axes.set_yscale("log")
    axes.set_ylim(bottom=100 * SMALLEST_DRAWN)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xticks(counts)
    axes.set_xlabel("joint modes")
    axes.set_ylabel("max relative pressure error [%]")
    axes.set_title(plain(f"{case.name} ({case.kind})"), loc="left")
    return axes


def convergence_figure(results: Results) -> Drawn | None:
    """Draw one panel per load case; None where no method has joint modes."""
    cases = [case for case in results.cases.values() if any(map(any, case.methods.values()))]
    if not cases:
        return None
    columns = min(len(cases), 3)
    rows = -(-len(cases) // columns)
    figure = new_figure(4.4 * columns + 0.6, 3.7 * rows + 0.9)
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axes, case in zip(grid.flat, cases, strict=False):
        plot_convergence(case, axes)
        axes.label_outer(remove_inner_ticks=False)
    for axes in grid.flat[len(cases) :]:
        axes.set_visible(False)
    handles = {
        text: handle
        for axes in grid.flat[: len(cases)]
        for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3)
    figure.suptitle(f"Largest relative pressure error against {against(results.cases.values())}")
    caption = (
        "Largest relative pressure error, Eq. (15.31), over all contact points and instants "
        "against the number of joint modes, one panel per load case. Dashed: methods without "
        "joint modes. Triangles on the lower edge: errors below 1e-4 %. Dotted: 5 %, what "
        "Breitfuss and Holl report of method B (jim-b) with 20 modes."
    )
    return Drawn(
        figure=figure,
        stem="convergence",
        title="Error over the number of joint modes",
        caption=caption,
        section="convergence",
    )
