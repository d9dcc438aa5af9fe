"""The table of methods."""

import pytest

from faying.reduction.methods import METHODS


@pytest.mark.parametrize("fact", ["colour", "marker", "meaning"])
def test_methods_are_told_apart(fact):
    assert len({getattr(method, fact) for method in METHODS.values()}) == len(METHODS)
