"""``*AMPLITUDE``: what loads are multiplied by at the end of a step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import real
from faying.io.abaqus.keyword import Keyword

_TIMED = ("STATIC", "DYNAMIC", "VISCO", "MODAL DYNAMIC")
"""Procedures whose data line holds the length of the step, behind its first increment."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Amplitudes:
    """All amplitudes of a deck, and how long its steps last.

    Attributes
    ----------
    keywords
        Upper-case name to the keyword.
    lengths
        Of the steps, from 0 for what stands before the first.
    """

    keywords: Mapping[str, Keyword]
    lengths: Sequence[float]

    def factor(self, load: Keyword, step: int) -> float:
        """Return what the loads of a keyword are multiplied by at the end of a step.

        A course over the time of the step stays at its last value in the steps that follow; one
        over the total time goes on.
        """
        if not load.has("AMPLITUDE"):
            return 1.0
        name = load.value("AMPLITUDE")
        if name.upper() not in self.keywords:
            names = (
                ", ".join(amplitude.value("NAME") for amplitude in self.keywords.values()) or "none"
            )
            load.refuse(f"there is no *AMPLITUDE '{name}'; known are {names}")
        keyword = self.keywords[name.upper()]
        total = keyword.choice("TIME", "STEP TIME") == "TOTAL TIME"
        time = sum(self.lengths[: step + 1]) if total else self.lengths[load.step]
        times, values = _table(keyword)
        time -= real(load, None, load.value("TIME DELAY", "0"), "TIME DELAY")
        return float(np.interp(time, times, values))

    def note(self, load: Keyword, ignored: list[str]) -> None:
        """Say what of the course over time is taken."""
        if load.has("AMPLITUDE"):
            factor = self.factor(load, load.step)
            name = load.value("AMPLITUDE")
            note = f"AMPLITUDE={name} of *{load.name}: times {factor:g}, its end in the step"
            if note not in ignored:
                ignored.append(note)


def read_amplitudes(deck: Deck) -> Amplitudes:
    """Read all *AMPLITUDE and the lengths of the steps."""
    amplitudes: dict[str, Keyword] = {}
    for keyword in deck.of("AMPLITUDE"):
        name = keyword.required("NAME")
        if name.upper() in amplitudes:
            keyword.refuse(f"there are two amplitudes '{name}'; rename one of them")
        amplitudes[name.upper()] = keyword
    lengths = [0.0] + [1.0] * deck.n_step
    for keyword in deck.of(*_TIMED):
        rows = keyword.rows()
        if keyword.step and rows and len(rows[0]) > 1 and rows[0][1]:
            lengths[keyword.step] = real(keyword, 0, rows[0][1], "the length of the step")
    return Amplitudes(keywords=amplitudes, lengths=lengths)


def _table(keyword: Keyword) -> tuple[Vector, Vector]:
    """Return times and values of an amplitude, shifted as CalculiX does by SHIFTX and SHIFTY."""
    keyword.allow("NAME", "TIME", "VALUE", "DEFINITION", "SHIFTX", "SHIFTY", "SMOOTH")
    for parameter, usual in (("VALUE", "RELATIVE"), ("DEFINITION", "TABULAR")):
        if keyword.choice(parameter, usual) != usual:
            keyword.refuse(f"{parameter}={keyword.value(parameter)} is not supported; give {usual}")
    numbers = [
        real(keyword, row, text, "a time or a value")
        for row, fields in enumerate(keyword.rows())
        for text in fields
        if text
    ]
    if len(numbers) < 2 or len(numbers) % 2:
        keyword.refuse(f"found {len(numbers)} numbers, expected pairs of a time and a value")
    table = np.array(numbers).reshape(-1, 2)
    if (np.diff(table[:, 0]) < 0).any():
        keyword.refuse("the times do not increase; sort them")
    shift = [real(keyword, None, keyword.value(f"SHIFT{axis}", "0"), "a shift") for axis in "XY"]
    return table[:, 0] + shift[0], table[:, 1] + shift[1]
