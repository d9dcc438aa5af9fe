"""``faying fit`` and ``faying band``: parameters from measured curves, bands of backbones."""

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

if TYPE_CHECKING:
    from faying.assessment.identification import Identification

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
    with study_work(study, workers, scheduler) as (checked, bar, executor):
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
    with study_work(study, workers, scheduler) as (checked, bar, executor):
        bands = band_of_study(checked, folder, progress=bar, executor=executor)
    for name, covered in bands.items():
        shown = ", ".join(f"{what} {text}" for what, text in covered.facts.items())
        typer.echo(f"{name}: {shown}")
    typer.echo(f"Results are in {folder}")


def _show(fitted: "Identification") -> None:
    """Print values, intervals, correlations and remarks."""
    from faying.cli.tables import plain_console, text_table

    columns = ["parameter", "value", "95 % interval", *(f"with {n}" for n in fitted.values)]
    rows = (
        (
            name,
            f"{value:.4g}",
            "{:.4g} to {:.4g}".format(*fitted.intervals[name]),
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
