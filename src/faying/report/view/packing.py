"""Arrays as short text in a page: quantized, differenced, deflated, in base64."""

import zlib
from base64 import b64encode
from typing import TypedDict

import numpy as np

from faying._typing import Indices, Matrix

STEPS = int(np.iinfo(np.uint16).max)
"""Steps between the smallest and the largest number of an array."""


class Packed(TypedDict):
    """An array as the page's script unpacks it.

    Attributes
    ----------
    shape
        Rows and columns.
    low, high
        Per column the numbers that 0 and ``STEPS`` stand for; absent of integers.
    data
        Differences down the columns, column after column, their bytes from the lowest to the
        highest each in one row, deflated (zlib) and in base64.
    """

    shape: list[int]
    low: list[float]
    high: list[float]
    data: str


def packed_numbers(values: Matrix) -> Packed:
    """Pack numbers (n, k), each column to a 65535th of its range.

    Notes
    -----
    Neighbours in a mesh are neighbours in numbers, so that differences are small and deflate well.
    """
    table = np.asarray(values, dtype=float)
    low, high = (_ends(table, take) for take in (np.min, np.max))
    span = np.where(high > low, high - low, 1.0)
    steps = np.rint((table - low) / span * STEPS).astype(np.int64)
    return Packed(
        shape=list(table.shape), low=low.tolist(), high=high.tolist(), data=_deflated(steps, 2)
    )


def packed_integers(values: Indices) -> Packed:
    """Pack integers (n, k) from 0 up to 2³² − 1 without loss."""
    table = np.asarray(values, dtype=np.int64)
    return Packed(shape=list(table.shape), low=[], high=[], data=_deflated(table, 4))


def _ends(table: Matrix, take: np.ufunc | object) -> Matrix:
    return take(table, axis=0) if len(table) else np.zeros(table.shape[1])  # type: ignore[operator]


def _deflated(table: Indices, width: int) -> str:
    differences = np.diff(table, axis=0, prepend=0).T.ravel()
    octets = differences.astype(f"<u{width}").view(np.uint8).reshape(-1, width)
    return b64encode(zlib.compress(octets.T.tobytes(), 9)).decode("ascii")
