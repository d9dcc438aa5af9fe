"""Groups of ``results.h5`` and their members: ``python docs/stored_groups.py`` prints them.

The site shows the same, from the docstrings of the stored values.
"""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from typing import Any, get_args, get_origin, get_type_hints

from faying.files.described import SPARSE
from faying.files.meanings import Meaning, Table
from faying.reduction.stored_model import (
    OWN_COORDINATES,
    OWN_PORTS,
    TABLES,
    StoredBoundary,
    StoredCoordinates,
    StoredPorts,
)
from faying.study.results.solved_fields import RecoveredRecord
from faying.study.results.store import MEANINGS
from faying.study.results.values import Results


def _groups(group: str, hint: Any) -> Iterator[tuple[str, type]]:
    """Yield groups and the values they hold; NAME, N and 0 stand for names and numbers."""
    if is_dataclass(hint) and isinstance(hint, type) and hint in MEANINGS:
        yield group or "/", hint
        for name, inner in get_type_hints(hint).items():
            yield from _groups(f"{group}/{name}", inner)
        return
    origin, arguments = get_origin(hint), get_args(hint)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        key = "N" if arguments[0] is int else "NAME"
        yield from _groups(f"{group}/{key}", arguments[1])
    elif origin is tuple:
        yield from _groups(f"{group}/0", arguments[0])
    else:
        for argument in arguments:
            yield from _groups(group, argument)


EVERY = [*_groups("", Results), ("/ of recovered_HISTORY.h5", RecoveredRecord)]

GROUPS = {next(group for group, held in EVERY if held is kind): kind for _, kind in EVERY}
"""The first group of each kind of value."""

MODELS: dict[str, Table] = {
    "/ports": {n: told for n, told in TABLES[StoredPorts].items() if n not in OWN_PORTS},
    "/ports/interpolation": SPARSE,
    "/ports/boundaries/NAME": TABLES[StoredBoundary],
    "/reduced/METHOD/N": {
        n: told for n, told in TABLES[StoredCoordinates].items() if n not in OWN_COORDINATES
    },
}
"""Groups of reduced models and what their members mean."""


def tables() -> dict[str, Table]:
    """Return groups with their members, in the order of the file."""
    return {group: MEANINGS[kind] for group, kind in GROUPS.items()} | MODELS


def page() -> list[str]:
    """Return the lines of the page of the site."""
    lines = ["Groups of results.h5", "====================", ""]
    for group, members in tables().items():
        lines += [group, "-" * len(group), "", ".. list-table::", "   :header-rows: 1", ""]
        lines += _row("member", "axes", "dimension", "what it is")
        for name, meaning in members.items():
            lines += _row(f"``{name}``", meaning.shape, meaning.dimension, meaning.description)
        lines.append("")
    return lines


def _row(*cells: str) -> list[str]:
    first, *others = (" ".join(cell.split()).replace("|", "\\|") for cell in cells)
    return [f"   * - {first}", *(f"     - {cell}" for cell in others)]


def _line(name: str, meaning: Meaning) -> str:
    return f"    {name} {meaning.shape} [{meaning.dimension}] {meaning.description}"


if __name__ == "__main__":
    for group, members in tables().items():
        rows = [group, *(_line(name, meaning) for name, meaning in members.items())]
        sys.stdout.write("\n".join(rows) + "\n")
