"""The interface of executors: prepare once per worker, then call a function per task."""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from typing import Any, Protocol

Function = Callable[[Any], Any]
"""Function from a task to its result; both can be pickled."""

Prepare = Callable[[], Function]
"""Called once by a worker: builds a model, factorizes it, returns the function of the tasks.

It is pickled, so it must be a function of a module, or ``functools.partial`` of one. The function
it returns is not, so that this may hold factorizations.
"""

Results = Generator[tuple[int, Any], None, None]
"""Indices of tasks and their results, None at last for a task that killed several workers;
closing the generator ends running tasks."""


class Executor(Protocol):
    """A computer of tasks."""

    @property
    def n_workers(self) -> int:
        """Number of workers at present."""

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield index and result of each task in the order of completion.

        Parameters
        ----------
        prepare
            Called once by each worker.
        tasks
            Arguments of the prepared function. Tasks of a dead worker are given to others.

        Raises
        ------
        CampaignError
            If no worker is available.
        Exception
            Any error of ``prepare`` or its function, at once.
        """


def results_of(
    submit: Callable[[Any], "Future[Any]"],
    tasks: Sequence[Any],
    places: Iterable[int],
    *,
    together: int,
    death: type[Exception],
    watch: Callable[[], float | None] = lambda: None,
) -> Generator[tuple[int, Any], None, list[int]]:
    """Yield index and result of tasks as they complete; return the tasks whose workers died.

    ``submit`` sends a task to a worker; ``together`` tasks run at a time. Futures raise ``death``
    where a worker died. ``watch``, called before each wait, returns the seconds to wait at most,
    or raises where waiting is useless.
    """
    waiting, running, suspects = deque(places), dict[Future[Any], int](), list[int]()
    try:
        while waiting or running:
            while waiting and len(running) < together:
                place = waiting.popleft()
                running[submit(tasks[place])] = place
            for future in wait(running, watch(), FIRST_COMPLETED).done:
                place = running.pop(future)
                try:
                    result = future.result()
                except death:
                    suspects.append(place)
                    continue
                yield place, result
    finally:
        for future in running:
            future.cancel()
    return sorted(suspects)


@dataclass(frozen=True)
class SerialExecutor:
    """Executor in this process, the reference of all others."""

    @property
    def n_workers(self) -> int:
        """Number of workers: always one."""
        return 1

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield index and result of each task in order."""
        if not tasks:
            return
        function = prepare()
        for number, task in enumerate(tasks):
            yield number, function(task)
