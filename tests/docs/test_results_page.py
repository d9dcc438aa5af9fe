"""docs/stored_groups.py, from which the site makes its page, knows every stored value."""

import sys

import pytest
from pages import DOCS

from faying.study.results.store import MEANINGS

sys.path.insert(0, str(DOCS))
import stored_groups


def test_every_kind_of_value_has_its_group():
    assert set(stored_groups.GROUPS.values()) == set(MEANINGS)


@pytest.mark.parametrize("group", stored_groups.tables())
def test_every_member_says_what_it_is(group):
    members = stored_groups.tables()[group]
    assert members
    assert all(meaning.description for meaning in members.values())
