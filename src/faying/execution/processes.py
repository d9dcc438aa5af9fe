"""Tasks in processes of this machine; where one dies others go on with its task."""

import os
import pickle
import signal
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import Any

from faying.exceptions import CampaignError
from faying.execution.executor import FATAL_DEATHS, Function, LostTasksError, Prepare, Results
from faying.linalg.threads import limit_threads

# Spawned, not forked: a fork copies the locks of threads that do not exist in the copy.
CONTEXT = get_context("spawn")


@dataclass(frozen=True)
class ProcessExecutor:
    """Processes of this machine.

    Attributes
    ----------
    n_workers
        Processes at a time, no more than there are tasks. They end with the campaign.
    threads
        Threads of the linear algebra in each.

    Notes
    -----
    As with every use of :mod:`multiprocessing`, a script calls it below
    ``if __name__ == "__main__":``, for each process reads the script again.
    """

    n_workers: int
    threads: int = 1

    def __post_init__(self) -> None:
        for count, what in ((self.n_workers, "workers"), (self.threads, "threads per worker")):
            if count < 1:
                message = f"the number of {what} is {count}; give at least one"
                raise CampaignError(message)

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield place and result of each task as they come.

        A pool whose process dies is lost as a whole: what was being computed in it is computed
        again at the end, each task alone, so that only those are given up that kill by themselves.
        """
        payload, lost = pickled(prepare), list[int]()
        suspects = yield from self._tried(payload, tasks, range(len(tasks)), self.n_workers)
        for task in suspects:
            for _ in range(FATAL_DEATHS - 1):
                if not (yield from self._tried(payload, tasks, [task], 1)):
                    break
            else:
                lost.append(task)
        if lost:
            raise LostTasksError(lost)

    def _tried(
        self, payload: bytes, tasks: Sequence[Any], places: Sequence[int], size: int
    ) -> Generator[tuple[int, Any], None, list[int]]:
        """Yield results of some tasks; return those that were at work when a process died."""
        waiting, suspects, unprepared = deque(places), list[int](), 0
        while waiting:
            ready, running = CONTEXT.Event(), dict[Future[Any], int]()
            try:
                with self._pool(min(size, len(waiting)), payload, ready) as pool:
                    while waiting or running:
                        while waiting and len(running) < size:
                            future = pool.submit(_computed, tasks[waiting[0]])
                            running[future] = waiting.popleft()
                        for future in wait(running, return_when=FIRST_COMPLETED).done:
                            result = future.result()
                            yield running.pop(future), result
            except BrokenProcessPool:
                if ready.is_set():
                    suspects += running.values()
                    continue
                waiting.extendleft(reversed(running.values()))
                unprepared += 1
                if unprepared == FATAL_DEATHS:
                    message = (
                        f"{unprepared} worker processes died before they were ready (often for "
                        "lack of memory: use fewer); a script must call this below "
                        "'if __name__ == \"__main__\":'"
                    )
                    raise CampaignError(message) from None
        return sorted(suspects)

    @contextmanager
    def _pool(self, size: int, payload: bytes, ready: Any) -> Iterator[ProcessPoolExecutor]:
        """Yield a pool whose processes end with it, whatever they are at."""
        pool = ProcessPoolExecutor(size, CONTEXT, _begin, (payload, ready, self.threads))
        try:
            yield pool
            pool.shutdown()
        finally:
            # What terminate_workers of Python 3.14 does; after a shutdown there are none.
            for process in list((pool._processes or {}).values()):
                process.terminate()
            pool.shutdown(cancel_futures=True)


def pickled(value: object) -> bytes:
    """Return what is sent to the workers.

    Raises
    ------
    CampaignError
        If it cannot be sent.
    """
    try:
        return pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        message = (
            f"{value!r} cannot be sent to other processes ({error}); give a function of a module "
            "or functools.partial of one, and let it build what cannot be sent"
        )
        raise CampaignError(message) from None


_SENT: dict[str, Any] = {}
"""In a worker: what it prepares from, and the function that came of it."""


def _begin(payload: bytes, ready: Any, threads: int) -> None:
    """Begin a worker, which ends with its parent and leaves Ctrl-C to it.

    Threads are set here and not by variables of the parent's environment, which its other threads
    may read at that moment.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    limit_threads(threads)
    Thread(target=_end_with_parent, daemon=True).start()
    _SENT.update(payload=payload, ready=ready)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _computed(task: Any) -> Any:
    """Compute a task on a worker, which prepares before its first."""
    try:
        if "function" not in _SENT:
            _SENT["function"] = pickle.loads(_SENT["payload"])()
            _SENT["ready"].set()
        function: Function = _SENT["function"]
        return function(task)
    except Exception as error:
        raise _sendable(error) from None


def _sendable(error: Exception) -> Exception:
    """Return an error, in words where it cannot be sent itself."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return CampaignError(f"{type(error).__name__}: {error}")
    return error
