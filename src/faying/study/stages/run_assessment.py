"""Assessment of the joint of a run over its load cases."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from faying.assessment.check import Check
from faying.assessment.joint_judge import JointJudge, rest_of
from faying.assessment.joint_record import REST, Assessment, CaseState
from faying.assessment.preload_scatter import spreads_of_cases
from faying.assessment.slip_reserve import followed_openings
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load
from faying.study.inputs.loads import case_load
from faying.study.judgement.comparison import state_of_case
from faying.study.judgement.margins import with_margins
from faying.study.keys.requirement_rules import requirements_of
from faying.study.keys.tables import LoadCaseSection
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
    """Return the assessment of a joint over all load cases and vibrations; None if it failed.

    ``exact`` has the static pressures of the full model, and is used for preload scatter. Static
    load cases without friction or gaskets are certified, and followed to their openings.
    """
    hertz = joint.study.unit_set.frequency
    vibrating = {
        f"{name}, level {curve.level:g}, {frequency} {hertz}": CaseState(**vars(period))
        for name, swept in frequencies.items()
        for curve in swept.response.curves
        for frequency, period in curve.periods.items()
    }
    if not cases and not vibrating:
        return None
    study, books = joint.study, joint.books
    with books.stage("joint assessment"), books.attempt("joint assessment"):
        loads = [case_load(case) for case in study.load_cases if case.kind == "static"]
        loaded = {n: state_of_case(case) for n, case in cases.items() if case.kind != "backbone"}
        # Pressures and bolt forces of backbones belong to the preloaded joint.
        states = loaded | vibrating or {REST: state_of_case(next(iter(cases.values())))}
        reserves = {n: case.reserve for n, case in cases.items() if case.reserve is not None}
        judge = JointJudge(
            system=joint.model,
            exact=exact,
            preloaded=_with_common_moments(rest_of(joint.rest), states),
            cases=states,
            requirements=requirements_of(study.requirement),
            strengths=replace(StudyBolts.of(study).strengths, tightened=joint.loaded.preloads),
            attempt=books.attempt,
            loads=loads,
            followed=[load.name for load in loads],
            summed=_static_loads(study.load_cases),
            reserves=reserves,
            openings=followed_openings(
                {load.name: reserves[load.name] for load in loads if load.name in reserves}
            ),
            rest=joint.rest,
        )
        with books.attempt("certified bounds"):
            judge = judge.certified(lambda: joint.certifier)
        assessment, threads = judge.assessment(), judge.strengths.threads
        if study.preload_scatter is not None:
            scattered = exact, judge.surfaces, loads, study.preload_scatter.spread, threads
            with books.attempt("preload scatter"):
                spreads = spreads_of_cases(*scattered, books.stage)
                assessment = replace(assessment, scatter=spreads)
        # What is told of bolts of known threads where their strength cannot be computed.
        unknown = (
            Check(part=name, kind="bolt", quantity="yield", reason=FAILED) for name in threads
        )
        assessment = replace(assessment, checks=tuple(unknown))
        with books.attempt("strength of bolts"):
            counted = {c.name: c.repetitions for c in study.load_cases if c.repetitions}
            assessment = judge.with_strength(assessment, states, counted)
        with books.attempt("margins of bolts"):
            return with_margins(assessment, judge, study.requirement.margins, loads)
        return assessment
    return None


FAILED = "it could not be computed, see the warnings"
"""Reason of a strength check that failed."""


def _with_common_moments(preloaded: CaseState, states: Mapping[str, CaseState]) -> CaseState:
    """Return the preloaded state with the moments of bolts that all cases have."""
    moments = {
        name: ends
        for name, ends in preloaded.bolt_moments.items()
        if all(name in state.bolt_moments for state in states.values())
    }
    return replace(preloaded, bolt_moments=moments)


ENDS = ("forth", "back")
"""Names of the ends of the largest cycle, at plus and minus its amplitude."""


def _static_loads(cases: Sequence[LoadCaseSection]) -> list[Load]:
    """Return the loads of static cases, and of the ends of cycles."""
    loads = list[Load]()
    for case in cases:
        load, largest = case_load(case), max(case.amplitudes or (1.0,))
        if case.kind == "static":
            loads.append(load)
        elif case.kind == "cycle":
            for end, factor in zip(ENDS, (largest, -largest), strict=True):
                loads.append(replace(load.scaled(factor), name=f"{case.name}, {end}"))
    return loads
