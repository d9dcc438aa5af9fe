"""Values as named arrays and back."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pytest

from faying._typing import Indices, Vector
from faying.files.flattening import flattened, restored


@dataclass(frozen=True, kw_only=True)
class Inner:
    level: float
    holds: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Outer:
    name: str
    counts: Indices
    texts: tuple[str, ...]
    by_number: Mapping[int, Inner]
    forces: Mapping[str, Vector] = field(default_factory=dict)
    parts: tuple[Inner, ...] = ()
    inner: Inner | None = None
    error: float | None = None


def test_values_come_back():
    inner = Inner(level=0.5, holds=True)
    value = Outer(
        name="joint",
        counts=np.array([1, 2]),
        texts=("a", "µ"),
        by_number={3: inner, 7: Inner(level=1.0, holds=False)},
        forces={"tip/left": np.array([1.0, 2.0]), "%": np.zeros(0)},
        parts=(inner, inner),
        inner=inner,
    )
    again = restored(Outer, flattened(value))
    assert (again.name, again.texts, again.by_number) == (value.name, value.texts, value.by_number)
    assert (again.parts, again.inner, again.error) == (value.parts, inner, None)
    assert again.inner.holds is True
    assert again.counts.dtype == np.int64
    assert again.forces.keys() == value.forces.keys()
    assert all(np.array_equal(again.forces[name], value.forces[name]) for name in value.forces)


def test_empty_members_come_back():
    value = Outer(name="", counts=np.zeros(0, dtype=np.int64), texts=(), by_number={})
    again = restored(Outer, flattened(value))
    assert (again.texts, again.parts, again.forces, again.by_number) == ((), (), {}, {})


def test_a_missing_member_is_named():
    with pytest.raises(KeyError, match="counts"):
        restored(Outer, {"name": np.array("joint")})
