"""The checkpoint of a run: its finished pieces on disk until the whole is done, to resume from."""

import hashlib
import shutil
from pathlib import Path

from faying import __version__
from faying.exceptions import StudyError
from faying.execution.checkpoint import Checkpoint
from faying.files.atomic import write_text

__all__ = ["Checkpoint", "open_checkpoint"]


def open_checkpoint(out: Path, study_text: str, *, resume: bool) -> Checkpoint:
    """Open the checkpoint of a results folder; start afresh unless asked to resume.

    Raises
    ------
    StudyError
        If a run is to be resumed whose study text or faying version differs.
    """
    folder, mark = out / "unfinished", hashlib.sha256(f"{__version__}\n{study_text}".encode())
    stamp = folder / "study.sha256"
    if resume and stamp.exists() and stamp.read_text() != mark.hexdigest():
        message = (
            f"{folder} belongs to another version of this study or of faying; "
            "run without --resume to start afresh"
        )
        raise StudyError(message)
    if not resume:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    write_text(stamp, mark.hexdigest())
    return Checkpoint(folder)
