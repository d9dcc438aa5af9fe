"""A deck as a sequence of keywords, with parts replaced by their instances."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from faying._typing import Matrix, Vector
from faying.exceptions import refuse
from faying.io.abaqus.fields import integers, lines, table
from faying.io.abaqus.keyword import (
    PARAMETERS,
    Body,
    Keyword,
    Scope,
    add,
    is_content,
    keyword_name,
    named,
    without_blanks,
)
from faying.io.deck_lines import Dialect, Lines, LineTexts, read_lines

_PARTS = re.compile(r"(?:^|,)((?:\"[^\"]*\"|'[^']*'|[^,])*)")


def read_keywords(lines: Lines) -> list[Keyword]:
    """Split a deck into its keywords, in order.

    A keyword line that ends in a comma continues on the next line. Data lines are not parsed.
    """
    text = lines.text
    heads = [
        i
        for i in text.holding(b"*").tolist()
        if text[i].lstrip()[:1] == b"*" and is_content(text[i])
    ]
    first = next((i for i in range(len(text)) if is_content(text[i])), None)
    if first is not None and heads[:1] != [first]:
        refuse(
            f"{lines.where(first)}: data before the first keyword; a deck starts with "
            "a line such as *HEADING or *NODE"
        )
    return [_keyword(lines, i, end) for i, end in pairwise([*heads, len(text)])]


def _keyword(lines: Lines, begin: int, end: int) -> Keyword:
    head, start, where = _decoded(lines.text[begin]), begin + 1, lines.where(begin)
    while head.endswith(","):
        k = next((k for k in range(start, end) if is_content(lines.text[k])), end)
        if k == end or not _is_continuation(lines.text[k]):
            break
        head, start = f"{head} {_decoded(lines.text[k])}", k + 1
    name, *arguments = (part.strip() for part in _PARTS.findall(head.lstrip("* \t")))
    return Keyword(
        name=keyword_name(name),
        parameters=dict(_parameters(arguments, where)),
        body=Body(lines[start:end]),
        place=where,
    )


def _is_continuation(line: bytes) -> bool:
    """Return whether a line looks like parameters rather than data."""
    first = line.split(b",")[0]
    return b"=" in first or first.strip().upper() in _FLAGS


_FLAGS = frozenset(
    (b"GENERATE", b"UNSORTED", b"INTERNAL", b"SMALL SLIDING", b"NLGEOM", b"PERTURBATION", b"FIXED")
)


def _decoded(line: bytes) -> str:
    return line.decode("latin-1").strip()


def _parameters(parts: list[str], where: str) -> Iterator[tuple[str, str]]:
    seen = set()
    for part in parts:
        name, _, value = part.partition("=")
        name = without_blanks(name)
        if not part:
            continue
        if not name or name in seen:
            problem = "has no name" if not name else "is given twice"
            refuse(f"{where}: the parameter '{part}' {problem}; correct the keyword line")
        seen.add(name)
        value = value.strip()
        if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'":
            value = value[1:-1]
        yield name, value.strip()


@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """The keywords of a deck in order.

    Attributes
    ----------
    n_step
        Number of steps.
    path
        Path of the deck, for messages.
    ignore
        Words of :data:`faying.io.left_out.IGNORABLE` for content to leave out.
    ignored
        Notes, to which readers append.
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
    def offsets(self) -> dict[str, int]:
        """Offset of the ids of each instance, by upper-case name."""
        scopes = (keyword.scope for keyword in self.keywords)
        return {scope.name.upper(): scope.offset for scope in scopes if scope.name}

    @property
    def perturbations(self) -> frozenset[int]:
        """Linear perturbation steps, in which loads of other steps do not act."""
        return frozenset(k.step for k in self.of("STEP") if k.has("PERTURBATION"))

    def until(self, step: int | None) -> "Deck":
        """Return the deck up to a step: model data and steps.

        Linear perturbation steps do not affect later ones; by default the last other
        step is chosen.
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
        """Return each head keyword with the member keywords that follow it."""
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
"""Keywords whose parameters are checked only where they are used."""


def check_parameters(deck: Deck) -> None:
    """Refuse unknown parameters of all keywords that are always read."""
    for keyword in deck.keywords:
        if keyword.name in PARAMETERS and keyword.name not in _CHECKED_WHERE_READ:
            keyword.check()


def read_keyword_deck(path: Path, ignore: frozenset[str] = frozenset()) -> Deck:
    """Read a deck into keywords, without parsing their data."""
    keywords = instantiated(read_keywords(read_lines(path, DIALECT)))
    if not keywords:
        refuse(f"{path}: the deck is empty; it needs *NODE, *ELEMENT, …")
    numbered, step, inside = [], 0, False
    for keyword in keywords:
        if keyword.name == "STEP":
            if inside:
                keyword.refuse("a step before this one does not end; add *END STEP")
            step, inside = step + 1, True
        elif keyword.name == "END STEP" and not inside:
            keyword.refuse("it has no *STEP before it; remove it")
        elif step and not inside:  # both programs refuse it
            keyword.refuse("it is between or after steps; move it before the first *STEP")
        numbered.append(replace(keyword, step=step if inside else 0))
        inside = inside and keyword.name != "END STEP"
    return Deck(keywords=numbered, n_step=step, path=path, ignore=ignore)


_INCLUDE = re.compile(rb"^\s*\*\s*INCLUDE\s*,", re.IGNORECASE)
_INPUT = re.compile(rb"INPUT\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^,]*))", re.IGNORECASE)


def _includes(text: LineTexts, where: Callable[[int], str]) -> Iterator[tuple[int, int, str]]:
    """Yield first line, line after the last, and file name of each *INCLUDE."""
    for i in text.holding(b"*").tolist():
        if _INCLUDE.match(text[i]):
            yield i, i + 1, _file_name(text[i], where(i))


def _file_name(line: bytes, origin: str) -> str:
    match = _INPUT.search(line)
    name = next((group for group in match.groups() if group), b"") if match else b""
    if not name.strip():
        refuse(f"{origin}: *INCLUDE names no file; give INPUT=file")
    return name.strip().decode("utf-8", "surrogateescape")


DIALECT = Dialect(kind="input deck", include="*INCLUDE", statements=_includes, deck_first=True)
"""Included files are searched beside the deck, where both programs run, then beside the file that
includes them."""


_ASSEMBLY = "the assembly's own nodes and elements"
_PARTS_OF_DECKS = ("PART", "INSTANCE", "ASSEMBLY")


def instantiated(keywords: Sequence[Keyword]) -> list[Keyword]:
    """Return keywords with instances replaced by the keywords of their parts.

    A deck without parts is unchanged.
    """
    parts: dict[str, list[Keyword]] = {}
    result: list[Keyword] = []
    names: set[str] = set()
    opened: list[Keyword] = []
    members, scope = result, Scope()
    for keyword in keywords:
        kind = keyword.name.removeprefix("END ")
        if kind not in _PARTS_OF_DECKS:
            members.append(replace(keyword, scope=scope) if scope.name else keyword)
            continue
        if keyword.name != kind:
            if not opened or opened[-1].name != kind:
                keyword.refuse(f"it has no *{kind} before it; remove it")
            opened.pop()
            members, scope = result, Scope()
            continue
        if kind == "PART" or any(other.name in (kind, "PART") for other in opened):
            _check_closed(opened)
        opened.append(keyword)
        if kind == "PART":
            keyword.check()
            members = []
            add(parts, keyword, keyword.required("NAME"), members, "parts")
        elif kind == "INSTANCE":
            keyword.check()
            rotation, translation = _position(keyword)
            scope = Scope(name=keyword.required("NAME"), rotation=rotation, translation=translation)
            if scope.name.upper() in names:
                keyword.refuse(f"there are two instances '{scope.name}'; rename one of them")
            names.add(scope.name.upper())
            part = named(keyword, keyword.required("PART"), parts, "part")
            result += [replace(member, scope=scope) for member in part]
    _check_closed(opened)
    return result


def _check_closed(opened: Sequence[Keyword]) -> None:
    if opened:
        opened[-1].refuse(f"it does not end; add *END {opened[-1].name}")


def _position(keyword: Keyword) -> tuple[Matrix, Vector]:
    """Return rotation and translation of an instance: first moved, then rotated about an axis."""
    rows = lines(keyword)
    if len(rows) > 2:
        rows[2].refuse("found more than two data lines; expected a translation and a rotation")
    rotation, shift = np.eye(3), np.zeros(3)
    if rows:
        rows[0].check((3,), "a translation (3 numbers)")
        shift = np.array(rows[0].reals("a translation"))
    if len(rows) == 2:
        rows[1].check((7,), "two points of an axis and an angle (7 numbers)")
        values = np.array(rows[1].reals("a coordinate or an angle"))
        first, second, angle = values[:3], values[3:6], np.radians(values[6])
        length = float(np.linalg.norm(second - first))
        if not length > 0:
            keyword.refuse("the two points of the axis are the same", 1)
        rotation = Rotation.from_rotvec((second - first) / length * angle).as_matrix()
        shift = rotation @ (shift - first) + first
    return rotation, shift


def with_distinct_ids(keywords: Sequence[Keyword], ignored: list[str]) -> list[Keyword]:
    """Return keywords whose ids have separate ranges, if more than one scope has nodes.

    Ids may repeat between instances; the ids of each are then raised by a power of ten times its
    number, as the first entries of ``ignored`` state.
    """
    names = list(dict.fromkeys(keyword.scope.name for keyword in keywords if keyword.scope.name))
    if not names:
        return list(keywords)
    largest: dict[str, int] = {}
    for keyword in keywords:
        if keyword.name in ("NODE", "ELEMENT"):
            fields = table(keyword)
            # Continuation lines of elements start with node ids, which are harmless here.
            first = np.flatnonzero(np.diff(fields.row, prepend=-1))
            ids = integers(fields.texts[first], keyword, fields.row[first], "an id")
            name = keyword.scope.name
            largest[name] = max(largest.get(name, 0), int(ids.max(initial=0)))
    if len(largest) < 2:
        return list(keywords)
    step = 10 ** len(str(max(largest.values())))
    ordered = sorted(largest, key=lambda name: names.index(name) if name else len(names))
    offsets = {name: number * step for number, name in enumerate(ordered)}
    places = {name: f"instance '{name}'" if name else _ASSEMBLY for name in offsets}
    ignored[:0] = [
        f"ids of {places[name]} are raised by {offset}"
        for name, offset in offsets.items()
        if offset
    ]
    return [
        replace(k, scope=replace(k.scope, offset=offsets.get(k.scope.name, 0))) for k in keywords
    ]
