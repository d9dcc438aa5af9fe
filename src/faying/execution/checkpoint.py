"""Named bundles of arrays in a folder, written so that each is complete or absent."""

import hashlib
import json
import shutil
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__
from faying._typing import Matrix
from faying.exceptions import FormatError, refuse_study
from faying.files.atomic import held, remove_left_over, replacing, write_text
from faying.files.contents import reason_of
from faying.files.numpy_archive import read_arrays

Arrays = Mapping[str, Matrix]


class Bundles:
    """Named bundles of arrays in memory."""

    def __init__(self) -> None:
        self._bundles: dict[str, Arrays] = {}

    def bundle(self, key: str, compute: Callable[[], Arrays]) -> Arrays:
        """Return the arrays under a key; compute and store them if they are missing."""
        if self.has(key):
            return self.get(key)
        arrays = compute()
        self.put(key, arrays)
        return arrays

    def fill(self, keys: Sequence[str], compute: Callable[[], Iterable[Arrays]]) -> None:
        """Compute bundles together where one is missing, and store the missing ones."""
        if all(map(self.has, keys)):
            return
        for key, arrays in zip(keys, compute(), strict=True):
            if not self.has(key):
                self.put(key, arrays)

    def has(self, key: str) -> bool:
        """Return whether a key has a bundle."""
        return key in self._bundles

    def get(self, key: str) -> Arrays:
        """Return the arrays under a key."""
        return self._bundles[key]

    def put(self, key: str, arrays: Arrays) -> None:
        """Store arrays under a key."""
        self._bundles[key] = arrays


@dataclass(frozen=True)
class Checkpoint(Bundles):
    """A folder with one ``.npz`` file per key."""

    folder: Path

    def has(self, key: str) -> bool:
        """Return whether a key has a bundle."""
        return self._path(key).exists()

    def get(self, key: str) -> Arrays:
        """Return the arrays under a key.

        Raises
        ------
        FormatError
            If the file is damaged.
        """
        path = self._path(key)
        try:
            return read_arrays(path)
        except Exception as error:  # whatever a damaged archive meets
            message = f"{path}, the result of '{key}', is damaged ({reason_of(error)}); delete it"
            raise FormatError(message) from None

    def put(self, key: str, arrays: Arrays) -> None:
        """Store arrays under a key, atomically.

        Raises
        ------
        FormatError
            If the folder cannot be written.
        """
        try:
            with replacing(self._path(key)) as temporary:
                _write(temporary, arrays)
        except OSError as error:
            message = (
                f"cannot store the result of '{key}' in {self.folder}: {error.strerror}; "
                "free disk space or choose another folder"
            )
            raise FormatError(message) from None

    def discard(self) -> None:
        """Remove the folder."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _path(self, key: str) -> Path:
        return self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.npz"


FINISHED = (
    "All of this was finished before, of the same study and files, and nothing was computed; "
    "without --resume it is computed anew"
)


def stamp_of(mark: str) -> str:
    """Return a hash of this version and a mark, which identifies results."""
    return hashlib.sha256(f"{__version__}\n{mark}".encode()).hexdigest()


def finished_before(out: Path, mark: str) -> Mapping[str, Any] | None:
    """Return ``summary.json`` with a remark if the results of a mark are finished, else None."""
    try:
        summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if (out / "unfinished").exists() or summary.get("mark") != stamp_of(mark):
        return None
    return {**summary, "remarks": [*summary.get("remarks", ()), FINISHED]}


def open_checkpoint(out: Path, mark: str, *, resume: bool) -> Checkpoint:
    """Open the checkpoint of a results folder, emptied unless the run resumes.

    Raises
    ------
    StudyError
        If the run to resume had another mark or version of faying.
    """
    folder = out / "unfinished"
    stamp = folder / "study.sha256"
    if resume and stamp.exists() and stamp.read_text() != stamp_of(mark):
        refuse_study(
            f"{folder} belongs to another version of this study, of a file that it names, or of "
            "faying; run without --resume to start afresh"
        )
    if not resume:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    write_text(stamp, stamp_of(mark))
    return Checkpoint(folder)


@contextmanager
def results_in(out: Path, mark: str, *, resume: bool) -> Iterator[Checkpoint]:
    """Lock a results folder, and yield its checkpoint for intermediate results.

    The checkpoint is discarded where the results are written without an error.
    """
    out.mkdir(parents=True, exist_ok=True)
    with held(out):
        for folder in (out, out / "figures"):
            remove_left_over(folder)
        checkpoint = open_checkpoint(out, mark, resume=resume)
        yield checkpoint
        checkpoint.discard()


def _write(path: Path, arrays: Arrays) -> None:
    """Write arrays like ``np.savez``, which does not accept the name ``file``."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, value in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asarray(value), allow_pickle=False)
