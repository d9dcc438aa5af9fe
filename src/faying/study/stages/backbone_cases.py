"""Load cases that are backbones: each amplitude is kept as soon as it is computed."""

import time
from functools import partial

import numpy as np

from faying.assessment.backbone import Backbone
from faying.assessment.modal_analysis import modal_analysis
from faying.assessment.modal_cycles import ModalCycle, StillModeError
from faying.exceptions import naming
from faying.execution.checkpoint import Arrays
from faying.files.flattening import flattened, restored
from faying.study.keys.tables import DEFAULT_INCREMENTS, LoadCaseSection
from faying.study.results.responses import respond
from faying.study.results.values import Response
from faying.study.stages.checkpointed_steps import SECONDS, IncrementalCase


def backbone_response(run: IncrementalCase) -> Response:
    """Compute the backbones of a load case, of the modes that move where they are measured."""
    case, curves, seconds = run.case, {}, 0.0
    still: StillModeError | None = None
    for mode in sorted(case.modes):
        name = f"mode {mode}"
        if run.steps.has(name):
            run.progress(len(case.levels))
        with naming(f"load case '{case.name}'"):
            try:
                arrays = run.steps.take(name, partial(_curve, run, mode))
            except StillModeError as error:
                still = error
                run.progress(len(case.levels))
                continue
        curves[str(mode)] = restored(Backbone, arrays)
        seconds += float(arrays[SECONDS])
    if still is not None and not curves:
        with naming(f"load case '{case.name}'"):
            raise still
    return respond(run.preloaded, run.model, seconds, backbones=curves)


def _curve(run: IncrementalCase, mode: int) -> Arrays:
    """Compute one backbone.

    Every amplitude starts from the preloaded joint: those that are taken over hand nothing on.
    """
    start, case = time.perf_counter(), run.case
    analysis = modal_analysis(
        run.system,
        mode,
        case.levels,
        over=case.over,
        at=case.at,
        initial=run.preloaded,
        increments=cycle_increments(case),
    )
    seconds, cycles = time.perf_counter() - start, []
    for number in range(len(case.levels)):
        name = f"mode {mode}, amplitude {number + 1}"
        cycle, took = run.steps.value(ModalCycle, name, partial(analysis.cycle, number))
        cycles.append(cycle)
        seconds += took
        run.progress(1)
    curve = analysis.backbone(cycles, masing=case.masing)
    return {**flattened(curve), SECONDS: np.asarray(seconds)}


def cycle_increments(case: LoadCaseSection) -> int:
    """Return the increments of a full cycle."""
    return 4 * (case.increments or DEFAULT_INCREMENTS)
