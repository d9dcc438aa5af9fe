"""Load histories: two columns of a csv file, time and value."""

import re
from pathlib import Path

import numpy as np

from faying._typing import Matrix
from faying.exceptions import StudyError
from faying.files.contents import file_text
from faying.simulation.load import History
from faying.study.keys.ranges import LARGEST


def read_history(path: Path) -> History:
    """Read a load history.

    Parameters
    ----------
    path
        Text with two columns separated by a comma, time and value. One header line, empty lines
        and comments after ``#`` are allowed.

    Raises
    ------
    StudyError
        If it cannot be read, or times do not increase; the message names the line.
    """
    numbered = [
        (number, line.split("#", 1)[0].strip())
        for number, line in enumerate(_text(path).splitlines(), start=1)
    ]
    rows = [(number, line) for number, line in numbered if line]
    if rows and not any(_is_numeric(cell) for cell in re.split("[,;]", rows[0][1])):
        rows = rows[1:]
    values = np.array([_row(path, number, line) for number, line in rows]).reshape(-1, 2)
    _check(path, [number for number, _ in rows], values)
    return History(times=values[:, 0], values=values[:, 1])


def _text(path: Path) -> str:
    try:
        return file_text(path)
    except UnicodeDecodeError:
        reason = "it is no UTF-8 text"
    except OSError as error:
        reason = str(error.strerror)
    message = f"cannot read load history {path}: {reason}; give lines 'time, value'"
    raise StudyError(message)


def _is_numeric(line: str) -> bool:
    try:
        [float(cell) for cell in line.split(",")]
    except ValueError:
        return False
    return True


def _row(path: Path, number: int, line: str) -> tuple[float, float]:
    cells = line.split(",")
    if len(cells) != 2 or not _is_numeric(line):
        message = (
            f"{path}, line {number}: found '{line[:40]}', expected two numbers 'time, value' "
            "with decimal points, separated by a comma"
        )
        raise StudyError(message)
    return float(cells[0]), float(cells[1])


def _check(path: Path, lines: list[int], rows: Matrix) -> None:
    """Refuse what cannot be interpolated."""
    if len(rows) < 2:
        message = f"{path}: found {len(rows)} samples, expected two or more lines 'time, value'"
        raise StudyError(message)
    beyond = np.flatnonzero(~(np.abs(rows) <= LARGEST).all(axis=1))
    if beyond.size:
        message = (
            f"{path}, line {lines[beyond[0]]}: the sample is not finite, or larger than "
            f"{LARGEST:g}; remove or correct the line"
        )
        raise StudyError(message)
    if rows[0, 0] < 0:
        message = (
            f"{path}, line {lines[0]}: time {rows[0, 0]:g} is negative; loads act from t = 0, "
            "shift the times"
        )
        raise StudyError(message)
    back = np.flatnonzero(np.diff(rows[:, 0]) <= 0)
    if back.size:
        first = int(back[0])
        message = (
            f"{path}, line {lines[first + 1]}: time {rows[first + 1, 0]:g} does not come after "
            f"{rows[first, 0]:g}; times must increase"
        )
        raise StudyError(message)
