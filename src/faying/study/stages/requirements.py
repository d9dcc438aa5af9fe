"""The joint of a run judged over its load cases, whatever solved them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.check import Check
from faying.assessment.clamp_range import CertifiedClamps, certified_clamps
from faying.assessment.joint_assessment import judged, loosest_checks, opening_cases
from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.opening import Openings, areas_that_open, opening_factors
from faying.assessment.preload_scatter import PreloadScatter, Spread, preload_spreads
from faying.assessment.requirements import Requirements
from faying.assessment.slip_demand import SlipDemand, slip_coefficients, slip_demands
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.clamp_ends import clamp_checks
from faying.assessment.strength.preload_ends import loosest_forces, preload_ends, with_initial
from faying.assessment.strength.stressed import with_threads
from faying.assessment.strength.thread import Thread
from faying.assessment.verdicts import wanted_clamps
from faying.joint.bolt_surroundings import surroundings
from faying.joint.model import Model
from faying.joint.tangential import tangential_rows
from faying.reduction.projection import contact_surfaces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load
from faying.simulation.without_friction import pressures_without_friction
from faying.study.inputs.loads import case_load
from faying.study.judgement.comparison import increments
from faying.study.judgement.margins import demanded_checks
from faying.study.keys.requirement_rules import requirements_of
from faying.study.keys.tables import LoadCaseSection, Study
from faying.study.keys.threads import preload_ranges, threads_of
from faying.study.results.values import CaseResult
from faying.study.stages.offline import PreparedJoint
from faying.study.stages.optional import Extras
from faying.study.stages.progress import Stages
from faying.units import units_of


def assess_run(
    study: Study,
    joint: PreparedJoint,
    cases: Mapping[str, CaseResult],
    stages: Stages,
    extras: Extras,
    exact: Model | ReducedModel,
) -> Assessment | None:
    """Judge the joint over the references of all load cases; None where that failed.

    Parameters
    ----------
    exact
        Whose static pressures are those of the full model; preloads scatter on it.

    Static load cases without friction are certified, and followed to their openings.
    """
    if not cases:
        return None
    model = joint.model
    with stages.stage("joint assessment"), extras.attempt("joint assessment"):
        requirements = requirements_of(study.requirement)
        static = [case for case in study.load_cases if case.kind == "static"]
        smooth = static if model.contact.forgets else []
        intervals = _intervals(joint, smooth, cases, extras)
        reserves = {n: case.reserve for n, case in cases.items() if case.reserve is not None}
        states = {name: _state(case, intervals.get(name)) for name, case in cases.items()}
        preloaded = CaseState(
            pressure=joint.rest.pressure.reshape(-1, model.contact.n_points)[-1:],
            bolt_forces={n: np.ravel(joint.rest.bolt_force(n))[-1:] for n in model.bolts},
            bolt_moments={
                n: joint.rest.bolt_bending(n).reshape(-1, 2, 2)[-1:]
                for n in bent_bolts(model.bolts)
                if all(n in state.bolt_moments for state in states.values())
            },
        )
        demands: dict[tuple[str, str], SlipDemand] = {}
        with extras.attempt("slip by sums"):
            demands = _demands(joint, study, requirements)
        assessment = judged(
            contact_surfaces(model),
            model.bolts,
            preloaded,
            states,
            requirements,
            {**_paths(joint, smooth, requirements, extras), **_rubbed_paths(static, reserves)},
            reserves,
            demands,
        )
        threads = threads_of(study)
        spreads = _scatter(study, exact, static, threads, extras)
        assessment = replace(assessment, scatter=spreads)
        with extras.attempt("strength of bolts"):
            loads = {case.name: case_load(case) for case in smooth}
            goal = joint.loaded.preloads
            ranges, hot = preload_ranges(study), _temperatures(study)
            ends = preload_ends(exact, preloaded, states, loads, ranges, goal, hot)
            surfaces = contact_surfaces(model)
            limits = wanted_clamps(requirements.min_clamp_force, surfaces)
            clamps = clamp_checks(ends, surfaces, model.bolts, limits, study.units)
            initial = loosest_forces(model, preloaded, ranges)
            loosened: tuple[Check, ...] = ()
            if initial is not None:
                opens = set(opening_cases(assessment))
                follow = [case for case in smooth if case.name in opens]
                paths = _paths(joint, follow, requirements, extras, initial)
                slips = _demands(joint, study, requirements, initial)
                loose = judged(
                    surfaces, model.bolts, preloaded, states, requirements, paths, reserves, slips
                )
                loosened = loosest_checks(loose, units_of(study.units))
            assessment = replace(assessment, checks=tuple(clamps), loosened=loosened)
            counted = {c.name: c.repetitions for c in study.load_cases if c.repetitions}
            assessment = with_threads(assessment, states, threads, study.units, ends, counted)
        with extras.attempt("margins of bolts"):
            every, rubs = (
                [case_load(case) for case in static],
                _coefficients(model, study, requirements),
            )
            margins, ranges = study.requirement.margins, preload_ranges(study)
            checks = demanded_checks(
                margins, ranges, exact, threads, every, rubs, assessment, study.units
            )
            return replace(assessment, checks=checks)
        return assessment
    return None


def _temperatures(study: Study) -> dict[str, Load]:
    """Return the temperatures that every static load case may have beside its loads."""
    names = () if study.preload_scatter is None else study.preload_scatter.temperatures
    return {name: Load({name: 1.0}, name=name) for name in names}


def _scatter(
    study: Study,
    exact: Model | ReducedModel,
    static: list[LoadCaseSection],
    threads: Mapping[str, Thread],
    extras: Extras,
) -> tuple[Spread, ...]:
    """Return what scatter of the preloads does to static load cases."""
    if study.preload_scatter is None:
        return ()
    scatter = PreloadScatter(**study.preload_scatter.model_dump(exclude={"temperatures"}))
    spreads: list[Spread] = []
    with extras.attempt("preload scatter"):
        surfaces = exact.interfaces if isinstance(exact, ReducedModel) else contact_surfaces(exact)
        for case in static:
            spreads += preload_spreads(exact, surfaces, case_load(case), scatter, threads)
    return tuple(spreads)


def _state(case: CaseResult, certified: CertifiedClamps | None) -> CaseState:
    """Return a load case as it is judged: over all instants, or all increments of its paths."""
    response, paths = case.reference, increments(case.reference)
    states = [np.atleast_2d(response.pressure), *(record.pressure for record in paths)]
    pressure = np.concatenate(states)
    moments = {name: ends.reshape(-1, 2, 2) for name, ends in response.bolt_moments.items()}
    return CaseState(
        pressure=pressure,
        bolt_forces={
            name: np.concatenate(
                [np.atleast_1d(force), *(record.bolt_forces[name] for record in paths)]
            )
            for name, force in response.bolt_forces.items()
        },
        certified=certified,
        retightened=any(
            name in response.bolt_forces and (record.factors[:, column] != 1).any()
            for record in paths
            for column, name in enumerate(record.loads)
        ),
        times=case.times,
        # Of increments bending is known at the last one, which stands for the others.
        bolt_moments={
            name: np.concatenate([ends, *[ends[-1:]] * (len(pressure) - len(ends))])
            for name, ends in moments.items()
        },
    )


def _intervals(
    joint: PreparedJoint,
    static: list[LoadCaseSection],
    cases: Mapping[str, CaseResult],
    extras: Extras,
) -> dict[str, CertifiedClamps]:
    """Return the certified clamp forces of static load cases."""
    if not static:
        return {}
    with extras.attempt("certified bounds"):
        start = np.zeros(1)
        inputs = np.concatenate([case_load(case).inputs(joint.model, start) for case in static])
        pressure = np.array([cases[case.name].reference.pressure for case in static])
        areas = surroundings(contact_surfaces(joint.model), joint.model.bolts)
        certificate = joint.certifier.certify_inputs(inputs, pressure, areas)
        return {case.name: certified_clamps(certificate, row) for row, case in enumerate(static)}
    return {}


ENDS = ("forth", "back")
"""What the ends of the largest cycle are called, at plus and minus its amplitude."""


def _demands(
    joint: PreparedJoint, study: Study, requirements: Requirements, initial: Vector | None = None
) -> dict[tuple[str, str], SlipDemand]:
    """Return the friction that static load cases and ends of cycles need, as if there were none."""
    model, loads = joint.model, list[Load]()
    for case in study.load_cases:
        load, largest = case_load(case), max(case.amplitudes or (1.0,))
        if case.kind == "static":
            loads.append(load)
        elif case.kind == "cycle":
            for end, factor in zip(ENDS, (largest, -largest), strict=True):
                loads.append(replace(load.scaled(factor), name=f"{case.name}, {end}"))
    if not loads:
        return {}
    coefficients = _coefficients(model, study, requirements)
    names, start = [load.name for load in loads], np.zeros(1)
    inputs = np.concatenate([load.inputs(model, start) for load in loads])
    inputs = with_initial(model, inputs, initial)
    pressure = pressures_without_friction(model, inputs)
    rows, surfaces = tangential_rows(model), contact_surfaces(model)
    return slip_demands(model, surfaces, rows, names, inputs, pressure, coefficients)


def _coefficients(model: Model, study: Study, requirements: Requirements) -> dict[str, float]:
    """Return the coefficient that each interface is judged with, of those that have one.

    Of a range it is the smallest.
    """
    scatter = study.preload_scatter
    lowest = scatter.surface_friction[0] if scatter and scatter.surface_friction else None
    frictions = {name: interface.law.friction for name, interface in model.interfaces.items()}
    smooth = [name for name, friction in frictions.items() if not friction > 0]
    rubbing = {
        name: friction if lowest is None else lowest
        for name, friction in frictions.items()
        if friction > 0
    }
    return rubbing | slip_coefficients(requirements.slip_friction, smooth)


def _paths(
    joint: PreparedJoint,
    static: list[LoadCaseSection],
    requirements: Requirements,
    extras: Extras,
    initial: Vector | None = None,
) -> dict[str, Openings]:
    """Follow static load cases without friction to their openings; not those where that failed."""
    model, openings, start = joint.model, dict[str, Openings](), np.zeros(1)
    areas = areas_that_open(model.interfaces, model.contact.slices, model.bolts)
    for case in static:
        with extras.attempt(f"{case.name}, load factors of opening"):
            inputs = with_initial(model, case_load(case).inputs(model, start), initial)[0]
            openings[case.name] = opening_factors(
                model, inputs, areas, open_below=requirements.open_share
            )
    return openings


def _rubbed_paths(
    static: list[LoadCaseSection], reserves: Mapping[str, SlipReserve]
) -> dict[str, Openings]:
    """Return the openings of static load cases that were followed with friction."""
    return {
        case.name: Openings(
            opened=dict(zip(reserve.areas, reserve.openings, strict=True)), followed=reserve.largest
        )
        for case in static
        if (reserve := reserves.get(case.name)) is not None and reserve.areas
    }
