"""``*AMPLITUDE``: what loads are multiplied by at the end of a step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import parameter, real
from faying.io.abaqus.keyword import Keyword, add, named

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
        keyword = named(load, load.value("AMPLITUDE"), self.keywords, "*AMPLITUDE")
        total = keyword.choice("TIME") == "TOTAL TIME"
        time = sum(self.lengths[: step + 1]) if total else self.lengths[load.step]
        times, values = _table(keyword)
        time -= parameter(load, "TIME DELAY", 0.0)
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
        add(amplitudes, keyword, keyword.required("NAME"), keyword, "amplitudes")
    lengths = [0.0] + [1.0] * deck.n_step
    for keyword in deck.of(*_TIMED):
        rows = keyword.rows()
        if keyword.step and rows and len(rows[0]) > 1 and rows[0][1]:
            lengths[keyword.step] = real(keyword, 0, rows[0][1], "the length of the step")
    return Amplitudes(keywords=amplitudes, lengths=lengths)


def _table(keyword: Keyword) -> tuple[Vector, Vector]:
    """Return times and values of an amplitude, shifted as CalculiX does by SHIFTX and SHIFTY."""
    keyword.check()
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
    shift = parameter(keyword, "SHIFTX", 0.0), parameter(keyword, "SHIFTY", 0.0)
    return table[:, 0] + shift[0], table[:, 1] + shift[1]
