"""Comma-separated numbers of data lines, as whole tables and one at a time.

Fields are strict: digits, signs, a point and an exponent after E or D. An invalid number is
an error with its line, never a zero.
"""

import math
import re
from collections.abc import Container
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask, Vector
from faying.exceptions import FormatError
from faying.io.abaqus.keyword import Keyword
from faying.io.deck_lines import LONGEST_WORD

Fields = npt.NDArray[np.bytes_]

_REAL = re.compile(r"[+-]?(?=\.?\d)\d*\.?\d*(?:[ED][+-]?\d+)?", re.IGNORECASE)
_INTEGER = re.compile(r"[+-]?\d{1,15}")
_COMMA, _NEWLINE = ord(","), ord("\n")


def _mask(characters: bytes) -> Mask:
    allowed = np.zeros(256, dtype=bool)
    allowed[np.frombuffer(characters, dtype=np.uint8)] = True
    return allowed


_IN_INTEGERS = _mask(b"0123456789+- \t,\n")
_IN_REALS = _mask(b"0123456789+-.EeDd \t,\n")


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """All fields of a keyword's data lines.

    Attributes
    ----------
    texts : (n_field,)
    row : (n_field,)
        Data line of each field.
    """

    keyword: Keyword
    texts: Fields
    row: Indices

    @property
    def counts(self) -> Indices:
        """Number of fields on each data line."""
        return np.bincount(self.row, minlength=len(self.keyword.data))

    def columns(self, fewest: int, width: int, expected: str) -> tuple[list[Fields], Indices]:
        """Return the columns of lines of ``fewest`` to ``width`` fields, empty where left out.

        Also return the number of fields on each line.
        """
        counts = self.counts
        wrong = np.flatnonzero((counts < fewest) | (counts > width))
        if wrong.size:
            self.keyword.refuse(
                f"found {counts[wrong[0]]} fields, expected {expected}", int(wrong[0])
            )
        table = np.zeros((len(counts), width), dtype=self.texts.dtype)
        start = np.cumsum(counts) - counts
        table[self.row, np.arange(len(self.row)) - start[self.row]] = self.texts
        return list(table.T), counts

    def cropped(self, width: int) -> "Table":
        """Return the table with only the first ``width`` fields of each line.

        It is unchanged unless each line has more fields, so that no record spans several lines.
        """
        counts = self.counts
        if not len(counts) or counts.min() <= width:
            return self
        start = np.cumsum(counts) - counts
        keep = np.arange(len(self.row)) - start[self.row] < width
        return Table(keyword=self.keyword, texts=self.texts[keep], row=self.row[keep])

    def records(self, width: int, expected: str) -> tuple[Fields, Indices]:
        """Return records (n, width), which may span several lines, and the first line of each.

        Each record starts on a new line.
        """
        start = np.arange(0, len(self.texts), width)
        rows = self.row[start]
        first = np.flatnonzero(np.diff(self.row, prepend=-1))
        misplaced = np.flatnonzero(~np.isin(start, first))
        lone = rows[np.flatnonzero(np.diff(rows, prepend=-1) == 0)]
        incomplete = len(self.texts) % width != 0
        if misplaced.size or lone.size or incomplete:
            bad = int(rows[misplaced[0]]) if misplaced.size else int(rows[-1])
            self.keyword.refuse(
                f"expected {expected}, each on separate lines; a field is missing or extra", bad
            )
        return self.texts.reshape(-1, width), rows


def table(keyword: Keyword) -> Table:
    """Split the data lines of a keyword into fields; a comma at the end of a line adds none."""
    if not keyword.data:
        return Table(keyword=keyword, texts=np.zeros(0, "S1"), row=np.zeros(0, dtype=np.int64))
    joined = b"\n".join(keyword.data)
    letters = np.frombuffer(joined, dtype=np.uint8)
    places = np.flatnonzero((letters == _COMMA) | (letters == _NEWLINE))
    newline = letters[places] == _NEWLINE
    lengths = np.diff(places, prepend=-1, append=len(letters)) - 1
    row = np.concatenate([[0], np.cumsum(newline)]).astype(np.int64)
    if lengths.max() > LONGEST_WORD:
        long = int(lengths.argmax())
        keyword.refuse(
            f"a field of {lengths[long]} characters is not a number or label", int(row[long])
        )
    texts = np.strings.strip(np.array(joined.replace(b"\n", b",").split(b",")))
    keep = ~(np.append(newline, True) & (texts == b""))
    return Table(keyword=keyword, texts=texts[keep], row=row[keep])


def integers(texts: Fields, keyword: Keyword, row: Indices, what: str) -> Indices:
    """Return the values of integer fields."""
    if not len(texts):
        return np.zeros(0, dtype=np.int64)
    _check_letters(texts, _IN_INTEGERS, keyword, row, what)
    if np.strings.str_len(texts).max() <= 15:
        try:
            return texts.astype(np.int64)
        except ValueError:
            pass
    raise _unreadable_field(texts, _INTEGER, keyword, row, f"{what}, a whole number")


def reals(texts: Fields, keyword: Keyword, row: Indices, what: str) -> Vector:
    """Return the values of real fields; an empty field is 0, as in both programs."""
    if not len(texts):
        return np.zeros(0)
    _check_letters(texts, _IN_REALS, keyword, row, what)
    plain = np.where(texts == b"", b"0", texts)
    letters = np.ascontiguousarray(plain).view(np.uint8)
    if (letters == ord("D")).any() or (letters == ord("d")).any():
        flat = np.ascontiguousarray(np.strings.upper(plain)).view(np.uint8)
        plain = np.where(flat == ord("D"), np.uint8(ord("E")), flat).view(plain.dtype)
    try:
        values: Vector = plain.astype(np.float64)
    except ValueError:
        raise _unreadable_field(texts, _REAL, keyword, row, f"{what}, a number") from None
    if not np.isfinite(values).all():
        bad = int(np.flatnonzero(~np.isfinite(values))[0])
        keyword.refuse(
            f"{what}: '{texts[bad].decode('latin-1')}' is too large for a number", int(row[bad])
        )
    return values


def _check_letters(texts: Fields, allowed: Mask, keyword: Keyword, row: Indices, what: str) -> None:
    width = texts.dtype.itemsize
    letters = np.ascontiguousarray(texts).view(np.uint8).reshape(-1, width)
    bad = ~(allowed[letters] | (letters == 0)).all(axis=1)
    if bad.any():
        first = int(bad.argmax())
        keyword.refuse(
            f"{what}: '{texts[first].decode('latin-1')}' is not a number", int(row[first])
        )


def _unreadable_field(
    texts: Fields, form: re.Pattern[str], keyword: Keyword, row: Indices, what: str
) -> Exception:
    unreadable = (i for i, t in enumerate(texts) if not form.fullmatch(t.decode("latin-1")))
    first = next(unreadable, 0)
    message = f"found '{texts[first].decode('latin-1')}', expected {what}"
    return keyword.error(message, int(row[first]))


def is_integer(text: str) -> bool:
    """Return whether a field is a whole number."""
    return _INTEGER.fullmatch(text) is not None


def _number(keyword: Keyword, text: str, what: str, row: int | None = None) -> float:
    if _REAL.fullmatch(text):
        value = float(text.upper().replace("D", "E"))
        if math.isfinite(value):
            return value
    message = f"found '{text}', expected {what}, a number"
    raise keyword.error(message, row)


def parameter(keyword: Keyword, name: str, default: float | None = None) -> float:
    """Return the number of a parameter, which is required unless it has a default."""
    if default is not None and not keyword.has(name):
        return default
    return _number(keyword, keyword.required(name), name)


@dataclass(frozen=True, eq=False)
class Line:
    """A data line of a keyword, or some of its fields: its number, and the stripped texts."""

    keyword: Keyword
    row: int
    texts: list[str]

    def __len__(self) -> int:
        return len(self.texts)

    def text(self, column: int) -> str:
        """Return a field; empty beyond the end of the line."""
        return self.texts[column] if column < len(self) else ""

    def error(self, text: str) -> FormatError:
        """Return the error that names file, line and keyword."""
        return self.keyword.error(text, self.row)

    def refuse(self, text: str) -> NoReturn:
        """Raise the error that names file, line and keyword."""
        raise self.error(text)

    def behind(self, column: int) -> "Line":
        """Return the fields from a column on."""
        return replace(self, texts=self.texts[column:])

    def groups(self, size: int) -> list["Line"]:
        """Return the fields in groups of some size."""
        starts = range(0, len(self), size)
        return [replace(self, texts=self.texts[start : start + size]) for start in starts]

    def check(self, counts: Container[int], expected: str) -> None:
        """Refuse another number of fields."""
        if len(self) not in counts:
            self.refuse(f"found {len(self)} fields, expected {expected}")

    def integer(self, column: int, what: str) -> int:
        """Return the value of an integer field."""
        if not is_integer(self.text(column)):
            self.refuse(f"found '{self.text(column)}', expected {what}, a whole number")
        return int(self.text(column))

    def real(self, column: int, what: str, default: float | None = None) -> float:
        """Return the value of a real field; an empty one is the default, or an error without."""
        text = self.text(column)
        if default is not None and not text:
            return default
        return _number(self.keyword, text, what, self.row)

    def positive(self, column: int, what: str) -> float:
        """Return the value of a required positive field."""
        value = self.real(column, what)
        if not value > 0:
            self.refuse(f"{what} is {value:g}; it must be positive")
        return value

    def reals(self, what: str) -> list[float]:
        """Return the values of all fields."""
        return [self.real(column, what) for column in range(len(self))]

    def padded(self, count: int, what: str) -> Vector:
        """Return real fields (count,), zero where they are empty or missing."""
        return np.array([self.real(column, what, 0.0) for column in range(count)])


def lines(keyword: Keyword, counts: Container[int] | None = None, expected: str = "") -> list[Line]:
    """Return the data lines of a keyword; refuse other numbers of fields than ``counts``."""
    found = [Line(keyword, row, texts) for row, texts in enumerate(keyword.rows())]
    if counts is not None:
        for line in found:
            line.check(counts, expected)
    return found


def only_line(keyword: Keyword, counts: Container[int], expected: str) -> Line:
    """Return the single data line of a keyword."""
    found = lines(keyword)
    if len(found) != 1 or len(found[0]) not in counts:
        keyword.refuse(f"expected one data line with {expected}", 0 if found else None)
    return found[0]
