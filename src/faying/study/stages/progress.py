"""Progress and timing of a run, so that the steps of the run itself stay readable."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter as clock
from typing import Any, Protocol


class ProgressBar(Protocol):
    """The part of ``rich.progress.Progress`` that a run uses."""

    def add_task(self, description: str, *, total: float | None = None) -> Any:
        """Start a bar."""
        ...

    def advance(self, task: Any, advance: float = 1) -> None:
        """Move a bar on."""
        ...

    def remove_task(self, task: Any) -> None:
        """Take a finished bar away."""
        ...


class Stages:
    """Named stages of a run: each shows a bar while it lasts and leaves its wall time.

    A stage within another one counts for itself alone, so the times add up.

    Parameters
    ----------
    since
        Instant of ``time.perf_counter`` at which the program started; what passed since then is
        the stage ``start``. Without it the run is counted from now.
    """

    def __init__(self, bar: ProgressBar | None, since: float | None = None) -> None:
        now = clock()
        self.seconds: dict[str, float] = {} if since is None else {"start": now - since}
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
