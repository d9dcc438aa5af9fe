"""Arguments that several commands share."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faying.exceptions import CampaignError, StudyError

if TYPE_CHECKING:
    from faying.execution import Executor
    from faying.study.keys.tables import Study
    from faying.study.stages.books import ProgressBar

StudyPath = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study file.")]
Resume = Annotated[bool, typer.Option("--resume", help="Continue an interrupted call.")]
Ignored = Annotated[
    list[str] | None,
    typer.Option(metavar="WORD", help="Leave out of a deck: plastic, friction, temperature."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS|FILE", help="Dask cluster instead of processes."),
]
Integrator = Annotated[
    str | None,
    typer.Option(
        help="Integrator, as studies name it.  [default: implicit-euler]", show_default=False
    ),
]


def results_folder(default: str) -> Any:
    """Return the option for the results folder with its default name."""
    text = f"Folder for results.  [default: {default}]"
    return typer.Option(help=text, show_default=False)


def workers_for(work: str) -> Any:
    """Return the option for the number of processes that share some work."""
    return typer.Option(help=f"Processes that share {work}.")


def usable_folder(out: Path) -> Path:
    """Return a results folder after making it and checking that it can be written."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        # Fail before the computation rather than after it.
        with TemporaryFile(dir=out):
            pass
    except OSError as error:
        message = f"cannot write to folder {out}: {error.strerror}; choose another with --out"
        raise StudyError(message) from None
    return out


def shared_executor(workers: int, scheduler: str | None, stack: ExitStack) -> "Executor | None":
    """Return the executor of the workers, None for this process alone; the stack closes it."""
    if scheduler is None and workers == 1:
        return None
    from faying.execution import DaskExecutor, ProcessExecutor

    if scheduler is None:
        return ProcessExecutor(workers)
    if workers != 1:
        message = "--workers and --scheduler exclude each other; the cluster has its own workers"
        raise CampaignError(message)
    return stack.enter_context(DaskExecutor.connect(scheduler))


@contextmanager
def study_work(
    path: Path, workers: int = 1, scheduler: str | None = None
) -> Iterator[tuple["Study", "ProgressBar", "Executor | None"]]:
    """Yield a study, a progress bar, and the executor of its workers, if any."""
    from rich.console import Console

    from faying.cli.progress import progress_bar
    from faying.study.keys.schema import naming_tables, read_study

    study = read_study(path)
    with ExitStack() as stack:
        executor = shared_executor(workers, scheduler, stack)
        bar = stack.enter_context(progress_bar(Console(stderr=True)))
        stack.enter_context(naming_tables(study))
        yield study, bar, executor
