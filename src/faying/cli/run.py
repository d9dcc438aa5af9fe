"""``faying run``: compute a study."""

from pathlib import Path
from typing import Annotated

import typer

from faying.cli.arguments import StudyPath, usable_folder
from faying.exceptions import StudyError

NOT_CONVERGED = 1
"""Exit status of a study that ran but did not converge somewhere."""


def run(
    study: StudyPath,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for results.  [default: STUDY-results]", show_default=False),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Keep what an interrupted run has finished.")
    ] = False,
) -> None:
    """Run a study: every method on every load case; results, pictures and a report in a folder."""
    compute(study, out or Path(f"{study.stem}-results"), resume=resume)


def compute(path: Path, out: Path, *, resume: bool) -> None:
    """Run the study of a file into a folder and exit with 1 if something did not converge."""
    from faying.study.schema import read_study

    study = read_study(path)
    if not study.load_cases:
        message = f"{path.name} has no [[load_case]]; add one, there is nothing to compute"
        raise StudyError(message)
    usable_folder(out)
    from rich.console import Console
    from rich.progress import Progress

    from faying.cli.outcome import show_outcome
    from faying.study.run import run as run_study

    console = Console(stderr=True)
    # A bar that is not seen would leave an empty line among the messages.
    hidden = not console.is_terminal
    with Progress(console=console, transient=True, disable=hidden) as progress:
        result = run_study(study, out, resume=resume, progress=progress)
    show_outcome(result.summary, out, Console())
    if not result.converged:
        message = f"Some solutions did not converge; {out / 'summary.json'} names them"
        typer.echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
