"""Arguments that several commands share."""

from pathlib import Path
from tempfile import TemporaryFile
from typing import Annotated

import typer

from faying.exceptions import StudyError

StudyPath = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study file.")]


def usable_folder(out: Path) -> Path:
    """Return a folder for results that exists or can be made.

    Raises
    ------
    StudyError
        If it is a file or cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        # Found out now rather than when the results of an hour are to be written.
        with TemporaryFile(dir=out):
            pass
    except OSError as error:
        message = f"cannot write to folder {out}: {error.strerror}; choose another with --out"
        raise StudyError(message) from None
    return out
