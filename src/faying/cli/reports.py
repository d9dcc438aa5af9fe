"""``faying report`` and ``faying view``: build or open the report of a finished run."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from faying.exceptions import refuse_study


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished run.")],
) -> None:
    """Build DIR/report.html and its figures from DIR/results.h5."""
    from faying.report.html import write_report
    from faying.study.stages.recover import results_of

    write_report(results_of(folder), folder)
    typer.echo(f"Wrote {folder / 'report.html'}")


def view(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished run.")],
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the report, or print its path.")
    ] = True,
) -> None:
    """Open DIR/report.html in the browser."""
    page = (folder / "report.html").resolve()
    if not page.is_file():
        refuse_study(
            f"{folder} holds no report.html; give the folder of a finished 'faying run', or build "
            "the report of one with 'faying report DIR'"
        )
    if not browser:
        typer.echo(page)
    elif not webbrowser.open(page.as_uri()):
        typer.echo(f"No browser could be opened; the report is {page}")
