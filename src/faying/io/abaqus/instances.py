"""Parts, assembly and instances: every instance becomes a copy of its part's keywords."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.io.abaqus.fields import check_count, integers, numbers, table
from faying.io.abaqus.keyword import Keyword, Scope, add, named

_ASSEMBLY = "the assembly's own nodes and elements"
_CLOSING = {"PART": "END PART", "INSTANCE": "END INSTANCE", "ASSEMBLY": "END ASSEMBLY"}


def instantiated(keywords: Sequence[Keyword]) -> list[Keyword]:
    """Replace parts and instances by the keywords they stand for, in the scope of the instance.

    A deck without parts comes back as it is.
    """
    if not any(keyword.name in _CLOSING for keyword in keywords):
        return list(keywords)
    parts: dict[str, list[Keyword]] = {}
    result: list[Keyword] = []
    i = 0
    names: list[str] = []
    while i < len(keywords):
        keyword = keywords[i]
        if keyword.name == "PART":
            keyword.check()
            end = _end(keywords, i)
            members = list(keywords[i + 1 : end])
            add(parts, keyword, keyword.required("NAME"), members, "parts")
            i = end
        elif keyword.name == "INSTANCE":
            end = _end(keywords, i)
            inside, scope = _instance(keyword, keywords[i + 1 : end], parts)
            if scope.name.upper() in map(str.upper, names):
                keyword.refuse(f"there are two instances '{scope.name}'; rename one of them")
            names.append(scope.name)
            result += [replace(member, scope=scope) for member in inside]
            i = end
        elif keyword.name == "ASSEMBLY":
            _end(keywords, i)
        elif keyword.name != "END ASSEMBLY":
            result.append(keyword)
        i += 1
    return result


def _end(keywords: Sequence[Keyword], start: int) -> int:
    closing = _CLOSING[keywords[start].name]
    for i in range(start + 1, len(keywords)):
        if keywords[i].name == closing:
            return i
        if keywords[i].name in ("PART", keywords[start].name):
            break
    message = f"it does not end; add *{closing}"
    raise keywords[start].error(message)


def _instance(
    keyword: Keyword, keywords: Sequence[Keyword], parts: dict[str, list[Keyword]]
) -> tuple[list[Keyword], Scope]:
    keyword.check()
    name, part = keyword.required("NAME"), keyword.required("PART")
    members = named(keyword, part, parts, "part")
    rotation, translation = _position(keyword)
    scope = Scope(name=name, rotation=rotation, translation=translation)
    return [*members, *keywords], scope


def _position(keyword: Keyword) -> tuple[Matrix, Vector]:
    """Rotation and translation of an instance: first moved, then turned about an axis."""
    rows = keyword.rows()
    if len(rows) > 2:
        keyword.refuse("found more than two data lines; expected a translation and a rotation", 2)
    rotation, shift = np.eye(3), np.zeros(3)
    if rows:
        check_count(keyword, 0, rows[0], (3,), "a translation (3 numbers)")
        shift = np.array(numbers(keyword, 0, rows[0], "a translation"))
    if len(rows) == 2:
        check_count(keyword, 1, rows[1], (7,), "two points of an axis and an angle (7 numbers)")
        values = np.array(numbers(keyword, 1, rows[1], "a coordinate or an angle"))
        first, second, angle = values[:3], values[3:6], np.radians(values[6])
        length = float(np.linalg.norm(second - first))
        if not length > 0:
            keyword.refuse("the two points of the axis are the same", 1)
        rotation = _rotation((second - first) / length, float(angle))
        shift = rotation @ (shift - first) + first
    return rotation, shift


def _rotation(axis: Vector, angle: float) -> Matrix:
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def with_distinct_ids(keywords: Sequence[Keyword], ignored: list[str]) -> list[Keyword]:
    """Give ids of different scopes different ranges, if more than one scope has nodes.

    Ids may repeat between instances; those of each are then raised by a power of ten times its
    number, which ``ignored`` says before all else.
    """
    names = list(dict.fromkeys(keyword.scope.name for keyword in keywords if keyword.scope.name))
    if not names:
        return list(keywords)
    largest: dict[str, int] = {}
    for keyword in keywords:
        if keyword.name in ("NODE", "ELEMENT"):
            fields = table(keyword)
            # Continuation lines of elements start with node ids, which do no harm here.
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
