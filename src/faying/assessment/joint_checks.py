"""Checks of bolts and interfaces from an assessment: requirements, and general conditions.

Even without requirements, no bolt may yield, and no interface may lose its clamp force, open or
slide under the given loads: the default limit is a load factor of one.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from faying.assessment.check import Check, Outcome, worst_check
from faying.assessment.extremes import find_least, find_most
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.requirements import Verdict
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.clamp_ends import clamp_loss
from faying.units import Units

TIMES_LOAD = "× load"
"""Unit of load factors."""

OF_AREA = "% of what the preload presses"
"""Unit of open areas."""

NO_THREAD = "add its size and grade"
"""Remedy for an unknown strength of a bolt."""

NO_COEFFICIENT = "no coefficient of friction: give slip_friction"
"""Reason for unknown slip along an interface."""


def joint_checks(
    found: Assessment, units: Units, reserves: Mapping[str, SlipReserve] | None = None
) -> tuple[Check, ...]:
    """Return the checks of every bolt and interface, bolts first.

    Slip reserves are by load case, for joints with friction.
    """
    demands: dict[str, list[Verdict]] = {}
    for verdict in found.verdicts:
        demands.setdefault(verdict.requirement, []).append(verdict)
    if reserves and not found.bolts:  # bolts without shear: both are judged by the path
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
        opened = _opening_check(name, interface, found.open_below)
        nominal = [
            *opened,
            *_interface_checks(name, interface, demands, reserves or {}, found.followed, units),
        ]
        checks += _worse_ends([*at_ends, *nominal])
    return tuple(checks)


def _worse_ends(checks: Sequence[Check]) -> Iterator[Check]:
    """Yield one check of each quantity: the worse of nominal and scattered preloads."""
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
    blank = partial(Check, part=name, kind="bolt")
    checks = [check for check in found.checks if (check.kind, check.part) == ("bolt", name)]
    clamps = [check for check in checks if check.quantity.startswith("clamp loss")]
    strength = [check for check in checks if check not in clamps]
    loosened = [check for check in found.loosened if (check.kind, check.part) == ("bolt", name)]
    yield from strength
    if not strength:
        yield blank(quantity="yield", reason=NO_THREAD)
    shared = [
        place
        for place in bolt.clamp_around
        if sum(place in other.clamp_around for other in found.bolts.values()) > 1
    ]
    losses = [
        check
        for place in shared
        for check in clamp_loss(
            blank(quantity=f"clamp loss at {place}"),
            bolt.clamp_around[place].preload,
            bolt.clamp_around[place].least,
            bolt.clamp_around[place].least_case,
        )
    ]
    yield from _most_used([*clamps, *losses])
    demand = demands.get("min_opening_factor", ())
    openings = [
        _followed_factor(blank(quantity=f"opening at {place}"), factors, demand, found.followed)
        for place, factors in bolt.opening_around.items()
        if factors and bolt.clamp_around[place].preload > 0
    ]
    yield from _most_used([*loosened, *openings])
    for verdict in demands.get("no_opening_within", ()):
        if verdict.place == name:
            quantity = f"pressed within {verdict.limit:g} {units.length}"
            yield _requirement_check(blank(quantity=quantity), verdict)


def _local_slip(
    name: str, bolt: BoltAssessment, found: Assessment, demands: Sequence[Verdict]
) -> Iterator[Check]:
    """Yield checks of bolts around which sums exceed friction, but not on the whole interface."""
    limit = max((demand.limit for demand in demands), default=1.0)
    for place, demand in bolt.slip_around.items():
        whole = found.interfaces[place].slip
        if not whole.safety or not demand.safety:
            continue
        (case, around), over_all = find_least(demand.safety), min(whole.safety.values())
        if around < limit <= over_all:
            reason = (
                f"S_G {around:.2f} around it in {case}, {over_all:.2f} of the interface: "
                "its load moves to other bolts, which a friction law of the interface would show"
            )
            yield Check(part=name, kind="bolt", quantity=f"slip at {place}", reason=reason)


def _interface_checks(
    name: str,
    interface: InterfaceAssessment,
    demands: Mapping[str, Sequence[Verdict]],
    reserves: Mapping[str, SlipReserve],
    followed: Mapping[str, float],
    units: Units,
) -> Iterator[Check]:
    blank = partial(Check, part=name, kind="interface")
    demanded = partial(blank, unit=units.pressure, required=True)
    clamps = [demand for demand in demands.get("min_clamp_force", ()) if demand.place == name]
    for clamp in clamps:
        check = demanded(quantity="clamp force", unit=units.force, case=clamp.case)
        yield check.at_least(clamp.value, clamp.limit)
    if not clamps:
        yield from clamp_loss(
            blank(quantity="clamp loss"),
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
            yield demanded(quantity=quantity, case=case).at_most(value, demand.limit)
    for ring in demands.get("closed_ring", ()):
        if ring.place == name:
            yield demanded(
                quantity="pressure on the ring",
                outcome="met" if ring.met else "not met",
                utilisation=ring.limit / ring.value if ring.value > 0 and ring.limit > 0 else None,
                value=ring.value,
                limit=ring.limit,
                case=ring.case,
            )
    factors = demands.get("min_opening_factor", ())
    unknown = [demand.reason for demand in factors if demand.met is None]
    opening = blank(quantity="opening")
    if unknown:
        yield replace(opening, reason=unknown[0], required=True)
    elif interface.preload > 0 and interface.opening:
        yield _followed_factor(opening, interface.opening, factors, followed)
    yield from _slip(name, interface, demands, reserves)


def _opening_check(name: str, interface: InterfaceAssessment, open_below: float) -> Iterator[Check]:
    """Yield the check of the open area in load cases that are not followed to opening."""
    opened = {
        case: share for case, share in interface.opened.items() if case not in interface.opening
    }
    if opened:
        case, share = find_most(opened)
        check = Check(part=name, kind="interface", quantity="open area", case=case, unit=OF_AREA)
        yield check.at_most(100 * share, 100 * (1 - open_below))


def _slip(
    name: str,
    interface: InterfaceAssessment,
    demands: Mapping[str, Sequence[Verdict]],
    reserves: Mapping[str, SlipReserve],
) -> Iterator[Check]:
    """Yield slip by sums of forces, and sliding along load paths with friction."""
    safety, sliding = demands.get("min_slip_safety", ()), demands.get("min_sliding_factor", ())
    unknown = [
        verdict.reason for verdict in safety if verdict.met is None and verdict.place in ("", name)
    ]
    slip, check = interface.slip, Check(part=name, kind="interface", quantity="slip")
    if unknown:
        yield replace(check, reason=unknown[0], required=True)
    elif slip.safety and (safety or not reserves):
        yield _least_factor(check, slip.safety, safety, unit="")
    elif slip.asked and not reserves and not slip.safety:
        if slip.coefficient is None:
            yield replace(check, reason=NO_COEFFICIENT)
        elif slip.unknown:
            yield replace(check, reason=slip.unknown)
        else:
            none = dict.fromkeys(slip.needed_friction, np.inf)
            yield _least_factor(check, none, safety)
    unknown = [demand.reason for demand in sliding if demand.met is None]
    check = Check(part=name, kind="interface", quantity="sliding")
    if unknown:
        yield replace(check, reason=unknown[0], required=True)
    elif reserves:
        yield _sliding(check, reserves, sliding)


def _sliding(
    check: Check, reserves: Mapping[str, SlipReserve], demands: Sequence[Verdict]
) -> Check:
    """Return the check of the factors at which an interface slides, or at which its path ended."""
    slid = {
        case: np.inf
        if reserve.gross_slip is None or reserve.slides != check.part
        else reserve.gross_slip
        for case, reserve in reserves.items()
    }
    followed = {
        case: reserve.largest if reserve.gross_slip is None else reserve.gross_slip
        for case, reserve in reserves.items()
    }
    return _followed_factor(check, slid, demands, followed)


def _followed_factor(
    check: Check,
    factors: Mapping[str, float],
    demands: Sequence[Verdict],
    followed: Mapping[str, float],
) -> Check:
    """Return the check of the smallest load factor, where cases were followed up to others."""
    known = _least_factor(check, factors, demands)
    if known.outcome == "not met":
        return known
    reached = {case: min(factor, followed.get(case, np.inf)) for case, factor in factors.items()}
    held = _least_factor(check, reached, demands)
    if held.outcome == "met":
        return replace(held, beyond=held.value is not None and factors[held.case] > held.value)
    reason = f"it holds up to {held.value:.3g} times {held.case}, where the path ends"
    return replace(check, reason=reason, required=held.required)


def _least_factor(
    check: Check, factors: Mapping[str, float], demands: Sequence[Verdict], unit: str = TIMES_LOAD
) -> Check:
    """Return the check of the smallest load factor over load cases."""
    limit = max((demand.limit for demand in demands), default=1.0)
    case, factor = find_least(factors)
    return replace(check, unit=unit, case=case, required=bool(demands)).at_least(factor, limit)


def _requirement_check(check: Check, verdict: Verdict) -> Check:
    """Return a requirement without a number as a check."""
    if verdict.met is None:
        return replace(check, reason=verdict.reason, required=True)
    outcome: Outcome = "met" if verdict.met else "not met"
    return replace(check, outcome=outcome, case=verdict.case, required=True)


def _most_used(checks: Sequence[Check]) -> Iterator[Check]:
    if checks:
        yield max(checks, key=lambda check: check.utilisation or 0.0)
