"""Parts of many loads on a reduced model, computed by workers before the call that finds them.

A worker is given a piece of the static cases, or a whole transient: the same pieces as without
workers, so that numbers do not depend on how many there are.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from faying._typing import Indices
from faying.exceptions import StudyError
from faying.execution.campaign import run_grouped_campaign
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.execution.executor import Executor, Function
from faying.study.inputs.load_set import LoadSet, TimedLoad
from faying.study.stages.optional import Extras
from faying.study.stages.progress import Stages
from faying.workflow.solve_cases import CaseSolver, end_key, n_steps

Piece = Indices | TimedLoad
"""Rows of static cases, or a transient."""


def compute_pieces(
    solver: CaseSolver, loads: LoadSet, named: Sequence[int], executor: Executor
) -> None:
    """Have workers compute the pieces that are not there yet.

    Static pieces come back from the workers; of transients, which may be long, workers keep the
    pieces themselves, so they must see the folder of the checkpoint.

    Raises
    ------
    FayingError
        As the call without workers would raise, or if workers fail; what is finished is kept.
    """
    static = solver.static_pieces(loads)
    transients = {end_key(load): load for load in loads.transients}
    jobs: dict[str, Piece] = {**transients, **static}  # what takes longest first
    weights = {key: len(rows) for key, rows in static.items()}
    weights |= {key: n_steps(load) for key, load in transients.items()}
    checkpoint = Checkpoint(solver.checkpoint.folder.resolve())
    sent = replace(solver, checkpoint=checkpoint, stages=Stages(None), extras=Extras())
    prepare = partial(prepare_pieces, sent, loads, tuple(named))
    with solver.stages.stage("workers", sum(weights.values())) as advance:
        run_grouped_campaign(
            prepare,
            [{key: job} for key, job in jobs.items()],
            executor,
            keep=solver.checkpoint,
            progress=lambda key: advance(weights[key]),
        )


def prepare_pieces(solver: CaseSolver, loads: LoadSet, named: Sequence[int]) -> Function:
    """Take the model and the loads on a worker.

    Raises
    ------
    StudyError
        If the worker does not see the folder of the results.
    """
    if loads.transients and not solver.checkpoint.folder.is_dir():
        message = (
            f"a worker does not see {solver.checkpoint.folder}, where it keeps what it finishes of "
            "loads over time; choose a folder that all machines share with --out"
        )
        raise StudyError(message)
    return partial(_computed, solver, loads, named)


def _computed(
    solver: CaseSolver, loads: LoadSet, named: Sequence[int], group: Sequence[Piece]
) -> Iterator[Arrays]:
    for job in group:
        if isinstance(job, TimedLoad):
            yield solver.walked(job)
        else:
            yield solver.static_piece(loads, job, named)
