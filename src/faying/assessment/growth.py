"""What first happens as a load grows: increments, and where in one of them it happens."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from faying.exceptions import ConvergenceError

State = TypeVar("State")

Event = Callable[[State, State], float]
"""What is left, after an increment and before it, until something happens: zero or less if it has.

Of what only happens or not it is infinite, or minus infinity.
"""

PRECISION, CLOSE = 1e-3, 1e-6
"""Width of the interval in which a factor is found, over the factor: of what only happens or not,
and of what a number says."""

MOST_HALVINGS, MOST_CHORDS = 12, 40
"""Cuts of an increment: what happens below a four-thousandth of it happens at once."""

NOTHING = 1e-9
"""What is left, over what was before the increment, that is as good as nothing."""

LARGEST = 10.0
"""Load factor at which the search is given up."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Growth(Generic[State]):
    """What was found as a load grew.

    Attributes
    ----------
    factors
        Event to the load factor at which it first happens, of those that do.
    states
        Event to the states there and before the increment in which it happens.
    largest
        Load factor up to which the load grew.
    stopped
        Whether it ended there because the next increment had no solution.
    """

    factors: Mapping[str, float]
    states: Mapping[str, tuple[State, State]]
    largest: float
    stopped: bool


def first_events(
    reach: Callable[[float, State], State],
    start: State,
    events: Mapping[str, Event[State]],
    *,
    increments: int,
    largest: float,
) -> Growth[State]:
    """Let a load grow until all of some events have happened, or to a factor.

    It grows in equal increments to its nominal value, from there on by the same share of itself.
    The increment in which something first happens is cut where a chord says that it does
    (regula falsi of Anderson and Björck), or halved where no number says when, and what is left of
    it again, so that the path goes there in smaller and smaller increments.

    Parameters
    ----------
    reach
        Takes a load factor and the state before to the state there, in one increment.
    events
        By name.

    Raises
    ------
    ConvergenceError
        If a trial in an increment is not solved.
    """
    factors: dict[str, float] = {}
    states: dict[str, tuple[State, State]] = {}
    here, factor, stopped = start, 0.0, False
    while factor < largest and len(factors) < len(events):
        target = min(_next(factor, increments), largest)
        try:
            after = reach(target, here)
        except ConvergenceError:
            stopped = True
            break
        for name, left in events.items():
            if name not in factors and left(after, here) <= 0:
                factors[name], states[name] = _cut(reach, left, (factor, target), (here, after))
        here, factor = after, target
    return Growth(factors=factors, states=states, largest=factor, stopped=stopped)


def _cut(
    reach: Callable[[float, State], State],
    left: Event[State],
    factors: tuple[float, float],
    states: tuple[State, State],
) -> tuple[float, tuple[State, State]]:
    """Return the factor at which something happens in an increment, the states there and before."""
    (low, high), (before, begun) = factors, states
    above, below = left(before, before), left(begun, before)
    passed: bool | None = None
    counts = 0 < above < np.inf
    precision, most = (CLOSE, MOST_CHORDS) if counts else (PRECISION, MOST_HALVINGS)
    nothing = NOTHING * above if counts else 0.0
    for _ in range(most):
        if high - low <= precision * high:
            break
        middle = low + (above / (above - below) if counts else 0.5) * (high - low)
        trial = reach(middle, before)
        value = left(trial, before)
        happened = value <= nothing
        if counts and happened == passed:
            # The other end stays again: it counts less, so that the next chord goes beyond.
            less = 1 - value / (below if happened else above)
            less = less if less > 0 else 0.5
            above, below = (above * less, below) if happened else (above, below * less)
        passed = happened
        if happened:
            high, begun, below = middle, trial, value
        else:
            low, before, above = middle, trial, value
        if abs(value) <= nothing:
            break
    return high, (begun, before)


def _next(factor: float, increments: int) -> float:
    """Return the load factor of the next increment."""
    if factor < 1 - 0.5 / increments:
        return (round(factor * increments) + 1) / increments
    return factor * (1 + 1 / increments)
