"""Free-field lines as programs fold them, and equations that are no fields at all."""

import numpy as np

from faying._typing import Indices

_DATA = 8
"""Data fields of a line."""

_LONG = frozenset((b"CORD2R", b"CORD2C", b"CORD2S"))
"""Cards whose eleven fields are written in one line; in others a ninth is likely a slip."""


def unfolded(text: list[bytes]) -> tuple[list[bytes], Indices]:
    """Return lines of bulk data with one way of continuing free-field cards, and where they were.

    A line that ends with a comma goes on in the next one, which then begins with data and not with
    a blank field; and one line may hold the eleven fields of CORD2R. Both become lines of eight. Of
    DEQATN, whose commas separate arguments, the name is left.

    Parameters
    ----------
    text
        Without comments.
    """
    lines: list[bytes] = []
    origin: list[Indices] = []
    done = 0
    for start in _special(text):
        if start < done:
            continue
        end, found = start + 1, [text[start]]
        if text[start][:6] == b"DEQATN":
            found = [b"DEQATN"]
            while end < len(text) and text[end][:1] in (b" ", b"+", b"*", b"\t", b""):
                end += 1
        else:
            while end < len(text) and _folded(text[end - 1], text[end]):
                end += 1
            found = _rows(text[start:end])
        lines += text[done:start] + found
        origin += [np.arange(done, start), np.minimum(start + np.arange(len(found)), end - 1)]
        done = end
    return lines + text[done:], np.concatenate([*origin, np.arange(done, len(text))])


def _special(text: list[bytes]) -> list[int]:
    """Return the lines that may need another form, of which a deck has few."""
    return [
        i
        for i, line in enumerate(text)
        if (b"," in line and (line.rstrip().endswith(b",") or line[:5] == b"CORD2"))
        or line[:6] == b"DEQATN"
    ]


def _folded(line: bytes, following: bytes) -> bool:
    """Whether a line goes on in the next one, which begins with a number."""
    first = following.lstrip()[:1]
    return line.rstrip().endswith(b",") and b"," in following and first.isdigit()


def _rows(lines: list[bytes]) -> list[bytes]:
    """Fold the fields of one card, or of one line of it, into lines of eight."""
    parts = [part.strip() for line in lines for part in line.rstrip().rstrip(b",").split(b",")]
    name, data = parts[0], parts[1:]
    if len(data) <= _DATA or (len(lines) == 1 and name not in _LONG):
        return lines
    marked = len(data) == _DATA + 1 and data[_DATA][:1] in (b"+", b"*")
    if marked or b"*" in name or b" " in name:
        return lines
    rows = [data[k : k + _DATA] for k in range(0, len(data), _DATA)]
    heads = [name] + [b""] * (len(rows) - 1)
    return [b",".join([head, *row]) for head, row in zip(heads, rows, strict=True)]
