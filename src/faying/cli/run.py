"""``faying run``: compute a study; ``faying demo``: compute the built-in bolted cantilever."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from faying.cli.arguments import (
    Resume,
    Scheduler,
    StudyPath,
    results_folder,
    study_work,
    usable_folder,
    workers_for,
)
from faying.cli.interruption import resumable
from faying.exceptions import refuse_study


def run(
    study: StudyPath,
    out: Annotated[Path | None, results_folder("STUDY-results")] = None,
    resume: Resume = False,
    workers: Annotated[int, workers_for("transients of the full model")] = 1,
    scheduler: Scheduler = None,
) -> None:
    """Run a study: every method on every load case, with results and a report in a folder."""
    folder = out or Path(f"{study.stem}-results")
    compute(study, folder, resume=resume, workers=workers, scheduler=scheduler)


def compute(
    path: Path, out: Path, *, resume: bool, workers: int = 1, scheduler: str | None = None
) -> None:
    """Run a study file, write its results to a folder, and exit with the status of the verdict."""
    since = perf_counter()  # the imports take a second
    with resumable(["faying", "run", str(path), "--out", str(out)], out):
        from rich.console import Console

        with study_work(path, workers, scheduler) as (study, bar, executor):
            if not study.load_cases and not study.frequencies:
                refuse_study(
                    f"{path.name} has neither [[load_case]] nor [[frequency]], there is nothing "
                    "to compute; add one"
                )
            usable_folder(out)
            from faying.workflow.run import run as run_study

            summary = run_study(
                study, out, resume=resume, progress=bar, executor=executor, since=since
            )
        from faying.cli.outcome import end, show_outcome

        console = Console(markup=False)
        show_outcome(summary, out, console)
        end(summary, out, console, "solutions")


def demo(
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("faying-demo"),
    quick: Annotated[bool, typer.Option("--quick", help="A coarse mesh: under a minute.")] = False,
) -> None:
    """Run the built-in study of a bolted cantilever with every method and a report."""
    studies = Path(__file__).parent.parent / "study"
    compute(studies / ("demo-quick.toml" if quick else "demo.toml"), out, resume=False)
