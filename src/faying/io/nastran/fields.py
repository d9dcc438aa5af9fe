"""Fields of cards: numbers and component digits, read and written.

A real may be written ``1.5``, ``1.5E-3``, ``1.5D-3`` or ``1.5-3`` (without exponent letter).
Fields are byte strings of one width, padded with blanks or NUL.
"""

import math
import re
from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask, Vector
from faying.exceptions import FormatError

Fields = npt.NDArray[np.bytes_]

ROW = 8
"""Data fields of a line in small or free field."""

_REAL = re.compile(r"[+-]?(?=\.?\d)\d*\.?\d*(?:[ED][+-]?\d+|[+-]\d+)?")
_INTEGER = re.compile(r"[+-]?\d{1,18}")
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-])")
_BLANK, _PLUS, _MINUS, _POINT, _ZERO, _NINE = (ord(c) for c in " +-.09")
_D, _E = ord("D"), ord("E")


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
    """Return characters (n, width) of fields (n,), padded with blanks."""
    width = fields.dtype.itemsize
    letters = np.ascontiguousarray(fields).view(np.uint8).reshape(len(fields), width)
    return np.maximum(letters, np.uint8(_BLANK))


def is_blank(fields: Fields) -> Mask:
    """Return which fields (n,) are blank."""
    # Columns are few: a loop over them is faster than a reduction along each short row.
    highest = reduce(np.maximum, characters(fields).T)
    return np.asarray(highest == _BLANK)


def _texts(letters: npt.NDArray[np.uint8]) -> Fields:
    joined: Fields = np.ascontiguousarray(letters).view(f"S{letters.shape[1]}").ravel()
    return joined


def integers(fields: Fields) -> tuple[Indices, Mask]:
    """Return values of integer fields, and where there is no integer (or a blank; value 0)."""
    letters = characters(fields)
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
    """Replace D by E and insert the E missing in ``1.5-3``."""
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
    """Return values of real fields, and where there is no finite real (or a blank; value 0).

    Integers count as reals, as several preprocessors write them.
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
    """Return the shortest text of up to ``width`` characters closest to ``value``, with a point.

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
    """Return the text with the most digits that fits and stays finite."""
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


def components(digits: str, error: Callable[[str], FormatError]) -> tuple[int, ...]:
    """Return components 0..5, ascending, of digits 1..6."""
    if not digits or set(digits) - set("123456") or len(set(digits)) != len(digits):
        shown = f"'{digits}'" if digits else "nothing"
        message = f"components are {shown}; expected distinct digits 1 to 6, such as 123"
        raise error(message)
    return tuple(sorted(int(digit) - 1 for digit in digits))


def digits_of(numbers: tuple[int, ...]) -> str:
    """Return digits 1..6 of components 0..5."""
    return "".join(str(number + 1) for number in sorted(numbers))


def frame_independent(numbers: tuple[int, ...]) -> bool:
    """Return whether all or none of the translations occur, and likewise of the rotations.

    Then the components span the same space in any node's coordinate system.
    """
    return all(len(set(numbers) & group) in (0, 3) for group in ({0, 1, 2}, {3, 4, 5}))


LONGEST_RANGE = 1_000_000
"""Most ids of a range, or cards repeated by one line: more are taken as a mistake that
would fill the memory."""

LARGEST_ID = 99_999_999
"""Largest id that fits the eight columns of a small field."""

Value = int | float | str | None


def small(name: str, values: Sequence[Value]) -> str:
    """Return the lines of a card with eight data fields of eight columns each."""
    texts = [_text(value, 8).ljust(8) for value in values]
    lines = [
        f"{name if i == 0 else '+':8}{''.join(texts[i : i + 8])}".rstrip()
        for i in range(0, max(len(texts), 1), 8)
    ]
    return "\n".join(lines)


def large(name: str, values: Sequence[Value]) -> str:
    """Return the lines of a card with four data fields of sixteen columns each.

    Lines come in pairs, as Nastran requires.
    """
    texts = [_text(value, 16).ljust(16) for value in values]
    texts += [" " * 16] * (-len(texts) % 8)
    lines = [
        f"{name + '*' if i == 0 else '*':8}{''.join(texts[i : i + 4])}".rstrip()
        for i in range(0, len(texts), 4)
    ]
    return "\n".join(lines)


def _text(value: Value, width: int) -> str:
    if value is None:
        return ""
    return format_real(value, width) if isinstance(value, float) else str(value)
