"""All figures of a run."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from faying.exceptions import FormatError
from faying.files.names import file_names
from faying.report.figures.backbone import backbone_figure, backbone_slip_figure
from faying.report.figures.entry import Drawn, FigureEntry
from faying.report.figures.error import convergence_figure, error_figure, errs
from faying.report.figures.frequency import PREFIX, frequency_figure
from faying.report.figures.gap import gap_figure, initial_gap_figure
from faying.report.figures.loops import fretting_figure, loop_figure
from faying.report.figures.preload import model_figure, preload_figure, tightening_figure
from faying.report.figures.pressure import pressure_figure
from faying.report.figures.response import motion_slip_figure, path_figure, response_figure
from faying.report.figures.slip import slip_figure
from faying.report.style import house_style, save
from faying.study.results.values import CaseResult, Results

Draw = Callable[[], Drawn | None]


def write_figures(
    results: Results, folder: Path, progress: Callable[[int], None] | None = None
) -> list[FigureEntry]:
    """Draw every figure of a run into a folder as PNG, atomically, in the order of a report.

    The folder is made if it does not exist. ``progress`` is called with 1 after each figure.
    """
    entries = []
    stems = file_names(results.cases) | {
        f"{PREFIX}{name}": stem for name, stem in file_names(results.frequencies).items()
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with house_style():
            for draw in _drawings(results):
                drawn = draw()
                if drawn is not None:
                    entries.append(_saved(drawn, folder, stems))
                if progress:
                    progress(1)
    except OSError as error:
        message = f"cannot write figures to {folder}: {error.strerror}; check folder and free space"
        raise FormatError(message) from None
    return entries


def _saved(drawn: Drawn, folder: Path, stems: dict[str, str]) -> FigureEntry:
    stem, kind = drawn.stem, "frequency" if drawn.section.startswith(PREFIX) else "case"
    if drawn.section in stems and stem not in SHARED:
        stem = f"{kind}_{stems[drawn.section]}_{stem}"
    path = folder / f"{stem}.png"
    width, height = save(drawn.figure, path)
    return FigureEntry(
        path=path,
        title=drawn.title,
        caption=drawn.caption,
        section=drawn.section,
        stem=drawn.stem,
        wide=width > 2.4 * height,
    )


SHARED = ("model", "initial_gap", "preload", "tightening", "convergence")
"""Figures of the whole run; a load case may bear the name of their section."""


def _drawings(results: Results) -> Iterator[Draw]:
    """Yield what to draw, one figure at a time so that only one is in memory."""
    for draw in (
        model_figure,
        initial_gap_figure,
        preload_figure,
        tightening_figure,
        convergence_figure,
    ):
        yield _of_run(draw, results)
    for case in results.cases.values():
        for draw_case in _of_kind(case):
            yield _of_case(draw_case, results, case)
    for name in results.frequencies:
        yield partial(frequency_figure, results, name)


def _of_kind(case: CaseResult) -> tuple[Callable[[Results, CaseResult], Drawn | None], ...]:
    """Return what draws a case; the fields of backbones are the preload's and not drawn again."""
    if case.times is not None:
        return response_figure, motion_slip_figure, slip_figure, gap_figure
    if case.reference.backbones:
        return backbone_figure, backbone_slip_figure
    return (
        pressure_figure,
        slip_figure,
        path_figure,
        loop_figure,
        fretting_figure,
        gap_figure,
        *((error_figure,) if errs(case) else ()),
    )


def _of_run(draw: Callable[[Results], Drawn | None], results: Results) -> Draw:
    return lambda: draw(results)


def _of_case(
    draw: Callable[[Results, CaseResult], Drawn | None], results: Results, case: CaseResult
) -> Draw:
    return lambda: draw(results, case)
