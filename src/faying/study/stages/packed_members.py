"""Values whose members are numbers, text or arrays, as named arrays until the run ends."""

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from faying._typing import Matrix

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")


def packed_members(value: "DataclassInstance") -> dict[str, Matrix]:
    """Return the members of a value by name; what is None is left out."""
    members = {one.name: getattr(value, one.name) for one in fields(value)}
    return {name: np.asarray(member) for name, member in members.items() if member is not None}


def unpacked_members(kind: type[T], arrays: Mapping[str, Matrix]) -> T:
    """Return the value that :func:`packed_members` took apart."""
    members: dict[str, Any] = {one.name: arrays.get(one.name) for one in fields(kind)}
    return kind(
        **{
            name: member.item() if isinstance(member, np.ndarray) and not member.ndim else member
            for name, member in members.items()
        }
    )
