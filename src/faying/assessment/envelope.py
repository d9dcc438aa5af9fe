"""Envelopes over load cases or instants: the extremes at every contact point, and their cases."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields

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


PICKS = {"max_pressure": np.argmax, "min_pressure": np.argmin, "max_gap": np.argmax}
"""Function that picks the extreme of several values of a point."""


def envelope_of(solution: Solution, rows: Indices) -> Envelope:
    """Return the envelope over the cases or instants of a solution, whose numbers are ``rows``."""
    pressure, gap = solution.pressure, solution.gap
    values = {"max_pressure": pressure, "min_pressure": pressure, "max_gap": gap}
    return _pick_extremes(values, dict.fromkeys(values, np.broadcast_to(rows[:, None], gap.shape)))


def joined(parts: Iterable[Envelope]) -> Envelope:
    """Return the envelope of several envelopes, at least one, in the order of their cases."""
    envelopes = list(parts)
    members = [field.name for field in fields(Envelope)]
    every = {name: np.array([getattr(part, name) for part in envelopes]) for name in members}
    return _pick_extremes(every, {name: every[f"{name}_case"] for name in PICKS})


def _pick_extremes(values: Mapping[str, Matrix], cases: Mapping[str, Indices]) -> Envelope:
    members = {}
    for name, pick in PICKS.items():
        which = pick(values[name], axis=0)[None]
        members[name] = np.take_along_axis(values[name], which, axis=0)[0]
        members[f"{name}_case"] = np.take_along_axis(cases[name], which, axis=0)[0]
    return Envelope(**members)
