"""Tasks in processes of this machine; one that dies is replaced and its task redone."""

import os
import pickle
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

from faying.exceptions import CampaignError
from faying.execution.executor import FATAL_DEATHS, Function, LostTasksError, Prepare, Results

# Spawned, not forked: a fork copies the locks of threads that do not exist in the copy.
CONTEXT = get_context("spawn")

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMBA_NUM_THREADS",
)
"""Where the libraries below NumPy look, when they are loaded, how many threads they may use."""


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
        """Yield place and result of each task as they come."""
        crew = _Crew(
            payload=pickled(prepare), tasks=tasks, size=self.n_workers, threads=self.threads
        )
        try:
            yield from crew.results()
        finally:
            crew.dismiss()


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


@dataclass(eq=False)
class _Worker:
    """A process, this end of its pipe, and what it is at."""

    process: SpawnProcess
    connection: Connection
    prepared: bool = False
    place: int | None = None


@dataclass(eq=False, kw_only=True)
class _Crew:
    """The workers of one map, and what is left to do."""

    payload: bytes
    tasks: Sequence[Any]
    size: int
    threads: int
    workers: dict[Connection, _Worker] = field(default_factory=dict)
    waiting: deque[int] = field(default_factory=deque)
    deaths: Counter[int] = field(default_factory=Counter)
    lost: list[int] = field(default_factory=list)
    unprepared: int = 0

    def results(self) -> Iterator[tuple[int, Any]]:
        """Hand tasks out and yield what comes back."""
        self.waiting.extend(range(len(self.tasks)))
        unfinished = len(self.tasks)
        while unfinished > len(self.lost):
            self._staff(unfinished - len(self.lost))
            for connection in wait(list(self.workers)):
                worker = self.workers[connection]  # type: ignore[index]  # pipes are connections
                try:
                    kind, content = worker.connection.recv()
                except (EOFError, OSError):
                    self._take_back(worker)
                    continue
                if kind == "raised":
                    raise content
                if kind == "done" and worker.place is not None:
                    place, worker.place = worker.place, None
                    unfinished -= 1
                    yield place, content
                worker.prepared, self.unprepared = True, 0
                self._occupy(worker)
        if self.lost:
            raise LostTasksError(sorted(self.lost))

    def dismiss(self) -> None:
        """End all workers."""
        for worker in self.workers.values():
            worker.connection.close()
            worker.process.terminate()
        for worker in self.workers.values():
            _ended(worker.process)
        self.workers.clear()

    def _staff(self, unfinished: int) -> None:
        """Replace who died and give the idle what there is."""
        for worker in self.workers.values():
            if worker.prepared and worker.place is None:
                self._occupy(worker)
        while self.waiting and len(self.workers) < min(self.size, unfinished):
            worker = _started(self.payload, self.threads)
            self.workers[worker.connection] = worker

    def _occupy(self, worker: _Worker) -> None:
        if not self.waiting:
            return
        worker.place = self.waiting.popleft()
        # Where it has died, its pipe says so when it is read next, and the task goes back.
        with suppress(OSError):
            worker.connection.send(self.tasks[worker.place])

    def _take_back(self, worker: _Worker) -> None:
        """Take a dead worker's task back, or give up a task that kills."""
        del self.workers[worker.connection]
        worker.connection.close()
        code = _ended(worker.process)
        if worker.place is not None:
            self.deaths[worker.place] += 1
            if self.deaths[worker.place] < FATAL_DEATHS:
                self.waiting.appendleft(worker.place)
            else:
                self.lost.append(worker.place)
        elif not worker.prepared:
            self.unprepared += 1
            if self.unprepared >= FATAL_DEATHS:
                message = (
                    f"{self.unprepared} worker processes died before they were ready (exit code "
                    f"{code}; -9 is often lack of memory: use fewer); a script must call this "
                    "below 'if __name__ == \"__main__\":'"
                )
                raise CampaignError(message)


def _ended(process: SpawnProcess) -> int | None:
    """Wait for a process to end, make it if need be, and return its exit code."""
    process.join(timeout=5.0)
    if process.is_alive():
        process.kill()
        process.join()
    code = process.exitcode
    process.close()
    return code


def _started(payload: bytes, threads: int) -> _Worker:
    ours, theirs = CONTEXT.Pipe()
    process = CONTEXT.Process(target=_work, args=(theirs, payload), daemon=True)
    with _threads_of_children(threads):
        process.start()
    theirs.close()
    return _Worker(process, ours)


@contextmanager
def _threads_of_children(threads: int) -> Iterator[None]:
    """Set how many threads processes started meanwhile may use: read before NumPy is there."""
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, str(threads)))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _work(connection: Connection, payload: bytes) -> None:
    """Do what comes through the pipe until it is closed."""
    # Ctrl-C reaches the whole group; this process is ended by its parent.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(EOFError, OSError):  # the parent is gone: nobody is left to tell
        try:
            function = pickle.loads(payload)()
        except Exception as error:
            connection.send_bytes(_raised(error))
            return
        connection.send_bytes(pickle.dumps(("prepared", None)))
        while True:
            connection.send_bytes(_outcome(function, connection.recv()))


def _outcome(function: Function, task: Any) -> bytes:
    try:
        return pickle.dumps(("done", function(task)))
    except Exception as error:
        return _raised(error)


def _raised(error: Exception) -> bytes:
    """Return a message for the parent to raise; in words where the error cannot be sent."""
    try:
        message = pickle.dumps(("raised", error))
        pickle.loads(message)
    except Exception:
        return pickle.dumps(("raised", CampaignError(f"{type(error).__name__}: {error}")))
    return message
