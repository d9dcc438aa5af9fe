"""A deck as a sequence of keywords, with parts replaced by their instances and steps counted."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from pathlib import Path

import numpy as np

from faying.exceptions import FormatError, refuse
from faying.io.abaqus.instances import instantiated
from faying.io.abaqus.keyword import (
    PARAMETERS,
    Body,
    Keyword,
    Span,
    TextFile,
    is_content,
    keyword_name,
    without_blanks,
)
from faying.io.deck_lines import DeckFiles, with_usual_ends

_PARTS = re.compile(r"(?:^|,)((?:\"[^\"]*\"|'[^']*'|[^,])*)")


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
        refuse(
            f"{file.name}:{file.line(first[1])}: data before the first keyword; a deck starts with "
            "a line such as *HEADING or *NODE"
        )
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
    return Keyword(
        name=keyword_name(name),
        parameters=dict(_parameters(arguments, lambda: f"{file.name}:{file.line(begin)}")),
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
    return [part.strip() for part in _PARTS.findall(text)]


def _parameters(parts: list[str], where: Callable[[], str]) -> Iterator[tuple[str, str]]:
    seen = set()
    for part in parts:
        name, _, value = part.partition("=")
        name = without_blanks(name)
        if not part:
            continue
        if not name or name in seen:
            problem = "has no name" if not name else "is given twice"
            refuse(f"{where()}: the parameter '{part}' {problem}; correct the keyword line")
        seen.add(name)
        value = value.strip()
        if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'":
            value = value[1:-1]
        yield name, value.strip()


@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """Keywords in their order.

    Attributes
    ----------
    n_step
        Number of steps.
    path
        The deck, for messages that concern all of it.
    ignore
        What is left out on request: words of :data:`faying.io.left_out.IGNORABLE`.
    ignored
        Notes so far; readers append theirs.
    """

    keywords: Sequence[Keyword]
    n_step: int
    path: Path
    ignore: frozenset[str] = frozenset()
    ignored: list[str] = field(default_factory=list)

    def of(self, *names: str) -> list[Keyword]:
        """Return the keywords of these names."""
        return [keyword for keyword in self.keywords if keyword.name in names]

    def without(self, *names: str) -> "Deck":
        """Return the deck without the keywords of these names."""
        return replace(self, keywords=[k for k in self.keywords if k.name not in names])

    @property
    def perturbations(self) -> frozenset[int]:
        """The steps that are linear perturbations: loads of other steps do not act in them."""
        return frozenset(k.step for k in self.of("STEP") if k.has("PERTURBATION"))

    def until(self, step: int | None) -> "Deck":
        """Return the deck as it is in one step: model data and steps up to it.

        Linear perturbation steps leave nothing behind for later ones; by default the last other
        step is taken.
        """
        aside = self.perturbations
        general = [number for number in range(1, self.n_step + 1) if number not in aside]
        chosen = step if step is not None else (general[-1] if general else self.n_step)
        if step is not None and not 1 <= step <= self.n_step:
            refuse(f"{self.path}: there is no step {step}; the deck has {self.n_step}")
        keywords = [
            k
            for k in self.keywords
            if k.step == chosen or (k.step < chosen and k.step not in aside)
        ]
        return replace(self, keywords=keywords, n_step=chosen)

    def groups(self, head: str, *members: str) -> Iterator[tuple[Keyword, list[Keyword]]]:
        """Return each head with the members that follow it."""
        groups: list[tuple[Keyword, list[Keyword]]] = []
        for keyword in self.keywords:
            if keyword.name == head:
                groups.append((keyword, []))
            elif keyword.name in members and groups:
                if any(member.name == keyword.name for member in groups[-1][1]):
                    keyword.refuse(f"the *{head} above has one already; remove one of them")
                groups[-1][1].append(keyword)
            elif keyword.name in members:
                keyword.refuse(f"it must follow *{head}")
        return iter(groups)


_CHECKED_WHERE_READ = frozenset(
    (
        *("AMPLITUDE", "ORIENTATION", "EXPANSION", "INITIAL CONDITIONS"),
        *("FRICTION", "SURFACE BEHAVIOR"),
    )
)
"""Keywords whose parameters matter only where something uses them."""


def check_parameters(deck: Deck) -> None:
    """Refuse parameters that the table has not, of all keywords that are read in any case."""
    for keyword in deck.keywords:
        if keyword.name in PARAMETERS and keyword.name not in _CHECKED_WHERE_READ:
            keyword.check()


def read_keyword_deck(path: Path, ignore: frozenset[str] = frozenset()) -> Deck:
    """Read a deck into keywords, whose data nobody has looked at."""
    keywords = instantiated(read_keywords(read_spans(path)))
    if not keywords:
        refuse(f"{path}: the deck is empty; it needs *NODE, *ELEMENT, …")
    numbered, step, inside = [], 0, False
    for keyword in keywords:
        if keyword.name == "STEP":
            if inside:
                keyword.refuse("a step before this one does not end; add *END STEP")
            step, inside = step + 1, True
        numbered.append(replace(keyword, step=step if inside else 0))
        if keyword.name == "END STEP":
            if not inside:
                keyword.refuse("there is no *STEP that it ends")
            inside = False
    _check_order(numbered)
    return Deck(keywords=numbered, n_step=step, path=path, ignore=ignore)


def _check_order(keywords: Sequence[Keyword]) -> None:
    """Refuse model data after a step; both programs do."""
    steps = np.array([keyword.step for keyword in keywords])
    inside = np.flatnonzero(steps)
    if not inside.size:
        return
    for keyword in keywords[int(inside[0]) :]:
        if keyword.step == 0:
            keyword.refuse("it stands between or behind steps; move it before the first *STEP")


_INCLUDE = re.compile(rb"^\s*\*\s*INCLUDE\s*,", re.IGNORECASE)
_INPUT = re.compile(rb"INPUT\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^,]*))", re.IGNORECASE)


def read_spans(path: Path) -> list[Span]:
    """Read a deck and what it includes, as pieces of files in their order.

    Included files are looked for beside the deck, where both programs run, then beside the file
    that includes them.
    """
    return _expand(path, path.parent, DeckFiles("input deck", "*INCLUDE"), (), "")


def _expand(
    path: Path, home: Path, files: DeckFiles, parents: tuple[Path, ...], included_from: str
) -> list[Span]:
    text = with_usual_ends(files.read(path, included_from, parents))
    file = TextFile(name=files.names[-1], text=text)
    parts, start = [], 0
    for begin, end in Span(file=file, start=0, end=len(text)).starred():
        line = text[begin:end]
        if not (b"*" in line[:8] and _INCLUDE.match(line)):
            continue
        parts.append(Span(file=file, start=start, end=begin))
        origin = f"{file.name}:{file.line(begin)}"
        name = _file_name(line, origin)
        places = (home / name, path.parent / name)
        included = next(
            (candidate for candidate in places if _is_file(candidate, origin)), places[0]
        )
        parts += _expand(included, home, files, (*parents, path.resolve()), origin)
        start = min(end + 1, len(text))
    parts.append(Span(file=file, start=start, end=len(text)))
    return parts


def _is_file(path: Path, origin: str) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for any file
        return False
    except ValueError as error:  # a path with a NUL character
        message = f"{origin}: *INCLUDE names an impossible path; correct it"
        raise FormatError(message) from error


def _file_name(line: bytes, origin: str) -> str:
    match = _INPUT.search(line)
    name = next((group for group in match.groups() if group), b"") if match else b""
    if not name.strip():
        refuse(f"{origin}: *INCLUDE names no file; give INPUT=file")
    return name.strip().decode("utf-8", "surrogateescape")
