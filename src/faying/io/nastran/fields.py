"""Nastran numbers: text to value and value to text, one at a time and by the million.

A real may be written ``1.5``, ``1.5E-3``, ``1.5D-3`` or ``1.5-3`` (the exponent's letter left out).
Fields are byte strings of one width, padded with blanks or NUL.
"""

import math
import re
from collections.abc import Callable
from functools import reduce

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask, Vector

Fields = npt.NDArray[np.bytes_]

SHORT_DIGITS = 1e-3
"""What eight columns leave of a number with sign and exponent, as -1.23-10."""

_REAL = re.compile(r"[+-]?(?=\.?\d)\d*\.?\d*(?:[ED][+-]?\d+|[+-]\d+)?")
_INTEGER = re.compile(r"[+-]?\d{1,18}")
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-])")
_BLANK, _PLUS, _MINUS, _POINT, _ZERO, _NINE = (ord(c) for c in " +-.09")
_D, _E = ord("D"), ord("E")
_BLANKS = np.frombuffer(b" " * 8, dtype=np.uint64)[0]


def real(text: str) -> float | None:
    """Return the value of a non-blank real field, None if it is not one."""
    if not _REAL.fullmatch(text):
        return None
    plain = text.replace("D", "E")
    if "E" not in plain:
        plain = _BARE_EXPONENT.sub(r"E\1", plain)
    value = float(plain)
    return value if math.isfinite(value) else None


def integer(text: str) -> int | None:
    """Return the value of a non-blank integer field, None if it is not one."""
    return int(text) if _INTEGER.fullmatch(text) else None


def characters(fields: Fields) -> npt.NDArray[np.uint8]:
    """Characters (n, width) of fields (n,), blank where there is nothing."""
    width = fields.dtype.itemsize
    letters = np.ascontiguousarray(fields).view(np.uint8).reshape(len(fields), width)
    return np.maximum(letters, np.uint8(_BLANK))


def is_blank(fields: Fields) -> Mask:
    """Where nothing is written."""
    # Columns are few: a loop over them is faster than a reduction along each short row.
    highest = reduce(np.maximum, characters(fields).T)
    return np.asarray(highest == _BLANK)


def _texts(letters: npt.NDArray[np.uint8]) -> Fields:
    joined: Fields = np.ascontiguousarray(letters).view(f"S{letters.shape[1]}").ravel()
    return joined


def integers(fields: Fields) -> tuple[Indices, Mask]:
    """Values of integer fields, and where there is no integer (blank included; value 0 there)."""
    letters = characters(fields)
    values = np.zeros(len(fields), dtype=np.int64)
    bad = np.ones(len(fields), dtype=bool)
    if letters.shape[1] % 8 == 0:
        words = letters.view(np.uint64)
        short = np.logical_and.reduce([word == _BLANKS for word in words.T[1:]], axis=0)
        values, plain = plain_integers(words[:, 0])
        bad = ~(plain & short)
    unread = np.flatnonzero(bad)
    values[unread], bad[unread] = _other_integers(fields[unread], letters[unread])
    return values, bad


def _other_integers(fields: Fields, letters: npt.NDArray[np.uint8]) -> tuple[Indices, Mask]:
    digit = (letters >= _ZERO) & (letters <= _NINE)
    allowed = digit | (letters == _BLANK) | (letters == _PLUS) | (letters == _MINUS)
    count = digit.sum(axis=1)
    bad: Mask = ~allowed.all(axis=1) | (count == 0) | (count > 18)
    values = np.zeros(len(fields), dtype=np.int64)
    try:
        values[~bad] = _texts(letters[~bad]).astype(np.int64)
    except ValueError:
        for i in np.flatnonzero(~bad):
            number = integer(fields[i].decode("latin-1").strip())
            bad[i] = number is None
            values[i] = number or 0
    return values, bad


def _with_exponent_letters(letters: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Turn D into E and insert the E that ``1.5-3`` leaves out."""
    letters = np.where(letters == _D, np.uint8(_E), letters)
    sign = (letters[:, 1:] == _PLUS) | (letters[:, 1:] == _MINUS)
    previous = letters[:, :-1]
    bare = sign & (((previous >= _ZERO) & (previous <= _NINE)) | (previous == _POINT))
    rows = np.flatnonzero(bare.any(axis=1))
    wide = np.full((len(letters), letters.shape[1] + 1), _BLANK, dtype=np.uint8)
    wide[:, :-1] = letters
    if rows.size:
        insertion = bare[rows].argmax(axis=1)[:, None] + 1
        column = np.arange(wide.shape[1])
        source = np.where(column > insertion, column - 1, column)
        wide[rows] = np.take_along_axis(wide[rows], source, axis=1)
        wide[rows, insertion[:, 0]] = _E
    return wide


def reals(fields: Fields) -> tuple[Vector, Mask]:
    """Values of real fields, and where there is no finite real (blank included; value 0 there).

    An integer is taken as a real: several preprocessors write them.
    """
    letters = characters(fields)
    digit = (letters >= _ZERO) & (letters <= _NINE)
    sign_or_exponent = np.isin(letters, (_BLANK, _PLUS, _MINUS, _POINT, _D, _E))
    bad: Mask = np.asarray(~(digit | sign_or_exponent).all(axis=1) | ~digit.any(axis=1))
    values = np.zeros(len(fields))
    try:
        values[~bad] = _texts(_with_exponent_letters(letters[~bad])).astype(np.float64)
    except ValueError:
        for i in np.flatnonzero(~bad):
            number = real(fields[i].decode("latin-1").strip("\0 "))
            bad[i] = number is None
            values[i] = number or 0.0
    np.logical_or(bad, ~np.isfinite(values), out=bad)
    values[bad] = 0.0
    return values, bad


def format_real(value: float, width: int = 16) -> str:
    """Shortest text of at most ``width`` characters closest to ``value``, always with a point.

    Sixteen columns hold 10 to 15 significant digits (a double has up to 17), eight hold 2 to 7.
    """
    if value == 0.0:
        return "0."
    fitting = [
        text
        for style in (_plain, _exponential)
        if (text := _longest(style, value, width)) is not None
    ]
    return min(fitting, key=lambda text: abs((real(text) or 0.0) - value), default="")


def _longest(style: Callable[[float, int], str | None], value: float, width: int) -> str | None:
    """Text with the most digits that fits and stays finite."""
    for digits in range(min(17, width), 0, -1):
        text = style(value, digits)
        if text is None:
            return None
        if len(text) <= width and real(text) is not None:
            return text
    return None


def _plain(value: float, digits: int) -> str | None:
    exponent = math.floor(math.log10(abs(value)))
    if not -4 <= exponent <= 15:
        return None
    text = f"{value:.{max(digits - 1 - exponent, 0)}f}"
    if "." not in text:
        return text + "."
    text = text.rstrip("0")
    sign = "-" if text.startswith("-") else ""
    body = text.removeprefix("-")
    return sign + (body.removeprefix("0") if body.startswith("0.") and body != "0." else body)


def _exponential(value: float, digits: int) -> str:
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    mantissa = mantissa.rstrip("0") if "." in mantissa else mantissa + "."
    return f"{mantissa}{int(exponent):+d}"


_WIDTH = 64
_EACH = np.uint64(0x0101010101010101)
_ZEROS, _BEYOND_NINE = (np.uint64(code) * _EACH for code in (0x30, 0x76))
_HIGHEST_BITS, _EVERY_BIT = (np.uint64(code) * _EACH for code in (0x80, 0xFF))
_PAIRS = np.uint64(0x000000FF000000FF)
_MILLION_AND_HUNDRED = np.uint64((1_000_000 << 32) + 100)
_TEN_THOUSAND_AND_ONE = np.uint64((10_000 << 32) + 1)


def plain_integers(words: npt.NDArray[np.uint64]) -> tuple[Indices, Mask]:
    """Return the values of fields that hold one run of digits and blanks, and which fields do.

    Parameters
    ----------
    words : (n,)
        Eight characters each, the first in the lowest byte.

    Returns
    -------
    values : (n,)
        Zero where a field holds anything else.
    plain : (n,)

    Notes
    -----
    20 ns a field, a third of what conversion of texts takes. Digits are added up in pairs, then in
    fours and eights: D. Lemire, "Quickly parsing eight-digit integers" (2018).
    """
    for bits in (32, 16, 8):  # blanks from the end to the front
        unused_bits = np.uint64(_WIDTH - bits)
        ends_blank = words >> unused_bits == _BLANKS >> unused_bits
        words = np.where(ends_blank, words << np.uint64(bits) | _BLANKS >> unused_bits, words)
    digits = words ^ _ZEROS
    above = (digits & ~_HIGHEST_BITS) + _BEYOND_NINE | digits
    others = (above & _HIGHEST_BITS) >> np.uint64(7)
    others *= np.uint64(0xFF)  # all bits of characters that are no digits
    plain: Mask = (others & (others + np.uint64(1)) == 0) & (others != _EVERY_BIT)  # all in front
    plain &= (words ^ _BLANKS) & others == 0
    digits &= ~others
    digits = digits * np.uint64(10) + (digits >> np.uint64(8))
    high = (digits & _PAIRS) * _MILLION_AND_HUNDRED
    low = (digits >> np.uint64(16) & _PAIRS) * _TEN_THOUSAND_AND_ONE
    values = (high + low >> np.uint64(32)).astype(np.int64)
    return np.where(plain, values, 0), plain
