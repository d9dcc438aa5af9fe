"""Measured surfaces: heights, or gaps, over a plane, with holes."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying._typing import Frozen, Matrix, Vector
from faying.exceptions import FormatError, refuse
from faying.files.contents import file_text
from faying.files.csv_rows import csv_rows
from faying.files.numpy_archive import read_arrays

HEIGHTS, GAPS = "z", "gap"
"""Names of the third column of a scan."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scan(Frozen):
    """Samples of a surface, or of the gap between two.

    Attributes
    ----------
    places : (n, 2) [length]
        Positions in axes of the scan.
    values : (n,) [length]
        Heights out of the material, or gaps.
    is_gap
        Whether the values are gaps.
    holes
        Number of samples without a value, which are left out.
    """

    places: Matrix
    values: Vector
    is_gap: bool = False
    holes: int = 0


def read_scan(path: Path | str) -> Scan:
    """Read a scan from columns x, y and z (height out of the material) or gap.

    Parameters
    ----------
    path
        ``.csv`` with the names of the columns in its first line; ``.npz`` with arrays of these
        names, of one length or as the axes and values (n_y, n_x) of a grid; any other, as ``.xyz``,
        has three numbers a line. Entries that are not finite numbers are holes.

    Returns
    -------
    Scan

    Raises
    ------
    FormatError
        If the file cannot be read, columns are missing, or fewer than ten samples have a value.
    """
    path = Path(path)
    try:
        if path.suffix.lower() == ".npz":
            columns, kind = _read_arrays(path)
        else:
            columns, kind = _read_lines(path)
    except FormatError:
        raise
    except Exception as error:  # NumPy and zipfile raise various errors for damaged archives
        message = f"{path}: the scan cannot be read ({error})"
        raise FormatError(message) from None
    there = np.isfinite(columns.sum(axis=1))
    if np.count_nonzero(there) < 10:
        refuse(f"{path}: {np.count_nonzero(there)} samples have a value; a scan needs ten")
    values = columns[there]
    return Scan(
        places=values[:, :2],
        values=values[:, 2],
        is_gap=kind == GAPS,
        holes=int(len(there) - len(values)),
    )


def _read_arrays(path: Path) -> tuple[Matrix, str]:
    arrays = read_arrays(path)
    kind = _value_column(path, list(arrays))
    x, y, values = (np.asarray(arrays[name], dtype=float) for name in ("x", "y", kind))
    if values.ndim == 2 and x.ndim == y.ndim == 1 and values.shape == (len(y), len(x)):
        x, y = np.meshgrid(x, y)
    if not x.shape == y.shape == values.shape:
        refuse(
            f"{path}: x {x.shape}, y {y.shape} and {kind} {values.shape} do not match; give one of "
            f"each per sample, or the axes of a grid and {kind} (n_y, n_x)"
        )
    return np.column_stack([x.ravel(), y.ravel(), values.ravel()]), kind


def _read_lines(path: Path) -> tuple[Matrix, str]:
    lines = file_text(path).splitlines()
    if path.suffix.lower() == ".csv":
        rows = [row for _, row in csv_rows(path, lines) if row and not row[0].startswith("#")]
        header = [name.strip().lower() for name in rows[0]] if rows else []
        kind = _value_column(path, header)
        order = [header.index(name) for name in ("x", "y", kind)]
        entries = [
            [row[column] if column < len(row) else "" for column in order] for row in rows[1:]
        ]
        return np.array([[_number(entry) for entry in row] for row in entries]), kind
    entries = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    numbered = [row[:3] for row in entries if len(row) >= 3 and np.isfinite(_number(row[0]))]
    return np.array([[_number(entry) for entry in row] for row in numbered]).reshape(-1, 3), HEIGHTS


def _value_column(path: Path, names: list[str]) -> str:
    for kind in (HEIGHTS, GAPS):
        if {"x", "y", kind} <= set(names):
            return kind
    message = (
        f"{path}: the columns are {', '.join(names) or 'not named'}; a scan has x, y and z (height "
        "out of the material) or gap"
    )
    raise FormatError(message)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
