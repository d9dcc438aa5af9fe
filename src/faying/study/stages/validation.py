"""Validation of reduced models at random loads of the training box."""

from collections.abc import Mapping

import numpy as np

from faying.assessment.choose_joint_modes import JointModeChoice
from faying.joint.model import Model
from faying.reduction.snapshots import LoadBox
from faying.simulation.static import solve_static_cases
from faying.study.inputs.loads import training_box
from faying.study.results.validation_record import (
    LoadSpaceRecord,
    LoadSpaceResult,
    ValidationRecord,
)
from faying.study.stages.books import Books
from faying.study.stages.offline import Models, PreparedJoint


def validate(
    joint: PreparedJoint, models: Models, choices: Mapping[str, JointModeChoice]
) -> ValidationRecord:
    """Return the errors of every method over the load space of a study.

    Parts that fail are absent, and named among the omissions.
    """
    space, study, books = None, joint.study, joint.books
    count = study.validation.unseen_loads
    if study.reduction.training.box and count:
        with books.stage("unseen loads"), books.attempt("unseen loads"):
            box = training_box(study.reduction.training)
            space = _load_space(joint.model, box, count, models, books)
    return ValidationRecord(load_space=space, choices=choices)


def _load_space(
    model: Model, box: LoadBox, count: int, models: Models, books: Books
) -> LoadSpaceRecord:
    """Return the errors of all methods at random loads of the training box."""
    unseen = box.random_loads(model, count, seed=1)
    exact = solve_static_cases(model, unseen)
    results: dict[str, dict[int, LoadSpaceResult]] = {}
    for name, sizes in models.items():
        results[name] = {}
        for size, rom in sizes.items():
            with books.attempt(f"unseen loads, {name} with {size} joint modes"):
                solved = solve_static_cases(rom, unseen)
                largest = np.abs(solved.pressure - exact.pressure).max(axis=1) / exact.max_pressure
                results[name][size] = LoadSpaceResult(
                    median_error=float(np.median(largest)), worst_error=float(largest.max())
                )
    return LoadSpaceRecord(n_loads=count, methods=results)
