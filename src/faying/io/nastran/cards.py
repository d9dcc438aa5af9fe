"""Cards of a deck: fields by number, as columns of all cards of a name or of a single card.

Field j of a card is field j % 8 + 2 of row j // 8 in the reference guide.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn, TypeVar

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import FormatError
from faying.io.deck_lines import Lines
from faying.io.nastran import fields as numbers
from faying.io.nastran.card_table import field_of, place_of
from faying.io.nastran.fields import Fields

Read = TypeVar("Read")


@dataclass(frozen=True, eq=False, kw_only=True)
class Bulk:
    """All cards of a deck.

    Attributes
    ----------
    fields : (n_field,)
        Data fields of all cards, concatenated.
    names : (n_card,)
    start : (n_card + 1,)
        First field of each card.
    line_start, line : (n_line,)
        First field of each physical line, and its index in ``lines``.
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
            (name := raw.decode("latin-1")): Cards(
                bulk=self, name=name, index=index, first=np.zeros_like(index)
            )
            for raw, index in zip(names, groups, strict=True)
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Cards:
    """Cards of one name, or repeating groups of their fields.

    Attributes
    ----------
    index, first : (n,)
        Index of each card in ``bulk``, and the field of the card that is field 0 here.
    size
        Fields of a group; None means up to the end of the card.
    """

    bulk: Bulk
    name: str
    index: Indices
    first: Indices
    size: int | None = None

    def __len__(self) -> int:
        return len(self.index)

    @property
    def start(self) -> Indices:
        """First field (n,) of each card."""
        return np.asarray(self.bulk.start[self.index] + self.first)

    @property
    def count(self) -> Indices:
        """Number of fields (n,) of each card."""
        count = np.asarray(self.bulk.start[self.index + 1] - self.start)
        return count if self.size is None else np.minimum(count, self.size)

    def take(self, which: Indices | Mask) -> "Cards":
        """Return some of the cards."""
        return replace(self, index=self.index[which], first=self.first[which])

    def groups(self, first: int, size: int) -> "Cards":
        """Return the repeating groups of fields from ``first`` on, without blank groups."""
        number = np.maximum(-(-(self.count - first) // size), 0)
        card = np.repeat(np.arange(len(self)), number)
        behind = np.arange(len(card)) - np.repeat(np.cumsum(number) - number, number)
        places = self.first[card] + first + size * behind
        groups = replace(self, index=self.index[card], first=places, size=size)
        return groups.take(np.logical_or.reduce([groups.given(j) for j in range(size)]))

    @property
    def whole(self) -> "Cards":
        """Return the whole card of each group."""
        return replace(self, first=np.zeros_like(self.first), size=None)

    def place(self, card: int, field: int = 0) -> str:
        """Return file:line of a card."""
        return self.bulk.where(int(self.start[card]) + field)

    def where(self, card: int, field: int = 0) -> str:
        """Return file:line and the name of a card."""
        return f"{self.place(card, field)}: {self.name}"

    def error(self, card: int, text: str, field: int = 0) -> FormatError:
        """Return the error that names file, line and card."""
        return FormatError(f"{self.where(card, field)}: {text}")

    def refuse(self, card: int, text: str, field: int = 0) -> NoReturn:
        """Raise the error that names file, line and card."""
        raise self.error(card, text, field)

    def refuse_where(self, wrong: Mask, text: Callable[[int], str], field: int = 0) -> None:
        """Raise the error of the first wrong card, where ``wrong`` (n,) marks any."""
        if wrong.any():
            card = int(wrong.argmax())
            self.refuse(card, text(card), field)

    def column(self, field: int) -> Fields:
        """Return field j (n,) of every card as text; empty beyond the end of a card."""
        if not len(self.bulk.fields):
            return np.zeros(len(self), dtype=self.bulk.fields.dtype)
        positions = np.minimum(self.start + field, len(self.bulk.fields) - 1)
        texts = self.bulk.fields[positions]
        texts[field >= self.count] = b""
        return texts

    def given(self, field: int) -> Mask:
        """Return where field j is not blank."""
        return ~numbers.is_blank(self.column(field))

    def words(self, field: int) -> list[str]:
        """Return field j of every card as stripped text."""
        return [text.decode("latin-1").strip("\0 ") for text in self.column(field)]

    def integers(self, field: int, default: int | None = None) -> Indices:
        """Return field j (n,) as integers; blank is ``default`` or, without one, an error."""
        raw = self.column(field)
        values, bad = numbers.integers(raw)
        self._check(raw, bad, field, "an integer", default is None)
        return np.where(bad, default or 0, values)

    def reals(self, field: int, default: float | None = None) -> Vector:
        """Return field j (n,) as reals; blank is ``default`` or, without one, an error."""
        raw = self.column(field)
        values, bad = numbers.reals(raw)
        self._check(raw, bad, field, "a real number", default is None)
        return np.where(bad, default or 0.0, values)

    def vectors(self, fields: Iterable[int]) -> Matrix:
        """Return several fields (n, n_field) as reals, zero for blanks."""
        return np.stack([self.reals(field, 0.0) for field in fields], axis=1)

    def check_finite(self, vectors: Matrix) -> None:
        """Refuse loads (n, ...) that are too large."""
        wrong = np.asarray(~np.isfinite(vectors).reshape(len(vectors), -1).all(axis=1))
        self.refuse_where(wrong, lambda _: "the load is too large for a number")

    def _check(self, raw: Fields, bad: Mask, field: int, kind: str, required: bool) -> None:
        if not bad.any():
            return
        faulty = bad if required else bad & ~numbers.is_blank(raw)
        if faulty.any():
            card = int(np.flatnonzero(faulty)[0])
            raise self.malformed(card, field, raw[card].decode("latin-1"), kind)

    def malformed(self, card: int, field: int, text: str, kind: str) -> FormatError:
        """Return the error for a field of another kind than expected."""
        shown = text.strip("\0 ")
        content = f"'{shown}'" if shown else "nothing"
        name = named(self.name, int(self.first[card]) + field)
        return self.error(card, f"{name} holds {content}, expected {kind}", field)

    def __iter__(self) -> Iterator["Card"]:
        start, count = self.start.tolist(), self.count.tolist()
        for i, (first, length) in enumerate(zip(start, count, strict=True)):
            texts = self.bulk.fields[first : first + length].tolist()
            yield Card(
                cards=self, number=i, texts=[t.decode("latin-1").strip("\0 ") for t in texts]
            )


def named(card: str, field: int) -> str:
    """Return the name of a field in messages: its number in the row and its name."""
    name = field_of(card, field).name
    return f"field {field % 8 + 2}" + (f" ({name})" if name else "")


@dataclass(frozen=True, eq=False, kw_only=True)
class Card:
    """One card or a group of its fields, for rare cards and irregular layouts.

    ``first`` is the field of the card that is field 0 here.
    """

    cards: Cards
    number: int
    texts: list[str]
    first: int = 0

    def __len__(self) -> int:
        return len(self.texts)

    def text(self, field: int) -> str:
        """Return the stripped text of field j; empty beyond the end."""
        return self.texts[field] if field < len(self.texts) else ""

    def place(self, name: str) -> int:
        """Return the number of a field by name; one beyond the end if the card lacks it."""
        return place_of(self.cards.name, name)

    def integer(self, field: int, default: int | None = None) -> int:
        """Return field j as an integer; blank is ``default`` or, without one, an error."""
        text = self.text(field)
        value = default if not text else numbers.integer(text)
        if value is None:
            raise self.cards.malformed(self.number, self.first + field, text, "an integer")
        return value

    def real(self, field: int, default: float | None = None) -> float:
        """Return field j as a real within its bounds; blank is ``default`` or else an error."""
        text = self.text(field)
        value = default if not text else numbers.real(text)
        if value is None:
            raise self.cards.malformed(self.number, self.first + field, text, "a real number")
        if fault := field_of(self.cards.name, self.first + field).fault(value):
            self.refuse(f"{self.named(field)} is {value:g}; it {fault}", field)
        return value

    def error(self, text: str, field: int = 0) -> FormatError:
        """Return the error that names file, line and card."""
        return self.cards.error(self.number, text, self.first + field)

    def refuse(self, text: str, field: int = 0) -> NoReturn:
        """Raise the error that names file, line and card."""
        raise self.error(text, field)

    def named(self, field: int) -> str:
        """Return the name of a field in messages: its number in the row and its name."""
        return named(self.cards.name, self.first + field)

    def groups(self, first: int, size: int) -> list["Card"]:
        """Return the repeating groups of fields from ``first`` on, without blank groups."""
        groups = (self.part(start, size) for start in range(first, len(self), size))
        return [group for group in groups if any(group.texts)]

    def part(self, first: int, size: int) -> "Card":
        """Return ``size`` fields from ``first`` on."""
        return replace(self, texts=self.texts[first : first + size], first=self.first + first)

    def where(self) -> str:
        """Return file:line and the name."""
        return self.cards.where(self.number)

    def choice(self, field: int, allowed: Collection[str], remedy: str = "") -> str:
        """Return the text of field j; refuse texts that are not allowed."""
        text = self.text(field)
        if text not in allowed:
            name = field_of(self.cards.name, self.first + field).name or self.named(field)
            known = f"; it is {', '.join(filter(None, allowed))}"
            wrong = f" is not supported; {remedy}" if remedy else known
            self.refuse(f"{name} = '{text}'{wrong}", field)
        return text

    def find(
        self,
        table: Mapping[int, Read],
        field: int,
        what: str,
        kinds: str,
        number: int | None = None,
    ) -> Read:
        """Return the object with the id in a field, or with id ``number``.

        ``kinds`` lists the cards that could define it.
        """
        number = self.integer(field) if number is None else number
        if number not in table:
            self.refuse(f"{what} {number} is not in the deck; define it ({kinds})", field)
        return table[number]

    def reals(self, fields: Iterable[int], default: float | None = None) -> Vector:
        """Return several fields (n,) as reals."""
        return np.array([self.real(field, default) for field in fields])

    def combination(self) -> list[tuple[float, int, "Card"]]:
        """Return factors, sets and fields of S, S1, L1, S2, L2, ...; S = 1 if blank."""
        overall = self.real(1, 1.0)
        return [(overall * part.real(0), part.integer(1), part) for part in self.groups(2, 2)]

    def refuse_given(self, fields: Sequence[int]) -> None:
        """Refuse fields that are not blank."""
        for field in fields:
            if self.text(field):
                self.refuse(
                    f"{self.named(field)} holds '{self.text(field)}' but must be blank; are "
                    "fields shifted?",
                    field,
                )

    def refuse_non_zero(self, fields: Sequence[int], what: str, remedy: str) -> None:
        """Refuse fields with anything but zero."""
        for field in fields:
            text = self.text(field)
            if text and numbers.real(text) != 0.0:
                place = f"field {(self.first + field) % 8 + 2}"
                self.refuse(f"{what} '{text}' ({place}) is not supported; {remedy}", field)


def each(cards: Mapping[str, Cards], *names: str) -> Iterator[Card]:
    """Yield the cards of some names, name by name."""
    for name in names:
        yield from cards.get(name, ())


def single(cards: Mapping[str, Cards], name: str) -> Card | None:
    """Return the only card of a name, None without one; refuse several."""
    listed = list(cards.get(name, ()))
    if len(listed) > 1:
        listed[1].refuse(f"a second {name}; the first is at {listed[0].where()}, keep one")
    return listed[0] if listed else None


def by_id(cards: Mapping[str, Cards], *names: str, what: str = "") -> dict[int, Card]:
    """Return cards by the id in their first field; refuse ids that occur twice.

    ``what`` is the term for such a card in messages, by default its name.
    """
    by_number: dict[int, Card] = {}
    for card in each(cards, *names):
        earlier = by_number.setdefault(card.integer(0), card)
        if earlier is not card:
            called = f"{what or card.cards.name} {card.integer(0)}"
            card.refuse(f"{called} is already defined at {earlier.where()}; renumber one")
    return by_number


def property_of(card: Card, properties: Mapping[int, Read], kinds: str) -> Read:
    """Return the property of an element; a blank field means the id of the element.

    ``kinds`` lists the cards that could define it.
    """
    return card.find(properties, 1, "property", kinds, card.integer(1, card.integer(0)))
