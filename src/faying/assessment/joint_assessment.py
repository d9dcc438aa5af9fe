"""The joint judged over its load cases: bolts, interfaces, and what it must hold."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.assessment.bolt_bending import bending_of
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.certificate import certifier
from faying.assessment.clamp_range import ClampRange, certified_clamps, clamp_range
from faying.assessment.joint_record import (
    Assessment,
    BoltAssessment,
    CaseState,
    InterfaceAssessment,
)
from faying.assessment.opening import (
    Openings,
    area_name,
    areas_that_open,
    opening_factors,
)
from faying.assessment.preload_scatter import PreloadScatter, preload_spreads
from faying.assessment.recovery import solve_cases_at_ports
from faying.assessment.requirements import Requirements, check_names
from faying.assessment.slip_demand import SlipDemand, slip_coefficients, slip_demands
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.clamp_ends import clamp_checks
from faying.assessment.strength.preload_ends import preload_ends
from faying.assessment.strength.stressed import with_threads
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange, variation_of
from faying.assessment.verdicts import verdicts, wanted_clamps
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

AXIAL = 0.2
"""Axial load over all that changes in a bolt and around it, from which it has a load factor.

Where a load lifts a flange off one has up to all of it, 0.4 to 0.6 on a tee and a pipe flange that
are pulled; where it bends or turns, pressure that is lost on one side of the bolt comes on the
other, and 0 to 0.03 are left, of any sign.
"""

NOTHING = 1e-6
"""Axial load over the preload that is round-off of tightening, 1e-10, and loads that balance."""


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
    wanted = requirements or Requirements()
    check_names(wanted, list(system.contact.slices), list(system.contact.slices))
    rest, cases = solve_static(system), solve_static_cases(system, loads)
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
        pressure=rest.pressure[None],
        bolt_forces={name: np.atleast_1d(rest.bolt_force(name)) for name in system.bolts},
        bolt_moments={name: rest.bolt_bending(name)[None] for name in bent},
    )
    areas, start = areas_that_open(surfaces, system.contact.slices, system.bolts), np.zeros(1)
    followed = {
        load.name: opening_factors(
            full, load.inputs(full, start)[0], areas, open_below=wanted.open_share
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
        slip_coefficients(wanted.slip_friction, list(surfaces)),
    )
    found = judged(surfaces, system.bolts, at_rest, states, wanted, followed, demands=demands)
    spreads = [
        spread
        for load in loads
        if scatter is not None
        for spread in preload_spreads(system, surfaces, load, scatter, threads or {})
    ]
    factor = 1.0 if scatter is None else scatter.tightening_factor
    ranges = dict.fromkeys(system.bolts, PreloadRange(variation=variation_of(factor)))
    ends = preload_ends(system, at_rest, states, {load.name: load for load in loads}, ranges)
    limits = wanted_clamps(wanted.min_clamp_force, surfaces)
    clamps = tuple(clamp_checks(ends, surfaces, limits, system.units))
    found = replace(found, scatter=tuple(spreads), checks=clamps)
    return with_threads(found, states, threads or {}, system.units, ends)


def _exact(system: Model | ReducedModel, loads: Sequence[Load], cases: Solution) -> Matrix:
    """Return the full model's pressures (n_case, n_point), to be certified."""
    if isinstance(system, Model) or system.contact.residual_compliance is not None:
        return cases.pressure
    return solve_cases_at_ports(system.joint, loads).pressure


def judged(
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    rest: CaseState,
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
    rest
        The preloaded state.
    paths
        Load case to its openings, of static ones that were followed.
    reserves
        Load case to its slip reserve, of joints with friction.
    demands
        Interface and bolt, or no bolt, to the friction that static load cases need.
    """
    known, wanted = paths or {}, requirements or Requirements()
    needed = demands or {}
    interfaces = {
        name: replace(_interface(name, surface, rest, cases, known), slip=needed.get((name, "")))
        for name, surface in surfaces.items()
    }
    around = surroundings(surfaces, bolts)
    nearest = {name: nearest_bolts(one.points, bolts) for name, one in surfaces.items() if bolts}
    clamps: dict[str, dict[str, ClampRange]] = {name: {} for name in bolts}
    for (interface, bolt), points in around.items():
        surface = surfaces[interface]
        weights = surface.weights * points[slice(*surface.slice)]
        certified = {
            case: one.certified.areas[interface, bolt]
            for case, one in cases.items()
            if one.certified is not None
        }
        clamps[bolt][interface] = _clamp(surface, weights, rest, cases, certified)
    return Assessment(
        bolts={
            name: replace(
                _bolt(
                    name,
                    surfaces,
                    {place: found == number for place, found in nearest.items()},
                    rest,
                    cases,
                    clamps[name],
                ),
                slip_around={place: one for (place, bolt), one in needed.items() if bolt == name},
                opening_around={
                    place: factors
                    for place in surfaces
                    if (factors := _openings(known, area_name(place, name)))
                },
            )
            for number, name in enumerate(bolts)
        },
        interfaces=interfaces,
        verdicts=tuple(
            verdicts(wanted, surfaces, bolts, rest, cases, interfaces, known, reserves or {})
        ),
        open_below=wanted.open_share,
    )


def _interface(
    name: str,
    surface: ContactSurface,
    rest: CaseState,
    cases: Mapping[str, CaseState],
    paths: Mapping[str, Openings],
) -> InterfaceAssessment:
    own, weights = slice(*surface.slice), surface.weights
    certified = {
        case: one.certified.interfaces[name]
        for case, one in cases.items()
        if one.certified is not None
    }
    clamp = _clamp(surface, weights, rest, cases, certified)
    areas = {case: ((one.pressure[:, own] > 0) @ weights).min() for case, one in cases.items()}
    peaks = {case: one.pressure[:, own].max() for case, one in cases.items()}
    means = {
        case: float(surface.nodal_average(one.pressure[:, own].T).max(initial=0.0))
        for case, one in cases.items()
    }
    crushed = max(means, key=means.__getitem__)
    highest = max(peaks, key=peaks.__getitem__)
    smallest = min(areas, key=areas.__getitem__)
    peak = cases[highest].pressure[:, own].max(axis=0).argmax()
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
    rest: CaseState,
    cases: Mapping[str, CaseState],
    certified: Mapping[str, Vector],
) -> ClampRange:
    """Return the clamp forces of an interface, or of an area with weights of its points alone."""
    own = slice(*surface.slice)
    return clamp_range(
        float(rest.pressure[0, own] @ weights),
        {case: one.pressure[:, own] @ weights for case, one in cases.items()},
        certified,
    )


def _bolt(
    name: str,
    surfaces: Mapping[str, ContactSurface],
    near: Mapping[str, Mask],
    rest: CaseState,
    cases: Mapping[str, CaseState],
    clamps: Mapping[str, ClampRange],
) -> BoltAssessment:
    preload = float(rest.bolt_forces[name][0])
    lows = {case: float(one.bolt_forces[name].min()) for case, one in cases.items()}
    highs = {case: float(one.bolt_forces[name].max()) for case, one in cases.items()}
    least, most = min(lows, key=lows.__getitem__), max(highs, key=highs.__getitem__)
    axial: dict[str, float] = {}
    factors: dict[str, float] = {}
    for case, one in cases.items():
        if one.retightened:
            continue
        load, gain, changed = _axial_load(name, surfaces, near, rest, one)
        axial[case] = load
        # A share of the load that the bolt takes; its force can change for other reasons too.
        acts = abs(load) > max(NOTHING * abs(preload), AXIAL * changed)
        if acts and 0 <= gain / load <= 1:
            factors[case] = gain / load
    return BoltAssessment(
        preload=preload,
        least=lows[least],
        least_case=least,
        most=highs[most],
        most_case=most,
        axial_loads=axial,
        load_factors=factors,
        clamp_around=clamps,
        bending=bending_of(
            rest.bolt_moments[name][0],
            {case: one.bolt_moments[name] for case, one in cases.items()},
        )
        if name in rest.bolt_moments
        else None,
    )


def _axial_load(
    name: str,
    surfaces: Mapping[str, ContactSurface],
    near: Mapping[str, Mask],
    rest: CaseState,
    case: CaseState,
) -> tuple[float, float, float]:
    """Return F_A = ΔF_S − ΔF_K, ΔF_S and |ΔF_S| + Σ |ΔF_i| of all points where F_A is largest."""
    gains = case.bolt_forces[name] - rest.bolt_forces[name]
    found = [(0.0, 0.0, 0.0)]
    for place, surface in surfaces.items():
        own, area = slice(*surface.slice), surface.weights * near[place]
        change = case.pressure[:, own] - rest.pressure[:, own]
        loads = gains - change @ area
        worst = int(np.abs(loads).argmax())
        changed = np.abs(change[worst]) @ area + abs(gains[worst])
        found.append((float(loads[worst]), float(gains[worst]), float(changed)))
    return max(found, key=lambda one: abs(one[0]))
