"""Values of data classes as named arrays, and back by the annotations of their fields.

A member of a member is called ``outer/inner``, as is what a mapping or a tuple of values holds
under a name or number; what is None is left out.
"""

import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints
from urllib.parse import quote, unquote

import numpy as np

from faying._typing import Matrix

T = TypeVar("T")


def flattened(value: object) -> dict[str, Matrix]:
    """Return the members of a value, and theirs, as arrays by name.

    Examples
    --------
    >>> flattened({"tip": {"Fz": -500.0}, "bolts": ("a", "b")})
    {'tip/Fz': array(-500.), 'bolts': array(['a', 'b'], dtype='<U1')}
    """
    if is_dataclass(value):
        members = {entry.name: getattr(value, entry.name) for entry in fields(value)}
    elif isinstance(value, Mapping):
        members = {quote(str(name), safe=""): member for name, member in value.items()}
    elif isinstance(value, tuple) and value and is_dataclass(value[0]):
        members = {str(number): member for number, member in enumerate(value)}
    else:
        texts = isinstance(value, tuple) and all(isinstance(entry, str) for entry in value)
        return {"": np.asarray(value, dtype=str if texts else None)}
    return {
        f"{name}/{inner}" if inner else name: array
        for name, member in members.items()
        if member is not None
        for inner, array in flattened(member).items()
    }


def restored(kind: type[T], arrays: Mapping[str, Matrix]) -> T:
    """Return the value that :func:`flattened` took apart; arrays of other names are ignored.

    Raises
    ------
    KeyError
        If a member is missing that has no default.
    """
    hints, members = get_type_hints(kind), _grouped(arrays)
    values: dict[str, Any] = {}
    for field in fields(kind):  # type: ignore[arg-type]  # data classes alone are asked for
        hint, optional = hints[field.name], False
        if get_origin(hint) in (types.UnionType, Union):
            hint, optional = get_args(hint)[0], True
        if field.name in members:
            values[field.name] = _member(hint, members[field.name])
        elif optional:
            values[field.name] = None
        elif _is_mapping(hint):
            values[field.name] = {}
        elif field.default is MISSING and field.default_factory is MISSING:
            raise KeyError(field.name)
    return kind(**values)


def _grouped(arrays: Mapping[str, Matrix]) -> dict[str, dict[str, Matrix]]:
    """Return arrays by the first part of their names, then by the others."""
    groups: dict[str, dict[str, Matrix]] = {}
    for name, array in arrays.items():
        first, _, inner = name.partition("/")
        groups.setdefault(first, {})[inner] = array
    return groups


def _is_mapping(hint: Any) -> bool:
    return isinstance(get_origin(hint), type) and issubclass(get_origin(hint), Mapping)


def _member(hint: Any, arrays: Mapping[str, Matrix]) -> Any:
    """Return a member as it is annotated."""
    arguments = get_args(hint)
    if is_dataclass(hint):
        return restored(hint, arrays)  # type: ignore[arg-type]
    if _is_mapping(hint):
        inner = _grouped(arrays).items()
        return {arguments[0](unquote(name)): _member(arguments[1], parts) for name, parts in inner}
    if get_origin(hint) is tuple and "" not in arrays:
        return tuple(_member(arguments[0], parts) for parts in _grouped(arrays).values())
    array = arrays[""]
    if get_origin(hint) is tuple:
        return tuple(array.tolist())
    if get_origin(hint) is np.ndarray:
        return np.asarray(array, dtype=get_args(arguments[1])[0])
    return array.item()
