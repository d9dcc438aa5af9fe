"""Loads of a study, with their time steps and durations."""

import numpy as np

from faying.digits import CURVE_POINTS
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.reduction.methods import METHODS
from faying.reduction.normal_modes import NO_MASS
from faying.reduction.snapshots import LoadBox
from faying.simulation.load import History, Load
from faying.study.keys.friction_rules import check_friction
from faying.study.keys.load_files import read_history
from faying.study.keys.requirement_rules import check_requirements
from faying.study.keys.tables import (
    DEFAULT_INSTANTS,
    ForceSection,
    LoadCaseSection,
    Study,
    Timed,
    TrainingSection,
)


def time_step(timed: Timed, period: float) -> float:
    """Return the time step [time], for a structure with the given longest period [time]."""
    if timed.step is not None:
        return timed.step
    return period / (timed.steps_per_period or DEFAULT_INSTANTS)


def time_span(timed: Timed, period: float) -> float:
    """Return the duration [time]; the end of the shortest history file by default."""
    if timed.duration is not None:
        return timed.duration
    if timed.periods is None and isinstance(timed, LoadCaseSection):
        files = [force.file for force in timed.forces if force.file]
        if files:
            return min(float(read_history(file).times[-1]) for file in files)
    # "At least one period of the dominant vibration" (seed §15.3.4.2).
    return period * (timed.periods or 1.0)


def instants(timed: Timed) -> tuple[float, ...]:
    """Return a key that is equal for load cases with equal time step and duration.

    Both are proportional to the period or constant, so values at two periods determine them.
    """
    return tuple(of(timed, period) for of in (time_step, time_span) for period in (1.0, 2.0))


def case_load(case: LoadCaseSection) -> Load:
    """Return the load of a case; histories are read from their files.

    Raises
    ------
    StudyError
        If a history file has become invalid since the study was read.
    """
    forces = {force.target: _amount(force) for force in case.forces}
    if case.rise_time is not None:
        forces = {name: _rising(value, case.rise_time) for name, value in forces.items()}
    return Load(forces, name=case.name)


def _rising(value: float | History, rise_time: float) -> float | History:
    """Return a constant load as a history that rises by half a cosine, then stays constant."""
    if isinstance(value, History):
        return value
    part = np.linspace(0.0, 1.0, CURVE_POINTS + 1)
    return History(rise_time * part, value * (0.5 - 0.5 * np.cos(np.pi * part)))


def training_box(training: TrainingSection) -> LoadBox:
    """Return the box of training loads."""
    return LoadBox(
        ranges={side.target: (side.min, side.max) for side in training.box},
        levels=training.levels,
        preload_factors=training.preload_factors,
    )


def check_loads(study: Study, model: Model) -> None:
    """Refuse loads as :func:`check_targets`, and transients or modes without mass.

    Raises
    ------
    StudyError, ModelError
        As :func:`check_targets`, or if the model has no mass where it is needed.
    """
    if missing := missing_mass(study, model):
        raise ModelError(missing)
    check_targets(study, model)


def missing_mass(study: Study, model: Model) -> str:
    """Return a message about missing mass; empty where there is mass, or no need of it."""
    needed_by = _moving(study)
    if not needed_by or model.structure.has_mass:
        return ""
    return f"{NO_MASS}, and {needed_by}; give rho in the source, or by [material.NAME] in the study"


def check_targets(study: Study, model: Model) -> None:
    """Refuse loads on missing components of boundaries, and options that friction excludes.

    Raises
    ------
    StudyError
        As :func:`faying.study.keys.friction_rules.check_friction`, and for requirements on
        unknown interfaces.
    ModelError
        If a load has no such boundary or component.
    """
    check_friction(study, model)
    check_requirements(study, model)
    start = np.zeros(1)
    training = Load({side.target: 0.0 for side in study.reduction.training.box}, name="training")
    for load in (*map(case_load, study.load_cases), training):
        load.inputs(model, start)


def _moving(study: Study) -> str:
    """Return which part of a study needs mass, as a phrase; empty where all is static."""
    for case in study.load_cases:
        if case.transient or case.kind == "backbone":
            return f"load case '{case.name}' is a {'transient' if case.transient else 'backbone'}"
    for swept in study.frequencies:
        return f"'{swept.name}' is a [[frequency]]"
    training = study.reduction.training
    if training.dynamics and is_trained(study):
        return "its methods train on step responses (dynamics = false trains on static loads only)"
    return ""


def is_trained(study: Study) -> bool:
    """Return whether a method of the study uses training loads."""
    return any(METHODS[name].trained for name in study.reduction.methods)


def _amount(force: ForceSection) -> float | History:
    return read_history(force.file) if force.file else force.value or 0.0
