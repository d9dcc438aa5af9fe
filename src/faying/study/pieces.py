"""The expensive pieces of a run, computed by workers before it and found finished by it.

These are integrations of the full model: reference responses of transient load cases, and the
training steps of method B. Static solutions take milliseconds once the joint is condensed, and
reduced models need bases, which would cost every worker more than they give.
"""

from functools import partial
from pathlib import Path

from faying import __version__
from faying.exceptions import StudyError
from faying.execution.campaign import run_campaign
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.execution.executor import Executor, Function
from faying.study.cases import packed, respond, response_key, solve_case
from faying.study.offline import PreparedJoint, is_trained, prepare_joint, step_training
from faying.study.progress import Stages
from faying.study.schema import parse_study
from faying.study.tables import Study
from faying.study.training import StepTraining, step_key, step_loads

Piece = tuple[str, int]
"""``"case"`` or ``"training"``, and which of them."""


def pieces(study: Study) -> dict[str, Piece]:
    """Return the pieces that are worth a worker, by the keys the run looks them up under."""
    found: dict[str, Piece] = {
        response_key(case): ("case", number)
        for number, case in enumerate(study.load_cases)
        if case.kind != "static"
    }
    training = study.reduction.training
    if is_trained(study) and training.system == "full":
        numbers = range(len(step_loads(training)))
        found |= {step_key(number): ("training", number) for number in numbers}
    return found


def compute_pieces(
    study: Study, executor: Executor, checkpoint: Checkpoint, stages: Stages
) -> None:
    """Have workers compute the pieces that are not there yet.

    Raises
    ------
    FayingError
        As the run would raise, or if workers fail; what is finished is kept to resume from.
    """
    tasks = pieces(study)
    with stages.stage("workers", len(tasks)) as advance:
        prepare = partial(prepare_pieces, study.source.text, study.source.path, __version__)
        run_campaign(prepare, tasks, executor, keep=checkpoint, progress=lambda _: advance(1))


def prepare_pieces(text: str, path: Path, version: str) -> Function:
    """Prepare the joint of a study on a worker, which sees its files under the same path.

    Raises
    ------
    StudyError
        If the worker has another version of faying, or lacks a file of the study.
    """
    if version != __version__:
        message = (
            f"a worker has faying {__version__}, this run is of {version}; "
            "install the same version everywhere"
        )
        raise StudyError(message)
    study = parse_study(text, path)
    joint = prepare_joint(study, Stages(None))
    return partial(_computed, study, joint, step_training(study, joint, None))


def _computed(study: Study, joint: PreparedJoint, steps: StepTraining, piece: Piece) -> Arrays:
    kind, number = piece
    if kind == "training":
        return steps.forces(number)
    solution, seconds = solve_case(joint, study.load_cases[number], joint.model)
    return packed(respond(solution, joint.model, seconds))
