"""What every executor offers: prepare once per worker, then one function call per task."""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from typing import Any, Protocol

from faying.exceptions import CampaignError
from faying.iterations import RETRIES

Function = Callable[[Any], Any]
"""From a task to its result; both can be pickled."""

Prepare = Callable[[], Function]
"""What a worker does once: build a model, factorize it, return the function of the tasks.

It is sent to the workers, so it is a function of a module, or ``functools.partial`` of one. What it
returns is not sent: factorizations, which do not pickle, may live in it.
"""

Results = Generator[tuple[int, Any], None, None]
"""Places of tasks and their results; closing it ends what still works on them."""


class Executor(Protocol):
    """Something that maps tasks to results."""

    @property
    def n_workers(self) -> int:
        """Workers there are at present."""
        ...

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield the place of each task and its result, as they come, in any order.

        Parameters
        ----------
        prepare
            Called once by each worker.
        tasks
            Tasks of a worker that dies are given to others.

        Raises
        ------
        LostTasksError
            At the end, after all other results: tasks whose workers died again and again.
        CampaignError
            If there is no worker to be had.
        Exception
            Whatever ``prepare`` or its function raise, at once.
        """
        ...


def results_of(
    submit: Callable[[Any], "Future[Any]"],
    tasks: Sequence[Any],
    places: Iterable[int],
    *,
    together: int,
    death: type[Exception],
    watch: Callable[[], float | None] = lambda: None,
) -> Generator[tuple[int, Any], None, list[int]]:
    """Yield place and result of some tasks as they come; return those whose workers died.

    ``submit`` sends a task to a worker, ``together`` of them at a time; futures raise ``death``
    where it died. ``watch``, called before each waiting, returns how many seconds to wait at most
    before it is called again, or raises where there is nothing to wait for.
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


class LostTasksError(CampaignError):
    """Tasks that killed every worker they were given to.

    Attributes
    ----------
    places
        Which of the tasks.
    """

    def __init__(self, places: Sequence[int]) -> None:
        self.places = tuple(places)
        shown = ", ".join(str(task + 1) for task in self.places)
        message = (
            f"every worker that tried task number {shown} died, {RETRIES} at least; a worker "
            "dies without a message where memory runs out: give each more of it"
        )
        super().__init__(message)


@dataclass(frozen=True)
class SerialExecutor:
    """The reference of all executors: nothing is sent anywhere."""

    @property
    def n_workers(self) -> int:
        """Always one: this process."""
        return 1

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield place and result of each task in their order."""
        if not tasks:
            return
        function = prepare()
        for number, task in enumerate(tasks):
            yield number, function(task)
