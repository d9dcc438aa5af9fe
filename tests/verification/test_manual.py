"""The page of the verification manual says what the program computes."""

import re
from pathlib import Path

import manual
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "verification.md"
NUMBER = re.compile(r"\d+\.?\d*(?:e-?\d+)?")


@pytest.fixture(scope="module")
def found():
    return list(manual.lines())


def test_the_page_has_the_table(found):
    text = PAGE.read_text()
    text = text[text.index(found[0]) :].split("\n\n")[0]
    printed = text.splitlines()
    assert len(printed) == len(found)
    for ours, theirs in zip(found, printed, strict=True):
        assert NUMBER.sub("#", ours) == NUMBER.sub("#", theirs)
        for one, other in zip(NUMBER.findall(ours), NUMBER.findall(theirs), strict=True):
            # Printed figures end in a digit that another processor may round otherwise, and
            # errors have two digits.
            assert float(one) == pytest.approx(float(other), rel=0.02), theirs


def test_every_test_it_names_is_there():
    names = re.findall(r"`(test_\w+\.py)`", PAGE.read_text())
    here = {path.name for path in Path(__file__).parents[1].rglob("test_*.py")}
    assert names
    assert set(names) <= here
