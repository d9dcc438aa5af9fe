"""Load factors at which a joint opens: where too little is left of what the preload presses."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np

from faying._typing import Mask, Vector
from faying.assessment.growth import LARGEST, State, first_events
from faying.assessment.load_path import growing_gap, input_path
from faying.assessment.requirements import OPEN_BELOW
from faying.contact.condensed import CondensedContact
from faying.contact.forces import ContactForces
from faying.contact.state import ContactState
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.bolt_surroundings import nearest_bolts, told_apart
from faying.joint.system import Joint, Placed
from faying.model.bolt import Bolt

MOST_EXACT = 2000
"""Order of the contact problem up to which a load is followed from kink to kink: ten seconds.

Beyond, and where hard contact has no unique forces, it is followed in increments.
"""

INCREMENTS = 20
"""Increments up to the nominal load, of loads that are followed so."""

TOUCHING = 1e-9
"""Slack over the largest free gap below which a point is closed."""


@final
@dataclass(frozen=True, kw_only=True)
class Openings:
    """Factors of one load at which a joint opens, infinite where it does not.

    Attributes
    ----------
    opened
        Area (:func:`areas_that_open`) to the factor from which less than a share of what the
        preload presses there is still pressed.
    first
        Interface to the factor at which the first point closed at rest opens, of exact paths.
    last
        Interface to the factor from which it carries no force, of exact paths.
    followed
        Factor up to which the load was followed.
    """

    opened: Mapping[str, float]
    first: Mapping[str, float] = field(default_factory=dict)
    last: Mapping[str, float] = field(default_factory=dict)
    followed: float = np.inf


def area_name(interface: str, bolt: str = "") -> str:
    """Return what an interface, or its part nearest to a bolt, is called."""
    return f"{interface} around {bolt}" if bolt else interface


def areas_that_open(
    interfaces: Mapping[str, Placed], slices: Mapping[str, slice], bolts: Mapping[str, Bolt]
) -> dict[str, Mask]:
    """Return the points (n_point,) of every interface and, of several bolts, nearest to each."""
    numbers = np.arange(max((own.stop for own in slices.values()), default=0))
    found: dict[str, Mask] = {}
    for name, own in slices.items():
        found[area_name(name)] = (numbers >= own.start) & (numbers < own.stop)
        if len(bolts) > 1 and told_apart(bolts):
            nearest = np.full(len(numbers), -1)
            nearest[own] = nearest_bolts(interfaces[name].points, bolts)
            for number, bolt in enumerate(bolts):
                if (nearest == number).any():
                    found[area_name(name, bolt)] = nearest == number
    return found


def pressed_shares(areas: Mapping[str, Mask], pressed: Mask, weights: Vector) -> dict[str, Vector]:
    """Return the share of each point (n_point,) in what is pressed of an area at rest."""
    shares = {name: np.where(points & pressed, weights, 0.0) for name, points in areas.items()}
    return {name: one / one.sum() for name, one in shares.items() if one.sum() > 0}


def opening_factors(
    system: Joint,
    inputs: Vector,
    areas: Mapping[str, Mask],
    *,
    open_below: float = OPEN_BELOW,
    largest: float = LARGEST,
) -> Openings:
    """Find the factors at which a joint without friction opens under a static load.

    Parameters
    ----------
    system
        Full model, or the joint of a reduced one.
    inputs : (n_input,)
        Of the load.
    areas
        Name to the points (n_point,) of what opens.
    open_below
        Share of the area pressed at rest; from 0, nothing left, to 1.
    largest
        Factor at which the search ends where the load is followed in increments.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`faying.load_path`.

    Notes
    -----
    Exactly, from kink to kink, up to :data:`MOST_EXACT`; beyond in twenty increments to the nominal
    load and of a twentieth from there on, the one in which an area opens bisected to a thousandth.
    """
    condensed = system.static_contact
    if not isinstance(condensed, CondensedContact) or condensed.order <= MOST_EXACT:
        try:
            path = input_path(system, inputs)
        except (ModelError, ConvergenceError):  # hard contact without unique forces, round-off
            pass
        else:
            shares = pressed_shares(areas, path.closed[0], system.contact.weights)
            opened = {
                name: path.factor_of(path.closed @ share < _enough(open_below))
                for name, share in shares.items()
            }
            slices = system.contact.slices
            return Openings(
                opened=opened,
                first={name: path.first_opening(areas[name]) for name in slices},
                last={name: path.loss_of_clamp(name) for name in slices},
            )
    return _searched(system, inputs, areas, open_below, largest)


def _enough(share: float) -> float:
    """Return the share below which an area is open: of none left, below round-off."""
    return max(share, TOUCHING)


def opening_events(
    closed: Callable[[State], Mask], shares: Mapping[str, Vector], open_below: float
) -> dict[str, Callable[[State, State], bool]]:
    """Return what says whether an area is open after an increment, by its name.

    Parameters
    ----------
    closed
        Points (n_point,) that are closed in a state.
    shares
        From :func:`pressed_shares`.
    """
    enough = _enough(open_below)

    def event(share: Vector) -> Callable[[State, State], bool]:
        return lambda after, _: bool(closed(after) @ share < enough)

    return {name: event(share) for name, share in shares.items()}


_Solved = tuple[ContactForces, ContactState]


def _searched(
    system: Joint, inputs: Vector, areas: Mapping[str, Mask], open_below: float, largest: float
) -> Openings:
    """Follow a load in increments, each a static problem of its own."""
    condensed = system.static_contact
    a, b = growing_gap(system, inputs)
    touching = TOUCHING * float(np.abs(a).max(initial=0.0))

    def reach(factor: float, here: _Solved) -> _Solved:
        return condensed.solve(a + factor * b, here[1])

    def closed(solved: _Solved) -> Mask:
        # Of forces that are not unique some are zero where the sides touch.
        return np.asarray(solved[0].slack <= touching if hard else solved[0].forces > 0)

    hard, start = bool(np.isinf(system.contact.penalty).any()), condensed.solve(a)
    shares = pressed_shares(areas, closed(start), system.contact.weights)
    events = opening_events(closed, shares, open_below)
    found = first_events(reach, start, events, increments=INCREMENTS, largest=largest)
    opened = {name: found.factors.get(name, np.inf) for name in shares}
    return Openings(opened=opened, followed=found.largest)
