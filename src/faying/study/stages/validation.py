"""What a study says beyond its load cases: a load space, and the penalty."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from faying.assessment.choose_joint_modes import JointModeChoice
from faying.assessment.penalty_advice import UnitNames, recommend_penalty
from faying.assessment.penalty_sweep import penalty_sweep
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.method import Method
from faying.reduction.methods import METHODS
from faying.reduction.snapshots import LoadBox
from faying.simulation.static import AT_REST, solve_static_cases
from faying.simulation.static_case import solve_static
from faying.study.inputs.loads import case_load, training_box
from faying.study.keys.tables import Study
from faying.study.results.validation_record import (
    LoadSpaceRecord,
    LoadSpaceResult,
    PenaltyRecord,
    ValidationRecord,
)
from faying.study.stages.offline import PreparedJoint, TrainedBases
from faying.study.stages.optional import Extras
from faying.study.stages.progress import Stages
from faying.units import units_of

Models = Mapping[str, Mapping[int, System]]

SEED = 1
"""Of the random loads, fixed so that runs repeat."""


def validate(
    study: Study,
    joint: PreparedJoint,
    models: Models,
    trained: TrainedBases,
    choices: Mapping[str, JointModeChoice],
    stages: Stages,
    extras: Extras,
) -> ValidationRecord:
    """Compute what the study's load spaces and penalty mean for every method.

    What fails is absent, and named among the extras.
    """
    space = None
    count = study.validation.unseen_loads
    if study.reduction.training.box and count:
        with stages.stage("unseen loads"), extras.attempt("unseen loads"):
            box = training_box(study.reduction.training)
            space = _load_space(joint.model, box, count, models, extras)
    sweep = None
    swept = study.validation.penalty_sweep and joint.model.contact.forgets
    if swept and joint.model.contact.proportional:
        with stages.stage("penalty sweep"), extras.attempt("penalty sweep"):
            sweep = _penalty(study, joint.model, trained, models)
    return ValidationRecord(load_space=space, penalty=sweep, choices=choices)


def _load_space(
    model: Model, box: LoadBox, count: int, models: Models, extras: Extras
) -> LoadSpaceRecord:
    """Return errors at random loads of the training box."""
    unseen = box.random_loads(model, count, SEED)
    exact = solve_static_cases(model, unseen)
    results: dict[str, dict[int, LoadSpaceResult]] = {}
    for name, sizes in models.items():
        results[name] = {}
        for size, rom in sizes.items():
            with extras.attempt(f"unseen loads, {name} with {size} joint modes"):
                solved = solve_static_cases(rom, unseen)
                largest = np.abs(solved.pressure - exact.pressure).max(axis=1) / exact.max_pressure
                results[name][size] = LoadSpaceResult(
                    median_error=float(np.median(largest)), worst_error=float(largest.max())
                )
    return LoadSpaceRecord(n_loads=count, methods=results)


def _penalty(
    study: Study, model: Model, trained: TrainedBases, models: Models
) -> PenaltyRecord | None:
    """Sweep the contact stiffness over the study's static load cases (or its preload)."""
    loads = [case_load(case) for case in study.load_cases if case.kind == "static"] or [AT_REST]
    # Gaps that stay open say nothing of the stiffness of contact.
    loads = [load for load in loads if solve_static(model, load).contact_forces.any()]
    if not loads:
        return None
    methods = {
        name: partial(
            _reduced,
            method=METHODS[name],
            trained=trained,
            count=max(sizes),
        )
        for name, sizes in models.items()
        if METHODS[name].forces is None
    }
    swept = penalty_sweep(model, loads, methods=methods)
    units = units_of(study.units)
    names = UnitNames(penalty=units.of("force/length³"), length=units.length)
    advice = recommend_penalty(swept, units=names)
    return PenaltyRecord(
        sweep=swept, recommended=advice.penalty, reached=advice.reached, advice=advice.text
    )


def _reduced(model: Model, *, method: Method, trained: TrainedBases, count: int) -> System:
    return method.reduced(model, trained.of(method), trained.contact_forces, count)
