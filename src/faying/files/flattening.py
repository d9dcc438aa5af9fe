"""Dataclasses flattened to named arrays, and restored by the annotations of their fields.

Nested members are called ``outer/inner``, where ``inner`` is a field, a key of a mapping or a
number of a tuple. None is left out, and restored where an array is missing. An empty mapping
is called ``name/``.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, cast
from urllib.parse import quote

import numpy as np

from faying._typing import Matrix
from faying.files.described import is_default, read_value

T = TypeVar("T")


def flattened(value: object) -> dict[str, Matrix]:
    """Return all nested members of a value as arrays by name.

    Examples
    --------
    >>> flattened({"tip": {"Fz": -500.0}, "bolts": ("a", "b")})
    {'tip/Fz': array(-500.), 'bolts': array(['a', 'b'], dtype='<U1')}
    """
    if is_dataclass(value):
        names = [entry.name for entry in fields(value) if not is_default(value, entry.name)]
        members = {name: getattr(value, name) for name in names}
    elif isinstance(value, Mapping):
        members = {quote(str(name), safe=""): member for name, member in value.items()}
    elif isinstance(value, tuple) and value and is_dataclass(value[0]):
        members = {str(number): member for number, member in enumerate(value)}
    else:
        texts = isinstance(value, tuple) and all(isinstance(entry, str) for entry in value)
        return {"": np.asarray(value, dtype=str if texts else None)}
    arrays = {
        f"{name}/{inner}" if inner else name: array
        for name, member in members.items()
        if member is not None
        for inner, array in flattened(member).items()
    }
    empty = [name for name, member in members.items() if isinstance(member, Mapping) and not member]
    return arrays | {f"{name}/": np.zeros(0) for name in empty}


def restored(kind: type[T], arrays: Mapping[str, Matrix]) -> T:
    """Return the value that :func:`flattened` has flattened; arrays of other names are ignored."""
    tree: dict[str, Any] = {}
    for name, array in arrays.items():
        *outer, last = name.split("/")
        group = tree
        for part in outer:
            group = group.setdefault(part, {})
        if last:
            group[last] = array
    return cast("T", read_value(tree, kind, {}))
