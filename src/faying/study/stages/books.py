"""The books of a run: its times and progress, what failed, and what is finished."""

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
"""Names of the sentences about what failed, and of the wall time, beside the arrays of a value."""

T = TypeVar("T")


class ProgressBar(Protocol):
    """The part of ``rich.progress.Progress`` that a run uses."""

    def add_task(self, description: str, *, total: float | None = None) -> Any:
        """Start a bar."""

    def advance(self, task: Any, advance: float = 1) -> None:
        """Move a bar on."""

    def remove_task(self, task: Any) -> None:
        """Take a finished bar away."""


class Books:
    """What a run notes while it computes.

    Named stages show a bar while they last and leave their wall time; a stage within another one
    counts for itself alone, so the times add up. What a run can do without is attempted, and a
    failure is a warning. What is finished is kept.

    Parameters
    ----------
    since
        Instant of ``time.perf_counter`` at which the program started; what passed since then is
        the stage ``start``. Without it the run is counted from now.
    checkpoint
        Where finished pieces are kept; in memory unless given.

    Attributes
    ----------
    failed
        What could not be done and why, one sentence each, in the order of the run.
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
        """Time a stage; yields a function to call as it advances. Repeated stages add up."""
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
        """Time a stage that is too short, or too scattered, to be shown while it lasts."""
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
        """Return the seconds of the stages so far, and as ``other`` those outside all of them.

        Together they are the wall time since the start, between stages.
        """
        whole = clock() - self._since
        return {**self.seconds, "other": whole - sum(self.seconds.values())}

    def attempt(self, name: str) -> "ExitStack[bool]":
        """Return a context that tries what a run can do without; what it raises is noted by name.

        That it meets what nobody foresaw must not cost what was computed before it, so errors of
        every kind stop here. Interrupts do not.
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
        """Note an error; say whether it ends here."""
        if not isinstance(error, Exception):
            return False
        known = isinstance(error, FayingError)
        said = f"{name}: {error if known else f'{type(error).__name__}: {error}'}"
        if said not in self.failed:
            self.failed.append(said)
        return True

    def value(self, kind: type[T], key: str, compute: Callable[[], T]) -> T:
        """Return a value as it is kept under a key, or compute and keep it.

        With what failed meanwhile, for a run that takes it over does not try again.
        """
        return self.timed_value(kind, key, compute)[0]

    def timed_value(self, kind: type[T], key: str, compute: Callable[[], T]) -> tuple[T, float]:
        """Return a value in the same way, and the seconds it took in whichever run."""
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
        # What it takes to compute the value belongs to the stage that asks for it.
        keeping = clock() - start - computing
        self.seconds["checkpoint"] = self.seconds.get("checkpoint", 0.0) + keeping
        if self._within:
            self._within[-1] += keeping
        repeated: Iterable[str] = map(str, bundle.get(FAILED, ()))
        self.failed.extend(text for text in repeated if text not in self.failed)
        return value, float(bundle.get(SECONDS, 0.0))
