"""Reduction of a study's model to one file, which is solved without the full model."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from faying import __version__
from faying.assessment.transient_error import EXACT
from faying.exceptions import refuse_study
from faying.linalg.threads import one_thread
from faying.reduction.method import Method
from faying.reduction.methods import METHODS
from faying.reduction.model_reader import PRELOAD_PATH
from faying.reduction.projection import completed
from faying.reduction.reduced_model import ReducedModel
from faying.study.keys.errors import one_of
from faying.study.keys.tables import Study
from faying.study.results.mode_choice import mode_sentences
from faying.study.stages.books import Books, ProgressBar
from faying.study.stages.normal_modes import normal_modes_of
from faying.study.stages.offline import (
    build_bases,
    choose_counts,
    prepare_joint,
    reduced_models,
)


@one_thread()
def reduce_study(
    study: Study,
    out: Path,
    *,
    method: str = EXACT,
    joint_modes: int | None = None,
    shapes: bool = True,
    progress: ProgressBar | None = None,
    report: Callable[[str], object] | None = None,
) -> ReducedModel:
    """Reduce the model of a study by one method, write it to a file and return it.

    Parameters
    ----------
    out
        Path of the file, which is written atomically.
    method
        A method with a basis, whether or not the study names it.
    joint_modes
        Number of joint modes of methods that have them; by default the largest number of the study.
    shapes
        Store the trial vectors, as :meth:`ReducedModel.save`.
    report
        Called with a sentence about the chosen number of normal modes for each load case.

    Returns
    -------
    ReducedModel
        The reduced model in the file.

    Notes
    -----
    This is the offline part of a run for one method. No load case is solved, except that
    ``normal_modes = "auto"`` solves load cases over time with reduced models.
    """
    chosen = _method(method)
    counts = [joint_modes] if joint_modes else list(study.reduction.joint_modes)[-1:]
    section = study.reduction.model_copy(
        update={"methods": (chosen.name,), "joint_modes": tuple(counts)}
    )
    alone = study.model_copy(update={"reduction": section})
    if chosen.trained and not section.training.box:
        refuse_study(
            f"method '{chosen.name}' needs training loads, and {study.path.name} has none; "
            f"add [reduction.training] with a box, or use method '{EXACT}'"
        )
    books = Books(progress)
    joint = prepare_joint(alone, books)
    modes = normal_modes_of(joint)
    trained = build_bases(joint, modes.modes)
    if report is not None:
        for line in mode_sentences(modes.choices, study.unit_set):
            report(line)
    bare = reduced_models(joint, trained, choose_counts(joint, trained))
    (rom,) = (model for model in bare[chosen.name].values() if isinstance(model, ReducedModel))
    with books.stage("recovery matrices"):
        (rom,) = completed(joint.model, [rom])
    title = study.title or study.path.stem
    rom = replace(rom, name=title, period=joint.period if joint.period < float("inf") else None)
    with books.stage("file"):
        text = study.text
        rom.save(
            out,
            shapes=shapes,
            provenance={
                "faying": __version__,
                "study": text,
                "study_sha256": hashlib.sha256(text.encode()).hexdigest(),
                "factorization": joint.model.structure.interior_factor.backend,
                # Initial bolt forces, increment by increment.
                PRELOAD_PATH: json.dumps([dict(load.bolt_forces) for load in joint.preload_path]),
            },
        )
    return rom


def _method(name: str) -> Method:
    """Return the method of a name; refuse methods that give no reduced model."""
    names = [method.name for method in METHODS.values() if method.forces is None]
    if name not in names:
        refuse_study(f"method: {one_of(name, names)}")
    return METHODS[name]
