"""Requirements judged where they are nearest to failing."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from faying.assessment.joint_record import CaseState, InterfaceAssessment
from faying.assessment.requirements import ClosedRing, Requirements, Verdict
from faying.assessment.sealing import ring_around, ring_pressure
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
    slip: Mapping[str, float],
) -> Iterator[Verdict]:
    """Yield the verdicts on what is required.

    Parameters
    ----------
    slip
        Load case to the factor at which an interface slips as a whole.
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
    yield from _factor_verdict(wanted.min_opening_factor, interfaces)
    yield from _slip_verdict(wanted.min_slip_safety, slip, interfaces)
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


def _factor_verdict(
    limit: float | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    factors = {
        (name, case): factor
        for name, one in interfaces.items()
        for case, factor in one.loss_of_clamp.items()
    }
    if limit is None:
        return
    if not factors:
        reason = (
            "it is judged by following static loads without friction, and none was followed; add "
            "one, take a coarser interface, or leave the requirement out"
        )
        yield Verdict.unknown("min_opening_factor", limit, reason)
        return
    name, case = min(factors, key=factors.__getitem__)
    value = factors[name, case]
    yield Verdict.at_least("min_opening_factor", name, case, value, limit)


def _slip_verdict(
    limit: float | None, slip: Mapping[str, float], interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    """Judge the factors of gross slip, and S_G of interfaces that a coefficient is given for."""
    if limit is None:
        return
    found = {("", case): factor for case, factor in slip.items()}
    for name, one in interfaces.items():
        if one.slip is None or one.slip.coefficient is None:
            continue
        if one.slip.unknown:
            reason = (
                f"what is carried along it is not known: {one.slip.unknown}; give it friction or a "
                "sticking area, or leave it out of slip_friction"
            )
            yield Verdict.unknown("min_slip_safety", limit, reason, name)
            continue
        found |= {(name, case): safety for case, safety in one.slip.safety.items()}
    if found:
        place, case = min(found, key=found.__getitem__)
        yield Verdict.at_least("min_slip_safety", place, case, found[place, case], limit)
    elif not any(one.slip and one.slip.unknown for one in interfaces.values()):
        yield Verdict.unknown("min_slip_safety", limit, NO_SLIP)


NO_SLIP = (
    "it is judged by static loads and cycles with friction, or by static loads and slip_friction, "
    "the coefficient to judge interfaces without friction with, and there is neither"
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
