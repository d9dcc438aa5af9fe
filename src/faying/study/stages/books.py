"""The books of a run: wall times, progress, failures, and finished values."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from time import perf_counter as clock
from types import TracebackType
from typing import Any, Protocol, TypeVar

import numpy as np

from faying._typing import Matrix
from faying.exceptions import FayingError
from faying.execution.checkpoint import Bundles
from faying.files.flattening import flattened, restored

FAILED, SECONDS = "failed", "wall_seconds"
"""Names under which failures and wall time are stored beside the arrays of a value."""

T = TypeVar("T")


class ProgressBar(Protocol):
    """The part of ``rich.progress.Progress`` that a run uses."""

    def add_task(self, description: str, *, total: float | None = None) -> Any:
        """Start a bar, and return its number."""

    def advance(self, task: Any, advance: float = 1) -> None:
        """Advance a bar."""

    def remove_task(self, task: Any) -> None:
        """Remove a finished bar."""


class Books:
    """Wall times, progress, failures and finished values of a run.

    A named stage shows a bar, and its wall time is recorded. The time of a stage within another
    counts once, so that the times add up. Optional work is attempted, and its failure is a
    warning. Finished values are stored.

    Parameters
    ----------
    since
        Instant of ``time.perf_counter`` at which the program started; the time since then is
        the stage ``start``. By default the run starts now.
    checkpoint
        Store of finished values; memory unless given.

    Attributes
    ----------
    failed
        Sentences about optional work that failed, in the order of the run.
    """

    def __init__(
        self,
        bar: ProgressBar | None = None,
        since: float | None = None,
        checkpoint: Bundles | None = None,
    ) -> None:
        now = clock()
        self.seconds: dict[str, float] = {} if since is None else {"start": now - since}
        self.failed: list[str] = []
        self.checkpoint = Bundles() if checkpoint is None else checkpoint
        self._since = now if since is None else since
        self._within: list[float] = []
        self._bar = bar

    @contextmanager
    def stage(self, name: str, total: float | None = None) -> Iterator[Callable[[int], None]]:
        """Time a stage, and yield a function to report its progress. Repeated stages add up."""
        task = self._bar.add_task(name, total=total) if self._bar else None

        def advance(amount: int = 1) -> None:
            if self._bar:
                self._bar.advance(task, amount)

        try:
            with self.timed(name):
                yield advance
        finally:
            if self._bar:
                self._bar.remove_task(task)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Time a stage without a progress bar."""
        start = clock()
        self._within.append(0.0)
        try:
            yield
        finally:
            elapsed = clock() - start
            alone = elapsed - self._within.pop()
            self.seconds[name] = self.seconds.get(name, 0.0) + alone
            if self._within:
                self._within[-1] += elapsed

    def account(self) -> dict[str, float]:
        """Return the seconds of the stages so far, and as ``other`` the time outside all stages.

        The sum is the wall time since the start.
        """
        whole = clock() - self._since
        return {**self.seconds, "other": whole - sum(self.seconds.values())}

    def attempt(self, name: str) -> "ExitStack[bool]":
        """Return a context for optional work, in which an error becomes a warning under a name.

        An unforeseen error must not lose what was computed before, so errors of
        every kind are caught. Interrupts are not.
        """
        tried: ExitStack[bool] = ExitStack()
        tried.push(partial(self._noted, name))
        return tried

    def _noted(
        self,
        name: str,
        _kind: type[BaseException] | None,
        error: BaseException | None,
        _trace: TracebackType | None,
    ) -> bool:
        """Record an error; return whether it is suppressed."""
        if not isinstance(error, Exception):
            return False
        known = isinstance(error, FayingError)
        said = f"{name}: {error if known else f'{type(error).__name__}: {error}'}"
        if said not in self.failed:
            self.failed.append(said)
        return True

    def value(self, kind: type[T], key: str, compute: Callable[[], T]) -> T:
        """Return the value stored under a key, or compute and store it.

        Failures are stored with it, because a resumed run does not try again.
        """
        return self.timed_value(kind, key, compute)[0]

    def timed_value(self, kind: type[T], key: str, compute: Callable[[], T]) -> tuple[T, float]:
        """Return the value stored under a key, or computed, and the seconds of its computation."""
        n_failed, computing = len(self.failed), 0.0

        def arrays() -> dict[str, Matrix]:
            nonlocal computing
            start = clock()
            members = flattened(compute())
            computing = clock() - start
            failed = np.array(self.failed[n_failed:], dtype=str)
            return {**members, FAILED: failed, SECONDS: np.asarray(computing)}

        start = clock()
        bundle = self.checkpoint.bundle(key, arrays)
        value = restored(kind, bundle)
        # The time of computing the value belongs to the calling stage.
        keeping = clock() - start - computing
        self.seconds["checkpoint"] = self.seconds.get("checkpoint", 0.0) + keeping
        if self._within:
            self._within[-1] += keeping
        repeated: Iterable[str] = map(str, bundle.get(FAILED, ()))
        self.failed.extend(text for text in repeated if text not in self.failed)
        return value, float(bundle.get(SECONDS, 0.0))
