"""Verdicts on requirements in their most critical place and case."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from faying.assessment.extremes import find_least, find_most
from faying.assessment.joint_record import CaseState, InterfaceAssessment
from faying.assessment.opening import Openings
from faying.assessment.requirements import ClosedRing, Requirements, Verdict
from faying.assessment.sealing import ring_around, ring_pressure
from faying.assessment.slip_reserve import SlipReserve
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import pressed_near
from faying.model.bolt import Bolt


def verdicts(
    requirements: Requirements,
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    interfaces: Mapping[str, InterfaceAssessment],
    paths: Mapping[str, Openings],
    reserves: Mapping[str, SlipReserve],
) -> Iterator[Verdict]:
    """Yield the verdicts on all requirements.

    Paths are the openings of static load cases, reserves those against slip of joints with
    friction.
    """
    yield from _clamp_verdict(requirements.min_clamp_force, interfaces)
    peaks = {(name, item.max_pressure_case): item.max_pressure for name, item in interfaces.items()}
    yield from _pressure_verdict("max_pressure", requirements.max_pressure, peaks)
    means = {
        (name, item.max_nodal_pressure_case): item.max_nodal_pressure
        for name, item in interfaces.items()
    }
    yield from _pressure_verdict("max_nodal_pressure", requirements.max_nodal_pressure, means)
    yield from _opening_verdict(requirements.no_opening_within, surfaces, bolts, preloaded, cases)
    yield from _opening_verdicts(requirements.min_opening_factor, paths)
    if bolts or not reserves:
        remedy = SLIDING_INSTEAD if reserves else NO_SUMS
        yield from _slip_verdict(requirements.min_slip_safety, interfaces, remedy)
    else:
        yield from _sliding_verdict("min_slip_safety", requirements.min_slip_safety, reserves)
    yield from _sliding_verdict("min_sliding_factor", requirements.min_sliding_factor, reserves)
    for ring in requirements.closed_ring:
        yield _ring_verdict(ring, surfaces, cases)


def _clamp_verdict(
    limit: float | Mapping[str, float] | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    """Yield the verdict on the least clamp force, by its certified lower bound if there is one."""
    for name, demanded in wanted_clamps(limit, interfaces).items():
        interface = interfaces[name]
        value = (
            interface.least_clamp if interface.certified is None else float(interface.certified[0])
        )
        yield Verdict.at_least("min_clamp_force", name, interface.least_clamp_case, value, demanded)


def wanted_clamps(
    limit: float | Mapping[str, float] | None, interfaces: Iterable[str]
) -> Mapping[str, float]:
    """Return the required clamp force of each interface that has one."""
    if limit is None:
        return {}
    return limit if isinstance(limit, Mapping) else dict.fromkeys(interfaces, limit)


def _pressure_verdict(
    requirement: str, limit: float | None, peaks: Mapping[tuple[str, str], float]
) -> Iterator[Verdict]:
    """Yield the verdict on the largest pressures of the interfaces, each with its case."""
    if limit is None:
        return
    (name, case), value = find_most(peaks)
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
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
) -> Iterator[Verdict]:
    """Yield the verdict on the smallest pressure near each bolt, under preload pressure."""
    if radius is None:
        return
    for bolt_name, bolt in bolts.items():
        masked = pressed_near(surfaces, bolt, radius, preloaded.pressure[0])
        if not masked.any():
            reason = (
                f"the preload presses no contact point within {radius:g} of bolt '{bolt_name}', so "
                "nothing can open there; give a larger radius for no_opening_within"
            )
            yield Verdict.unknown("no_opening_within", radius, reason, bolt_name)
            continue
        case, value = find_least(
            {case: float(state.pressure[:, masked].min()) for case, state in cases.items()}
        )
        yield Verdict(
            requirement="no_opening_within",
            met=value > 0,
            place=bolt_name,
            case=case,
            value=value,
            limit=radius,
        )


def _opening_verdicts(limit: float | None, paths: Mapping[str, Openings]) -> Iterator[Verdict]:
    """Yield the verdicts on the factors at which static load cases open an area."""
    if limit is None:
        return
    factors = {
        (area, case): factor for case, path in paths.items() for area, factor in path.opened.items()
    }
    short = [
        f"{name} was followed up to {path.followed:g} times the load"
        for name, path in paths.items()
        if path.followed < limit and np.isinf(min(path.opened.values(), default=np.inf))
    ]
    none = "no static load was followed to its opening"
    yield _least_factor("min_opening_factor", limit, factors, short, none)


def _least_factor(
    requirement: str,
    limit: float,
    factors: Mapping[tuple[str, str], float],
    short: Sequence[str],
    none: str,
) -> Verdict:
    """Return the verdict on the least factor over places and cases, where some are unknown."""
    if factors:
        (place, case), factor = find_least(factors)
        if factor < limit or not short:
            return Verdict.at_least(requirement, place, case, factor, limit)
    return Verdict.unknown(requirement, limit, short[0] if short else none)


def _slip_verdict(
    limit: float | None, interfaces: Mapping[str, InterfaceAssessment], remedy: str
) -> Iterator[Verdict]:
    """Yield the verdict on S_G of interfaces with a coefficient, all shear by friction."""
    if limit is None:
        return
    safeties: dict[tuple[str, str], float] = {}
    asked = {
        name: interface.slip
        for name, interface in interfaces.items()
        if interface.slip.coefficient is not None
    }
    for name, slip in asked.items():
        if slip.unknown:
            reason = f"what is carried along it is not known: {slip.unknown}"
            yield Verdict.unknown("min_slip_safety", limit, f"{reason}; {remedy}", name)
        safeties |= {(name, case): safety for case, safety in slip.safety.items()}
    if safeties:
        (name, case), safety = find_least(safeties)
        yield Verdict.at_least("min_slip_safety", name, case, safety, limit)
    elif not asked:
        yield Verdict.unknown("min_slip_safety", limit, NO_SLIP)
    elif all(not slip.unknown for slip in asked.values()):
        yield Verdict.at_least("min_slip_safety", "", "no load acts along it", np.inf, limit)


def _sliding_verdict(
    requirement: str, limit: float | None, reserves: Mapping[str, SlipReserve]
) -> Iterator[Verdict]:
    """Yield the verdict on the factors at which interfaces slide as a whole."""
    if limit is None:
        return
    factors = {
        (item.slides, case): np.inf if item.gross_slip is None else item.gross_slip
        for case, item in reserves.items()
    }
    short = [
        f"it holds up to {item.largest:.3g} times {case}, where the next increment had no solution"
        for case, item in reserves.items()
        if item.gross_slip is None and item.largest < limit
    ]
    yield _least_factor(requirement, limit, factors, short, NO_FRICTION)


NO_SUMS = (
    "leave it out of slip_friction, or give the interface 'friction' and demand min_sliding_factor"
)
SLIDING_INSTEAD = "demand min_sliding_factor in place of min_slip_safety: load paths answer it"
"""Remedies where slip by sums is unknown."""

NO_FRICTION = "it is judged by static loads and cycles of joints with friction, and there is none"
"""Reason for unknown sliding without load paths with friction."""

NO_SLIP = (
    "it is judged by static loads or cycles with a coefficient of friction: add what is missing, "
    "the coefficient to the interface or as slip_friction"
)
"""Reason for unknown slip without static loads or a coefficient."""


def ring_surface(ring: ClosedRing, surfaces: Mapping[str, ContactSurface]) -> str:
    """Return the interface of a ring, by default the only one."""
    return ring.interface or next(iter(surfaces))


def _ring_verdict(
    ring_limit: ClosedRing, surfaces: Mapping[str, ContactSurface], cases: Mapping[str, CaseState]
) -> Verdict:
    name = ring_surface(ring_limit, surfaces)
    ring = ring_around(surfaces[name], ring_limit.around)
    lowest, pressure = find_least(
        {case: float(ring_pressure(ring, state.pressure).min()) for case, state in cases.items()}
    )
    return Verdict(
        requirement="closed_ring",
        met=0 < pressure >= ring_limit.pressure,
        place=name,
        case=lowest,
        value=pressure,
        limit=ring_limit.pressure,
    )
