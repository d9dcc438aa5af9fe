"""Figure of pressure errors of reduced models over their joint modes."""

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from faying.display.style import plain
from faying.report.figures.album import Drawn
from faying.report.methods import GOOD_ERROR, against
from faying.report.style import SMALLEST_DRAWN, colour, marker, new_figure
from faying.study.results.values import CaseResult, Results


def plot_convergence(case: CaseResult, axes: Axes) -> Axes:
    """Draw the largest relative pressure error of each method over its joint modes.

    Methods without joint modes are horizontal lines; errors below the lower limit are
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
        for n in exact:
            # Nested, so that none hides the others.
            size = 4 + 3 * (len(case.methods) - 1 - rank)
            level = 100 * SMALLEST_DRAWN
            axes.plot(n or counts[0], level, "v", color=colour(name), ms=size, clip_on=False)
    axes.axhline(100 * GOOD_ERROR, color="0.6", lw=0.9, ls=":")
    axes.text(
        0.01,
        120 * GOOD_ERROR,
        f"{100 * GOOD_ERROR:g} %",
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
    """Draw pressure errors over joint modes by load case; None without joint modes."""
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
    return Drawn(
        figure=figure,
        stem="convergence",
        title="Error over the number of joint modes",
        caption=(
            "Largest relative pressure error, Eq. (15.31), over all contact points and instants "
            "against the number of joint modes, one panel per load case. Dashed: methods without "
            "joint modes. Triangles on the lower edge: errors below 1e-4 %. Dotted: 5 %, what "
            "Breitfuss and Holl report of method B (jim-b) with 20 modes."
        ),
    )
