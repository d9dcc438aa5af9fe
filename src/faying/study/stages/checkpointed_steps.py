"""Parts of what one model answers to a load case, kept as they come for a run that resumes."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from faying.execution.checkpoint import Arrays, Bundles
from faying.files.flattening import flattened, restored
from faying.joint.model import Model
from faying.joint.system import System
from faying.simulation.solution import Solution
from faying.study.keys.tables import LoadCaseSection

T = TypeVar("T")

SECONDS = "seconds"
"""Name of the wall time that a piece took, in whichever run, beside its arrays."""


@dataclass(frozen=True)
class CheckpointedSteps:
    """Where pieces of a response are kept, and the key of the whole of it."""

    checkpoint: Bundles
    key: str

    def has(self, name: str) -> bool:
        """Say whether a piece is there."""
        return self.checkpoint.has(self._key(name))

    def take(self, name: str, compute: Callable[[], Arrays]) -> Arrays:
        """Return a piece, as an interrupted run left it or computed and kept, with its seconds.

        Of a piece of pieces ``compute`` says itself how long these took.
        """

        def timed() -> Arrays:
            start = time.perf_counter()
            arrays = compute()
            return {SECONDS: np.asarray(time.perf_counter() - start), **arrays}

        return self.checkpoint.bundle(self._key(name), timed)

    def value(self, kind: type[T], name: str, compute: Callable[[], T]) -> tuple[T, float]:
        """Return a piece that is a value of some kind, and the seconds it took."""
        arrays = self.take(name, lambda: flattened(compute()))
        return restored(kind, arrays), float(arrays[SECONDS])

    def _key(self, name: str) -> str:
        return f"{self.key}, {name}"


@dataclass(frozen=True, eq=False, kw_only=True)
class IncrementalCase:
    """A load case that a system answers in increments, from its preloaded state.

    Attributes
    ----------
    model
        The full model.
    steps
        Where finished amplitudes and increments are kept.
    progress
        Called with how many increments or amplitudes there are more, computed or taken over.
    """

    case: LoadCaseSection
    model: Model
    system: System
    preloaded: Solution
    steps: CheckpointedSteps
    progress: Callable[[int], object]
