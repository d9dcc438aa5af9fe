"""Axes of stored values: what has one name has one length, in a value and all values within it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, is_dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from faying.exceptions import refuse_value
from faying.files.described import is_default
from faying.files.meanings import Meaning, Table

Axes = dict[str, int]
"""Known lengths of axes by name."""

_OPTIONAL = re.compile(r"\[n_time,?\]")
_AXIS = re.compile(r"(?:(\d+) \+ )?(?:(\d+) )?([a-z]\w*)(?: \+ (\d+))?|(\d+)")


@dataclass(frozen=True, kw_only=True)
class ShapeRules:
    """Rules for the arrays of stored dataclasses.

    Attributes
    ----------
    tables
        Meanings of their members.
    axes_within
        Function from a dataclass, its entry in the file and the known axes to the axes within it.
    check_relations
        Function that refuses members that do not fit together, by the same arguments.
    """

    tables: Mapping[type, Table]
    axes_within: Callable[[Any, str, Axes], Axes]
    check_relations: Callable[[Any, str, Axes], None]

    def check(self, value: Any, axes: Axes, entry: str = "") -> None:
        """Refuse a value whose arrays have other axes than their meanings say.

        Indices must lie within their axis, and numbers with a dimension be finite. The axis
        ``[n_time,]`` is there where its length is known.

        Raises
        ------
        ValueError
            With the path of the entry in the file.
        """
        known = dict(self.axes_within(value, entry, axes))
        for name, meaning in self.tables[type(value)].items():
            if not is_default(value, name):
                self._check_member(getattr(value, name), meaning, known, f"{entry}/{name}")
        self.check_relations(value, entry, known)

    def _check_member(self, value: Any, meaning: Meaning, axes: Axes, entry: str) -> None:
        """Check a member; those of a mapping do not share new axes."""
        if value is None:
            return
        if is_dataclass(value):
            self.check(value, axes, entry)
        elif isinstance(value, Mapping):
            for name, member in value.items():
                self._check_member(member, meaning, dict(axes), f"{entry}/{name}")
        elif isinstance(value, tuple) and value and is_dataclass(value[0]):
            for number, member in enumerate(value):
                self.check(member, axes, f"{entry}/{number}")
        elif meaning.shape:
            _check_shape(np.shape(value), meaning.shape, axes, entry)
            values = value.data if sp.issparse(value) else np.asarray(value)
            if meaning.index:
                length = axes[meaning.index]
                if values.size and (values.min() < 0 or values.max() >= length):
                    span = f"from {values.min()} to {values.max()}"
                    refuse_value(f"'{entry}' holds indices {span} into {length}")
            elif meaning.dimension not in ("", "1") and not np.isfinite(values).all():
                refuse_value(f"'{entry}' holds numbers that are not finite")


def _check_shape(shape: tuple[int, ...], meaning: str, axes: Axes, entry: str) -> None:
    text = _OPTIONAL.sub("n_time," if "n_time" in axes else "", meaning.strip("()"))
    names = [name.strip() for name in text.split(",") if name.strip()]
    fits = len(shape) == len(names) and all(
        _fits(length, name, axes) for length, name in zip(shape, names, strict=True)
    )
    if not fits:
        lengths = ", ".join(f"{name} = {axes[name]}" for name in names if name in axes)
        message = f"'{entry}' has shape {shape}, expected {meaning}"
        raise ValueError(f"{message} with {lengths}" if lengths else message)


def _fits(length: int, name: str, axes: Axes) -> bool:
    """Return whether an axis has the length of its name, which the first such axis defines."""
    match = _AXIS.fullmatch(name)
    if match is None or match[5]:
        return name == str(length)
    more = int(match[1] or 0) + int(match[4] or 0)
    count, remainder = divmod(length - more, int(match[2] or 1))
    return remainder == 0 and count >= 0 and axes.setdefault(match[3], count) == count
