"""``*SURFACE BEHAVIOR``: pressure over closure."""

from typing import Literal

import numpy as np

from faying.contact.laws import Curve, ExponentialClosure, TableClosure
from faying.exceptions import ModelError
from faying.io.abaqus.fields import numbers, only_line, optional_real, positive
from faying.io.abaqus.keyword import Keyword

Normal = float | Literal["hard"] | Curve
"""Contact stiffness [force/length³], or pressure over closure."""

_FLAGS = ("PENALTY", "DIRECT", "AUGMENTED LAGRANGE", "NO SEPARATION")


def read_behaviour(
    head: Keyword, members: list[Keyword], abaqus: bool, ignored: list[str]
) -> Normal:
    """Return the normal behaviour of an interaction; hard where it says nothing.

    ``abaqus`` says that only Abaqus reads the deck.
    """
    penalty: Normal = "hard"
    for member in members:
        if member.name == "SURFACE BEHAVIOR":
            penalty = _surface_behavior(member, abaqus, ignored)
        elif member.name == "GAP CONDUCTANCE":
            ignored.append(f"*{member.name} of {head.value('NAME')}")
    return penalty


def _surface_behavior(keyword: Keyword, abaqus: bool, ignored: list[str]) -> Normal:
    keyword.check()
    if keyword.has("NO SEPARATION"):
        keyword.refuse("NO SEPARATION is not supported; faying's contact opens")
    ignored += [
        f"{flag} of *SURFACE BEHAVIOR: faying enforces contact in its own way"
        for flag in _FLAGS
        if keyword.has(flag)
    ]
    kind = keyword.choice("PRESSURE-OVERCLOSURE")
    if kind == "HARD":
        return "hard"
    if kind in ("EXPONENTIAL", "TABULAR"):
        return _curve(keyword, kind, abaqus)
    fields = only_line(keyword, range(1, 4), "the slope (pressure per overclosure)")
    slope = positive(keyword, 0, fields[0], "the slope")
    for column in range(1, len(fields)):
        # CalculiX: tension at large clearance and its range, for node-to-surface contact only.
        optional_real(keyword, 0, fields, column, 0.0, "a number")
        ignored.append("tension and range behind the slope of *SURFACE BEHAVIOR")
    return slope


_STEP, _LARGEST = 0.05, 12.0
"""Between the rows of CalculiX's exponential, and its last, by the logarithm of pressure."""


def _curve(keyword: Keyword, kind: str, abaqus: bool) -> Curve:
    """Pressure over closure by EXPONENTIAL, which programs take differently, or TABULAR.

    CalculiX (User's Manual, *SURFACE BEHAVIOR): p = p0 exp(c ln(100) / c0), nothing beyond c0 of
    clearance; by a table whose chords are 3e-4 above it. Abaqus: p0 s (e^s - 1) / (e - 1).
    """
    rows = [numbers(keyword, i, row, "a number") for i, row in enumerate(keyword.rows())]
    pairs = 1 if kind == "EXPONENTIAL" else max(len(rows), 2)
    if len(rows) != pairs or any(len(row) != 2 for row in rows):
        keyword.refuse(
            f"{kind} needs {'one line' if pairs == 1 else 'two lines or more'} of two numbers"
        )
    try:
        if kind == "TABULAR":
            pressures, closures = zip(*rows, strict=True)
            return TableClosure(closures=closures, pressures=pressures)
        law = ExponentialClosure(clearance=rows[0][0], pressure=rows[0][1])
    except ModelError as error:
        raise keyword.error(str(error), 0) from error
    if abaqus:
        return law
    powers = np.arange(-np.log(100.0) + _STEP, _LARGEST, _STEP)
    return TableClosure(
        closures=(-law.clearance, *(law.clearance / np.log(100.0) * powers)),
        pressures=(0.0, *(law.pressure * np.exp(powers))),
    )
