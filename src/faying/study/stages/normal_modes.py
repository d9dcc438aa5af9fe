"""The normal modes of a study, their number given or chosen for load cases over time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, partial

from faying.assessment.choose_normal_modes import NormalModeChoice, choose_normal_modes
from faying.reduction.normal_modes import NormalModes, fixed_interface_normal_modes
from faying.study.inputs.loads import case_load, time_span, time_step
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.mode_choice import chosen_count
from faying.study.stages.full_transients import integrator_of
from faying.study.stages.offline import PreparedJoint
from faying.study.stages.path_cases import rest_state

Modes = Callable[[int], NormalModes]


@dataclass(frozen=True, eq=False, kw_only=True)
class StudyModes:
    """Normal modes, and the choice of their number by load case; empty if the study gives it."""

    modes: NormalModes
    choices: Mapping[str, NormalModeChoice] = field(default_factory=dict)


def normal_modes_of(joint: PreparedJoint) -> StudyModes:
    """Compute the normal modes of a study, their number given or chosen.

    Chosen numbers are stored, so that a resumed run does not choose again.
    """
    structure, study, books = joint.model.structure, joint.study, joint.books
    modes = cache(partial(fixed_interface_normal_modes, structure))
    count, choices = study.reduction.normal_modes, {}
    if count is None:
        for case in study.load_cases:
            if case.transient:
                with books.stage(f"choose normal modes, {case.name}"):
                    choose = partial(_chosen, joint, case, modes)
                    key = f"{case.name} normal modes"
                    choices[case.name] = books.value(NormalModeChoice, key, choose)
        count = chosen_count(choices)
    with books.stage("normal_modes"):
        # Static cases need no mass, and a structure without mass has no vibration modes.
        return StudyModes(modes=modes(count if structure.has_mass else 0), choices=choices)


def _chosen(joint: PreparedJoint, case: LoadCaseSection, modes: Modes) -> NormalModeChoice:
    mark = joint.study.reduction.transient_tolerance if case.tolerance is None else case.tolerance
    return choose_normal_modes(
        joint.model,
        case_load(case),
        step=time_step(case, joint.period),
        duration=time_span(case, joint.period),
        integrator=integrator_of(case),
        tolerance=mark,
        step_tolerance=case.tolerance,
        rest=partial(rest_state, tightening=joint.preload_path, full=joint.rest),
        modes=modes,
    )
