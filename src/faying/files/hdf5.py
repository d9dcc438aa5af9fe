"""Untrusted HDF5 files, checked and opened for reading.

The HDF5 library trusts the bytes of a file: a few damaged bytes can make it loop or crash.
A separate process, started with the first file, checks every file before this process opens it.
"""

import atexit
import json
import os
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py

from faying.exceptions import FayingError, FormatError
from faying.files.child_python import (
    SLOWEST_READING,
    STARTUP_SECONDS,
    python_command,
    python_environment,
)
from faying.files.contents import reason_of
from faying.linalg.memory import free_memory

STALLED_SECONDS = 20.0
"""Processor seconds after which checking a file counts as stalled."""

_LOCK = threading.Lock()
_WATCHES: dict[int, "subprocess.Popen[str]"] = {}


def look_through(path: Path, *, whole: bool = True) -> None:
    """Check a file in the separate process.

    If ``whole``, all its data must be present and fit in memory.
    """
    extra = path.stat().st_size / SLOWEST_READING if path.is_file() else 0.0
    seconds = STALLED_SECONDS + extra
    file = {"path": str(path.resolve()), "room": free_memory()}
    request = {**file, "whole": whole, "seconds": seconds}
    with _LOCK:
        answer = _request_answer(json.dumps(request), STARTUP_SECONDS + extra)
    if answer is None:
        message = "the HDF5 library crashes or stalls on it"
        raise OSError(message)
    if "closed" in answer:
        raise FileNotFoundError(answer["closed"])
    if "wrong" in answer:
        raise OSError(answer["wrong"])


def _request_answer(request: str, limit: float) -> Any:
    """Return the answer of the separate process; None where it ended or took too long."""
    watch = _WATCHES.get(os.getpid())
    if watch is None or watch.poll() is not None:
        _end_process()
        watch = _WATCHES[os.getpid()] = _start_process()
    assert watch.stdin is not None
    assert watch.stdout is not None
    timer = threading.Timer(limit, watch.kill)
    timer.start()
    line = ""
    try:
        watch.stdin.write(request + "\n")
        watch.stdin.flush()
        line = watch.stdout.readline()
    except OSError:
        pass
    finally:
        timer.cancel()
        if not line.endswith("\n"):  # also an interrupt: a late answer would pass for the next
            _end_process()
    return json.loads(line) if line.endswith("\n") else None


def _start_process() -> "subprocess.Popen[str]":
    return subprocess.Popen(
        python_command("-m", "faying.files.hdf5_walk"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        encoding="utf-8",
        env=python_environment(),
    )


@atexit.register
def _end_process() -> None:
    watch = _WATCHES.pop(os.getpid(), None)
    if watch is not None:
        watch.kill()
        with suppress(BrokenPipeError), watch:
            pass


@contextmanager
def open_hdf5(path: Path, expected: str, remedy: str) -> Iterator[h5py.File]:
    """Open a file for reading whose data lie in the file itself and fit in memory.

    A separate process checks it before: see :mod:`faying.files.hdf5_walk`. Messages end with
    ``expected`` for a file of another kind, and with ``remedy`` for a damaged one.

    Raises
    ------
    FormatError
        If the file cannot be read, here or within the ``with`` statement.
    """
    check_hdf5(path, expected, remedy)
    try:
        with h5py.File(path, "r") as file:
            yield file
    except FayingError:
        raise
    except Exception as error:  # HDF5 and h5py raise whatever a damaged file meets
        raise damaged(path, error, remedy) from None


def check_hdf5(path: Path, expected: str, remedy: str, *, whole: bool = True) -> None:
    """Refuse a file that is damaged or links to other files, before this process opens it.

    If ``whole``, all its data must be present and fit in memory.
    """
    try:
        look_through(path, whole=whole)
    except FileNotFoundError:
        message = f"{path} is not an HDF5 file, or was cut off; expected {expected}"
        raise FormatError(message) from None
    except OSError as error:
        raise damaged(path, error, remedy) from None


def damaged(path: Path, error: Exception, remedy: str) -> FormatError:
    """Return the error about a damaged file."""
    reason = f"{path} is damaged, or another program wrote it ({reason_of(error)}); {remedy}"
    return FormatError(reason)
