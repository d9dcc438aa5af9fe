"""Lines of a deck to keywords with parameters and data lines."""

import re
from collections.abc import Iterator

import numpy as np

from faying.exceptions import FormatError
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.keyword_names import keyword_name, without_blanks
from faying.io.deck_lines import Lines

_PARTS = re.compile(r"\"[^\"]*\"|'[^']*'|[^,]")


def read_keywords(lines: Lines) -> list[Keyword]:
    """Split a deck into its keywords, in order.

    A keyword line that ends in a comma continues on the next line; ``**`` starts a comment, and so
    does ``>*``, which stands before the first lines of some decks of CalculiX.

    Raises
    ------
    FormatError
        If data stand before the first keyword, or a keyword line cannot be understood.

    Notes
    -----
    About 0.3 µs a line.
    """
    marks = [t.lstrip()[:2] for t in lines.text]
    # Comments and blank lines belong to nothing; "*" alone starts a keyword.
    content = [i for i, mark in enumerate(marks) if mark and mark not in (b"**", b">*")]
    starts = [k for k, i in enumerate(content) if marks[i][:1] == b"*"]
    if content and (not starts or starts[0]):
        message = (
            f"{lines.where(content[0])}: data before the first keyword; a deck starts with a line "
            "such as *HEADING or *NODE"
        )
        raise FormatError(message)
    ends = [*starts[1:], len(content)][: len(starts)]
    return [_keyword(lines, content[start:end]) for start, end in zip(starts, ends, strict=True)]


def _keyword(lines: Lines, content: list[int]) -> Keyword:
    used, text = 1, _decoded(lines, content[0])
    while text.endswith(",") and used < len(content) and _is_continuation(lines, content[used]):
        text += " " + _decoded(lines, content[used])
        used += 1
    name, *rest = _split(text.lstrip("* \t"))
    data = np.array(content[used:], dtype=np.int64)
    where = lines.where(content[0])
    return Keyword(
        name=keyword_name(name),
        parameters=dict(_parameters(rest, where)),
        data=[lines.text[i] for i in content[used:]],
        line=content[0],
        data_lines=data,
        lines=lines,
    )


def _is_continuation(lines: Lines, line: int) -> bool:
    """Whether a line looks like parameters: a letter first, for data start with numbers or sets."""
    first = lines.text[line].split(b",")[0]
    return b"=" in first or first.strip().upper() in _FLAGS


_FLAGS = frozenset(
    (b"GENERATE", b"UNSORTED", b"INTERNAL", b"SMALL SLIDING", b"NLGEOM", b"PERTURBATION", b"FIXED")
)


def _decoded(lines: Lines, line: int) -> str:
    return lines.text[line].decode("latin-1").strip()


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


def _parameters(parts: list[str], where: str) -> Iterator[tuple[str, str]]:
    seen = set()
    for part in parts:
        name, _, value = part.partition("=")
        name = without_blanks(name)
        if not part:
            continue
        if not name or name in seen:
            problem = "has no name" if not name else "is given twice"
            message = f"{where}: the parameter '{part}' {problem}; correct the keyword line"
            raise FormatError(message)
        seen.add(name)
        value = value.strip()
        if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'":
            value = value[1:-1]
        yield name, value.strip()
