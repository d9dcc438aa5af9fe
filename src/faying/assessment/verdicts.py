"""Requirements judged where they are nearest to failing."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from faying.assessment.joint_record import CaseState, InterfaceAssessment
from faying.assessment.opening import Openings
from faying.assessment.requirements import ClosedRing, Requirements, Verdict
from faying.assessment.sealing import ring_around, ring_pressure
from faying.assessment.slip_reserve import SlipReserve
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import pressed_near
from faying.model.bolt import Bolt


def verdicts(
    wanted: Requirements,
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    rest: CaseState,
    cases: Mapping[str, CaseState],
    interfaces: Mapping[str, InterfaceAssessment],
    paths: Mapping[str, Openings],
    reserves: Mapping[str, SlipReserve],
) -> Iterator[Verdict]:
    """Yield the verdicts on what is required.

    Parameters
    ----------
    paths
        Static load case to its openings.
    reserves
        Load case to its slip reserve, of joints with friction.
    """
    yield from _clamp_verdict(wanted.min_clamp_force, interfaces)
    peaks = {name: (one.max_pressure_case, one.max_pressure) for name, one in interfaces.items()}
    yield from pressure_verdict("max_pressure", wanted.max_pressure, peaks)
    means = {
        name: (one.max_nodal_pressure_case, one.max_nodal_pressure)
        for name, one in interfaces.items()
    }
    yield from pressure_verdict("max_nodal_pressure", wanted.max_nodal_pressure, means)
    yield from _opening_verdict(wanted.no_opening_within, surfaces, bolts, rest, cases)
    yield from opening_verdicts(wanted.min_opening_factor, paths)
    if bolts or not reserves:
        yield from _slip_verdict(wanted.min_slip_safety, interfaces)
    else:
        yield from _sliding_verdict("min_slip_safety", wanted.min_slip_safety, reserves)
    yield from _sliding_verdict("min_sliding_factor", wanted.min_sliding_factor, reserves)
    for ring in wanted.closed_ring:
        yield _ring_verdict(ring, surfaces, cases)


def _clamp_verdict(
    limit: float | Mapping[str, float] | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    """Judge the least clamp force by the lower end of its certified interval, where it has one."""
    for name, least in wanted_clamps(limit, interfaces).items():
        one = interfaces[name]
        value = one.least_clamp if one.certified is None else float(one.certified[0])
        yield Verdict.at_least("min_clamp_force", name, one.least_clamp_case, value, least)


def wanted_clamps(
    limit: float | Mapping[str, float] | None, interfaces: Iterable[str]
) -> Mapping[str, float]:
    """Return the least clamp force of each interface that has one."""
    if limit is None:
        return {}
    return limit if isinstance(limit, Mapping) else dict.fromkeys(interfaces, limit)


def pressure_verdict(
    requirement: str, limit: float | None, found: Mapping[str, tuple[str, float]]
) -> Iterator[Verdict]:
    """Judge the largest pressures of the interfaces, each with its case."""
    if limit is None:
        return
    name = max(found, key=lambda one: found[one][1])
    case, value = found[name]
    yield Verdict(
        requirement=requirement,
        met=value <= limit,
        place=name,
        case=case,
        value=value,
        limit=limit,
    )


def _opening_verdict(
    radius: float | None,
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    rest: CaseState,
    cases: Mapping[str, CaseState],
) -> Iterator[Verdict]:
    """Judge the smallest pressure near each bolt of points that the preload presses."""
    if radius is None:
        return
    for bolt_name, bolt in bolts.items():
        near = pressed_near(surfaces, bolt, radius, rest.pressure[0])
        lows = [
            (case, float(one.pressure[:, near].min())) for case, one in cases.items() if near.any()
        ]
        yield no_opening(bolt_name, radius, lows)


def no_opening(bolt: str, radius: float, lows: Sequence[tuple[str, float]]) -> Verdict:
    """Judge the smallest pressures around a bolt, each with its case."""
    if not lows:
        reason = (
            f"the preload presses no contact point within {radius:g} of bolt '{bolt}', so "
            "nothing can open there; give a larger radius for no_opening_within"
        )
        return Verdict.unknown("no_opening_within", radius, reason, bolt)
    case, value = min(lows, key=lambda one: one[1])
    return Verdict(
        requirement="no_opening_within",
        met=value > 0,
        place=bolt,
        case=case,
        value=value,
        limit=radius,
    )


def opening_verdicts(limit: float | None, paths: Mapping[str, Openings]) -> Iterator[Verdict]:
    """Judge the factors at which static load cases open an area."""
    if limit is None:
        return
    factors = {
        (area, case): factor for case, one in paths.items() for area, factor in one.opened.items()
    }
    short = [name for name, one in paths.items() if one.followed < limit and np.isinf(_least(one))]
    if factors:
        place, case = min(factors, key=factors.__getitem__)
        value = factors[place, case]
        if value < limit or not short:
            yield Verdict.at_least("min_opening_factor", place, case, value, limit)
            return
    reason = "no static load was followed to its opening"
    if short:
        reason = f"{short[0]} was followed up to {paths[short[0]].followed:g} times the load"
    yield Verdict.unknown("min_opening_factor", limit, reason)


def _least(openings: Openings) -> float:
    return min(openings.opened.values(), default=np.inf)


def _slip_verdict(
    limit: float | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    """Judge S_G of interfaces with a coefficient, all that acts along them carried by friction."""
    if limit is None:
        return
    found: dict[tuple[str, str], float] = {}
    asked = {
        name: one.slip
        for name, one in interfaces.items()
        if one.slip is not None and one.slip.coefficient is not None
    }
    for name, slip in asked.items():
        if slip.unknown:
            reason = f"what is carried along it is not known: {slip.unknown}"
            yield Verdict.unknown("min_slip_safety", limit, f"{reason}; {NO_SUMS}", name)
        found |= {(name, case): safety for case, safety in slip.safety.items()}
    if found:
        place, case = min(found, key=found.__getitem__)
        yield Verdict.at_least("min_slip_safety", place, case, found[place, case], limit)
    elif not asked:
        yield Verdict.unknown("min_slip_safety", limit, NO_SLIP)
    elif all(not slip.unknown for slip in asked.values()):
        yield Verdict.at_least("min_slip_safety", "", "no load acts along it", np.inf, limit)


def _sliding_verdict(
    requirement: str, limit: float | None, reserves: Mapping[str, SlipReserve]
) -> Iterator[Verdict]:
    """Judge the factors at which interfaces with friction slide as a whole."""
    if limit is None:
        return
    factors = {
        name: np.inf if one.gross_slip is None else one.gross_slip for name, one in reserves.items()
    }
    short = [n for n, one in reserves.items() if np.isinf(factors[n]) and one.largest < limit]
    case = min(factors, key=factors.__getitem__, default="")
    if case and (factors[case] < limit or not short):
        yield Verdict.at_least(requirement, reserves[case].slides, case, factors[case], limit)
        return
    reason = NO_FRICTION
    if short:
        reached = f"{reserves[short[0]].largest:.3g} times {short[0]}"
        reason = f"it holds up to {reached}, where the next increment had no solution"
    yield Verdict.unknown(requirement, limit, reason)


NO_SUMS = (
    "leave it out of slip_friction, add a sticking area, or demand min_sliding_factor of a joint "
    "with friction"
)
"""What to do where sums of forces tell nothing."""

NO_FRICTION = "it is judged by static loads and cycles of joints with friction, and there is none"
"""Why nothing is known of sliding where no load is followed with friction."""

NO_SLIP = (
    "it is judged by static loads or cycles, and a coefficient, that of the interface or "
    "slip_friction, and one of both is missing"
)
"""Why nothing is known of slip where no load and coefficient tells of it."""


def ring_surface(ring: ClosedRing, surfaces: Mapping[str, ContactSurface]) -> str:
    """Return the interface of a ring, the only one where none is named."""
    return ring.interface or next(iter(surfaces))


def ring_verdict(ring: ClosedRing, place: str, case: str, value: float) -> Verdict:
    """Judge the smallest pressure on a ring."""
    return Verdict(
        requirement="closed_ring",
        met=0 < value >= ring.pressure,
        place=place,
        case=case,
        value=value,
        limit=ring.pressure,
    )


def _ring_verdict(
    wanted: ClosedRing, surfaces: Mapping[str, ContactSurface], cases: Mapping[str, CaseState]
) -> Verdict:
    name = ring_surface(wanted, surfaces)
    ring = ring_around(surfaces[name], wanted.around)
    lows = {case: float(ring_pressure(ring, one.pressure).min()) for case, one in cases.items()}
    least = min(lows, key=lows.__getitem__)
    return ring_verdict(wanted, name, least, lows[least])
