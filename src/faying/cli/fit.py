"""``faying fit`` and ``faying band``: parameters from measured curves, bands of backbones."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faying.cli.arguments import (
    Scheduler,
    StudyPath,
    results_folder,
    study_work,
    usable_folder,
    workers_for,
)
from faying.cli.interruption import resumable

if TYPE_CHECKING:
    from faying.assessment.identification import Identification
    from faying.execution import Executor
    from faying.study.keys.tables import Study
    from faying.study.stages.books import ProgressBar

Workers = Annotated[int, workers_for("the backbones")]


def fit(
    study: StudyPath,
    out: Annotated[Path | None, results_folder("STUDY-fit")] = None,
    workers: Workers = 1,
    scheduler: Scheduler = None,
) -> None:
    """Fit the parameters of a study to its measured curves, with confidence intervals.

    When run again, it continues an interrupted fit.
    """
    from faying.workflow.fit import fit_study

    folder = usable_folder(out or Path(f"{study.stem}-fit"))
    with _continued("fit", study, folder, workers, scheduler) as (checked, bar, executor):
        fitted = fit_study(checked, folder, progress=bar, executor=executor)
    _show(fitted)
    typer.echo(f"Results are in {folder}")


def band(
    study: StudyPath,
    out: Annotated[Path | None, results_folder("STUDY-band")] = None,
    workers: Workers = 1,
    scheduler: Scheduler = None,
) -> None:
    """Compute the band of backbones over the parameter ranges of a study.

    When run again, it continues an interrupted call.
    """
    from faying.workflow.fit import band_of_study

    folder = usable_folder(out or Path(f"{study.stem}-band"))
    with _continued("band", study, folder, workers, scheduler) as (checked, bar, executor):
        bands = band_of_study(checked, folder, progress=bar, executor=executor)
    for name, covered in bands.items():
        shown = ", ".join(f"{what} {text}" for what, text in covered.facts.items())
        typer.echo(f"{name}: {shown}")
    typer.echo(f"Results are in {folder}")


@contextmanager
def _continued(
    name: str, study: Path, folder: Path, workers: int, scheduler: str | None
) -> "Iterator[tuple[Study, ProgressBar, Executor | None]]":
    """Yield study, progress bar and executor; if stopped, say that the same command continues."""
    command = ["faying", name, str(study), "--out", str(folder)]
    with resumable(command, folder, option=()), study_work(study, workers, scheduler) as work:
        yield work


def _show(fitted: "Identification") -> None:
    """Print values, intervals, correlations and remarks."""
    from faying.cli.tables import plain_console, text_table
    from faying.display.quantities import as_given

    columns = ["parameter", "value", "95 % interval", *(f"with {n}" for n in fitted.values)]
    rows = (
        (
            name,
            as_given(value, 4),
            " to ".join(as_given(end, 4) for end in fitted.intervals[name]),
            *(f"{entry:+.2f}" for entry in row),
        )
        for (name, value), row in zip(fitted.values.items(), fitted.correlations, strict=True)
    )
    console = plain_console()
    console.print(text_table("Parameters", columns, rows))
    console.print(
        f"Misfit {fitted.misfit:.3g} times the scatter of the measurements, after {fitted.trials} "
        "backbones."
    )
    for remark in fitted.remarks:
        typer.echo(f"Note: {remark}", err=True)
