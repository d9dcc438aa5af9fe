"""Finished pieces of a run, kept on disk until the whole is done, so that long runs resume."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying import __version__
from faying._typing import Matrix
from faying.exceptions import StudyError

Arrays = Mapping[str, Matrix]


@dataclass(frozen=True)
class Checkpoint:
    """A folder of named array bundles that belong to one study text and one version of faying."""

    folder: Path

    def bundle(self, key: str, compute: Callable[[], Arrays]) -> Arrays:
        """Return the arrays kept under a key, or compute and keep them."""
        path = self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.npz"
        if path.exists():
            with np.load(path) as kept:
                return {name: kept[name] for name in kept.files}
        arrays = compute()
        handle, temporary = tempfile.mkstemp(dir=self.folder, suffix=".tmp")
        with os.fdopen(handle, "wb") as file:
            np.savez(file, allow_pickle=False, **arrays)
        Path(temporary).replace(path)
        return arrays

    def discard(self) -> None:
        """Remove the folder once the results are written."""
        shutil.rmtree(self.folder, ignore_errors=True)


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
    stamp.write_text(mark.hexdigest())
    return Checkpoint(folder)
