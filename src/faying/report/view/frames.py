"""The instants, increments or single states in which a load case is shown."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices
from faying.study.judgement.comparison import increments
from faying.study.results.nodal_motion import shown_states
from faying.study.results.values import CaseResult
from faying.units import Units


@dataclass(frozen=True, eq=False, kw_only=True)
class Frames:
    """States of a load case, one after the other.

    Attributes
    ----------
    label, unit
        What tells them apart; no label where there is one only.
    values
        Its values.
    chosen
        Their numbers among all that were computed.
    """

    label: str
    unit: str
    values: tuple[float, ...]
    chosen: Indices


def frames(case: CaseResult, units: Units) -> Frames:
    """Choose the states of a load case that are shown: evenly, and where pressure is largest."""
    paths = increments(case.reference)
    if paths:
        path = paths[-1]
        chosen = shown_states(path.pressure.max(axis=1, initial=0.0))
        if path.factors.shape[1] == 1:
            values = path.factors[chosen, 0]
            return Frames(label="load factor", unit="", values=tuple(values), chosen=chosen)
        return Frames(label="increment", unit="", values=tuple(chosen + 1.0), chosen=chosen)
    if case.times is None:
        return Frames(label="", unit="", values=(0.0,), chosen=np.zeros(1, dtype=np.int64))
    chosen = shown_states(case.reference.pressure.max(axis=1, initial=0.0))
    times = tuple(case.times[chosen])
    return Frames(label="time", unit=units.time, values=times, chosen=chosen)
