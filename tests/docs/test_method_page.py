"""Advice on methods is no wider than what was measured, on more than one joint."""

from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "choose_a_method.md"


def table(header):
    """Rows of the table whose header line starts so, as mappings from column to text."""
    lines = iter(PAGE.read_text(encoding="utf-8").splitlines())
    columns = next(cells(line) for line in lines if line.startswith(header))
    next(lines)
    rows = []
    for line in lines:
        if not line.startswith("|"):
            return rows
        rows.append(dict(zip(columns, cells(line), strict=True)))
    return rows


def cells(line):
    return [cell.strip(" `") for cell in line.strip("|").split("|")]


def percent(text):
    return float(text.removesuffix(" %"))


MEASURED = table("| joint | load |")
ADVICE = {row["you want"]: row["largest errors on the three joints"] for row in table("| you want")}


def measured(method, load):
    return [percent(row[method]) for row in MEASURED if load in row["load"]]


def rounded(value):
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"


def claims(text, method, load):
    """Whether a text contains the range of the measured errors."""
    found = measured(method, load)
    return f"{rounded(min(found))} to {rounded(max(found))} %" in text


def test_every_load_was_measured_on_every_joint():
    joints = {row["joint"] for row in MEASURED}
    loads = {row["load"] for row in MEASURED}
    assert len(joints) >= 3
    assert len(MEASURED) == len(joints) * len(loads)


@pytest.mark.parametrize(
    ("want", "method", "load"),
    [
        ("pressures under loads that rise", "compliance", "rise"),
        ("pressures under loads that rise", "compliance`, 80 modes", "rise"),
        ("pressures after a jump", "compliance", "jump, implicit Euler"),
        ("pressures after a jump", "compliance", "jump, generalized"),
        ("a purely modal model", "jim-b", "static"),
    ],
)
def test_advice_states_the_range_over_the_joints(want, method, load):
    said = next(text for key, text in ADVICE.items() if key.startswith(want))
    assert claims(said, method, load), (said, measured(method, load))


def test_static_errors_of_compliance_are_nil():
    for method in ("compliance", "jim-a+compliance", "compliance`, 80 modes"):
        assert set(measured(method, "static")) == {0.0}
