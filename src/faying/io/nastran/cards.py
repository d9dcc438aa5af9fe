"""Bulk data as one flat table of fields: small, large and free field form look alike afterwards.

A physical line contributes eight data fields (four in large field form), so that field j of a card
is where the reference guide puts it: row j // 8, field j % 8 + 2. Everything is done for all lines
at once; a Python loop touches only free-field lines.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask, Vector
from faying.exceptions import FormatError
from faying.io.nastran import fields as numbers
from faying.io.nastran.fields import Fields
from faying.io.nastran.source import Lines

_BLANK, _STAR, _PLUS, _COMMA = (ord(c) for c in " *+,")
_COLUMNS = 80
_Letters = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False, kw_only=True)
class Bulk:
    """All cards of a deck.

    Attributes
    ----------
    fields : (n_field,)
        Data fields of all cards, one after the other.
    names : (n_card,)
    start : (n_card + 1,)
        First field of each card.
    line_start, line : (n_line,)
        First field of each physical line and its number in ``lines``.
    """

    fields: Fields
    names: Fields
    start: Indices
    line_start: Indices
    line: Indices
    lines: Lines

    def where(self, field: int) -> str:
        """Return file:line of a field."""
        row = int(np.searchsorted(self.line_start, field, side="right")) - 1
        return self.lines.where(int(self.line[max(row, 0)]))

    def cards(self) -> dict[str, "Cards"]:
        """Cards by name, each in the order of the deck."""
        if not len(self.names):
            return {}
        names, which = np.unique(self.names, return_inverse=True)
        order = np.argsort(which, kind="stable")
        groups = np.split(order, np.cumsum(np.bincount(which, minlength=len(names)))[:-1])
        return {
            (name := raw.decode("latin-1")): Cards(bulk=self, name=name, index=index)
            for raw, index in zip(names, groups, strict=True)
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Cards:
    """Cards of one name; ``index`` (n,) points into ``Bulk``."""

    bulk: Bulk
    name: str
    index: Indices

    def __len__(self) -> int:
        return len(self.index)

    @property
    def start(self) -> Indices:
        """First field (n,) of each card."""
        return self.bulk.start[self.index]

    @property
    def count(self) -> Indices:
        """Number of fields (n,) of each card."""
        return np.asarray(self.bulk.start[self.index + 1] - self.start)

    def take(self, which: Indices | Mask) -> "Cards":
        """Return some of the cards."""
        return Cards(bulk=self.bulk, name=self.name, index=self.index[which])

    def where(self, card: int, field: int = 0) -> str:
        """Return file:line and the name of a card."""
        return f"{self.bulk.where(int(self.start[card]) + field)}: {self.name}"

    def error(self, card: int, text: str, field: int = 0) -> FormatError:
        """Return the error that names file, line and card."""
        return FormatError(f"{self.where(card, field)}: {text}")

    def column(self, field: int) -> Fields:
        """Field j (n,) of every card as text; empty beyond the end of a card."""
        if not len(self.bulk.fields):
            return np.zeros(len(self), dtype=self.bulk.fields.dtype)
        at = np.minimum(self.start + field, len(self.bulk.fields) - 1)
        found = self.bulk.fields[at]
        found[field >= self.count] = b""
        return found

    def given(self, field: int) -> Mask:
        """Where field j is not blank."""
        return ~numbers.is_blank(self.column(field))

    def words(self, field: int) -> list[str]:
        """Field j of every card as stripped text."""
        return [text.decode("latin-1").strip("\0 ") for text in self.column(field)]

    def integers(self, field: int, default: int | None = None) -> Indices:
        """Field j (n,) as integers; blank is ``default`` or, without one, an error."""
        raw = self.column(field)
        values, bad = numbers.integers(raw)
        self._check(raw, bad, field, "an integer", default is None)
        return np.where(bad, default or 0, values)

    def reals(self, field: int, default: float | None = None) -> Vector:
        """Field j (n,) as reals; blank is ``default`` or, without one, an error."""
        raw = self.column(field)
        values, bad = numbers.reals(raw)
        self._check(raw, bad, field, "a real number", default is None)
        return np.where(bad, default or 0.0, values)

    def _check(self, raw: Fields, bad: Mask, field: int, kind: str, required: bool) -> None:
        if not bad.any():
            return
        faulty = bad if required else bad & ~numbers.is_blank(raw)
        if faulty.any():
            card = int(np.flatnonzero(faulty)[0])
            raise self.malformed(card, field, raw[card].decode("latin-1"), kind)

    def malformed(self, card: int, field: int, text: str, kind: str) -> FormatError:
        """Return the error for a field that is not what it should be."""
        shown = text.strip("\0 ")
        found = f"'{shown}'" if shown else "nothing"
        return self.error(card, f"field {field % 8 + 2} holds {found}, expected {kind}", field)

    def tail(self, field: int) -> tuple[Indices, Indices]:
        """Cards (m,) and positions (m,) in ``Bulk.fields`` of all non-blank fields from j on."""
        length = np.maximum(self.count - field, 0)
        card = np.repeat(np.arange(len(self)), length)
        inside = np.arange(len(card)) - np.repeat(np.cumsum(length) - length, length)
        position = self.start[card] + field + inside
        keep = ~numbers.is_blank(self.bulk.fields[position])
        return card[keep], position[keep]

    def __iter__(self) -> Iterator["Card"]:
        start, count = self.start.tolist(), self.count.tolist()
        for i, (first, length) in enumerate(zip(start, count, strict=True)):
            texts = self.bulk.fields[first : first + length].tolist()
            yield Card(
                cards=self, number=i, texts=[t.decode("latin-1").strip("\0 ") for t in texts]
            )


@dataclass(frozen=True, eq=False, kw_only=True)
class Card:
    """One card, for kinds that come in small numbers or irregular shapes."""

    cards: Cards
    number: int
    texts: list[str]

    def __len__(self) -> int:
        return len(self.texts)

    def text(self, field: int) -> str:
        """Return the stripped text of field j; empty beyond the end."""
        return self.texts[field] if field < len(self.texts) else ""

    def integer(self, field: int, default: int | None = None) -> int:
        """Field j as an integer; blank is ``default`` or, without one, an error."""
        text = self.text(field)
        value = default if not text else numbers.integer(text)
        if value is None:
            raise self.cards.malformed(self.number, field, text, "an integer")
        return value

    def real(self, field: int, default: float | None = None) -> float:
        """Field j as a real; blank is ``default`` or, without one, an error."""
        text = self.text(field)
        value = default if not text else numbers.real(text)
        if value is None:
            raise self.cards.malformed(self.number, field, text, "a real number")
        return value

    def error(self, text: str, field: int = 0) -> FormatError:
        """Return the error that names file, line and card."""
        return self.cards.error(self.number, text, field)

    def where(self) -> str:
        """Return file:line and the name."""
        return self.cards.where(self.number)

    def refuse_non_zero(self, fields: Sequence[int], what: str, remedy: str) -> None:
        """Raise if one of the fields holds anything but zero."""
        for field in fields:
            text = self.text(field)
            if text and numbers.real(text) != 0.0:
                message = f"{what} '{text}' (field {field % 8 + 2}) is not supported; {remedy}"
                raise self.error(message, field)


def read_cards(lines: Lines) -> Bulk:
    """Split bulk data lines into cards and fields.

    Continuation lines must follow their parent (comments may lie between).

    Raises
    ------
    FormatError
        If a continuation has no parent or another one's, or a free-field line is too long.

    Notes
    -----
    About 1 µs a line, 130 bytes of memory a line.
    """
    text = [_without_comment(line) for line in lines.text]
    for i, line in enumerate(text):
        if b"\t" in line:
            text[i] = _without_tabs(line, lines, i)
    letters = _letters(text)
    kept = np.flatnonzero((letters != _BLANK).any(axis=1))
    letters = letters[kept]
    free = (letters == _COMMA).any(axis=1)
    split = {int(i): _split_free(text[kept[i]], lines, int(kept[i])) for i in np.flatnonzero(free)}
    head = letters[:, :8].copy()
    for i, parts in split.items():
        head[i] = np.frombuffer(parts[0].ljust(8)[:8], dtype=np.uint8)
    first = head[:, 0]
    continued = (first == _PLUS) | (first == _STAR) | (head == _BLANK).all(axis=1)
    if len(kept) and continued[0]:
        message = f"{lines.where(int(kept[0]))}: a continuation line without a card above it"
        raise FormatError(message)
    _check_markers(letters, continued, free, kept, lines)
    large = (head == _STAR).any(axis=1)
    count = np.where(large, 4, 8) + _padding(large, continued)
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    heads = np.flatnonzero(~continued)
    names = np.char.strip(np.ascontiguousarray(head[heads]).view("S8").ravel(), b"* \0")
    return Bulk(
        fields=_fields(letters, large, free, split, start),
        names=names,
        start=np.append(start[heads], start[-1]),
        line_start=start[:-1],
        line=kept,
        lines=lines,
    )


def _without_comment(line: bytes) -> bytes:
    return line.partition(b"$")[0] if b"$" in line else line


def _without_tabs(line: bytes, lines: Lines, i: int) -> bytes:
    if b"," in line:
        return line.replace(b"\t", b" ")
    if b"*" in line[:8]:
        message = f"{lines.where(i)}: tabs in a large-field line; replace them by blanks"
        raise FormatError(message)
    return line.expandtabs(8)


def _letters(text: list[bytes]) -> _Letters:
    """Characters (n_line, 80), blank where there is nothing printable."""
    table = np.array(text or [b""], dtype=f"S{_COLUMNS}")[: len(text)]
    return numbers.characters(table)


def _split_free(line: bytes, lines: Lines, i: int) -> list[bytes]:
    """Name and exactly eight (large: four) data fields of a free-field line."""
    parts = [part.strip() for part in line.split(b",")]
    size = 4 if b"*" in parts[0] else 8
    extra = [part for part in parts[size + 1 :] if part]
    if len(extra) > 1 or (extra and (len(parts) > size + 2 or extra[0][:1] not in b"+*")):
        message = (
            f"{lines.where(i)}: a free-field line with more than {size} data fields; "
            "continue it on a line that starts with a comma"
        )
        raise FormatError(message)
    return (parts[: size + 1] + [b""] * size)[: size + 1]


def _check_markers(
    letters: _Letters, continued: Mask, free: Mask, kept: Indices, lines: Lines
) -> None:
    """Refuse continuations whose mark belongs to another card, as in a deck sorted by name."""
    below = np.flatnonzero(continued & ~free)
    below = below[(below > 0) & ~free[below - 1]]
    mark = np.ascontiguousarray(letters[below, :8]).view("S8").ravel()
    expected = np.ascontiguousarray(letters[below - 1, 72:80]).view("S8").ravel()
    mark, expected = np.char.strip(mark, b"+* "), np.char.strip(expected, b"+* ")
    wrong = below[(mark != b"") & (expected != b"") & (mark != expected)]
    if wrong.size:
        i = int(kept[wrong[0]])
        message = (
            f"{lines.where(i)}: this continuation does not belong to the line above (its mark "
            "differs); put continuation lines directly below their card"
        )
        raise FormatError(message)


def _padding(large: Mask, continued: Mask) -> Indices:
    """Empty fields to add to a large-field line that a small-field line continues mid-row."""
    padding = np.zeros(len(large), dtype=np.int64)
    joint = np.flatnonzero(large[:-1] & ~large[1:] & continued[1:])
    for i in joint:
        run = 1
        while continued[i - run + 1] and large[i - run]:
            run += 1
        padding[i] = 4 * (run % 2)
    return padding


def _fields(
    letters: _Letters, large: Mask, free: Mask, split: dict[int, list[bytes]], start: Indices
) -> Fields:
    longest = max((len(part) for parts in split.values() for part in parts[1:]), default=0)
    width = max(16, longest)
    table = np.full((int(start[-1]), width), _BLANK, dtype=np.uint8)
    rows = np.flatnonzero(~large & ~free)
    at = start[rows][:, None] + np.arange(8)
    table[at, :8] = letters[rows, 8:72].reshape(-1, 8, 8)
    rows = np.flatnonzero(large & ~free)
    at = start[rows][:, None] + np.arange(4)
    table[at, :16] = letters[rows, 8:72].reshape(-1, 4, 16)
    fields: Fields = table.view(f"S{width}").ravel()
    for i, parts in split.items():
        fields[start[i] : start[i] + len(parts) - 1] = parts[1:]
    return fields
