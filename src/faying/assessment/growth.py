"""First events as a load grows: increments, and the load factor of an event within one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Generic, TypeVar

import numpy as np
from scipy.optimize import brentq

from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_HALVINGS

State = TypeVar("State")

Event = Callable[[State, State], float]
"""Function of the states after and before an increment: positive before an event, else not.

Events without a number have infinity and minus infinity; numbers depend on the state after alone.
"""

PRECISION, SMALLEST_WIDTH = 1e-3, 1e-6
"""Final width of the interval of a factor, over it: for events without and with a number."""

DEFAULT_INCREMENTS = 10
"""Increments from the preload to a static load, and of a quarter of a cycle."""

LARGEST_FACTOR = 10.0
"""Largest load factor of a search."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Growth(Generic[State]):
    """First events under a growing load.

    Attributes
    ----------
    factors
        Event to the load factor at which it first happens; others are missing.
    states
        Event to the states there and before the increment in which it happens.
    largest
        Largest load factor of the path.
    stopped
        Whether the path ended because the next increment had no solution.
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
    known: Sequence[State] = (),
) -> Growth[State]:
    """Increase a load until all of some events have happened, or up to a factor.

    The load grows in equal increments to its nominal value, then by the same share of its current
    value. An increment in which an event first happens is cut at the zero of the event's number
    (Brent's method), or halved for events without a number. The remainder is cut again, so that
    increments shrink towards the event. Each is solved once for all events.

    ``reach`` is a function of a load factor and the state before that returns the state there, in
    one increment. ``known`` are states after the first increments, if they have been solved.

    Raises
    ------
    ConvergenceError
        If a trial in an increment is not solved.
    """
    factors: dict[str, float] = {}
    states: dict[str, tuple[State, State]] = {}
    state, factor, stopped, number = start, 0.0, False, 0
    while factor < largest and len(factors) < len(events):
        target = min(_next(factor, increments), largest)
        try:
            trial = known[number] if number < len(known) else reach(target, state)
        except ConvergenceError:
            stopped = True
            break
        reached, once = {factor: state, target: trial}, cache(reach)
        for name, left in events.items():
            if name not in factors and (value := left(trial, state)) <= 0:
                counts = np.isfinite(value) and left(state, state) > 0
                cut = _cut_by_chords if counts else _cut_by_halves
                factors[name], states[name] = cut(once, left, reached)
        state, factor, number = trial, target, number + 1
    return Growth(factors=factors, states=states, largest=factor, stopped=stopped)


Reached = dict[float, State]
"""Load factors in an increment to the solved states there, both ends included."""


def _cut_by_chords(
    reach: Callable[[float, State], State], left: Event[State], reached: Reached[State]
) -> tuple[float, tuple[State, State]]:
    """Return the factor at which a number reaches zero in an increment, states there and before.

    States on the way are added to those of the increment, for other events between them.
    """
    start = reached[min(reached)]
    nothing = SOLVED * left(start, start)

    def value(factor: float) -> float:
        if factor not in reached:
            reached[factor] = reach(factor, reached[_before(reached, factor)])
        return left(reached[factor], reached[factor]) - nothing

    high = next(factor for factor in sorted(reached) if value(factor) <= 0)
    factor = float(brentq(value, _before(reached, high), high, rtol=SMALLEST_WIDTH))
    high = next(factor for factor in sorted(reached) if value(factor) <= 0)
    return factor, (reached[high], reached[_before(reached, high)])


def _before(reached: Reached[State], factor: float) -> float:
    return max(earlier for earlier in reached if earlier < factor)


def _cut_by_halves(
    reach: Callable[[float, State], State], left: Event[State], reached: Reached[State]
) -> tuple[float, tuple[State, State]]:
    """Return the factor at which an event happens in an increment, states there and before."""
    low, high = min(reached), max(reached)
    lower, begun, smallest = reached[low], reached[high], (high - low) / 2**MOST_HALVINGS
    # A joint that slips under nearly no load is tested first, not after all halvings.
    middle = smallest if low == 0.0 else (low + high) / 2
    for _ in range(MOST_HALVINGS + 1):
        if high - low <= max(PRECISION * high, smallest):
            break
        trial = reach(middle, lower)
        if left(trial, lower) <= 0:
            high, begun = middle, trial
        else:
            low, lower = middle, trial
        middle = (low + high) / 2
    return high, (begun, lower)


def _next(factor: float, increments: int) -> float:
    """Return the load factor of the next increment."""
    if factor < 1 - 0.5 / increments:
        return (round(factor * increments) + 1) / increments
    return factor * (1 + 1 / increments)
