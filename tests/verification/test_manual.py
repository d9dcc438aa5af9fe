"""The page of the verification manual says what the program computes."""

import re
from pathlib import Path

import manual
import pytest

TEXT = (Path(__file__).parents[2] / "docs" / "verification.md").read_text()
TABLE = TEXT[TEXT.index(manual.HEAD[0]) :].split("\n\n")[0].splitlines()
NUMBER = re.compile(r"\d+\.?\d*(?:e-?\d+)?")
LONG = (
    "Hertz line contact",
    "Hertz point contact",
    "NAFEMS: punch, a quarter",
    "mass striking a stop",
    "bar on a frictional bed, seven forces",
    "Cattaneo–Mindlin",
)
"""What takes two to ten seconds; the others take less than one."""


def by_problem():
    """Rows of the page by the name in the first of them."""
    found = {}
    for line in TABLE[2:]:
        if name := line.split("|")[1].strip():
            rows = found[name] = []
        rows.append(line)
    return found


def problems():
    for problem in manual.PROBLEMS:
        marks = pytest.mark.long if problem.name in LONG else ()
        yield pytest.param(problem, marks=marks, id=problem.name)


@pytest.mark.parametrize("problem", list(problems()))
def test_the_page_has_what_is_computed(problem):
    printed, found = by_problem()[problem.name], list(manual.lines(problem))
    assert len(printed) == len(found)
    for ours, theirs in zip(found, printed, strict=True):
        assert NUMBER.sub("#", ours) == NUMBER.sub("#", theirs)
        for one, other in zip(NUMBER.findall(ours), NUMBER.findall(theirs), strict=True):
            # Printed figures end in a digit that another processor may round otherwise, and
            # errors have two digits.
            assert float(one) == pytest.approx(float(other), rel=0.02), theirs


def test_the_page_has_all_problems():
    assert tuple(TABLE[:2]) == manual.HEAD
    assert list(by_problem()) == [problem.name for problem in manual.PROBLEMS]
    assert set(LONG) <= set(by_problem())


def test_every_test_it_names_is_there():
    names = re.findall(r"`(test_\w+\.py)`", TEXT)
    here = {path.name for path in Path(__file__).parents[1].rglob("test_*.py")}
    assert names
    assert set(names) <= here
