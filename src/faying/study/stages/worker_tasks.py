"""The expensive pieces of a run, computed by workers before the run, which finds them finished.

These are transients of the full model: load cases, with the time step and half of it,
and the training steps of method B, in the groups that a run without workers computes side by
side. Static solutions take milliseconds once the joint is condensed, and reduced models need
bases, which would cost every worker more than it saves.
"""

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

from faying.exceptions import ConvergenceError
from faying.execution.campaign import run_grouped_campaign
from faying.execution.checkpoint import Arrays
from faying.execution.executor import Executor, Function
from faying.files.flattening import flattened
from faying.study.inputs.load_model import build_loaded, load_model
from faying.study.inputs.loads import is_trained
from faying.study.keys.friction_rules import reference_kind
from faying.study.keys.schema import parse_study
from faying.study.keys.tables import Study
from faying.study.stages.books import Books
from faying.study.stages.full_transients import FullTransient, case_groups, full_transients
from faying.study.stages.offline import PreparedJoint, prepare_joint, step_training
from faying.study.stages.training import StepTraining, step_groups

Piece = int | FullTransient
"""The number of a training step, or a transient of a load case."""


def pieces(study: Study, *, full: bool = True) -> list[dict[str, Piece]]:
    """Return the pieces for workers in groups, by their checkpoint keys.

    If ``full``, load cases are compared with the full model.
    """
    groups = case_groups(study.load_cases, half_step=study.validation.half_step) if full else []
    tasks: list[dict[str, Piece]] = [{**group} for group in groups]
    training = study.reduction.training
    if is_trained(study) and training.system == "full":
        tasks += [{**group} for group in step_groups(training)]
    return tasks


def compute_pieces(study: Study, executor: Executor, books: Books) -> None:
    """Have workers compute the missing pieces.

    A piece that does not converge is left to the run, which may not need it.
    """
    asked = study.validation.reference == "full"
    full = asked or reference_kind(study, build_loaded(load_model(study)))[0] == "full"
    groups = pieces(study, full=full)
    total = sum(map(len, groups))
    with books.stage("workers", total) as advance, suppress(ConvergenceError):
        prepare = partial(prepare_pieces, study.source.text, study.source.path)
        run_grouped_campaign(
            prepare, groups, executor, keep=books.checkpoint, progress=lambda _: advance(1)
        )


def prepare_pieces(text: str, path: Path) -> Function:
    """Prepare the joint of a study on a worker, which sees its files under the same path.

    Raises
    ------
    StudyError
        If the worker lacks a file of the study.
    """
    study = parse_study(text, path)
    joint = prepare_joint(study)
    return partial(_computed, joint, step_training(joint, None))


def _computed(joint: PreparedJoint, steps: StepTraining, group: Sequence[Piece]) -> list[Arrays]:
    numbers = [task for task in group if isinstance(task, int)]
    transients = [task for task in group if not isinstance(task, int)]
    if numbers:
        return list(steps.forces(numbers))
    return list(map(flattened, full_transients(joint, transients)))
