"""``faying report``: rebuild the report of a finished run."""

from pathlib import Path
from typing import Annotated

import typer

from faying.exceptions import StudyError


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished run.")],
) -> None:
    """Build DIR/report.html and its figures from DIR/results.h5."""
    if not (folder / "results.h5").is_file():
        message = f"{folder} holds no results.h5; name the folder of a finished 'faying run'"
        raise StudyError(message)
    from faying.report.html import write_report
    from faying.study.results.store import read_results

    write_report(read_results(folder / "results.h5"), folder)
    typer.echo(f"Wrote {folder / 'report.html'}")
