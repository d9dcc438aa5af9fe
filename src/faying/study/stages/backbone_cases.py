"""Load cases that are backbones: each amplitude is kept as soon as it is computed."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from faying.assessment.backbone import Backbone
from faying.assessment.modal_analysis import modal_analysis
from faying.assessment.modal_cycles import ModalCycle, StillModeError
from faying.exceptions import naming
from faying.execution.checkpoint import Arrays
from faying.files.flattening import flattened, restored
from faying.joint.model import Model
from faying.joint.system import System
from faying.simulation.solution import Solution
from faying.study.keys.tables import DEFAULT_INCREMENTS, LoadCaseSection
from faying.study.results.responses import respond
from faying.study.results.values import Response
from faying.study.stages.checkpointed_steps import SECONDS, CheckpointedSteps


def backbone_response(
    model: Model,
    case: LoadCaseSection,
    system: System,
    preloaded: Solution,
    steps: CheckpointedSteps,
    progress: Callable[[int], object],
) -> Response:
    """Compute the backbones of a load case, of the modes that move where they are measured.

    Parameters
    ----------
    model
        The full model.
    preloaded
        Preloaded state of the system.
    progress
        Called with the number of amplitudes that there are more of, computed or taken over.
    """
    curves, seconds = {}, 0.0
    still: StillModeError | None = None
    for mode in sorted(case.modes):
        name = f"mode {mode}"
        if steps.has(name):
            progress(len(case.levels))
        with naming(f"load case '{case.name}'"):
            compute = partial(_curve, case, system, preloaded, mode, steps, progress)
            try:
                arrays = steps.take(name, compute)
            except StillModeError as error:
                still = error
                progress(len(case.levels))
                continue
        curves[str(mode)] = restored(Backbone, arrays)
        seconds += float(arrays[SECONDS])
    if still is not None and not curves:
        with naming(f"load case '{case.name}'"):
            raise still
    return respond(preloaded, model, seconds, backbones=curves)


def _curve(
    case: LoadCaseSection,
    system: System,
    preloaded: Solution,
    mode: int,
    steps: CheckpointedSteps,
    progress: Callable[[int], object],
) -> Arrays:
    """Compute one backbone.

    Every amplitude starts from the preloaded joint: those that are taken over hand nothing on.
    """
    start = time.perf_counter()
    analysis = modal_analysis(
        system,
        mode,
        case.levels,
        over=case.over,
        at=case.at,
        initial=preloaded,
        increments=cycle_increments(case),
    )
    seconds, cycles = time.perf_counter() - start, []
    for number in range(len(case.levels)):
        name = f"mode {mode}, amplitude {number + 1}"
        cycle, took = steps.value(ModalCycle, name, partial(analysis.cycle, number))
        cycles.append(cycle)
        seconds += took
        progress(1)
    curve = analysis.backbone(cycles, masing=case.masing)
    return {**flattened(curve), SECONDS: np.asarray(seconds)}


def cycle_increments(case: LoadCaseSection) -> int:
    """Return the increments of a full cycle."""
    return 4 * (case.increments or DEFAULT_INCREMENTS)
