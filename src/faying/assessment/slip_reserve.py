"""Slip reserve: how far a load may grow until a joint begins to slip, or slips as a whole."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from faying.assessment.slip import SLIP, SlipStates, slip_change, slip_states
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.path import solve_path
from faying.simulation.solution import Solution

PRECISION = 1e-3
"""Width of the interval in which a factor is found, over the factor."""

MOST_BISECTIONS = 20
"""Bisections of an increment: what slips below a millionth of it slips at once."""

LARGEST = 10.0
"""Load factor at which the search is given up."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipReserve:
    """Load factors, on a path that grows in proportion from the preloaded joint.

    Attributes
    ----------
    first_slip
        At which the first point slips; None where none does up to ``largest``.
    interface, point
        Where: the interface, and the number of the point among its points (the one that slips
        farthest if several begin together); empty and -1 where none does.
    share
        Share of the area in contact that ``share_slip`` is about.
    share_slip
        At which that share slips; None where less does.
    gross_slip
        At which everything that is closed slips on some interface with friction; None where it
        does not.
    largest
        Factor up to which the path was followed.
    stopped
        Whether it ended there because the next increment had no solution.
    """

    first_slip: float | None
    interface: str
    point: int
    share: float
    share_slip: float | None
    gross_slip: float | None
    largest: float
    stopped: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class _Found:
    """A load factor at which something happens for the first time, and the state there."""

    factor: float
    after: Solution


def slip_reserve(
    system: System,
    load: Load,
    initial: Solution | None = None,
    *,
    share: float = 0.5,
    increments: int = 10,
    largest: float = LARGEST,
) -> SlipReserve:
    """Find the load factors at which a joint begins to slip, slips by a share, and as a whole.

    The load grows in equal increments to its nominal value, from there on by the same share of
    itself. The increment in which something first happens is bisected; each trial is one increment
    from the state before it, so what is found belongs to the path with its increments.

    Parameters
    ----------
    system
        Full or reduced model with friction.
    load
        Nominal load, of constant forces; the bolts stay locked.
    initial
        Preloaded state the path goes on from; by default the bolts are tightened first, in one
        increment with friction.
    share
        Share of the area in contact, above 0 and at most 1.
    increments
        Increments up to the nominal load.
    largest
        Load factor at which the search ends.

    Raises
    ------
    ModelError
        If the system has no friction, the load is a history, or a number is out of range.
    ConvergenceError
        If a trial of a bisection is not solved.

    Notes
    -----
    Some 35 increments up to a factor of ten, and ten for each factor found. Tightening with
    friction leaves points on their bounds, which slip under almost any load: where that is not
    wanted, look at the share.
    """
    _check(system, load, share, increments, largest)
    here = solve_path(system, [Load()]) if initial is None else initial
    events: dict[str, Callable[[SlipStates], bool]] = {
        "first": lambda states: bool(states.slip_share[-1] > 0),
        "share": lambda states: bool(states.slip_of_closed[-1] >= share),
        "gross": lambda states: bool(states.macroslip[-1]),
    }
    found: dict[str, _Found] = {}
    interface, point = "", -1
    factor, stopped = 0.0, False
    while factor < largest and len(found) < len(events):
        target = min(_next(factor, increments), largest)
        try:
            after = solve_path(system, [load.scaled(target)], initial=here)
        except ConvergenceError:
            stopped = True
            break
        states = slip_states(after, here)
        for name, happens in events.items():
            if name not in found and happens(states):
                found[name] = _bisected(system, load, here, (factor, target), happens)
                if name == "first":
                    interface, point = _farthest(found[name], here)
        here, factor = after, target
    factors = {name: one.factor for name, one in found.items()}
    return SlipReserve(
        first_slip=factors.get("first"),
        interface=interface,
        point=point,
        share=share,
        share_slip=factors.get("share"),
        gross_slip=factors.get("gross"),
        largest=factor,
        stopped=stopped,
    )


def _check(system: System, load: Load, share: float, increments: int, largest: float) -> None:
    if not len(system.contact.rubbing) or not (system.contact.friction > 0).any():
        message = "the model has no friction, so nothing holds that could slip; add friction"
        raise ModelError(message)
    if not 0 < share <= 1:
        message = f"the share of slipping area is {share:g}; give one above 0 and at most 1"
        raise ModelError(message)
    if increments < 1 or not 0 < largest < np.inf:
        message = (
            f"found {increments} increments up to a factor of {largest:g}; give one or more, and a "
            "positive factor"
        )
        raise ModelError(message)
    load.scaled(1.0)


def _next(factor: float, increments: int) -> float:
    """Return the load factor of the next increment."""
    if factor < 1 - 0.5 / increments:
        return (round(factor * increments) + 1) / increments
    return factor * (1 + 1 / increments)


def _bisected(
    system: System,
    load: Load,
    here: Solution,
    between: tuple[float, float],
    happens: Callable[[SlipStates], bool],
) -> _Found:
    """Find where between two factors something begins to happen, by single increments."""
    low, high = between
    after = solve_path(system, [load.scaled(high)], initial=here)
    for _ in range(MOST_BISECTIONS):
        if high - low <= PRECISION * high:
            break
        middle = (low + high) / 2
        trial = solve_path(system, [load.scaled(middle)], initial=here)
        if happens(slip_states(trial, here)):
            high, after = middle, trial
        else:
            low = middle
    return _Found(factor=high, after=after)


def _farthest(found: _Found, here: Solution) -> tuple[str, int]:
    """Return the interface, and the point of it, that slips farthest in an increment."""
    contact = found.after.system.contact
    change = slip_change(found.after, here)[-1]
    change[slip_states(found.after, here).status[-1] != SLIP] = 0.0
    point = int(change.argmax())
    for name, points in contact.slices.items():
        if points.start <= point < points.stop:
            return name, point - points.start
    return "", -1
