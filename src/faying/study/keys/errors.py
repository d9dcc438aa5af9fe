"""Mistakes in a study file, collected into one message for the user."""

import re
import tomllib
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final, Literal

from pydantic_core import PydanticCustomError

from faying.display.facts import bulleted
from faying.exceptions import StudyError

Location = tuple[str | int, ...]
"""Keys and zero-based array indices from the top of a file, e.g. ``("bolt", 0, "preload")``."""

OWN_TYPE: Final = "faying"
"""Type of validation errors whose text is shown unchanged."""

OF_TABLE: Final = "faying_table"
"""Type of such errors about a whole table."""

UNKNOWN_KEY = "unknown_key"
"""Type of the validation error for a key that a table does not have."""


def refusal(
    message: str, kind: Literal["faying", "faying_table"] = OWN_TYPE
) -> PydanticCustomError:
    """Return a validation error whose text is shown unchanged."""
    # pydantic formats the template with its context; braces of the text itself must survive
    return PydanticCustomError(kind, "{message}", {"message": message})


EXPECTED = {
    "float_type": ("a number", "write it without quotes"),
    "finite_number": ("a finite number", "nan and inf are not accepted"),
    "int_type": ("a whole number", "write it without quotes and decimal point"),
    "string_type": ("a text", "put it in quotes"),
    "bool_type": ("true or false", "write it without quotes"),
    "tuple_type": ("a list", "write [first, second, ...], or [[name]] above a table"),
    "dict_type": ("one table", "write { key = value }, or [name] above it"),
    "model_type": ("one table", "write { key = value }, or [name] above it"),
    "path_type": ("a file name", "put it in quotes"),
}
"""What was expected, and how to write it, by type of validation error."""


@dataclass(frozen=True)
class Problem:
    """A mistake: its location, and the text before and after it.

    The line of the location is searched when the message is made.
    """

    location: Location
    behind: str
    before: str = ""
    of_table: bool = False


Mistake = tuple[str | Location, str]
"""A key of a table, or a location within it, and what is wrong there; '' is the table itself."""

Mistakes = Iterator[Mistake]


def located(table: Location, mistakes: Iterable[Mistake]) -> Iterator[Problem]:
    """Yield the mistakes in a table as problems; a location that ends in a number is a table."""
    for key, text in mistakes:
        steps = key if isinstance(key, tuple) else (key,) * bool(key)
        of_table = not steps or isinstance(steps[-1], int)
        yield Problem((*table, *steps), f": {text}", of_table=of_table)


@dataclass(frozen=True)
class StudySource:
    """A study file as read."""

    path: Path
    text: str

    def told(self, problem: Problem) -> str:
        """Return the message of a mistake with its location."""
        where = self.table if problem.of_table else self.place
        return f"{problem.before}{where(problem.location)}{problem.behind}"

    def place(self, location: Location) -> str:
        """Return a location such as "'preload' in [[bolt]] number 1 of S.toml (line 3)"."""
        shown = f"{_described(location)}{self.path.name}"
        line = self._line(location)
        return f"{shown} (line {line})" if line else shown

    def table(self, location: Location) -> str:
        """Return the location of a table such as "[[bolt]] number 1 of S.toml (line 1)"."""
        words = f"{_table(location)} of {self.path.name}" if location else self.path.name
        line = self._line(location)
        return f"{words} (line {line})" if line else words

    def _line(self, location: Location) -> int | None:
        """Return the line of a table, key or entry; of its parent where it is missing."""
        while location:
            line = line_of(self.text, location)
            if line is not None:
                return line
            location = location[:-1]
        return None


def line_of(text: str, location: Location) -> int | None:
    r"""Return the line (from 1) on which a table, key or entry of a TOML text begins.

    tomllib reports no lines: the first line is searched up to which the text contains the location.
    None if the text does not contain it.

    Examples
    --------
    >>> line_of("[[bolt]]\nname = 'M6'\n", ("bolt", 0, "name"))
    2
    """
    lines = text.split("\n")

    def is_there(count: int) -> bool:
        tables: Any = _begun("\n".join(lines[:count]))
        for step in location:
            try:
                tables = tables[step]
            except (LookupError, TypeError):
                return False
        return True

    if not is_there(len(lines)):
        return None
    return bisect_left(range(1, len(lines) + 1), True, key=is_there) + 1


_OPENING = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"{3,5}|\Z)'
    r"|'''.*?(?:'{3,5}|\Z)"
    r'|"(?:\\.|[^"\\\n])*"|#[^\n]*|[\[\]{}]'
    r"|'[^'\n]*'",
    re.DOTALL,
)
"""Texts, comments, and brackets outside of both."""


def _begun(text: str) -> dict[str, Any]:
    """Return the tables in the first lines of a TOML text, in which lists may be open."""
    closing = []
    for token in _OPENING.findall(text):
        if token in ("[", "{"):
            closing.append("]" if token == "[" else "}")
        elif token in ("]", "}"):
            closing.pop()
        elif token[:3] in ('"""', "'''") and (len(token) < 6 or not token.endswith(token[:3])):
            closing.append(token[:3])
    try:
        return tomllib.loads("\n".join([text, "".join(reversed(closing))]))
    except tomllib.TOMLDecodeError:
        return {}


def nearest(word: str, words: Iterable[str]) -> str:
    """Return a hint to the most similar known name, or to all of them.

    Examples
    --------
    >>> nearest("prelaod", ["name", "preload"])
    "did you mean 'preload'?"
    """
    names = [str(name) for name in words]
    meant = guess(word, names)
    return meant or (f"known are {quoted(names)}" if names else "there is none")


def guess(word: str, names: Iterable[str]) -> str:
    """Return a hint to the most similar known name; empty if none is similar."""
    lower = {name.lower(): name for name in names}
    close = get_close_matches(word.lower(), list(lower), n=1)
    return f"did you mean '{lower[close[0]]}'?" if close else ""


def one_of(word: object, names: Sequence[str]) -> str:
    """Return a message that a name is not among the expected ones, with a hint."""
    text = f"found {shown(word)}, expected one of {quoted(names)}"
    meant = guess(str(word), names)
    return f"{text}; {meant}" if meant else text


def quoted(names: Iterable[object]) -> str:
    """Return names in quotes, separated by commas."""
    return ", ".join(f"'{name}'" for name in names)


def reject(source: StudySource, problems: Iterable[Problem]) -> None:
    """Raise one :class:`StudyError` for all problems; return if there are none."""
    lines = list(map(source.told, problems))
    if not lines:
        return
    several = f"{source.path.name}: {len(lines)} mistakes\n{bulleted(lines)}"
    raise StudyError(several if len(lines) > 1 else lines[0])


def translated(error: Mapping[str, Any]) -> Problem:
    """Turn one entry of pydantic's ``ValidationError.errors()`` into a problem."""
    location: Location = tuple(error["loc"])
    kind, value, context = str(error["type"]), error["input"], error.get("ctx", {})
    if kind == UNKNOWN_KEY:
        return Problem((*location, context["key"]), f"; {context['remedy']}", "unknown key ")
    if kind == "missing":
        missing = f"missing key '{location[-1]}' in "
        return Problem(location[:-1], "; add it", missing, of_table=True)
    if kind in (OWN_TYPE, OF_TABLE):
        return Problem(location, f": {error['msg']}", of_table=kind == OF_TABLE)
    if kind == "literal_error":
        choices = context["expected"].replace(" or ", ", ").split(", ")
        names = [name.strip("'") for name in choices]
        return Problem(location, f": {one_of(value, names)}")
    expected = _expectation(kind, context, str(error["msg"]))
    return Problem(location, f": found {shown(value)}, expected {expected}")


def shown(value: object) -> str:
    """Return a value as TOML would write it, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "a list of tables"
    text = f"'{value}'" if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _expectation(kind: str, context: Mapping[str, Any], message: str) -> str:
    """Return what was expected in place of a value, and how to correct it."""
    bounds = {
        "greater_than": "greater than {gt:g}",
        "greater_than_equal": "{ge:g} or more",
        "less_than": "less than {lt:g}",
        "less_than_equal": "{le:g} or less",
        "too_short": "{min_length} or more entries",
        "too_long": "at most {max_length} entries",
        "string_too_short": "a text that is not empty",
    }
    if kind in bounds:
        return bounds[kind].format(**context)
    return "; ".join(EXPECTED.get(kind, (message[:1].lower() + message[1:],)))


def _described(location: Location) -> str:
    """Return a location in words, ending in "of " or "at the top of "."""
    if not location:
        return ""
    *table, last = location
    if isinstance(last, int):
        if not table or isinstance(table[-1], int):
            return f"entry {last + 1} of "
        if len(table) == 1:
            return f"[[{table[0]}]] number {last + 1} of "
        return f"entry {last + 1} of {_described(tuple(table))}"
    if not table:
        return f"'{last}' at the top of "
    return f"'{last}' in {_table(table)} of "


def _table(parts: Sequence[str | int]) -> str:
    """Return a table in words: [a.b], [[a]] number 1, [[a]] number 1, forces number 2."""
    words: list[str] = []
    names: list[str] = []
    for part in parts:
        if isinstance(part, str):
            names.append(part)
            continue
        path = ".".join(names)
        words.append(f"{path if words else f'[[{path}]]'} number {part + 1}")
        names = []
    if names:
        path = ".".join(names)
        words.append(path if words else f"[{path}]")
    return ", ".join(words)
