"""What first happens as a load grows: increments, and the one in which it happens bisected."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from faying.exceptions import ConvergenceError

State = TypeVar("State")

PRECISION = 1e-3
"""Width of the interval in which a factor is found, over the factor."""

MOST_BISECTIONS = 12
"""Bisections of an increment: what happens below a four-thousandth of it happens at once."""

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
    events: Mapping[str, Callable[[State, State], bool]],
    *,
    increments: int,
    largest: float,
) -> Growth[State]:
    """Let a load grow until all of some events have happened, or to a factor.

    It grows in equal increments to its nominal value, from there on by the same share of itself.
    The increment in which something first happens is halved, and what is left of it again, so that
    the path goes there in smaller and smaller increments.

    Parameters
    ----------
    reach
        Takes a load factor and the state before to the state there, in one increment.
    events
        Name to whether it happens, given the state after an increment and that before.

    Raises
    ------
    ConvergenceError
        If a trial of a bisection is not solved.
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
        for name, happens in events.items():
            if name in factors or not happens(after, here):
                continue
            low, high, before, begun = factor, target, here, after
            for _ in range(MOST_BISECTIONS):
                if high - low <= PRECISION * high:
                    break
                middle = (low + high) / 2
                trial = reach(middle, before)
                if happens(trial, before):
                    high, begun = middle, trial
                else:
                    low, before = middle, trial
            factors[name], states[name] = high, (begun, before)
        here, factor = after, target
    return Growth(factors=factors, states=states, largest=factor, stopped=stopped)


def _next(factor: float, increments: int) -> float:
    """Return the load factor of the next increment."""
    if factor < 1 - 0.5 / increments:
        return (round(factor * increments) + 1) / increments
    return factor * (1 + 1 / increments)
