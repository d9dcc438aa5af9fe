"""Arrays as short text in a page: quantized, differenced, deflated, in base64."""

import zlib
from base64 import b64encode
from typing import TypedDict

import numpy as np

from faying._typing import Indices, Matrix

STEPS = int(np.iinfo(np.uint16).max)
"""Number of steps between the smallest and the largest value of an array."""


class Packed(TypedDict):
    """An array in the form that the page's script unpacks.

    Attributes
    ----------
    shape
        Rows and columns.
    low, high
        Values of 0 and ``STEPS`` for each column; empty for integers.
    data
        Differences along the columns, column after column, their bytes from the lowest to the
        highest in separate rows, deflated (zlib) and in base64.
    """

    shape: list[int]
    low: list[float]
    high: list[float]
    data: str


def packed_numbers(values: Matrix) -> Packed:
    """Return packed numbers (n, k), each column to a 65535th of its range.

    Notes
    -----
    Neighbouring nodes have neighbouring numbers, so that differences are small and deflate well.
    """
    table = np.asarray(values, dtype=float)
    low, high = (_ends(table, take) for take in (np.min, np.max))
    span = np.where(high > low, high - low, 1.0)
    steps = np.rint((table - low) / span * STEPS).astype(np.int64)
    return Packed(
        shape=list(table.shape), low=low.tolist(), high=high.tolist(), data=_deflated(steps, 2)
    )


def packed_integers(values: Indices) -> Packed:
    """Return packed integers (n, k) from 0 to 2³² − 1, without loss."""
    table = np.asarray(values, dtype=np.int64)
    return Packed(shape=list(table.shape), low=[], high=[], data=_deflated(table, 4))


def _ends(table: Matrix, take: np.ufunc | object) -> Matrix:
    return take(table, axis=0) if len(table) else np.zeros(table.shape[1])  # type: ignore[operator]


def _deflated(table: Indices, width: int) -> str:
    differences = np.diff(table, axis=0, prepend=0).T.ravel()
    octets = differences.astype(f"<u{width}").view(np.uint8).reshape(-1, width)
    return b64encode(zlib.compress(octets.T.tobytes(), 9)).decode("ascii")
