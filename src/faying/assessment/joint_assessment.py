"""Assessment of a joint over its load cases: bolts, interfaces and requirements."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Mask
from faying.assessment.check import Check
from faying.assessment.extremes import find_least, find_most
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_record import (
    Assessment,
    BoltAssessment,
    CaseState,
    ClampRange,
    InterfaceAssessment,
    bending_of,
    clamp_range,
)
from faying.assessment.opening import Openings, area_name
from faying.assessment.requirements import Requirements
from faying.assessment.slip_demand import NO_DEMAND, SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.preload_ends import LEAST
from faying.assessment.verdicts import verdicts, wanted_clamps
from faying.digits import DECK_DIGITS
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import contact_areas, nearest_bolts
from faying.model.bolt import Bolt
from faying.units import Units

SMALLEST_AXIAL_SHARE = 0.2
"""Axial load over all force changes in a bolt and around it, above which a load factor is given.

It is up to one where a load lifts a flange off, 0.4 to 0.6 on a tee and a pipe flange in tension.
Where a load bends or turns the joint, pressure moves from one side of the bolt to the other, and
the ratio is 0 to 0.03, of any sign.
"""


def judged(
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    requirements: Requirements | None = None,
    paths: Mapping[str, Openings] | None = None,
    reserves: Mapping[str, SlipReserve] | None = None,
    demands: Mapping[tuple[str, str], SlipDemand] | None = None,
    opens: Mapping[str, CaseState] | None = None,
) -> Assessment:
    """Return the assessment of a joint over solved load cases, static or transient.

    Paths and slip reserves belong to load cases: paths to those that were followed, reserves to
    joints with friction. Demands are the friction that static cases need, by interface and bolt, or
    no bolt. ``opens`` are the load cases whose open area is reported.
    """
    followed_paths, limits = paths or {}, requirements or Requirements()
    needed = demands or {}
    clamps = {
        area: clamp_range(
            float(preloaded.pressure[0] @ weights),
            {case: state.pressure @ weights for case, state in cases.items()},
            {case: state.certified[area] for case, state in cases.items() if state.certified},
        )
        for area, weights in contact_areas(surfaces, bolts).items()
    }
    interfaces = {
        name: replace(
            _interface(surface, cases, clamps[name, ""]),
            slip=needed.get((name, ""), NO_DEMAND),
            opening=_openings(followed_paths, name),
            opened=_open_shares(surface, preloaded, opens or {}),
        )
        for name, surface in surfaces.items()
    }
    nearest = {name: nearest_bolts(item.points, bolts) for name, item in surfaces.items() if bolts}
    return Assessment(
        bolts={
            name: replace(
                _bolt(
                    name,
                    surfaces,
                    {
                        side: closest == number
                        for side, closest in nearest.items()
                        if number in closest
                    },
                    preloaded,
                    cases,
                    {side: clamp for (side, bolt), clamp in clamps.items() if bolt == name},
                ),
                slip_around={side: item for (side, bolt), item in needed.items() if bolt == name},
                opening_around={
                    side: factors
                    for side in surfaces
                    if (factors := _openings(followed_paths, area_name(side, name)))
                },
            )
            for number, name in enumerate(bolts)
        },
        interfaces=interfaces,
        verdicts=tuple(
            verdicts(
                limits,
                surfaces,
                bolts,
                preloaded,
                cases,
                interfaces,
                followed_paths,
                reserves or {},
            )
        ),
        open_below=limits.open_share,
        followed={case: path.followed for case, path in followed_paths.items()},
    )


LOOSE = ("opening", "slip", "sliding")
"""Quantities judged at the least preloads."""


def loosest_checks(
    loose: Assessment, units: Units, reserves: Mapping[str, SlipReserve]
) -> tuple[Check, ...]:
    """Return the checks of opening, slip and sliding of a joint assessed at P_p,min."""
    return tuple(
        replace(check, scatter=LEAST)
        for check in joint_checks(loose, units, reserves)
        if check.quantity.split(" at ")[0] in LOOSE and check.outcome != "unknown"
    )


DISSIMILAR = (
    "its preloads scatter, and loads with friction are not solved there: gaps, a curve of closure "
    "or bolts that scatter differently keep it from changing in proportion; run the study at the "
    "smallest preloads, without scatter"
)
"""Reason of unknown checks at P_p,min."""


def dissimilar_checks(found: Assessment, limits: Requirements) -> Iterator[Check]:
    """Yield unknown checks of interfaces with friction whose states at P_p,min are not similar."""
    required = {
        "opening": limits.min_opening_factor is not None,
        "sliding": limits.min_sliding_factor is not None,
    }
    for name in found.interfaces:
        clamped = name in wanted_clamps(limits.min_clamp_force, found.interfaces)
        quantities = {"clamp force" if clamped else "clamp loss": clamped, **required}
        for quantity, asked in quantities.items():
            unknown = Check(part=name, kind="interface", quantity=quantity, scatter=LEAST)
            yield replace(unknown, reason=DISSIMILAR, required=asked)


def _interface(
    surface: ContactSurface, cases: Mapping[str, CaseState], clamp: ClampRange
) -> InterfaceAssessment:
    points, weights = slice(*surface.slice), surface.weights
    pressures = {case: state.pressure[:, points] for case, state in cases.items()}
    smallest, closed = find_least(
        {n: float(((p > 0) @ weights).min()) for n, p in pressures.items()}
    )
    highest, peak = find_most({n: float(p.max()) for n, p in pressures.items()})
    crushed, mean = find_most(
        {n: float(surface.nodal_average(p.T).max(initial=0.0)) for n, p in pressures.items()}
    )
    return InterfaceAssessment(
        preload=clamp.preload,
        least_clamp=clamp.least,
        least_clamp_case=clamp.least_case,
        certified=clamp.certified_least,
        most_clamp=clamp.most,
        most_clamp_case=clamp.most_case,
        certified_most=clamp.certified_most,
        certified_width=clamp.certified_width,
        max_pressure=peak,
        max_pressure_case=highest,
        max_pressure_point=surface.points[pressures[highest].max(axis=0).argmax()],
        max_nodal_pressure=mean,
        max_nodal_pressure_case=crushed,
        closed_area=closed,
        closed_area_case=smallest,
    )


def _open_shares(
    surface: ContactSurface, preloaded: CaseState, cases: Mapping[str, CaseState]
) -> dict[str, float]:
    """Return the largest open share of the area under preload pressure, by load cases."""
    points = slice(*surface.slice)
    pressed = np.where(preloaded.pressure[0, points] > 0, surface.weights, 0.0)
    if not pressed.any():
        return {}
    return {
        name: 1.0 - float(((state.pressure[:, points] > 0) @ pressed).min()) / float(pressed.sum())
        for name, state in cases.items()
        if not state.retightened
    }


def _openings(paths: Mapping[str, Openings], area: str) -> dict[str, float]:
    """Return the factors at which followed load cases open an area."""
    return {case: path.opened[area] for case, path in paths.items() if area in path.opened}


def _bolt(
    name: str,
    surfaces: Mapping[str, ContactSurface],
    masks: Mapping[str, Mask],
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    clamps: Mapping[str, ClampRange],
) -> BoltAssessment:
    preload = float(preloaded.bolt_forces[name][0])
    lowest, low = find_least(
        {n: float(state.bolt_forces[name].min()) for n, state in cases.items()}
    )
    highest, high = find_most(
        {n: float(state.bolt_forces[name].max()) for n, state in cases.items()}
    )
    axial: dict[str, float] = {}
    factors: dict[str, float] = {}
    for case, state in cases.items():
        if state.retightened or not masks:
            continue
        load, gain, changed = _axial_load(name, surfaces, masks, preloaded, state)
        axial[case] = load
        # The share of the load in the bolt, whose force can change for other reasons too.
        acts = abs(load) > max(DECK_DIGITS * abs(preload), SMALLEST_AXIAL_SHARE * changed)
        if acts and 0 <= gain / load <= 1:
            factors[case] = gain / load
    return BoltAssessment(
        preload=preload,
        least=low,
        least_case=lowest,
        most=high,
        most_case=highest,
        axial_loads=axial,
        load_factors=factors,
        clamp_around=clamps,
        bending=bending_of(
            preloaded.bolt_moments[name][0],
            {case: state.bolt_moments[name] for case, state in cases.items()},
        )
        if name in preloaded.bolt_moments
        else None,
    )


def _axial_load(
    name: str,
    surfaces: Mapping[str, ContactSurface],
    masks: Mapping[str, Mask],
    preloaded: CaseState,
    case: CaseState,
) -> tuple[float, float, float]:
    """Return F_A = ΔF_S − ΔF_K, ΔF_S and |ΔF_S| + Σ |ΔF_i| over all points at the largest F_A."""
    gains = case.bolt_forces[name] - preloaded.bolt_forces[name]
    candidates = [(0.0, 0.0, 0.0)]
    for interface, around in masks.items():
        surface = surfaces[interface]
        points, area = slice(*surface.slice), surface.weights * around
        change = case.pressure[:, points] - preloaded.pressure[:, points]
        loads = gains - change @ area
        worst = int(np.abs(loads).argmax())
        changed = np.abs(change[worst]) @ area + abs(gains[worst])
        candidates.append((float(loads[worst]), float(gains[worst]), float(changed)))
    return max(candidates, key=lambda candidate: abs(candidate[0]))
