"""From what is wrong in a study file to one message for the person who wrote it."""

import re
import tomllib
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
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
"""Type of the validation errors whose text is already meant for people."""

OF_TABLE: Final = "faying_table"
"""The same of errors that are those of a whole table."""

UNKNOWN_KEY = "unknown_key"
"""Type of the validation error for a key that a table does not have."""


def refusal(
    message: str, kind: Literal["faying", "faying_table"] = OWN_TYPE
) -> PydanticCustomError:
    """Return a validation error whose text is shown as it stands."""
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
"""Validation error to what was expected and how to write it."""


@dataclass(frozen=True)
class Problem:
    """One mistake: where, and what is said before and behind that.

    Where in the file a key or table stands is looked for when it is told.
    """

    location: Location
    behind: str
    before: str = ""
    of_table: bool = False


@dataclass(frozen=True)
class StudySource:
    """A study file as read."""

    path: Path
    text: str

    def told(self, problem: Problem) -> str:
        """Return a mistake with where it is."""
        where = self.table if problem.of_table else self.place
        return f"{problem.before}{where(problem.location)}{problem.behind}"

    def place(self, location: Location) -> str:
        """Say where a location is, as in "'preload' in [[bolt]] number 1 of S.toml (line 3)"."""
        shown = f"{_described(location)}{self.path.name}"
        line = self._line(location)
        return f"{shown} (line {line})" if line else shown

    def table(self, location: Location) -> str:
        """Say where a table is, as in "[[bolt]] number 1 of S.toml (line 1)"."""
        words = f"{_table(location)} of {self.path.name}" if location else self.path.name
        line = self._line(location)
        return f"{words} (line {line})" if line else words

    def _line(self, location: Location) -> int | None:
        """Return the line of a table, key or entry, or of what it would stand in."""
        while location:
            line = line_of(self.text, location)
            if line is not None:
                return line
            location = location[:-1]
        return None


def line_of(text: str, location: Location) -> int | None:
    r"""Return the line (from 1) on which a table, key or entry of a TOML text begins.

    It is the first at whose end the text before has it: tomllib reports no lines. None of what is
    not there.

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
"""Texts and comments, and the brackets outside of them."""


def _begun(text: str) -> dict[str, Any]:
    """Return the tables of the beginning of a TOML text, in which lists may still be open."""
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
    """Say which known name is meant, or list them.

    Examples
    --------
    >>> nearest("prelaod", ["name", "preload"])
    "did you mean 'preload'?"
    """
    names = [str(name) for name in words]
    meant = guess(word, names)
    return meant or (f"known are {quoted(names)}" if names else "there is none")


def guess(word: str, names: Iterable[str]) -> str:
    """Say which known name is meant, or nothing if none is near."""
    lower = {name.lower(): name for name in names}
    close = get_close_matches(word.lower(), list(lower), n=1)
    return f"did you mean '{lower[close[0]]}'?" if close else ""


def one_of(word: object, names: Sequence[str]) -> str:
    """Say that something else than one of a few names was found, and which is meant."""
    text = f"found {shown(word)}, expected one of {quoted(names)}"
    meant = guess(str(word), names)
    return f"{text}; {meant}" if meant else text


def quoted(names: Iterable[object]) -> str:
    """Return names as 'a', 'b', 'c'."""
    return ", ".join(f"'{name}'" for name in names)


def reject(source: StudySource, problems: Sequence[Problem]) -> None:
    """Raise one :class:`StudyError` for all problems; return if there are none."""
    if not problems:
        return
    lines = list(map(source.told, problems))
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
    """Say what was expected in place of a value, and how to mend it."""
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
    """Words for a location, ending in "of " or "at the top of "."""
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
    """Words for a table: [a.b], [[a]] number 1, [[a]] number 1, forces number 2."""
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
