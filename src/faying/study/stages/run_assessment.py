"""The joint of a run judged over its load cases."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Vector
from faying.assessment.joint_judge import JointJudge, certified_cases, rest_of, surfaces_of
from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.preload_scatter import PreloadScatter, Spread, preload_spreads
from faying.assessment.slip_reserve import followed_openings
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load
from faying.study.inputs.loads import case_load
from faying.study.judgement.comparison import state_of_case
from faying.study.judgement.margins import with_margins
from faying.study.keys.requirement_rules import requirements_of
from faying.study.keys.tables import LoadCaseSection, Study
from faying.study.keys.threads import StudyBolts
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.values import CaseResult
from faying.study.stages.offline import PreparedJoint


def assess_run(
    joint: PreparedJoint,
    cases: Mapping[str, CaseResult],
    frequencies: Mapping[str, FrequencyRecord],
    exact: Model | ReducedModel,
) -> Assessment | None:
    """Judge the joint over all load cases and periods that were kept; None where that failed.

    Static pressures of the exact model are those of the full model; preloads scatter on it. Static
    load cases without friction are certified, and followed to their openings.
    """
    vibrating = {
        f"{name}, level {curve.level:g} at {frequency}": CaseState(**vars(period))
        for name, swept in frequencies.items()
        for curve in swept.response.curves
        for frequency, period in curve.periods.items()
    }
    if not cases and not vibrating:
        return None
    study, books = joint.study, joint.books
    with books.stage("joint assessment"), books.attempt("joint assessment"):
        static = [case for case in study.load_cases if case.kind == "static"]
        loads = [case_load(case) for case in static]
        smooth = loads if joint.model.contact.forgets else []
        intervals = _intervals(joint, smooth, cases)
        states = {
            name: replace(state_of_case(case), certified=intervals.get(name, {}))
            for name, case in cases.items()
        }
        states |= vibrating
        reserves = {n: case.reserve for n, case in cases.items() if case.reserve is not None}
        judge = JointJudge(
            system=joint.model,
            exact=exact,
            preloaded=_bent_in_all(rest_of(joint.rest), states),
            cases=states,
            requirements=requirements_of(study.requirement),
            strengths=replace(StudyBolts.of(study).strengths, tightened=joint.loaded.preloads),
            attempt=books.attempt,
            loads=smooth,
            followed=[load.name for load in smooth],
            summed=_summed(study.load_cases),
            reserves=reserves,
            openings=followed_openings(
                {case.name: reserves[case.name] for case in static if case.name in reserves}
            ),
        )
        assessment = judge.assessment()
        assessment = replace(assessment, scatter=_scatter(study, exact, loads, judge))
        with books.attempt("strength of bolts"):
            ends = judge.ends(states)
            assessment = judge.at_ends(assessment, ends)
            counted = {c.name: c.repetitions for c in study.load_cases if c.repetitions}
            assessment = judge.strengthened(assessment, states, ends, counted)
        with books.attempt("margins of bolts"):
            return with_margins(assessment, judge, study.requirement.margins, loads)
        return assessment
    return None


def _bent_in_all(preloaded: CaseState, states: Mapping[str, CaseState]) -> CaseState:
    """Return the preloaded state with the moments of bolts whose bending is seen in all cases."""
    moments = {
        name: ends
        for name, ends in preloaded.bolt_moments.items()
        if all(name in state.bolt_moments for state in states.values())
    }
    return replace(preloaded, bolt_moments=moments)


def _scatter(
    study: Study, exact: Model | ReducedModel, loads: Sequence[Load], judge: JointJudge
) -> tuple[Spread, ...]:
    """Return what scatter of the preloads does to static load cases."""
    if study.preload_scatter is None:
        return ()
    scatter = PreloadScatter(**study.preload_scatter.model_dump(exclude={"temperatures"}))
    spreads: list[Spread] = []
    with judge.attempt("preload scatter"):
        for load in loads:
            spreads += preload_spreads(
                exact, surfaces_of(exact), load, scatter, judge.strengths.threads
            )
    return tuple(spreads)


def _intervals(
    joint: PreparedJoint, loads: Sequence[Load], cases: Mapping[str, CaseResult]
) -> dict[str, dict[tuple[str, str], Vector]]:
    """Return the certified clamp forces of static load cases."""
    if not loads:
        return {}
    with joint.books.attempt("certified bounds"):
        start, names = np.zeros(1), [load.name for load in loads]
        inputs = np.concatenate([load.inputs(joint.model, start) for load in loads])
        pressure = np.array([cases[name].reference.pressure for name in names])
        return certified_cases(joint.certifier, joint.model, names, inputs, pressure)
    return {}


ENDS = ("forth", "back")
"""What the ends of the largest cycle are called, at plus and minus its amplitude."""


def _summed(cases: Sequence[LoadCaseSection]) -> list[Load]:
    """Return the static load cases, and the ends of cycles."""
    loads = list[Load]()
    for case in cases:
        load, largest = case_load(case), max(case.amplitudes or (1.0,))
        if case.kind == "static":
            loads.append(load)
        elif case.kind == "cycle":
            for end, factor in zip(ENDS, (largest, -largest), strict=True):
                loads.append(replace(load.scaled(factor), name=f"{case.name}, {end}"))
    return loads
