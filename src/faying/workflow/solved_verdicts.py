"""Requirements judged over many solved cases, from their metrics and envelopes alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.check import Check
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.requirements import ClosedRing, Requirements, Verdict
from faying.assessment.sealing import Ring, ring_around
from faying.assessment.slip_demand import SMALLEST_FRICTION, SlipDemand, slip_coefficients
from faying.assessment.verdicts import (
    no_opening,
    pressure_verdict,
    ring_surface,
    ring_verdict,
    wanted_clamps,
)
from faying.exceptions import ModelError
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import pressed_near
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution
from faying.simulation.static_case import solve_static
from faying.study.inputs.load_set import LoadSet
from faying.study.judgement.margins import NASA, demanded_checks
from faying.workflow.deciding_cases import (
    deciding_loads,
    followed_loads,
    judged_loads,
    loosened_checks,
)
from faying.workflow.solved_cases import SolvedCases
from faying.workflow.solved_strength import BoltStrengths, rest_of, solved_strength


def rings_of(requirements: Requirements, rom: ReducedModel) -> dict[str, Ring]:
    """Return the rings that are demanded, by the name of their metric."""
    named = _named(requirements, rom)
    return {
        name: ring_around(rom.interfaces[ring_surface(ring, rom.interfaces)], ring.around)
        for name, ring in named.items()
    }


def areas_of(requirements: Requirements, rom: ReducedModel) -> dict[str, TangentialRows]:
    """Return what is carried along the interfaces whose slip is judged by sums, by name."""
    if requirements.slip_friction is None:
        return {}
    carried = {rows.interface: rows for rows in rom.tangential if not rows.bolt}
    judged = _coefficients(requirements, rom)
    return {name: carried[name] for name in judged if name in carried and not carried[name].unknown}


def _coefficients(requirements: Requirements, rom: ReducedModel) -> dict[str, float]:
    smooth = [name for name, surface in rom.interfaces.items() if not surface.friction > 0]
    return slip_coefficients(requirements.slip_friction, smooth)


def _named(requirements: Requirements, rom: ReducedModel) -> dict[str, ClosedRing]:
    places = [ring_surface(ring, rom.interfaces) for ring in requirements.closed_ring]
    names = [
        surface if places.count(surface) == 1 else f"{surface}.{places[:number].count(surface) + 1}"
        for number, surface in enumerate(places)
    ]
    return dict(zip(names, requirements.closed_ring, strict=True))


def solved_verdicts(
    requirements: Requirements,
    rom: ReducedModel,
    sets: Mapping[str, SolvedCases],
    factors: Sequence[Verdict],
    preloaded: Solution | None = None,
) -> Iterator[Verdict]:
    """Yield the verdicts on what is required, each where it is nearest to failing.

    Parameters
    ----------
    sets
        Solved cases: static ones under an empty name, and transients by name.
    factors
        Verdicts on load factors of opening, where static cases were followed.
    preloaded
        Preloaded state of a joint with friction.

    """
    for name, force in wanted_clamps(requirements.min_clamp_force, rom.interfaces).items():
        case, value = _extreme(sets, f"clamp_force.{name}", largest=False)
        yield Verdict.at_least("min_clamp_force", name, case, value, force)
    limits = {
        "max_pressure": requirements.max_pressure,
        "max_nodal_pressure": requirements.max_nodal_pressure,
    }
    for requirement, limit in limits.items():
        if limit is None:
            continue
        extremes = {name: _extreme(sets, f"{requirement}.{name}") for name in rom.interfaces}
        yield from pressure_verdict(requirement, limit, extremes)
    yield from _openings(requirements.no_opening_within, rom, sets, preloaded)
    for name, ring in _named(requirements, rom).items():
        case, value = _extreme(sets, f"ring_pressure.{name}", largest=False)
        yield ring_verdict(ring, ring_surface(ring, rom.interfaces), case, value)
    if requirements.min_opening_factor is not None:
        rubs = len(rom.contact.rubbing)
        reason = RUBBED_OPENING if rubs else "there is no static case"
        limit = requirements.min_opening_factor
        yield from factors or [Verdict.unknown("min_opening_factor", limit, reason)]
    if requirements.min_slip_safety is not None:
        yield from _slip(requirements.min_slip_safety, requirements, rom, sets.get(""))
    if requirements.min_sliding_factor is not None:
        reason = "sliding is followed with friction by faying run alone"
        yield Verdict.unknown("min_sliding_factor", requirements.min_sliding_factor, reason)


def solved_assessment(
    requirements: Requirements,
    rom: ReducedModel,
    loads: LoadSet,
    static: SolvedCases | None,
    transients: Mapping[str, SolvedCases],
    preload_state: Solution | None = None,
    strengths: BoltStrengths | None = None,
) -> Assessment:
    """Return bolts and interfaces over all cases, as far as metrics tell, with the verdicts."""
    strength = BoltStrengths() if strengths is None else strengths
    sets = {**({} if static is None else {"": static}), **transients}
    preloaded = solve_static(rom) if preload_state is None else preload_state
    at_rest, rubs = rest_of(rom, preloaded), bool(len(rom.contact.rubbing))
    coefficients = strength.rubbing(rom.interfaces) | _coefficients(requirements, rom)
    deciding = [] if rubs else deciding_loads(loads, static)
    followed = []
    if static is not None and deciding:
        followed = followed_loads(requirements, rom, loads, static, deciding)
    names = {load.name for load in deciding}
    judged_cases = [*deciding, *(load for load in followed if load.name not in names)]
    nominal = None
    if judged_cases:
        opens = {load.name for load in followed}
        nominal = judged_loads(rom, at_rest, judged_cases, opens, requirements, coefficients)
    demands = _slip_demands(requirements, rom, static)
    limits = wanted_clamps(requirements.min_clamp_force, rom.interfaces)
    factors = [] if nominal is None else _opening_verdicts(nominal)
    assessment = Assessment(
        bolts={
            name: _bolt(
                name,
                sets,
                float(np.ravel(preloaded.bolt_force(name))[-1]),
                None if nominal is None else nominal.bolts[name],
            )
            for name in rom.bolts
        },
        interfaces={
            name: _interface(
                name,
                surface,
                sets,
                float(np.ravel(preloaded.contact_force(name))[-1]),
                demands.get(name),
                {} if nominal is None else nominal.interfaces[name].opening,
            )
            for name, surface in rom.interfaces.items()
        },
        verdicts=tuple(solved_verdicts(requirements, rom, sets, factors, preload_state)),
        open_below=requirements.open_share,
        checks=tuple(solved_strength(strength, rom, sets, at_rest, loads, deciding, limits)),
        loosened=()
        if nominal is None
        else loosened_checks(
            rom, at_rest, judged_cases, nominal, requirements, coefficients, strength.ranges
        ),
    )
    factored = deciding_loads(loads, static)
    if strength.margins is None or (strength.margins.standard == NASA and not factored):
        return assessment
    checks = demanded_checks(
        strength.margins,
        strength.ranges,
        rom,
        strength.threads,
        factored,
        coefficients,
        assessment,
        rom.units,
    )
    return replace(assessment, checks=checks)


RUBBED_OPENING = "it is followed with friction by faying run alone"
"""Why nothing is known of the opening of joints with friction."""


def _opening_verdicts(nominal: Assessment) -> list[Verdict]:
    return [verdict for verdict in nominal.verdicts if verdict.requirement == "min_opening_factor"]


def _bolt(
    name: str,
    sets: Mapping[str, SolvedCases],
    preload: float,
    deciding: BoltAssessment | None,
) -> BoltAssessment:
    least_case, smallest = _extreme(sets, f"bolt_force.{name}", largest=False)
    most_case, largest = _extreme(sets, f"bolt_force.{name}")
    return BoltAssessment(
        preload=preload,
        least=smallest,
        least_case=least_case,
        most=largest,
        most_case=most_case,
        axial_loads={} if deciding is None else deciding.axial_loads,
        load_factors={} if deciding is None else deciding.load_factors,
        clamp_around={} if deciding is None else deciding.clamp_around,
        opening_around={} if deciding is None else deciding.opening_around,
    )


def _interface(
    name: str,
    surface: ContactSurface,
    sets: Mapping[str, SolvedCases],
    preload: float,
    slip: SlipDemand | None,
    opening: Mapping[str, float],
) -> InterfaceAssessment:
    least_case, smallest = _extreme(sets, f"clamp_force.{name}", largest=False)
    most_case, largest = _extreme(sets, f"clamp_force.{name}")
    pressure_case, pressure = _extreme(sets, f"max_pressure.{name}")
    mean_case, mean = _extreme(sets, f"max_nodal_pressure.{name}")
    open_case, open_area = _extreme(sets, f"open_area.{name}")
    return InterfaceAssessment(
        preload=preload,
        least_clamp=smallest,
        least_clamp_case=least_case,
        certified=None,
        most_clamp=largest,
        most_clamp_case=most_case,
        certified_most=None,
        certified_width=None,
        max_pressure=pressure,
        max_pressure_case=pressure_case,
        max_pressure_point=np.full(3, np.nan),
        max_nodal_pressure=mean,
        max_nodal_pressure_case=mean_case,
        closed_area=float(surface.weights.sum()) - open_area,
        closed_area_case=open_case,
        first_opening={},
        loss_of_clamp={},
        opening=opening,
        slip=slip,
    )


def sliding_checks(
    rom: ReducedModel, static: SolvedCases | None, transients: Mapping[str, SolvedCases]
) -> Iterator[Check]:
    """Judge interfaces with friction: what sticks somewhere in a case does not slide in it."""
    sets = {**({} if static is None else {"": static}), **transients}
    for name, surface in rom.interfaces.items():
        if not surface.friction > 0:
            continue
        shares: list[tuple[float, str]] = []
        for label, cases in sets.items():
            open_area, at_bound = (
                cases.column(f"{metric}.{name}") for metric in ("open_area", "area_at_bound")
            )
            closed = surface.weights.sum() - open_area
            slips = np.where(closed > 0, at_bound / np.where(closed > 0, closed, 1.0), 0.0)
            if not np.isnan(slips).all():
                row = int(np.nanargmax(slips))
                shares.append((float(slips[row]), cases.named(label, row)))
        share, case = max(shares, default=(np.inf, ""))
        slides = share > 1 - ALL
        yield Check(
            part=name,
            kind="interface",
            quantity="slipping share",
            outcome="unknown" if slides else "met",
            utilisation=share,
            value=100 * share,
            limit=100.0,
            unit="%",
            case=case,
            reason=SLIPS_ALL if slides else "",
        )


ALL = 1e-9
"""Distance from one from which a share of area is all of it: round-off of sums."""

SLIPS_ALL = "all that touches is at its friction bound; faying run tells whether it slides"
"""Why nothing is known of an interface that sticks nowhere."""


def _slip_demands(
    requirements: Requirements, rom: ReducedModel, static: SolvedCases | None
) -> dict[str, SlipDemand]:
    """Return the friction that static cases need at most of interfaces without any."""
    if static is None:
        return {}
    coefficients, carried = _coefficients(requirements, rom), areas_of(requirements, rom)
    unknown = {rows.interface: rows.unknown for rows in rom.tangential if not rows.bolt}
    demands = {}
    for name, surface in rom.interfaces.items():
        coefficient = coefficients.get(name)
        if surface.friction > 0:
            continue
        if name in carried and coefficient is not None:
            case, needed = _extreme({"": static}, f"needed_friction.{name}")
            safety = {case: coefficient / needed} if needed > SMALLEST_FRICTION else {}
            demands[name] = SlipDemand(
                needed_friction={case: needed}, coefficient=coefficient, safety=safety
            )
        else:
            why = unknown.get(name) or UNTOLD
            demands[name] = SlipDemand(coefficient=coefficient, unknown=why)
    return demands


UNTOLD = "the file does not tell what is carried along it; reduce the study again"
"""Why nothing is known of slip by sums in files of earlier versions."""


def _slip(
    limit: float, requirements: Requirements, rom: ReducedModel, static: SolvedCases | None
) -> Iterator[Verdict]:
    """Judge S_G of the static cases, by sums."""
    coefficients, carried = _coefficients(requirements, rom), areas_of(requirements, rom)
    if static is None or not coefficients:
        missing = "no slip_friction is given" if not coefficients else "there is no static case"
        reason = (
            f"it is judged by sums over static cases, with slip_friction, and {missing}; of joints "
            "with friction by faying run alone"
        )
        yield Verdict.unknown("min_slip_safety", limit, reason)
        return
    unknown = {rows.interface: rows.unknown for rows in rom.tangential if not rows.bolt}
    safeties: list[tuple[float, str, str]] = []
    for name, coefficient in coefficients.items():
        if name not in carried:
            why = unknown.get(name, UNTOLD)
            yield Verdict.unknown("min_slip_safety", limit, why, name)
            continue
        case, needed = _extreme({"": static}, f"needed_friction.{name}")
        safeties.append(
            (coefficient / needed if needed > SMALLEST_FRICTION else np.inf, name, case)
        )
    if safeties:
        value, interface, case = min(safeties)
        yield Verdict.at_least("min_slip_safety", interface, case, value, limit)


def _extreme(
    sets: Mapping[str, SolvedCases], metric: str, *, largest: bool = True
) -> tuple[str, float]:
    """Return the case, or history and instant, of an extreme value, and the value.

    Of clamp forces of certified cases it is the lower end of the interval.
    """
    best: list[tuple[str, float]] = []
    for name, cases in sets.items():
        names = {entry.name for entry in cases.metrics}
        low = metric.replace("clamp_force.", "clamp_force_low.", 1)
        extreme = cases.extreme(low if low in names else metric, largest=largest)
        if extreme is not None:
            best.append((cases.named(name, extreme[0]), extreme[1]))
    if not best:
        message = "no case was solved, so there is nothing to judge"
        raise ModelError(message)
    return (max if largest else min)(best, key=lambda entry: entry[1])


def _openings(
    radius: float | None, rom: ReducedModel, sets: Mapping[str, SolvedCases], state: Solution | None
) -> Iterator[Verdict]:
    if radius is None:
        return
    preload = (solve_static(rom) if state is None else state).pressure
    envelopes = {name: cases.envelope() for name, cases in sets.items()}
    for bolt_name, bolt in rom.bolts.items():
        points = np.flatnonzero(pressed_near(rom.interfaces, bolt, radius, preload))
        lows: list[tuple[str, float]] = []
        for name, envelope in envelopes.items():
            if envelope is not None and len(points):
                point = points[envelope.min_pressure[points].argmin()]
                case = sets[name].named(name, int(envelope.min_pressure_case[point]))
                lows.append((case, float(envelope.min_pressure[point])))
        yield no_opening(bolt_name, radius, lows)
