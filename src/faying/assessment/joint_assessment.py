"""The joint judged over its load cases: bolts, interfaces, and what it must hold."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.assessment.bolt_bending import bending_of
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.certificate import certifier
from faying.assessment.check import Check
from faying.assessment.clamp_range import ClampRange, certified_clamps, clamp_range
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_record import (
    Assessment,
    BoltAssessment,
    CaseState,
    InterfaceAssessment,
)
from faying.assessment.opening import Openings, area_name, areas_that_open, opening_factors
from faying.assessment.preload_scatter import PreloadScatter, preload_spreads
from faying.assessment.recovery import solve_cases_at_ports
from faying.assessment.requirements import Requirements, check_names
from faying.assessment.slip_demand import SlipDemand, slip_coefficients, slip_demands
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.clamp_ends import clamp_checks
from faying.assessment.strength.preload_ends import LEAST, preload_ends
from faying.assessment.strength.stressed import with_threads
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange, variation_of
from faying.assessment.verdicts import verdicts, wanted_clamps
from faying.digits import DECK_DIGITS
from faying.exceptions import ModelError
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import nearest_bolts, surroundings
from faying.joint.model import Model
from faying.joint.tangential import tangential_rows
from faying.model.bolt import Bolt
from faying.reduction.projection import contact_surfaces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static_cases
from faying.simulation.static_case import solve_static
from faying.units import Units

SMALLEST_AXIAL_SHARE = 0.2
"""Axial load over all that changes in a bolt and around it, from which it has a load factor.

Where a load lifts a flange off one has up to all of it, 0.4 to 0.6 on a tee and a pipe flange that
are pulled; where it bends or turns, pressure that is lost on one side of the bolt comes on the
other, and 0 to 0.03 are left, of any sign.
"""


def assess(
    system: Model | ReducedModel,
    loads: Sequence[Load],
    requirements: Requirements | None = None,
    *,
    paths: bool = True,
    threads: Mapping[str, Thread] | None = None,
    scatter: PreloadScatter | None = None,
) -> Assessment:
    """Judge a joint without friction over static load cases.

    Parameters
    ----------
    system
        Preloaded full or reduced model.
    loads
        Histories are taken at time zero.
    requirements
        What must hold.
    paths
        Whether each load is followed to its openings
        (:func:`~faying.assessment.opening.opening_factors`).
    threads
        Bolt to its thread, whose stress is then compared with the grade.
    scatter
        Of the preloads, over which the metrics of each load are then told too.

    Raises
    ------
    ModelError
        If a load does not fit, or there is none.

    Notes
    -----
    Some milliseconds a load, besides its path. Clamp forces of the full model
    are certified: those of a reduced model whose basis gives contact its forces from a static
    solution at the ports of the full one, another some milliseconds a load.
    """
    if not loads:
        message = "there is no load to assess the joint under; give one or more"
        raise ModelError(message)
    names = [load.name for load in loads]
    if len(set(names)) < len(names):
        message = "two loads have the same name; give each a name of its own, Load(…, name=…)"
        raise ModelError(message)
    demanded = requirements or Requirements()
    check_names(demanded, list(system.contact.slices), list(system.contact.slices))
    preloaded, cases = solve_static(system), solve_static_cases(system, loads)
    full = system.joint if isinstance(system, ReducedModel) else system
    surfaces = contact_surfaces(system) if isinstance(system, Model) else system.interfaces
    certificate = certifier(full).certify_inputs(
        cases.inputs, _exact(system, loads, cases), surroundings(surfaces, system.bolts)
    )
    bolt_forces = {name: np.asarray(cases.bolt_force(name)) for name in system.bolts}
    bent = {name: cases.bolt_bending(name) for name in bent_bolts(system.bolts)}
    states = {
        name: CaseState(
            pressure=cases.pressure[row : row + 1],
            bolt_forces={bolt: force[row : row + 1] for bolt, force in bolt_forces.items()},
            certified=certified_clamps(certificate, row),
            bolt_moments={bolt: moments[row : row + 1] for bolt, moments in bent.items()},
        )
        for row, name in enumerate(names)
    }
    at_rest = CaseState(
        pressure=preloaded.pressure[None],
        bolt_forces={name: np.atleast_1d(preloaded.bolt_force(name)) for name in system.bolts},
        bolt_moments={name: preloaded.bolt_bending(name)[None] for name in bent},
    )
    areas, start = areas_that_open(surfaces, system.contact.slices, system.bolts), np.zeros(1)
    followed = {
        load.name: opening_factors(
            full,
            load.inputs(full, start)[0],
            areas,
            open_below=demanded.open_share,
            interfaces=full.contact.slices,
        )
        for load in (loads if paths else ())
    }
    demands = slip_demands(
        system,
        surfaces,
        tangential_rows(system) if isinstance(system, Model) else system.tangential,
        names,
        cases.inputs,
        cases.pressure,
        slip_coefficients(demanded.slip_friction, list(surfaces)),
    )
    assessment = judged(
        surfaces, system.bolts, at_rest, states, demanded, followed, demands=demands
    )
    spreads = [
        spread
        for load in loads
        if scatter is not None
        for spread in preload_spreads(system, surfaces, load, scatter, threads or {})
    ]
    factor = 1.0 if scatter is None else scatter.tightening_factor
    ranges = dict.fromkeys(system.bolts, PreloadRange(variation=variation_of(factor)))
    ends = preload_ends(system, at_rest, states, {load.name: load for load in loads}, ranges)
    limits = wanted_clamps(demanded.min_clamp_force, surfaces)
    clamps = tuple(clamp_checks(ends, surfaces, system.bolts, limits, system.units))
    assessment = replace(assessment, scatter=tuple(spreads), checks=clamps)
    return with_threads(assessment, states, threads or {}, system.units, ends)


def _exact(system: Model | ReducedModel, loads: Sequence[Load], cases: Solution) -> Matrix:
    """Return the full model's pressures (n_case, n_point), to be certified."""
    if isinstance(system, Model) or system.contact.residual_compliance is not None:
        return cases.pressure
    return solve_cases_at_ports(system.joint, loads).pressure


def judged(
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    requirements: Requirements | None = None,
    paths: Mapping[str, Openings] | None = None,
    reserves: Mapping[str, SlipReserve] | None = None,
    demands: Mapping[tuple[str, str], SlipDemand] | None = None,
) -> Assessment:
    """Judge a joint whose load cases are solved already, static ones and those over time.

    Parameters
    ----------
    surfaces
        Geometry of the interfaces.
    preloaded
        The preloaded state.
    paths
        Load case to its openings, of static ones that were followed.
    reserves
        Load case to its slip reserve, of joints with friction.
    demands
        Interface and bolt, or no bolt, to the friction that static load cases need.
    """
    followed_paths, limits = paths or {}, requirements or Requirements()
    needed = demands or {}
    interfaces = {
        name: replace(
            _interface(name, surface, preloaded, cases, followed_paths), slip=needed.get((name, ""))
        )
        for name, surface in surfaces.items()
    }
    around = surroundings(surfaces, bolts)
    nearest = {name: nearest_bolts(item.points, bolts) for name, item in surfaces.items() if bolts}
    clamps: dict[str, dict[str, ClampRange]] = {name: {} for name in bolts}
    for (interface, bolt), points in around.items():
        surface = surfaces[interface]
        weights = surface.weights * points[slice(*surface.slice)]
        certified = {
            case: item.certified.areas[interface, bolt]
            for case, item in cases.items()
            if item.certified is not None
        }
        clamps[bolt][interface] = _clamp(surface, weights, preloaded, cases, certified)
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
                    clamps[name],
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
    )


LOOSE = ("opening", "slip")
"""What is judged at the end of the scatter where bolts are loosest."""


def loosest_checks(loose: Assessment, units: Units) -> tuple[Check, ...]:
    """Return the checks of opening and slip of a joint that was judged at P_p,min."""
    return tuple(
        replace(check, scatter=LEAST)
        for check in joint_checks(loose, units)
        if check.quantity.split(" at ")[0] in LOOSE and check.outcome != "unknown"
    )


def _interface(
    name: str,
    surface: ContactSurface,
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    paths: Mapping[str, Openings],
) -> InterfaceAssessment:
    points, weights = slice(*surface.slice), surface.weights
    certified = {
        case: state.certified.interfaces[name]
        for case, state in cases.items()
        if state.certified is not None
    }
    clamp = _clamp(surface, weights, preloaded, cases, certified)
    areas = {
        case: ((state.pressure[:, points] > 0) @ weights).min() for case, state in cases.items()
    }
    peaks = {case: state.pressure[:, points].max() for case, state in cases.items()}
    means = {
        case: float(surface.nodal_average(state.pressure[:, points].T).max(initial=0.0))
        for case, state in cases.items()
    }
    crushed = max(means, key=means.__getitem__)
    highest = max(peaks, key=peaks.__getitem__)
    smallest = min(areas, key=areas.__getitem__)
    peak = cases[highest].pressure[:, points].max(axis=0).argmax()
    return InterfaceAssessment(
        preload=clamp.preload,
        least_clamp=clamp.least,
        least_clamp_case=clamp.least_case,
        certified=clamp.certified_least,
        most_clamp=clamp.most,
        most_clamp_case=clamp.most_case,
        certified_most=clamp.certified_most,
        certified_width=clamp.certified_width,
        max_pressure=float(peaks[highest]),
        max_pressure_case=highest,
        max_pressure_point=surface.points[peak],
        max_nodal_pressure=means[crushed],
        max_nodal_pressure_case=crushed,
        closed_area=float(areas[smallest]),
        closed_area_case=smallest,
        first_opening={c: path.first[name] for c, path in paths.items() if name in path.first},
        loss_of_clamp={c: path.last[name] for c, path in paths.items() if name in path.last},
        opening=_openings(paths, name),
    )


def _openings(paths: Mapping[str, Openings], area: str) -> dict[str, float]:
    """Return the load cases that were followed, with the factor at which they open an area."""
    return {case: path.opened[area] for case, path in paths.items() if area in path.opened}


def _clamp(
    surface: ContactSurface,
    weights: Vector,
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    certified: Mapping[str, Vector],
) -> ClampRange:
    """Return the clamp forces of an interface, or of an area with weights of its points alone."""
    points = slice(*surface.slice)
    return clamp_range(
        float(preloaded.pressure[0, points] @ weights),
        {case: state.pressure[:, points] @ weights for case, state in cases.items()},
        certified,
    )


def _bolt(
    name: str,
    surfaces: Mapping[str, ContactSurface],
    masks: Mapping[str, Mask],
    preloaded: CaseState,
    cases: Mapping[str, CaseState],
    clamps: Mapping[str, ClampRange],
) -> BoltAssessment:
    preload = float(preloaded.bolt_forces[name][0])
    lows = {case: float(state.bolt_forces[name].min()) for case, state in cases.items()}
    highs = {case: float(state.bolt_forces[name].max()) for case, state in cases.items()}
    lowest, highest = min(lows, key=lows.__getitem__), max(highs, key=highs.__getitem__)
    axial: dict[str, float] = {}
    factors: dict[str, float] = {}
    for case, state in cases.items():
        if state.retightened or not masks:
            continue
        load, gain, changed = _axial_load(name, surfaces, masks, preloaded, state)
        axial[case] = load
        # A share of the load that the bolt takes; its force can change for other reasons too.
        acts = abs(load) > max(DECK_DIGITS * abs(preload), SMALLEST_AXIAL_SHARE * changed)
        if acts and 0 <= gain / load <= 1:
            factors[case] = gain / load
    return BoltAssessment(
        preload=preload,
        least=lows[lowest],
        least_case=lowest,
        most=highs[highest],
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
    """Return F_A = ΔF_S − ΔF_K, ΔF_S and |ΔF_S| + Σ |ΔF_i| of all points where F_A is largest."""
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
