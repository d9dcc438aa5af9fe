"""Envelopes over load cases or instants: the extremes at every contact point, and where from."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class Envelope:
    """Extremes of every contact point over cases.

    Attributes
    ----------
    max_pressure : (n_point,) [force/length²]
        Largest pressure of each contact point.
    max_pressure_case : (n_point,) [1]
        Number of the case or instant it is from, from 0, the first of several.
    min_pressure : (n_point,) [force/length²]
        Smallest pressure of each contact point.
    min_pressure_case : (n_point,) [1]
        Number of the case or instant it is from, from 0, the first of several.
    max_gap : (n_point,) [length]
        Largest gap of each contact point.
    max_gap_case : (n_point,) [1]
        Number of the case or instant it is from, from 0, the first of several.
    """

    max_pressure: Vector
    max_pressure_case: Indices
    min_pressure: Vector
    min_pressure_case: Indices
    max_gap: Vector
    max_gap_case: Indices


def envelope_of(solution: Solution, rows: Indices) -> Envelope:
    """Return the envelope of the cases or instants of a solution that have the numbers ``rows``."""
    pressure, gap = solution.pressure, solution.gap
    return Envelope(
        max_pressure=pressure.max(axis=0),
        max_pressure_case=rows[pressure.argmax(axis=0)],
        min_pressure=pressure.min(axis=0),
        min_pressure_case=rows[pressure.argmin(axis=0)],
        max_gap=gap.max(axis=0),
        max_gap_case=rows[gap.argmax(axis=0)],
    )


def joined(parts: Iterable[Envelope]) -> Envelope:
    """Return the envelope of several, in the order of their cases; there is at least one."""
    envelopes = list(parts)
    highest, at_highest = _extreme([envelope.max_pressure for envelope in envelopes], largest=True)
    lowest, at_lowest = _extreme([envelope.min_pressure for envelope in envelopes], largest=False)
    widest, at_widest = _extreme([envelope.max_gap for envelope in envelopes], largest=True)
    return Envelope(
        max_pressure=highest,
        max_pressure_case=_chosen(
            [envelope.max_pressure_case for envelope in envelopes], at_highest
        ),
        min_pressure=lowest,
        min_pressure_case=_chosen(
            [envelope.min_pressure_case for envelope in envelopes], at_lowest
        ),
        max_gap=widest,
        max_gap_case=_chosen([envelope.max_gap_case for envelope in envelopes], at_widest),
    )


def _extreme(rows: list[Vector], *, largest: bool) -> tuple[Vector, Indices]:
    table: Matrix = np.array(rows)
    which: Indices = table.argmax(axis=0) if largest else table.argmin(axis=0)
    return np.take_along_axis(table, which[None], axis=0)[0], which


def _chosen(rows: list[Indices], which: Indices) -> Indices:
    chosen: Indices = np.take_along_axis(np.array(rows), which[None], axis=0)[0]
    return chosen
