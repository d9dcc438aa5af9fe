"""Requirements judged where they are nearest to failing."""

from collections.abc import Iterator, Mapping

from faying.assessment.bolt_surroundings import pressed_near
from faying.assessment.joint_record import CaseState, InterfaceAssessment
from faying.assessment.requirements import Requirements, Verdict
from faying.exceptions import ModelError
from faying.interface.surface import ContactSurface
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
    yield from _pressure_verdict(wanted.max_pressure, interfaces)
    yield from _opening_verdict(wanted.no_opening_within, surfaces, bolts, rest, cases)
    yield from _factor_verdict(wanted.min_opening_factor, interfaces)
    yield from _slip_verdict(wanted.min_slip_safety, slip)


def _clamp_verdict(
    limit: float | Mapping[str, float] | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    """Judge the least clamp force by the lower end of its certified interval, where it has one."""
    if limit is None:
        return
    limits = limit if isinstance(limit, Mapping) else dict.fromkeys(interfaces, limit)
    unknown = sorted(set(limits) - set(interfaces))
    if unknown:
        known = ", ".join(interfaces)
        message = f"min_clamp_force: there is no interface '{unknown[0]}'; there are {known}"
        raise ModelError(message)
    for name, least in limits.items():
        one = interfaces[name]
        value = one.least_clamp if one.certified is None else float(one.certified[0])
        yield Verdict(
            requirement="min_clamp_force",
            met=value >= least,
            place=name,
            case=one.least_clamp_case,
            value=value,
            limit=least,
        )


def _pressure_verdict(
    limit: float | None, interfaces: Mapping[str, InterfaceAssessment]
) -> Iterator[Verdict]:
    if limit is None:
        return
    name = max(interfaces, key=lambda one: interfaces[one].max_pressure)
    worst = interfaces[name]
    yield Verdict(
        requirement="max_pressure",
        met=worst.max_pressure <= limit,
        place=name,
        case=worst.max_pressure_case,
        value=worst.max_pressure,
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
        if not near.any():
            message = (
                f"the preload presses no contact point within {radius:g} of bolt '{bolt_name}', so "
                "nothing can open there; give a larger radius for no_opening_within"
            )
            raise ModelError(message)
        lows = {case: one.pressure[:, near].min() for case, one in cases.items()}
        least = min(lows, key=lows.__getitem__)
        yield Verdict(
            requirement="no_opening_within",
            met=bool(lows[least] > 0),
            place=bolt_name,
            case=least,
            value=float(lows[least]),
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
        message = (
            "min_opening_factor is judged by following static loads without friction, and none "
            "was followed; add one, take a coarser interface, or leave the requirement out"
        )
        raise ModelError(message)
    name, case = min(factors, key=factors.__getitem__)
    value = factors[name, case]
    yield Verdict(
        requirement="min_opening_factor",
        met=value >= limit,
        place=name,
        case=case,
        value=value,
        limit=limit,
    )


def _slip_verdict(limit: float | None, slip: Mapping[str, float]) -> Iterator[Verdict]:
    if limit is None:
        return
    if not slip:
        message = (
            "min_slip_safety is judged by static loads and cycles with friction, and there is "
            "none; give an interface friction, or leave the requirement out"
        )
        raise ModelError(message)
    case = min(slip, key=slip.__getitem__)
    yield Verdict(
        requirement="min_slip_safety",
        met=slip[case] >= limit,
        place="",
        case=case,
        value=slip[case],
        limit=limit,
    )
