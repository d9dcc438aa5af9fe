"""Load factors at which a joint opens: too little of the area under preload pressure remains."""

from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.assessment.growth import DEFAULT_INCREMENTS, LARGEST_FACTOR, Event, first_events
from faying.assessment.requirements import OPEN_BELOW
from faying.contact.contact import Contact
from faying.contact.increment import Increment
from faying.digits import SOLVED
from faying.interface.interface import Interface
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import nearest_bolts, told_apart
from faying.joint.system import Joint
from faying.model.bolt import Bolt
from faying.simulation.solution import Solution
from faying.simulation.static import port_forces

State = TypeVar("State")


@dataclass(frozen=True, kw_only=True)
class Openings:
    """Factors of one load at which a joint opens, infinite where it does not.

    Attributes
    ----------
    opened
        Area (:func:`areas_that_open`) to the factor from which less than a share of its part under
        preload pressure is still under pressure.
    followed
        Largest factor of the load path.
    """

    opened: Mapping[str, float]
    followed: float = np.inf


def area_name(interface: str, bolt: str = "") -> str:
    """Return the name of an interface, or of its part nearest to a bolt."""
    return f"{interface} around {bolt}" if bolt else interface


def areas_that_open(
    interfaces: Mapping[str, Interface | ContactSurface],
    slices: Mapping[str, slice],
    bolts: Mapping[str, Bolt],
) -> dict[str, Mask]:
    """Return the points (n_point,) of every interface and, for several bolts, nearest to each."""
    numbers = np.arange(max((points.stop for points in slices.values()), default=0))
    areas: dict[str, Mask] = {}
    for name, points in slices.items():
        areas[area_name(name)] = (numbers >= points.start) & (numbers < points.stop)
        if len(bolts) > 1 and told_apart(bolts):
            nearest = np.full(len(numbers), -1)
            nearest[points] = nearest_bolts(interfaces[name].points, bolts)
            for number, bolt in enumerate(bolts):
                if (nearest == number).any():
                    areas[area_name(name, bolt)] = nearest == number
    return areas


def pressed_shares(areas: Mapping[str, Mask], pressed: Mask, weights: Vector) -> dict[str, Vector]:
    """Return the share of each point (n_point,) in the area under pressure at rest."""
    shares = {name: np.where(points & pressed, weights, 0.0) for name, points in areas.items()}
    return {name: share / share.sum() for name, share in shares.items() if share.sum() > 0}


def growing_displacements(system: Joint, inputs: Vector) -> tuple[Vector, Vector]:
    """Return displacements of the pairs (n_relative,) without contact, at rest and per load factor.

    The bolts stay locked.
    """
    ports = system.port_compliance
    start, growing = inputs.copy(), inputs.copy()
    start[: ports.n_boundary] = 0.0
    start[ports.bolts.stop :] = 0.0
    growing[ports.bolts] = 0.0
    at_rest, rate = port_forces(ports, np.array([start, growing])) @ ports.contact_columns
    return at_rest, rate


def opening_factors(
    system: Joint,
    inputs: Vector,
    areas: Mapping[str, Mask],
    *,
    open_below: float = OPEN_BELOW,
    reached: MutableMapping[float, Increment] | None = None,
) -> Openings:
    """Return the factors at which a joint without friction opens under a static load.

    An area of points (n_point,) opens where less than a share of its part under pressure at rest
    is left. The search ends at :data:`~faying.assessment.growth.LARGEST_FACTOR`. Increments that
    were reached under this load for other areas are taken from ``reached`` and added to it.

    Raises
    ------
    ModelError
        If slip or closure has a history.
    ConvergenceError
        If a trial in an increment is not solved.

    Notes
    -----
    In ten increments to the nominal load and of a tenth from there on. The depth of contact points
    depends continuously on the load, which leads to the factor at which an area opens within an
    increment. Areas that open and close again between two increments are missed.
    """
    contact, solver = system.contact, system.static_contact.increments
    contact.check_cases()
    fixed, growing = growing_displacements(system, inputs)
    touching = SOLVED * float(np.abs(contact.free_gap(fixed)).max(initial=0.0))
    cases = {} if reached is None else reached

    def reach(factor: float, start: Increment | None) -> Increment:
        if factor not in cases:
            cases[factor] = solver.solve(fixed + factor * growing, contact.offset(), start)
        return cases[factor]

    def pressed(case: Increment) -> Vector:
        return pressed_depth(contact, case.gap(solver.laws), touching)

    start = reach(0.0, None)
    shares = pressed_shares(areas, pressed(start) > 0, contact.weights)
    limit = enough(open_below)
    events = first_events(
        reach,
        start,
        {name: opening_event(pressed, share, limit) for name, share in shares.items()},
        increments=DEFAULT_INCREMENTS,
        largest=LARGEST_FACTOR,
    )
    opened = {name: events.factors.get(name, np.inf) for name in shares}
    return Openings(opened=opened, followed=events.largest)


def opening_margins(
    system: Joint,
    inputs: Matrix,
    areas: Mapping[str, Mask],
    factor: float,
    *,
    open_below: float = OPEN_BELOW,
) -> Vector:
    """Return the depth of contact of the most critical area at a factor of each load (n_case,).

    Negative where an area is open [length]: one contact solution a load, instead of some thirty in
    :func:`opening_factors`. Inputs are (n_case, n_input).
    """
    contact, margins = system.contact, np.full(len(inputs), np.inf)
    solver, offset = system.static_contact.increments, contact.offset()
    rested, case = None, None
    for number, row in enumerate(inputs):
        fixed, growing = growing_displacements(system, row)
        if rested is None or not np.array_equal(fixed, rested):
            touching = SOLVED * np.abs(contact.free_gap(fixed)).max(initial=0.0)
            case, rested = solver.solve(fixed, offset), fixed
            pressed = pressed_depth(contact, case.gap(solver.laws), touching) > 0
            shares = pressed_shares(areas, pressed, contact.weights).values()
        case = solver.solve(fixed + factor * growing, offset, case)
        depth = pressed_depth(contact, case.gap(solver.laws), touching)
        for share in shares:
            margins[number] = min(margins[number], _pressed_at(depth, share, enough(open_below)))
    return margins


def estimated_openings(
    rest: Solution, cases: Solution, areas: Mapping[str, Mask], open_below: float
) -> Matrix:
    """Return the factors at which loads would open areas (n_case, n_area), if contact were linear.

    The depth of every point, or the pressure of hard contact, falls in proportion to the load.
    Infinite factors never open the area. ``rest`` is before any load, at its last state.
    """
    contact = cases.system.contact
    hard = np.zeros(contact.n_points, dtype=bool)
    for name, points in contact.slices.items():
        hard[points] = not contact.laws[name].yields
    before, under = (
        [
            np.where(hard & (pressure > 0), pressure, -gap)
            for pressure, gap in zip(
                np.atleast_2d(solution.pressure), np.atleast_2d(solution.gap), strict=True
            )
        ]
        for solution in (rest, cases)
    )
    lost = before[-1] - np.array(under)
    losing = (before[-1] > 0) & (lost > 0)
    factors = np.where(losing, before[-1] / np.where(losing, lost, 1.0), np.inf)
    shares = pressed_shares(areas, before[-1] > 0, contact.weights)
    opens = np.full((len(factors), len(areas)), np.inf)
    for column, name in enumerate(areas):
        if name in shares:
            share, limit = shares[name], enough(open_below)
            opens[:, column] = [_pressed_at(each, share, limit) for each in factors]
    return opens


def _pressed_at(depth: Vector, shares: Vector, least: float) -> float:
    """Return the least depth over the share of an area that must not open."""
    points = np.flatnonzero(shares)
    order = points[np.argsort(-depth[points])]
    return float(depth[order[np.searchsorted(np.cumsum(shares[order]), least)]])


def pressed_depth(contact: Contact, gap: Vector, touching: float = 0.0) -> Vector:
    """Return the depth of contact of points (n_point,), negative where they are apart [length].

    Gaps are negative by the penetration where contact yields; points of hard contact count as
    closed where their gap is below ``touching``.
    """
    depth = -gap
    for law, points in zip(contact.laws.values(), contact.slices.values(), strict=True):
        depth[points] += 0.0 if law.yields else touching
    return depth


def enough(share: float) -> float:
    """Return the share below which an area is open, with a margin for round-off."""
    return max(share - SOLVED, SOLVED)


def opening_event(
    pressed: Callable[[State], Vector], shares: Vector, open_below: float
) -> Event[State]:
    """Return an event: the least depth over the share of an area that must not open.

    The depth of all points comes from :func:`pressed_depth`, their shares (n_point,) from
    :func:`pressed_shares`, the share that may open from :func:`enough`.
    """
    return lambda state, _: _pressed_at(pressed(state), shares, open_below)
