"""Tasks in processes of this machine; where a process dies, another repeats its task."""

import os
import pickle
import signal
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import Any

from faying.exceptions import CampaignError
from faying.execution.executor import Function, Prepare, Results, results_of
from faying.iterations import RETRIES
from faying.linalg.threads import limit_threads

# Spawned, not forked: a fork copies the locks of threads that do not exist in the copy.
CONTEXT = get_context("spawn")


@dataclass(frozen=True)
class ProcessExecutor:
    """Executor with several processes of this machine.

    Attributes
    ----------
    n_workers
        Number of processes, at most the number of tasks. They end with the campaign.
    threads
        Threads of the linear algebra in each process.

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
        """Yield index and result of each task in the order of completion.

        The death of a process ends its whole pool. Tasks that ran in it are computed
        again at the end, each alone, so that only tasks that kill a process alone are given up.
        """
        with closing(_Workers(pickled(prepare), self.threads)) as workers:
            tried = partial(results_of, workers.submit, tasks, death=BrokenProcessPool)
            workers.count = min(self.n_workers, len(tasks))
            suspects = yield from tried(range(len(tasks)), together=self.n_workers)
            workers.count = 1
            for task in suspects:
                deaths = 1
                while deaths < RETRIES and (yield from tried([task], together=1)):
                    deaths += 1
                if deaths == RETRIES:
                    yield task, None


class _Workers:
    """A pool of processes, replaced where one of them has died."""

    def __init__(self, payload: bytes, threads: int) -> None:
        self.payload, self.threads, self.count, self.unprepared = payload, threads, 1, 0
        self.ready = CONTEXT.Event()
        self.pool: ProcessPoolExecutor | None = None

    def submit(self, task: Any) -> "Future[Any]":
        """Submit a task to the pool, which is replaced where a process has died."""
        try:
            return self._pool().submit(_computed, task)
        except BrokenProcessPool:
            self._replace()
            return self._pool().submit(_computed, task)

    def _pool(self) -> ProcessPoolExecutor:
        if self.pool is None:
            self.ready.clear()
            arguments = self.payload, self.ready, self.threads
            self.pool = ProcessPoolExecutor(self.count, CONTEXT, _begin, arguments)
        return self.pool

    def _replace(self) -> None:
        """Close a pool in which a process died; raise where processes repeatedly die at start."""
        self.unprepared = 0 if self.ready.is_set() else self.unprepared + 1
        if self.unprepared == RETRIES:
            message = (
                f"{self.unprepared} worker processes died before they were ready (often for lack "
                "of memory: use fewer); a script must call this below "
                "'if __name__ == \"__main__\":'"
            )
            raise CampaignError(message) from None
        self.close()

    def close(self) -> None:
        """End the processes at once."""
        if self.pool is not None:
            # As terminate_workers of Python 3.14.
            for process in list((self.pool._processes or {}).values()):
                process.terminate()
            self.pool.shutdown(cancel_futures=True)
        self.pool = None


def pickled(value: object) -> bytes:
    """Return the pickled bytes of a value for the workers."""
    try:
        return pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        message = (
            f"{value!r} cannot be sent to other processes ({error}); give a function of a module "
            "or functools.partial of one, and let it build what cannot be sent"
        )
        raise CampaignError(message) from None


_SENT: dict[str, Any] = {}
"""In a worker: the pickled ``prepare``, and the function that it returned."""


def _begin(payload: bytes, ready: Any, threads: int) -> None:
    """Initialize a worker, which ends with its parent and leaves Ctrl-C to it.

    Threads are set here, not by environment variables of the parent, which its other threads
    may be reading.
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
    """Compute a task on a worker, after preparation at the first task."""
    try:
        if "function" not in _SENT:
            _SENT["function"] = pickle.loads(_SENT["payload"])()
            _SENT["ready"].set()
        function: Function = _SENT["function"]
        return function(task)
    except Exception as error:
        raise _sendable(error) from None


def _sendable(error: Exception) -> Exception:
    """Return an error, replaced by its message where it cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return CampaignError(f"{type(error).__name__}: {error}")
    return error
