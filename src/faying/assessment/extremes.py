"""The load case or place of the smallest or largest value."""

from collections.abc import Mapping
from typing import TypeVar

Name = TypeVar("Name", str, tuple[str, str])


def find_least(values: Mapping[Name, float]) -> tuple[Name, float]:
    """Return the name of the smallest value, the first of several, and that value."""
    name = min(values, key=values.__getitem__)
    return name, values[name]


def find_most(values: Mapping[Name, float]) -> tuple[Name, float]:
    """Return the name of the largest value, the first of several, and that value."""
    name = max(values, key=values.__getitem__)
    return name, values[name]
