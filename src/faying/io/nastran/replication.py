"""Expansion of folded free-field lines, and of cards that repeat the card above."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

from faying.exceptions import refuse
from faying.io.deck_lines import LineTexts
from faying.io.nastran import fields as numbers
from faying.io.nastran.fields import ROW

_TIMES = re.compile(rb"=(?:\((\d+)\)|(\d+))")
_STEP = re.compile(rb"\*(?:\(([^()]+)\)|([^()]+))")


@dataclass(frozen=True, kw_only=True)
class _Above:
    """The card above: name and fields, and the last increment of each."""

    fields: list[bytes]
    steps: dict[int, Decimal]


Edits = Iterator[tuple[int, int, Sequence[bytes]]]
"""Edits for :func:`faying.io.deck_lines.edited`."""


def replicated(text: LineTexts, where: Callable[[int], str]) -> Edits:
    """Yield cards that repeat the card above, written out in free field.

    ``=`` repeats a field of the card above, ``==`` this and all later ones, ``*d`` adds d to it; a
    line ``=n`` repeats the last line n more times, adding again. Cards have one line. The text
    has no comments; ``where`` returns file:line.
    """
    done = 0
    above: _Above | None = None
    for i in (i for i in text.holding(b"=").tolist() if text[i][:1] == b"="):
        previous = next((k for k in range(i - 1, done - 1, -1) if text[k].strip()), None)
        if previous is not None:
            above = _card(text, previous, where(i))
        if above is None:
            refuse(f"{where(i)}: a line of '=' without a card above it; write the card out")
        following = next((line for line in text[i + 1 :] if line.strip()), b"")
        if _continues(following):
            refuse(f"{where(i)}: a repeated card with a second line is not supported; write it out")
        cards, above = _repeated(_split(text[i]), above, where(i))
        done = i + 1
        yield i, done, cards


def _split(line: bytes) -> list[bytes]:
    """Return name and eight fields of a line."""
    if b"," in line:
        parts = [part.strip() for part in line.split(b",")]
    else:
        flat = line.expandtabs(8)
        # Only a number of repetitions may be longer than its field.
        if match := _TIMES.fullmatch(flat[:72].strip()):
            return [match[0], *[b""] * numbers.ROW]
        parts = [flat[k : k + 8].strip() for k in range(0, min(len(flat), 72), 8)]
    return (parts + [b""] * (numbers.ROW + 1))[: numbers.ROW + 1]


def _continues(line: bytes) -> bool:
    return line[:1] in (b" ", b"+", b"*", b",", b"\t")


def _card(text: LineTexts, i: int, where: str) -> _Above:
    if _continues(text[i]) or b"*" in text[i].partition(b",")[0][:8]:
        refuse(
            f"{where}: the card above has several lines or fields of sixteen columns, which cannot "
            "be repeated; write the card out"
        )
    return _Above(fields=_split(text[i]), steps={})


def _repeated(row: list[bytes], above: _Above, where: str) -> tuple[list[bytes], _Above]:
    """Return the cards made by a line, and the last of them."""
    times = _TIMES.fullmatch(row[0])
    if times is None and row[0] not in (b"=", b"=="):
        refuse(f"{where}: '{_shown(row[0])}' is not a card name; = repeats one, =n n times")
    if times is None:
        fields, steps = _derived(row, above, where)
        return [b",".join(fields)], _Above(fields=fields, steps=steps)
    count = int(times[1] or times[2])
    if not above.steps or count > numbers.LONGEST_RANGE:
        wrong = (
            f"it may up to {numbers.LONGEST_RANGE} times" if above.steps else "there is none above"
        )
        refuse(f"{where}: '{_shown(row[0])}' repeats a line that adds to a field (*d); {wrong}")
    cards = []
    fields = above.fields
    for _ in range(count):
        fields = [
            _sum(field, above.steps[k], where) if k in above.steps else field
            for k, field in enumerate(fields)
        ]
        cards.append(b",".join(fields))
    return cards, _Above(fields=fields, steps=above.steps)


def _derived(row: list[bytes], above: _Above, where: str) -> tuple[list[bytes], dict[int, Decimal]]:
    """Return the fields of a card that repeats others, and the increment of each."""
    fields = [above.fields[0]]
    steps: dict[int, Decimal] = {}
    for k in range(1, numbers.ROW + 1):
        if row[k] == b"==" or row[0] == b"==":
            return fields + above.fields[k:], steps
        if row[k] == b"=":
            fields.append(above.fields[k])
        elif match := _STEP.fullmatch(row[k]):
            steps[k] = _decimal(match[1] or match[2], where)
            fields.append(_sum(above.fields[k], steps[k], where))
        elif row[k][:1] == b"*":
            refuse(f"{where}: '{_shown(row[k])}' cannot be added to a field; write the card out")
        else:
            fields.append(row[k])
    return fields, steps


def _sum(field: bytes, step: Decimal, where: str) -> bytes:
    """Return a field plus a step; reals stay reals."""
    total = _decimal(field, where) + step
    whole = numbers.integer(field.decode("latin-1")) is not None and total == int(total)
    return str(int(total)).encode() if whole else repr(float(total)).upper().encode()


def _decimal(field: bytes, where: str) -> Decimal:
    text = field.decode("latin-1").strip()
    value = numbers.real(text)
    if value is None:
        refuse(f"{where}: '{text}' is not a number to add to; write the card out")
    return Decimal(repr(value))


def _shown(text: bytes) -> str:
    return text.decode("latin-1")[:24]


_LONG = frozenset((b"CORD2R", b"CORD2C", b"CORD2S"))
"""Cards with eleven fields in a line; in others a ninth field is probably a mistake."""


def unfolded(text: LineTexts) -> Edits:
    """Yield free-field cards in lines of eight fields, whatever their continuation.

    A line that ends with a comma continues on the next line, which then begins with data instead
    of a blank field. One line may have the eleven fields of CORD2R. Only the name of DEQATN is
    kept, as its commas separate arguments. The text has no comments.
    """
    done = 0
    for start in _special(text):
        if start < done:
            continue
        done = start + 1
        folded: list[bytes] | None = [b"DEQATN"]
        if text[start][:6] == b"DEQATN":
            while done < len(text) and text[done][:1] in (b" ", b"+", b"*", b"\t", b""):
                done += 1
        else:
            while done < len(text) and _folded(text[done - 1], text[done]):
                done += 1
            folded = _rows(text[start:done])
        if folded is not None:
            yield start, done, folded


def _special(text: LineTexts) -> list[int]:
    """Return the few lines that may need another form."""
    free = [
        i
        for i in text.holding(b",").tolist()
        if (line := text[i]).rstrip().endswith(b",") or line[:5] == b"CORD2"
    ]
    equations = [i for i in text.holding(b"DEQATN").tolist() if text[i][:6] == b"DEQATN"]
    return sorted({*free, *equations})


def _folded(line: bytes, following: bytes) -> bool:
    """Return whether a line continues on the next one, which begins with a number."""
    first = following.lstrip()[:1]
    return line.rstrip().endswith(b",") and b"," in following and first.isdigit()


def _rows(lines: LineTexts) -> list[bytes] | None:
    """Return the fields of a card or line in lines of eight; None if they are so already."""
    parts = [part.strip() for line in lines for part in line.rstrip().rstrip(b",").split(b",")]
    name, data = parts[0], parts[1:]
    if len(data) <= ROW or (len(lines) == 1 and name not in _LONG):
        return None
    marked = len(data) == ROW + 1 and data[ROW][:1] in (b"+", b"*")
    if marked or b"*" in name or b" " in name:
        return None
    rows = [data[k : k + ROW] for k in range(0, len(data), ROW)]
    heads = [name] + [b""] * (len(rows) - 1)
    return [b",".join([head, *row]) for head, row in zip(heads, rows, strict=True)]
