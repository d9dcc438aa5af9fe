"""Progress and timing of a run, so that the steps of the run itself stay readable."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
    """Named stages of a run: each shows a bar while it lasts and leaves its wall time."""

    def __init__(self, bar: ProgressBar | None) -> None:
        self.seconds: dict[str, float] = {}
        self._bar = bar

    @contextmanager
    def stage(self, name: str, total: float | None = None) -> Iterator[Callable[[int], None]]:
        """Time a stage; yields a function to call as it advances. Repeated stages add up."""
        task = self._bar.add_task(name, total=total) if self._bar else None

        def advance(amount: int = 1) -> None:
            if self._bar:
                self._bar.advance(task, amount)

        start = time.perf_counter()
        try:
            yield advance
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
            if self._bar:
                self._bar.remove_task(task)
