"""Checks of bolts and interfaces from an assessment: what is demanded, and what must hold anyway.

Demanded or not, no bolt may yield, no interface may lose its clamp force, open or slide under the
loads themselves: where the study demands no more, the limit is one times the load.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from faying.assessment.check import Check, PartKind, worst_check
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.requirements import Verdict
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.clamp_ends import clamp_loss
from faying.units import Units

TIMES_LOAD = "× load"
"""Unit of load factors."""

NO_THREAD = "add its size and grade"
"""Why nothing is known of the strength of a bolt."""

NO_COEFFICIENT = "no coefficient of friction: give slip_friction"
"""Why nothing is known of slip along an interface."""


def joint_checks(
    found: Assessment, units: Units, reserves: Mapping[str, SlipReserve] | None = None
) -> tuple[Check, ...]:
    """Return the checks of every bolt and interface, bolts first.

    Slip reserves are those of load cases of joints with friction.
    """
    demands: dict[str, list[Verdict]] = {}
    for verdict in found.verdicts:
        demands.setdefault(verdict.requirement, []).append(verdict)
    if reserves and not found.bolts:  # no bolts carry shear, and both are judged by the path
        demands.setdefault("min_sliding_factor", []).extend(demands.pop("min_slip_safety", ()))
    checks: list[Check] = []
    for name, bolt in found.bolts.items():
        checks += _bolt_checks(name, bolt, found, demands, units)
        if not reserves:
            checks += _local_slip(name, bolt, found, demands.get("min_slip_safety", ()))
    for name, interface in found.interfaces.items():
        at_ends = [
            check
            for check in (*found.checks, *found.loosened)
            if (check.kind, check.part) == ("interface", name)
        ]
        nominal = _interface_checks(name, interface, demands, reserves or {}, units)
        checks += _worse_ends([*at_ends, *nominal])
    return tuple(checks)


def _worse_ends(checks: Sequence[Check]) -> Iterator[Check]:
    """Yield one check of each quantity: of preloads that were meant and that scatter, the worse."""
    by_quantity: dict[str, list[Check]] = {}
    for check in checks:
        by_quantity.setdefault(check.quantity, []).append(check)
    for found in by_quantity.values():
        worst = worst_check(tuple(found))
        if worst is not None:
            yield worst


def _bolt_checks(
    name: str,
    bolt: BoltAssessment,
    found: Assessment,
    demands: Mapping[str, Sequence[Verdict]],
    units: Units,
) -> Iterator[Check]:
    checks = [check for check in found.checks if (check.kind, check.part) == ("bolt", name)]
    clamps = [check for check in checks if check.quantity.startswith("clamp loss")]
    strength = [check for check in checks if check not in clamps]
    loosened = [check for check in found.loosened if (check.kind, check.part) == ("bolt", name)]
    yield from strength
    if not strength:
        yield _unknown(name, "bolt", "yield", NO_THREAD)
    shared = [
        place
        for place in bolt.clamp_around
        if sum(place in other.clamp_around for other in found.bolts.values()) > 1
    ]
    losses = [
        check
        for place in shared
        for check in clamp_loss(
            name,
            "bolt",
            f"clamp loss at {place}",
            bolt.clamp_around[place].preload,
            bolt.clamp_around[place].least,
            bolt.clamp_around[place].least_case,
        )
    ]
    yield from _most_used([*clamps, *losses])
    demand = demands.get("min_opening_factor", ())
    openings = [
        _least_factor(name, "bolt", f"opening at {place}", factors, demand)
        for place, factors in bolt.opening_around.items()
        if factors and bolt.clamp_around[place].preload > 0
    ]
    yield from _most_used([*loosened, *openings])
    for verdict in demands.get("no_opening_within", ()):
        if verdict.place == name:
            yield _judged(verdict, "bolt", f"pressed within {verdict.limit:g} {units.length}")


def _local_slip(
    name: str, bolt: BoltAssessment, found: Assessment, demands: Sequence[Verdict]
) -> Iterator[Check]:
    """Yield where the sums around a bolt exceed friction while those of its interface do not."""
    limit = max((demand.limit for demand in demands), default=1.0)
    for place, demand in bolt.slip_around.items():
        whole = found.interfaces[place].slip
        if whole is None or not whole.safety or not demand.safety:
            continue
        case, least = min(demand.safety, key=demand.safety.__getitem__), min(whole.safety.values())
        if demand.safety[case] < limit <= least:
            reason = (
                f"S_G {demand.safety[case]:.2f} around it in {case}, {least:.2f} of the interface: "
                "what slips there others carry, which friction of the interface would tell"
            )
            yield _unknown(name, "bolt", f"slip at {place}", reason)


def _interface_checks(
    name: str,
    interface: InterfaceAssessment,
    demands: Mapping[str, Sequence[Verdict]],
    reserves: Mapping[str, SlipReserve],
    units: Units,
) -> Iterator[Check]:
    clamps = [demand for demand in demands.get("min_clamp_force", ()) if demand.place == name]
    if clamps:
        (clamp,) = clamps
        used = clamp.limit / clamp.value if clamp.value > 0 else np.inf
        yield _judged(clamp, "interface", "clamp force", used, units.force)
    else:
        yield from clamp_loss(
            name,
            "interface",
            "clamp loss",
            interface.preload,
            interface.least_clamp,
            interface.least_clamp_case,
        )
    pressures = {
        "max_pressure": ("pressure", interface.max_pressure, interface.max_pressure_case),
        "max_nodal_pressure": (
            "pressure, nodal average",
            interface.max_nodal_pressure,
            interface.max_nodal_pressure_case,
        ),
    }
    for requirement, (quantity, value, case) in pressures.items():
        for demand in demands.get(requirement, ()):
            yield _at_most(name, quantity, case, value, demand.limit, units.pressure)
    for ring in demands.get("closed_ring", ()):
        if ring.place == name:
            share = ring.limit / ring.value if ring.value > 0 and ring.limit > 0 else None
            yield _judged(ring, "interface", "pressure on the ring", share, units.pressure)
    factors = demands.get("min_opening_factor", ())
    if interface.preload > 0 or any(demand.met is None for demand in factors):
        yield from _opening(name, interface, factors)
    yield from _slip(name, interface, demands, reserves)


def _opening(
    name: str, interface: InterfaceAssessment, demands: Sequence[Verdict]
) -> Iterator[Check]:
    unknown = [one for one in demands if one.met is None]
    if unknown:
        yield _unknown(name, "interface", "opening", unknown[0].reason, required=True)
    elif interface.opening:
        yield _least_factor(name, "interface", "opening", interface.opening, demands)


def _slip(
    name: str,
    interface: InterfaceAssessment,
    demands: Mapping[str, Sequence[Verdict]],
    reserves: Mapping[str, SlipReserve],
) -> Iterator[Check]:
    """Yield slip by sums of forces, and sliding as a load is followed with friction."""
    safety, sliding = demands.get("min_slip_safety", ()), demands.get("min_sliding_factor", ())
    unknown = [one for one in safety if one.met is None and one.place in ("", name)]
    slip = interface.slip
    if unknown:
        yield _unknown(name, "interface", "slip", unknown[0].reason, required=True)
    elif slip is not None and slip.safety and (safety or not reserves):
        yield _least_factor(name, "interface", "slip", slip.safety, safety, unit="")
    elif slip is not None and not reserves and not slip.safety:
        if slip.coefficient is None:
            yield _unknown(name, "interface", "slip", NO_COEFFICIENT)
        elif slip.unknown:
            yield _unknown(name, "interface", "slip", slip.unknown)
        else:
            yield _least_factor(
                name, "interface", "slip", dict.fromkeys(slip.needed_friction, np.inf), safety
            )
    unknown = [one for one in sliding if one.met is None]
    if unknown:
        yield _unknown(name, "interface", "sliding", unknown[0].reason, required=True)
    elif reserves:
        yield _sliding(name, reserves, sliding)


def _sliding(name: str, reserves: Mapping[str, SlipReserve], demands: Sequence[Verdict]) -> Check:
    """Judge the factors at which an interface slides, or up to which its joint was followed."""
    factors = {
        case: one.gross_slip
        for case, one in reserves.items()
        if one.gross_slip is not None and one.slides == name
    }
    if factors:
        return _least_factor(name, "interface", "sliding", factors, demands)
    followed = {
        case: one.largest if one.gross_slip is None else one.gross_slip
        for case, one in reserves.items()
    }
    check = _least_factor(name, "interface", "sliding", followed, demands)
    if check.outcome == "met":
        return check
    reached = f"it holds up to {check.value:.3g} times {check.case}, where the path ends"
    return _unknown(name, "interface", "sliding", reached, required=check.required)


def _least_factor(
    part: str,
    kind: PartKind,
    quantity: str,
    factors: Mapping[str, float],
    demands: Sequence[Verdict],
    unit: str = TIMES_LOAD,
) -> Check:
    """Judge the least of the factors that load cases may be multiplied by."""
    limit = max((demand.limit for demand in demands), default=1.0)
    case = min(factors, key=factors.__getitem__)
    factor = factors[case]
    finite = bool(np.isfinite(factor))
    return Check(
        part=part,
        kind=kind,
        quantity=quantity,
        outcome="met" if factor >= limit else "not met",
        utilisation=limit / factor if factor > 0 else np.inf,
        value=factor if finite else None,
        limit=limit,
        unit=unit,
        case=case if finite else "",
        required=bool(demands),
    )


def _at_most(part: str, quantity: str, case: str, value: float, limit: float, unit: str) -> Check:
    return Check(
        part=part,
        kind="interface",
        quantity=quantity,
        outcome="met" if value <= limit else "not met",
        utilisation=value / limit if limit > 0 else None,
        value=value,
        limit=limit,
        unit=unit,
        case=case,
        required=True,
    )


def _judged(
    verdict: Verdict, kind: PartKind, quantity: str, used: float | None = None, unit: str = ""
) -> Check:
    """Return a requirement on one bolt or interface as a check of it."""
    if verdict.met is None:
        return _unknown(verdict.place, kind, quantity, verdict.reason, required=True)
    return Check(
        part=verdict.place,
        kind=kind,
        quantity=quantity,
        outcome="met" if verdict.met else "not met",
        utilisation=used,
        value=verdict.value if unit else None,
        limit=verdict.limit if unit else None,
        unit=unit,
        case=verdict.case,
        required=True,
    )


def _unknown(
    part: str, kind: PartKind, quantity: str, reason: str, *, required: bool = False
) -> Check:
    return Check(
        part=part, kind=kind, quantity=quantity, outcome="unknown", reason=reason, required=required
    )


def _most_used(checks: Sequence[Check]) -> Iterator[Check]:
    if checks:
        yield max(checks, key=lambda check: check.utilisation or 0.0)
