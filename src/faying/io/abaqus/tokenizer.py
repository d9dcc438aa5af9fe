"""Lines of a deck to keywords with parameters and data lines."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest

from faying.exceptions import FormatError
from faying.io.abaqus.file_spans import Body, Span, TextFile, is_content
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.keyword_table import keyword_name, without_blanks

_PARTS = re.compile(r"\"[^\"]*\"|'[^']*'|[^,]")


def read_keywords(parts: Sequence[Span]) -> list[Keyword]:
    """Split a deck into its keywords, in order.

    A keyword line that ends in a comma continues on the next line.

    Notes
    -----
    Data lines are not touched: about a second for 2 GB.
    """
    heads = [
        (number, begin, end)
        for number, part in enumerate(parts)
        for begin, end in part.starred()
        if is_content(part.file.text[begin:end])
    ]
    first = next(((n, begin) for n, p in enumerate(parts) for begin, _ in p.content()), None)
    if first is not None and (not heads or heads[0][:2] != first):
        file = parts[first[0]].file
        message = (
            f"{file.name}:{file.line(first[1])}: data before the first keyword; a deck starts with "
            "a line such as *HEADING or *NODE"
        )
        raise FormatError(message)
    return [_keyword(parts, head, following) for head, following in zip_longest(heads, heads[1:])]


_Head = tuple[int, int, int]
"""Span, and where the line of a keyword begins and ends."""


def _keyword(parts: Sequence[Span], head: _Head, following: _Head | None) -> Keyword:
    number, begin, end = head
    file = parts[number].file
    text = _decoded(file.text[begin:end])
    body = _between(parts, head, following)
    while text.endswith(","):
        content = next(((k, span) for k, p in enumerate(body) for span in p.content()), None)
        if content is None:
            break
        k, (start, stop) = content
        line = body[k].file.text[start:stop]
        if not _is_continuation(line):
            break
        text += " " + _decoded(line)
        body = [replace(body[k], start=min(stop + 1, body[k].end)), *body[k + 1 :]]
    name, *arguments = _split(text.lstrip("* \t"))
    place_of = partial(_place, file, begin)
    return Keyword(
        name=keyword_name(name),
        parameters=dict(_parameters(arguments, place_of)),
        body=Body(spans=tuple(body)),
        file=file,
        begin=begin,
    )


def _between(parts: Sequence[Span], head: _Head, following: _Head | None) -> list[Span]:
    """Return the pieces of the deck from behind a keyword's line to the next keyword."""
    number, _, end = head
    last = len(parts) - 1 if following is None else following[0]
    between = []
    for k in range(number, last + 1):
        part = parts[k]
        start = min(end + 1, part.end) if k == number else part.start
        stop = part.end if following is None or k < last else following[1]
        if start < stop:
            between.append(replace(part, start=start, end=stop))
    return between


def _place(file: TextFile, begin: int) -> str:
    return f"{file.name}:{file.line(begin)}"


def _is_continuation(line: bytes) -> bool:
    """Whether a line looks like parameters: a letter first, for data start with numbers or sets."""
    first = line.split(b",")[0]
    return b"=" in first or first.strip().upper() in _FLAGS


_FLAGS = frozenset(
    (b"GENERATE", b"UNSORTED", b"INTERNAL", b"SMALL SLIDING", b"NLGEOM", b"PERTURBATION", b"FIXED")
)


def _decoded(line: bytes) -> str:
    return line.decode("latin-1").strip()


def _split(text: str) -> list[str]:
    """Split at commas outside quotes."""
    parts = [""]
    position = 0
    while position < len(text):
        match = _PARTS.match(text, position)
        if match is None:
            parts.append("")
            position += 1
        else:
            parts[-1] += match.group()
            position = match.end()
    return [part.strip() for part in parts]


def _parameters(parts: list[str], where: Callable[[], str]) -> Iterator[tuple[str, str]]:
    seen = set()
    for part in parts:
        name, _, value = part.partition("=")
        name = without_blanks(name)
        if not part:
            continue
        if not name or name in seen:
            problem = "has no name" if not name else "is given twice"
            message = f"{where()}: the parameter '{part}' {problem}; correct the keyword line"
            raise FormatError(message)
        seen.add(name)
        value = value.strip()
        if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'":
            value = value[1:-1]
        yield name, value.strip()
