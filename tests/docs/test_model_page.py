"""docs/how-to/solve_many_loads.md lists what a file of a reduced model holds."""

import re

from pages import DOCS

from faying.contact.laws import LAWS
from faying.reduction.stored_model import OWN_COORDINATES, OWN_PORTS, TABLES, StoredModel

TEXT = (DOCS / "how-to" / "solve_many_loads.md").read_text(encoding="utf-8")
ROWS = dict(re.findall(r"^\| `(/[^|]*)` \| (.*) \|$", TEXT, re.MULTILINE))


def named(group):
    """What a row lists beside what it takes over from results.h5."""
    own = re.sub(r"(as|but for) .*?(;|$)", "", ROWS[group])
    return re.findall(r"`(\w+)`", own)


def test_members_are_those_that_are_stored():
    assert named("/") == list(TABLES[StoredModel])
    assert named("/ports") == list(OWN_PORTS)
    assert named("/reduced") == list(OWN_COORDINATES)
    assert set(named("/laws/NAME")) >= {"law", *LAWS}
