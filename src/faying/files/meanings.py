"""Meanings of stored values, read from the docstrings of their classes.

Each entry under ``Attributes`` of a stored dataclass reads

    name : (n_point,) [force/length²]
        What it is.

with the names of its axes (none for scalars) and its dimension in words (``1`` for plain numbers,
none for text and groups). ``[into n_node]`` marks whole numbers that are indices into that axis.
"""

import inspect
import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, get_args, get_type_hints

_ENTRY = re.compile(
    r"(?P<names>\w+(?:, \w+)*)(?: :(?: (?P<shape>\(.*?\)))?(?: \[(?P<dimension>[^]]*)\])?)?"
)
_ROLE = re.compile(r":\w+:`~?\.?([^`]*)`")


@dataclass(frozen=True)
class Meaning:
    """The meaning of a field.

    Attributes
    ----------
    description
    dimension
        Such as ``"force/length²"``; ``"1"`` for plain numbers; empty for text and groups.
    shape
        Names of the axes; empty for scalars.
    index
        Axis of which whole numbers are indices.
    """

    description: str
    dimension: str = ""
    shape: str = ""
    index: str = ""


Table = Mapping[str, Meaning]
"""Meanings of the members of a group by name."""


def meanings(kind: type) -> Table:
    """Return the meanings of the fields of a dataclass, from its docstring and its bases'."""
    said: dict[str, Meaning] = {}
    for base in reversed(inspect.getmro(kind)):
        said.update(_entries(base.__doc__))
    names = [field.name for field in fields(kind)]
    missing = [name for name in names if name not in said or not said[name].description]
    if missing:
        message = (
            f"the docstring of {kind.__name__} does not describe {', '.join(missing)}; "
            "add them there, and run Python without -OO, which drops docstrings"
        )
        raise TypeError(message)
    return {name: said[name] for name in names}


def tables_within(*kinds: type, without: Container[type] = ()) -> dict[type, Table]:
    """Return the tables of dataclasses and of all dataclasses in their fields, but ``without``."""
    tables: dict[type, Table] = {}
    waiting: list[Any] = list(reversed(kinds))
    while waiting:
        kind = waiting.pop()
        if not is_dataclass(kind):
            waiting += reversed(get_args(kind))
        elif isinstance(kind, type) and kind not in tables and kind not in without:
            tables[kind] = meanings(kind)
            waiting += reversed(get_type_hints(kind).values())
    return tables


def _entries(docstring: str | None) -> Iterator[tuple[str, Meaning]]:
    """Yield name and meaning of each entry under ``Attributes``."""
    text = inspect.cleandoc(docstring or "")
    section = re.search(r"^Attributes\n-+\n((?:.*\n?)*?)(?=\n\S+\n-+\n|\Z)", text, re.MULTILINE)
    if section is None:
        return
    for entry in re.split(r"\n(?=\w)", section[1].rstrip()):
        header, _, body = entry.partition("\n")
        match = _ENTRY.fullmatch(header.removesuffix(", optional"))
        if match is None:
            continue
        dimension = match["dimension"] or ""
        points_into = dimension.startswith("into ")
        meaning = Meaning(
            description=_plain(body),
            dimension="1" if points_into else dimension,
            shape=match["shape"] or "",
            index=dimension.removeprefix("into ") if points_into else "",
        )
        for name in match["names"].split(", "):
            yield name, meaning


def _plain(body: str) -> str:
    """Return a description as one line without markup or its final full stop."""
    text = " ".join(body.split()).replace("``", "")
    return _ROLE.sub(r"\1", text).removesuffix(".")
