"""Free-field lines as programs fold them, and equations that are no fields at all."""

from collections.abc import Sequence

import numpy as np

from faying._typing import Indices
from faying.io.line_texts import LineTexts, joined
from faying.io.nastran.fields import ROW

_LONG = frozenset((b"CORD2R", b"CORD2C", b"CORD2S"))
"""Cards whose eleven fields are written in one line; in others a ninth is likely a slip."""


def unfolded(text: LineTexts) -> tuple[LineTexts, Indices]:
    """Return lines of bulk data with one way of continuing free-field cards, and where they were.

    A line that ends with a comma goes on in the next one, which then begins with data and not with
    a blank field; and one line may hold the eleven fields of CORD2R. Both become lines of eight. Of
    DEQATN, whose commas separate arguments, the name is left.

    Parameters
    ----------
    text
        Without comments.
    """
    lines: list[Sequence[bytes]] = []
    origin: list[Indices] = []
    done = copied = 0
    for start in _special(text):
        if start < done:
            continue
        end = start + 1
        folded: list[bytes] | None = [b"DEQATN"]
        if text[start][:6] == b"DEQATN":
            while end < len(text) and text[end][:1] in (b" ", b"+", b"*", b"\t", b""):
                end += 1
        else:
            while end < len(text) and _folded(text[end - 1], text[end]):
                end += 1
            folded = _rows(text[start:end])
        done = end
        if folded is not None:
            lines += [text[copied:start], folded]
            origin += [
                np.arange(copied, start),
                np.minimum(start + np.arange(len(folded)), end - 1),
            ]
            copied = end
    lines.append(text[copied:])
    return joined(lines), np.concatenate([*origin, np.arange(copied, len(text))])


def _special(text: LineTexts) -> list[int]:
    """Return the lines that may need another form, of which a deck has few."""
    free = [
        i
        for i in text.holding(b",").tolist()
        if (line := text[i]).rstrip().endswith(b",") or line[:5] == b"CORD2"
    ]
    equations = [i for i in text.holding(b"DEQATN").tolist() if text[i][:6] == b"DEQATN"]
    return sorted({*free, *equations})


def _folded(line: bytes, following: bytes) -> bool:
    """Whether a line goes on in the next one, which begins with a number."""
    first = following.lstrip()[:1]
    return line.rstrip().endswith(b",") and b"," in following and first.isdigit()


def _rows(lines: LineTexts) -> list[bytes] | None:
    """Fold the fields of one card, or of one line of it, into lines of eight, None if they are."""
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
