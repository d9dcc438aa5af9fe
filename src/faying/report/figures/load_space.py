"""How methods do at loads they have not seen."""

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from faying.display.style import plain
from faying.report.figures.convergence import FLOOR
from faying.report.figures.entry import Drawn
from faying.report.style import colour, marker, new_figure
from faying.study.results.validation_record import LoadSpaceRecord, LoadSpaceResult
from faying.study.results.values import Results


def plot_load_space(record: LoadSpaceRecord, axes: Axes, *, worst: bool) -> Axes:
    """Draw the median or the worst error of each method over its joint modes."""
    for name, sizes in record.methods.items():
        sizes_tried = sorted(sizes)
        errors = [100 * max(_error(sizes[n], worst=worst), FLOOR) for n in sizes_tried]
        if sizes_tried == [0]:
            axes.axhline(errors[0], color=colour(name), ls="--", label=plain(name))
        elif sizes_tried:
            axes.plot(
                sizes_tried, errors, color=colour(name), marker=marker(name), label=plain(name)
            )
    counts = sorted({n for sizes in record.methods.values() for n in sizes if n}) or [1]
    axes.set_xticks(counts)
    axes.set_yscale("log")
    axes.set_ylim(bottom=100 * FLOOR)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlabel("joint modes")
    axes.set_ylabel("max relative pressure error [%]")
    axes.set_title(f"{'worst' if worst else 'median'} of {record.n_loads} loads", loc="left")
    return axes


def _error(result: LoadSpaceResult, *, worst: bool) -> float:
    return result.worst_error if worst else result.median_error


def load_space_figure(results: Results) -> Drawn | None:
    """Draw median and worst errors side by side; None without a load space."""
    record = results.validation.load_space
    if record is None or not record.methods:
        return None
    figure = new_figure(10.0, 4.8)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, worst in zip(panels, (False, True), strict=True):
        plot_load_space(record, axes, worst=worst)
        axes.label_outer(remove_inner_ticks=False)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    figure.suptitle("Pressure errors at unseen static loads of the training box")
    caption = (
        f"Largest relative pressure error of each method at {record.n_loads} random static loads "
        "from the training box, none of which it was trained with: the median load (left) and the "
        "worst (right). Errors below 1e-4 % lie on the lower edge."
    )
    return Drawn(
        figure=figure,
        stem="unseen-loads",
        title="Unseen loads",
        caption=caption,
        section="beyond",
    )
